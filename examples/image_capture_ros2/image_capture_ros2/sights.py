"""Blobs and faces, and the messages that carry them."""

from collections.abc import Iterable
from dataclasses import astuple, dataclass, fields
from typing import TypeVar

from geometry_msgs.msg import Point32
from sensor_msgs.msg import ChannelFloat32, PointCloud
from std_msgs.msg import Header

IMAGE_WIDTH = 640
IMAGE_HEIGHT = 480
EXPOSURE_S = 0.02
HALF_ANGLE = 0.5236
"""Of the camera's view, rad."""
FACE_AREA = 0.2475
"""The face of somebody at 1 m covers this share of the image."""


@dataclass(frozen=True)
class Blob:
    """Something in the image: its place across the image in [-1, 1], width and height in pixels."""

    offset: float
    width: float
    height: float
    contrast: float
    response: float


@dataclass(frozen=True)
class Face:
    """A blob that is a face, and the share of the image that it covers."""

    offset: float
    coverage: float
    score: float


SightT = TypeVar("SightT", Blob, Face)


def to_message(header: Header, kind: type[SightT], sights: Iterable[SightT]) -> PointCloud:
    """One point for each sight, one channel for each of its numbers."""
    rows = [astuple(sight) for sight in sights]
    names = [field.name for field in fields(kind)]
    channels = [
        ChannelFloat32(name=name, values=[row[place] for row in rows])
        for place, name in enumerate(names)
    ]
    return PointCloud(header=header, points=[Point32() for _ in rows], channels=channels)


def from_message(message: PointCloud, kind: type[SightT]) -> list[SightT]:
    """The reverse of ``to_message``."""
    return [
        kind(*row) for row in zip(*(channel.values for channel in message.channels), strict=True)
    ]
