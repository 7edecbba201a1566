#!/usr/bin/env python3
"""Copies the whole config into a plain object."""
import rospy
from dynamic_reconfigure.server import Server
from python_nodes.cfg import ReadReconfigureConfig
from std_msgs.msg import Float64


class Settings:
    lower = -9.0
    upper = 9.0
    noise = 1.0

    def take(self, config):
        self.lower = config["lower"]
        self.upper = config.upper
        return config


settings = Settings()


def main():
    rospy.init_node("read_reconfigure_client")
    pub = rospy.Publisher("output", Float64, queue_size=1000)

    def on_input(msg):
        if settings.lower <= msg.data:
            pub.publish(msg)
        if msg.data > settings.upper:
            rospy.logdebug("above")
        if abs(msg.data) < settings.noise:
            pub.publish(0.0)

    Server(ReadReconfigureConfig, lambda config, level: settings.take(config))
    rospy.Subscriber("input", Float64, on_input)
    rospy.spin()


if __name__ == "__main__":
    main()
