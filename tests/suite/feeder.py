"""Publishes prepared input to all nodes of a batch; its own program: rospy is one node.

It reads which topics there are from a file, waits until each has its subscribers, publishes a few
messages to each in turn, so that no queue fills, and says in a second file that it is done.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import rospy
from std_msgs.msg import Float64, String

AT_ONCE = 5
PAUSE_S = 0.02
PATIENCE_S = 60.0


def main() -> None:
    """Feed; the arguments are the file of topics and the file that tells the end."""
    topics = json.loads(Path(sys.argv[1]).read_text("utf-8"))
    rospy.init_node("feeder", disable_signals=True)
    kinds = {"std_msgs/Float64": Float64, "std_msgs/String": String}
    publishers = [
        rospy.Publisher(topic["name"], kinds[topic["type"]], queue_size=len(topic["values"]) + 1)
        for topic in topics
    ]
    until = time.monotonic() + PATIENCE_S
    for topic, publisher in zip(topics, publishers, strict=True):
        while publisher.get_num_connections() < topic["subscribers"]:
            if time.monotonic() > until:
                raise SystemExit(f"nobody listens to {topic['name']}")
            time.sleep(0.01)
    for first in range(0, max(len(topic["values"]) for topic in topics), AT_ONCE):
        for topic, publisher in zip(topics, publishers, strict=True):
            for value in topic["values"][first : first + AT_ONCE]:
                publisher.publish(kinds[topic["type"]](value))
        time.sleep(PAUSE_S)
    Path(sys.argv[2]).touch()
    # What is queued goes out until the graph ends this process.
    while True:
        time.sleep(1)


if __name__ == "__main__":
    main()
