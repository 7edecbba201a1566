"""Sights from a recorded mission; needs the Python of ROS."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from operator import itemgetter
from pathlib import Path

import genpy
from rosbag import Bag, ROSBagException

from simulated_world.errors import ObserverError
from simulated_world.observer import Channel, Observer
from simulated_world.progress import Progress
from simulated_world.rules import SightT
from simulated_world.sights import check_order

# What rosbag raises at a damaged bag; most of it is not its own.
DAMAGED = (
    ROSBagException,
    genpy.MessageException,
    ValueError,
    LookupError,
    struct.error,
    EOFError,
)


def read_bag(path: Path, observer: Observer[SightT]) -> list[SightT]:
    """What an observer would have seen of a recorded mission (ROS 1 bag).

    Raises:
        ObserverError: it is no bag, or nothing was recorded of what a person sees.
        OSError: it cannot be read.
    """
    channels = observer.eyes().channels()
    sights = []
    for topic, message in _messages(path, channels):
        sight = channels[topic].take(message)
        if sight is not None:
            sights.append(sight)
    check_order(sights, path)
    return sights


def _messages(
    path: Path, channels: Mapping[str, Channel[SightT]]
) -> Iterator[tuple[str, genpy.Message]]:
    """The messages on these topics, in the order of their stamps.

    A recorder on a busy machine hears one topic later than another. Where stamps are equal the
    order is that of ``channels``; a message without a stamp has the time of its recording.
    """
    stamped: list[tuple[int, int, str, genpy.Message]] = []
    places = {topic: place for place, topic in enumerate(channels)}
    try:
        with Bag(str(path)) as bag:
            _check_topics(bag, channels, path)
            topics = list(channels)
            progress = Progress(f"reading {path.name}", bag.get_message_count(topics))
            for topic, message, recorded in progress.over(bag.read_messages(topics=topics)):
                header = getattr(message, "header", None)
                time = recorded if header is None else header.stamp
                stamped.append((time.to_nsec(), places[topic], topic, message))
    except DAMAGED as error:
        text = f"{path}: no readable bag: {type(error).__name__}: {error}"
        raise ObserverError(text) from error
    stamped.sort(key=itemgetter(0, 1))
    for _, _, topic, message in stamped:
        yield topic, message


def _check_topics(bag: Bag, channels: Mapping[str, Channel[SightT]], path: Path) -> None:
    recorded = bag.get_type_and_topic_info().topics
    for topic, channel in channels.items():
        if topic in recorded and recorded[topic].msg_type != channel.message_type:
            there = recorded[topic].msg_type
            raise ObserverError(f"{path}: {topic} has {there}, not {channel.message_type}")
    if not any(topic in recorded for topic in channels):
        raise ObserverError(f"{path}: nothing was recorded on {', '.join(channels)}")
