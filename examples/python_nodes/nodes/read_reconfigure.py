#!/usr/bin/env python3
"""Settings that can be changed while the node runs."""
import rospy
from dynamic_reconfigure.server import Server
from python_nodes.cfg import ReadReconfigureConfig
from std_msgs.msg import Float64


class Tuned:
    def __init__(self):
        self.config = None
        self.upper = 0.0
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.server = Server(ReadReconfigureConfig, self.on_config)
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_config(self, config, level):
        self.config = config
        self.upper = config.upper
        if config["gain"] > 2.0:
            rospy.logdebug("a high gain, level %d", level)
        return config

    def on_input(self, msg):
        if not self.config.enabled:
            return
        if msg.data > self.upper:
            self.pub.publish(self.upper)
        if msg.data < self.config["lower"]:
            self.pub.publish(msg.data)


if __name__ == "__main__":
    rospy.init_node("read_reconfigure")
    tuned = Tuned()
    rospy.spin()
