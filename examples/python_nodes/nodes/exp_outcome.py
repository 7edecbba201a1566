#!/usr/bin/env python3
"""Says whether the input is within its limits, as numbers and as an answer."""
import rospy
from std_msgs.msg import Float64
from std_srvs.srv import SetBool, SetBoolResponse


class Outcome:
    def __init__(self):
        self.volts = rospy.get_param("~volts", 1.0)
        self.low = rospy.get_param("~low", -2.0)
        self.ready = rospy.get_param("~ready", 3.0)
        self.kept = rospy.get_param("~kept", 4.0)
        self.shown = rospy.get_param("~shown", 5.0)
        self.value = 0.0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.service = rospy.Service("ready", SetBool, self.on_ready)
        self.ask = rospy.ServiceProxy("ready", SetBool)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_ready(self, request):
        return SetBoolResponse(self.value < self.ready, "")

    def on_input(self, msg):
        self.value = msg.data
        self.pub.publish(Float64(self.value < self.volts))
        out = Float64()
        out.data = self.value > self.low
        self.pub.publish(out)
        answer = self.ask(True)
        self.pub.publish(float(answer.success))
        unused = Float64()
        unused.data = self.value > self.kept
        rospy.logdebug("%s", self.value > self.shown)


if __name__ == "__main__":
    rospy.init_node("exp_outcome")
    outcome = Outcome()
    rospy.spin()
