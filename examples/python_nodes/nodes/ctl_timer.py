#!/usr/bin/env python3
"""A watchdog that publishes while samples come."""
import rospy
from std_msgs.msg import Float64


class Watchdog:
    def __init__(self):
        self.missed = rospy.get_param("~missed", 5)
        self.level = rospy.get_param("~level", 9.0)
        self.reported = rospy.get_param("~reported", 50)
        self.ticks = 0
        self.worst = 0.0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)
        self.timer = rospy.Timer(rospy.Duration(0.1), self.on_tick)
        self.log_timer = rospy.Timer(rospy.Duration(0.2), self.on_log)

    def on_input(self, msg):
        self.ticks = 0
        if abs(msg.data) < self.level:
            self.worst = max(self.worst, abs(msg.data))

    def on_tick(self, event):
        self.ticks += 1
        if self.ticks <= self.missed:
            self.pub.publish(self.worst)

    def on_log(self, event):
        if self.ticks > self.reported:
            rospy.logdebug("no samples since %d ticks", self.ticks)


if __name__ == "__main__":
    rospy.init_node("ctl_timer")
    watchdog = Watchdog()
    rospy.spin()
