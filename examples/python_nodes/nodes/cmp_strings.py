#!/usr/bin/env python3
"""Handles samples as words tell it."""
import rospy
from std_msgs.msg import String


class Words:
    def __init__(self):
        self.watch = rospy.get_param("~watch", "word")
        self.mode = rospy.get_param("~mode", "plain")
        self.allowed = rospy.get_param("~allowed", ["word", "loud"])
        self.part = rospy.get_param("~part", "ou")
        self.style = rospy.get_param("~style", "Short")
        self.prefix = rospy.get_param("~prefix", "wo")
        self.noted = rospy.get_param("~noted", "quiet")
        self.pub = rospy.Publisher("output", String, queue_size=1000)
        self.sub = rospy.Subscriber("text", String, self.on_text)

    def on_text(self, msg):
        if msg.data == self.watch:
            self.pub.publish(msg)
        if "loud" != self.mode:
            self.pub.publish("not loud")
        if msg.data in self.allowed:
            self.pub.publish("allowed")
        if self.mode not in ("plain", "loud"):
            self.pub.publish("odd mode")
        if self.part in msg.data:
            self.pub.publish("part")
        if self.style.lower() == "short":
            self.pub.publish("short")
        if msg.data.startswith(self.prefix):
            self.pub.publish("prefix")
        if msg.data == self.noted:
            rospy.logdebug("noted")


if __name__ == "__main__":
    rospy.init_node("cmp_strings")
    words = Words()
    rospy.spin()
