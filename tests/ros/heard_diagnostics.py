"""Prints what a rospy subscriber gets on /diagnostics, as a line of JSON for each message."""

import json

import rospy
from diagnostic_msgs.msg import DiagnosticArray


def told(message):
    statuses = {
        one.name: {
            "level": one.level if isinstance(one.level, int) else ord(one.level),
            "message": one.message,
            "hardware_id": one.hardware_id,
            "values": {pair.key: pair.value for pair in one.values},
        }
        for one in message.status
    }
    print(json.dumps({"stamp": message.header.stamp.to_sec(), "status": statuses}), flush=True)


rospy.init_node("dashboard")
rospy.Subscriber("/diagnostics", DiagnosticArray, told)
rospy.spin()
