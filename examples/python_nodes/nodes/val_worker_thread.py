#!/usr/bin/env python3
"""Publishes in a thread of its own."""
import queue
import threading

import rospy
from std_msgs.msg import Float64


class Worker:
    def __init__(self):
        self.limit = rospy.get_param("~limit", 2.0)
        self.loud = rospy.get_param("~loud", 6.0)
        self.noted = rospy.get_param("~noted", 6.0)
        self.jobs = queue.Queue()
        self.log = []
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.thread = threading.Thread(target=self.work, daemon=True)
        self.thread.start()
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        if msg.data > self.limit:
            self.jobs.put(msg.data)
        if msg.data < self.noted:
            self.log.append(msg.data)

    def work(self):
        while not rospy.is_shutdown():
            value = self.jobs.get()
            if value > self.loud:
                value = self.loud
            self.pub.publish(value)


if __name__ == "__main__":
    rospy.init_node("val_worker_thread")
    worker = Worker()
    rospy.spin()
