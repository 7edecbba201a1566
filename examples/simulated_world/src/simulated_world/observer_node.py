"""A scripted observer's place on the ROS graph."""

from __future__ import annotations

import argparse
from collections.abc import Iterable

import rospy
from std_msgs.msg import Time

from simulated_world.observer import TYPE_I, TYPE_II, Mark


def start_observer() -> int:
    """Start the node; returns the person's seed, which the command line has as ``--seed``."""
    parser = argparse.ArgumentParser(description="scripted observer")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args(rospy.myargv()[1:])
    rospy.init_node("observer")
    return arguments.seed


class Keys:
    """The two keys: publishes marks."""

    def __init__(self) -> None:
        """The node has been started."""
        self._publishers = {
            topic: rospy.Publisher(f"/{topic}", Time, queue_size=10) for topic in (TYPE_I, TYPE_II)
        }

    def press(self, marks: Iterable[Mark]) -> None:
        """Publish what was marked."""
        for mark in marks:
            rospy.loginfo("%s at %.2f: %s", mark.topic, mark.time, mark.reason)
            self._publishers[mark.topic].publish(Time(rospy.Time.from_sec(mark.time)))
