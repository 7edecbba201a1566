#!/usr/bin/env python3
"""Answers whether the last sample was good; the node asks itself to show it works."""
import rospy
from std_msgs.msg import Bool, Float64
from std_srvs.srv import SetBool, SetBoolResponse, Trigger, TriggerResponse


class Judge:
    def __init__(self):
        self.limit = rospy.get_param("~limit", 5.0)
        self.tolerance = rospy.get_param("~tolerance", 2.0)
        self.noted = rospy.get_param("~noted", 0.0)
        self.value = 0.0
        self.is_on = False
        self.pub = rospy.Publisher("asked", Bool, queue_size=1000)
        self.judge_server = rospy.Service("judge", Trigger, self.on_judge)
        self.set_server = rospy.Service("switch", SetBool, self.on_switch)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_judge(self, request):
        if self.value > self.limit:
            return TriggerResponse(success=False, message="too high")
        if self.value < self.noted:
            rospy.logdebug("asked for a negative value")
        return TriggerResponse(success=True, message="good")

    def on_switch(self, request):
        response = SetBoolResponse(success=True)
        if request.data and abs(self.value) > self.tolerance:
            response.success = False
        return response

    def on_input(self, msg):
        self.value = msg.data
        self.pub.publish(True)


if __name__ == "__main__":
    rospy.init_node("exp_service_response")
    judge = Judge()
    rospy.spin()
