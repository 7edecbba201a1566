#!/usr/bin/env python3
"""Takes a picture whenever a face covers enough of it, once in two seconds."""

import math

import rospy
from std_msgs.msg import Float64

rospy.init_node("mission")
min_coverage_limit = rospy.get_param("~min_coverage_limit", 0.035)
max_coverage_limit = rospy.get_param("~max_coverage_limit", 0.2)
max_height = rospy.get_param("~max_height", 4.0)
end_s = rospy.Duration(rospy.get_param("~seconds", 600.0))
rate = rospy.Rate(rospy.get_param("~rate", 20))
picture = rospy.Publisher("~picture", Float64, queue_size=10)
descend = rospy.Publisher("~descend", Float64, queue_size=10)
rospy.Timer(end_s, lambda _: rospy.signal_shutdown("the mission is over"), oneshot=True)
while not rospy.is_shutdown():
    coverage = 0.035 + 0.016 * math.sin(math.pi * rospy.get_time())
    if coverage > min_coverage_limit and coverage < max_coverage_limit:
        picture.publish(coverage)
    height = 1.6 + 0.1 * math.sin(rospy.get_time())
    if height > max_height:
        descend.publish(height)
    try:
        rate.sleep()
    except rospy.ROSInterruptException:
        break
