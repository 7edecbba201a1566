#!/usr/bin/env python3
"""Several levels, in containers."""
import rospy
from std_msgs.msg import Float64, Int32


class Levels:
    def __init__(self):
        self.levels = [rospy.get_param("~first", 2.0)]
        self.levels.append(rospy.get_param("~second", 6.0))
        self.names = {"deep": rospy.get_param("~deep", -6.0), "note": 0.0}
        self.names["loud"] = rospy.get_param("~loud", 8.0)
        self.names.update(faint=rospy.get_param("~faint", 0.5))
        self.pub = rospy.Publisher("output", Int32, queue_size=1000)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        reached = 0
        for level in self.levels:
            if msg.data < level:
                break
            reached += 1
        self.pub.publish(reached)
        if msg.data < self.names["deep"]:
            self.pub.publish(-1)
        if abs(msg.data) < self.names["faint"]:
            self.pub.publish(-2)
        if msg.data > self.names["loud"]:
            rospy.logdebug("loud")
        if msg.data > self.names["note"]:
            self.pub.publish(-3)


if __name__ == "__main__":
    rospy.init_node("val_containers")
    levels = Levels()
    rospy.spin()
