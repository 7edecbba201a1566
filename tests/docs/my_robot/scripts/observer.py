#!/usr/bin/env python3
"""Marks each second that the last picture was taken more than three seconds ago."""

import rospy
from std_msgs.msg import Float64, Time

rospy.init_node("observer")
last = [rospy.get_time()]
mark = rospy.Publisher("/mark_no_action", Time, queue_size=10)
rospy.Subscriber("/mission/picture", Float64, lambda _: last.append(rospy.get_time()))
while not rospy.is_shutdown():
    if rospy.get_time() - last[-1] > 3.0:
        mark.publish(rospy.get_rostime())
    rospy.sleep(1.0)
