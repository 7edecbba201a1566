#!/usr/bin/env python3
"""Callbacks hand their samples to an event loop in a thread of its own."""
import asyncio
import threading

import rospy
from std_msgs.msg import Float64


class Node:
    def __init__(self):
        self.limit = rospy.get_param("~limit", 3.0)
        self.floor = rospy.get_param("~floor", -8.0)
        self.noted = rospy.get_param("~noted", 0.0)
        self.pub = rospy.Publisher("output", Float64, queue_size=1000)
        self.loop = asyncio.new_event_loop()
        threading.Thread(target=self.loop.run_forever, daemon=True).start()
        self.sub = rospy.Subscriber("input", Float64, self.on_input)

    def on_input(self, msg):
        asyncio.run_coroutine_threadsafe(self.handle(msg.data), self.loop).result()

    async def note(self, value):
        await asyncio.sleep(0)
        rospy.logdebug("noted: %f", value)

    async def emit(self, value):
        await asyncio.sleep(0)
        self.pub.publish(value)

    async def values(self, value):
        for part in (value, value / 2):
            if part > self.floor:
                yield part

    async def handle(self, value):
        if value > self.noted:
            await self.note(value)
        async for part in self.values(value):
            if part > self.limit:
                await self.emit(part)


if __name__ == "__main__":
    rospy.init_node("ctl_async")
    node = Node()
    rospy.spin()
