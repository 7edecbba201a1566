"""A scripted observer's place on the ROS graph."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable
from typing import Any

import rospy
from genpy.message import get_message_class
from std_msgs.msg import Time

from simulated_world.errors import ObserverError
from simulated_world.observer import Channel, Observer
from simulated_world.person import TYPE_I, TYPE_II, Mark, Person
from simulated_world.rules import SightT


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


def watch(observer: Observer[SightT], seed: int) -> None:
    """Watch the running robot as one person, until the node is shut down.

    Raises:
        ObserverError: the messages of a topic are not known here.
    """
    rospy.init_node("observer")
    person = Person(observer.rules(), seed)
    keys = Keys()
    # Each topic has a thread of its own.
    one_at_a_time = threading.Lock()

    def listener(channel: Channel[SightT]) -> Callable[[Any], None]:
        def on_message(message: object) -> None:
            with one_at_a_time:
                sight = channel.take(message)
                if sight is not None:
                    keys.press(person.see(sight))

        return on_message

    for topic, channel in observer.eyes().channels().items():
        message_class = get_message_class(channel.message_type)
        if message_class is None:
            raise ObserverError(f"{topic}: unknown messages {channel.message_type}")
        rospy.Subscriber(topic, message_class, listener(channel), queue_size=100)
    rospy.spin()
