"""What the robot did, from the topics that were recorded besides the reports, or from sights.

``robot_state`` reads numbers and texts over time from a ROS 1 bag or a folder of rosbag2: the
fields that are asked for, else those of a pose and of a mission's state where topics look like it.
A field is written ``TOPIC.FIELD.FIELD``; ``yaw`` of something with an orientation is its angle.
``seen_state`` takes position and yaw from a table of what a person beside the field sees.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, is_dataclass
from dataclasses import fields as fields_of
from numbers import Real
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import pyarrow as pa

from pytpc.base.columns import Floats, read_table
from pytpc.base.errors import InputError, TpcError
from pytpc_evaluation.stats.topics import BagTopics, open_topics

_POSES = {
    "geometry_msgs/msg/PoseStamped": "pose",
    "geometry_msgs/msg/PoseWithCovarianceStamped": "pose.pose",
    "nav_msgs/msg/Odometry": "pose.pose",
    "geometry_msgs/msg/Pose": "",
    "geometry_msgs/msg/TransformStamped": "transform",
}
# Whose pose it is, the best first; and what has a pose and is not the robot.
_ROBOT = ("truth", "uav", "robot", "base", "odom", "pose")
_OTHER = ("person", "goal", "target", "cmd", "command", "setpoint", "waypoint", "marker")
_STATES = {"state", "mode", "status", "phase"}
_NAMES = ("name", "mode", "phase", "status", "data", "state")
_AXES = ("x", "y", "z")
_YAW = "yaw"
_TIME = "time"


@dataclass(frozen=True, eq=False)
class Series:
    """A number over time: ``times`` and ``values`` float64[n], times in seconds of the mission."""

    label: str
    times: Floats
    values: Floats


@dataclass(frozen=True, eq=False)
class Phases:
    """A text over time: from ``times[i]`` on it is ``names[i]``."""

    label: str
    times: Floats
    names: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class RobotState:
    """All that is drawn of the robot; both empty where nothing is known."""

    series: tuple[Series, ...] = ()
    phases: tuple[Phases, ...] = ()


class _Quaternion(Protocol):
    x: float
    y: float
    z: float
    w: float


@dataclass(frozen=True, slots=True)
class _Field:
    topic: str
    path: tuple[str, ...]
    label: str


def robot_state(
    bag: Path,
    start_ns: int,
    wanted: Sequence[str] = (),
    on_progress: Callable[[int, int], None] | None = None,
) -> RobotState:
    """Read what the robot did.

    Args:
        bag: a ROS 1 bag, or a folder of rosbag2.
        start_ns: the begin of the mission, where the seconds count from.
        wanted: fields; without any they are looked for.
        on_progress: called with (messages read, messages in all).

    Raises:
        InputError: the bag cannot be read, or one of ``wanted`` is not in it; one line.
    """
    with open_topics(bag, "the robot's state") as topics:
        fields = [_field(text) for text in wanted] or _guessed(topics)
        return _read(topics, fields, start_ns, on_progress)


def seen_state(sights: Path, start_ns: int) -> RobotState:
    """What the robot did, from a table of sights.

    Args:
        sights: Parquet with ``time`` in seconds on the clock of the reports, and of ``x``, ``y``,
            ``z`` (m) and ``yaw`` (rad) those that are known; other columns are not drawn.
        start_ns: the begin of the mission, where the seconds count from.

    Raises:
        InputError: the file cannot be read, or has no time.
    """

    def state(table: pa.Table) -> RobotState:
        if _TIME not in table.column_names:
            raise InputError(f"no column {_TIME}; there are {', '.join(table.column_names)}")
        columns = {
            name: np.asarray(table.column(name).to_numpy(), dtype=np.float64)
            for name in (_TIME, *_AXES, _YAW)
            if name in table.column_names
        }
        order = np.argsort(columns[_TIME], kind="stable")
        times = columns.pop(_TIME)[order] - start_ns / 1e9
        sorted_ = {name: values[order] for name, values in columns.items()}
        return RobotState(
            tuple(
                Series(name, times, _unwrapped(values) if name == _YAW else values)
                for name, values in sorted_.items()
            )
        )

    return read_table(sights, "sights", state)


def _read(
    topics: BagTopics,
    fields: Sequence[_Field],
    start_ns: int,
    on_progress: Callable[[int, int], None] | None,
) -> RobotState:
    names = {topic.name for topic in topics.topics}
    for field in fields:
        if field.topic not in names:
            raise TpcError(f"no topic {field.topic}; there are {', '.join(sorted(names))}")
    times: dict[_Field, list[float]] = {field: [] for field in fields}
    values: dict[_Field, list[float | str]] = {field: [] for field in fields}
    for topic, time_ns, message in topics.messages({field.topic for field in fields}, on_progress):
        at = (_stamp(message) or time_ns) - start_ns
        for field in fields:
            if field.topic == topic:
                times[field].append(at / 1e9)
                values[field].append(_value(message, field))
    series, phases = [], []
    for field in fields:
        seconds = np.array(times[field])
        order = np.argsort(seconds, kind="stable")
        if any(isinstance(value, str) for value in values[field]):
            phases.append(_phases(field.label, seconds[order], [values[field][i] for i in order]))
        else:
            numbers = np.array(values[field], dtype=np.float64)[order]
            if field.path[-1:] == (_YAW,):
                numbers = _unwrapped(numbers)
            series.append(Series(field.label, seconds[order], numbers))
    return RobotState(tuple(series), tuple(phases))


def _field(text: str) -> _Field:
    topic, dot, path = text.partition(".")
    if not topic or not dot or not all(path.split(".")):
        raise TpcError(f"{text!r} is not TOPIC.FIELD, as /odom.pose.pose.position.x")
    topic = topic if topic.startswith("/") else f"/{topic}"
    return _Field(topic, tuple(path.split(".")), f"{topic}.{path}")


def _guessed(topics: BagTopics) -> list[_Field]:
    """Position and yaw of what looks most like the robot, and what looks like a mission's state."""
    there = [topic for topic in topics.topics if topic.messages]
    poses = {topic.name: topic.type for topic in there if topic.type in _POSES}
    fields = []
    own = sorted((_likeness(name), name) for name in poses if _likeness(name) is not None)
    if own:
        name = own[0][1]
        fields = _pose_fields(name, poses[name])
    for topic in there:
        if topic.name.rpartition("/")[2] in _STATES:
            field = next((one for one in _NAMES if one in topic.plain_fields), None)
            if field is not None:
                fields.append(_Field(topic.name, (field,), f"{topic.name}.{field}"))
    return list(dict.fromkeys(fields))


