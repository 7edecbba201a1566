#!/usr/bin/env python3
"""Calls services; the node offers them itself and publishes each call."""
import rospy
from std_msgs.msg import Float64, Int32
from std_srvs.srv import SetBool, SetBoolResponse, Trigger, TriggerResponse


class Caller:
    def __init__(self):
        self.high = rospy.get_param("~high", 6.0)
        self.low = rospy.get_param("~low", -6.0)
        self.dead = rospy.get_param("~dead", 1.0)
        self.noted = rospy.get_param("~noted", 3.0)
        self.pub = rospy.Publisher("output", Int32, queue_size=1000)
        self.trigger_server = rospy.Service("high", Trigger, self.on_trigger)
        self.set_server = rospy.Service("low", SetBool, self.on_set)
        self.trigger = rospy.ServiceProxy("high", Trigger)
        self.set_low = rospy.ServiceProxy("low", SetBool)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_trigger(self, request):
        self.pub.publish(1)
        return TriggerResponse(success=True)

    def on_set(self, request):
        self.pub.publish(2)
        return SetBoolResponse(success=request.data)

    def on_input(self, msg):
        if msg.data > self.high:
            self.trigger()
        if msg.data < self.low:
            self.set_low.call(data=True)
        if abs(msg.data) < self.dead:
            rospy.ServiceProxy("low", SetBool)(False)
        if msg.data > self.noted:
            rospy.logdebug("high soon")


if __name__ == "__main__":
    rospy.init_node("exp_service_proxy")
    caller = Caller()
    rospy.spin()
