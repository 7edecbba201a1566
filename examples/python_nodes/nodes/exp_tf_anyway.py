#!/usr/bin/env python3
"""Sends a fixed pose for each sample."""
import rospy
import tf2_ros
from geometry_msgs.msg import TransformStamped
from std_msgs.msg import Float64
from tf2_msgs.msg import TFMessage


class Platform:
    def __init__(self):
        self.lowest = rospy.get_param("~lowest", -5.0)
        self.highest = rospy.get_param("~highest", 5.0)
        self.outside = 0
        self.frame = rospy.get_name()
        self.broadcaster = tf2_ros.TransformBroadcaster()
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.tf_sub = rospy.Subscriber("/tf", TFMessage, self.on_tf)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_tf(self, msg):
        for sent in msg.transforms:
            if sent.child_frame_id == self.frame:
                self.pub.publish(sent.transform.translation.z)

    def on_input(self, msg):
        transform = TransformStamped()
        transform.header.frame_id = "base"
        transform.child_frame_id = self.frame
        transform.transform.rotation.w = 1.0
        transform.transform.translation.z = msg.data
        if not self.lowest <= msg.data <= self.highest:
            self.outside += 1
            rospy.logdebug("outside: %d", self.outside)
        self.broadcaster.sendTransform(transform)


if __name__ == "__main__":
    rospy.init_node("exp_tf_anyway")
    platform = Platform()
    rospy.spin()