def _pose_fields(topic: str, msgtype: str) -> list[_Field]:
    above = tuple(part for part in _POSES[msgtype].split(".") if part)
    position = "translation" if above == ("transform",) else "position"
    fields = [_Field(topic, (*above, position, axis), axis) for axis in _AXES]
    return [*fields, _Field(topic, (*above, _YAW), _YAW)]


def _likeness(topic: str) -> int | None:
    """The smaller, the more it is called like the robot's pose; None where like another's."""
    words = topic.lower()
    if any(word in words for word in _OTHER):
        return None
    return -sum(1 << (len(_ROBOT) - n) for n, word in enumerate(_ROBOT) if word in words)


def _stamp(message: object) -> int:
    """The message's own time, 0 where it has none."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    return 0 if stamp is None else int(stamp.sec) * 10**9 + int(stamp.nanosec)


def _value(message: object, field: _Field) -> float | str:
    found: Any = message
    for name in field.path:
        turned = getattr(found, "orientation", getattr(found, "rotation", None))
        if name == _YAW and not hasattr(found, "yaw") and turned is not None:
            return _yaw(turned)
        if isinstance(found, np.ndarray | list) and name.isdecimal() and int(name) < len(found):
            found = found[int(name)]
        elif hasattr(found, name):
            found = getattr(found, name)
        else:
            raise TpcError(f"{field.topic} has no {name}; {_offers(found)}")
    if isinstance(found, str):
        return found
    if isinstance(found, Real | np.bool_):
        return float(found)
    raise TpcError(f"{field.label} is neither a number nor a text; {_offers(found)}")


def _offers(found: object) -> str:
    names = [each.name for each in fields_of(found)] if is_dataclass(found) else []
    return f"there are {', '.join(names)}" if names else "there is nothing below it"


def _yaw(q: _Quaternion) -> float:
    """The angle about z of a quaternion, in radians."""
    return math.atan2(2 * (q.w * q.z + q.x * q.y), 1 - 2 * (q.y * q.y + q.z * q.z))


def _unwrapped(angles: Floats) -> Floats:
    """An angle that goes on where it would jump from pi to -pi."""
    finite = np.isfinite(angles)
    result = angles.copy()
    result[finite] = np.unwrap(angles[finite])
    return result


def _phases(label: str, seconds: Floats, texts: Sequence[float | str]) -> Phases:
    names = [str(text) for text in texts]
    first = [n for n, name in enumerate(names) if n == 0 or name != names[n - 1]]
    return Phases(label, seconds[first], tuple(names[n] for n in first))
