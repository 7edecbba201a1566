"""Small missions for the tests: keys, comparisons, events and bags, written out by hand."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

from pytpc.recording.events import Events, Report
from pytpc.recording.summaries import Summaries, Summary
from pytpc.ros.mission_run import MissionRun
from pytpc.static.link_unit import Comparison, Counts, LinkUnit, ParameterRead, Place, Tool
from pytpc.static.static_info import StaticInfo

SECOND = 10**9
STORE = get_typestore(Stores.ROS1_NOETIC)


class EventRow(NamedTuple):
    """An evaluation, with its time and node."""

    time_ns: int
    node: str
    key: str
    result: bool
    cmp: float
    thresh: float
    res: bool


class EventBuilder:
    """Collects evaluations one at a time."""

    def __init__(self) -> None:
        self._rows: list[EventRow] = []

    def add(self, time_ns: int, node: str, report: Report) -> None:
        self._rows.append(EventRow(time_ns, node, *report))

    def build(self) -> Events:
        return Events.of_rows(self._rows)


class SummaryBuilder:
    """Collects summaries one at a time."""

    def __init__(self) -> None:
        self._rows: list[Summary] = []

    def add(self, summary: Summary) -> None:
        self._rows.append(summary)

    def build(self) -> Summaries:
        return Summaries.of_rows(self._rows)


def equal_tables(one: Events | Summaries, other: Events | Summaries) -> bool:
    """Whether both hold the same rows (NaN equals NaN) under the same words."""
    theirs = other.columns()
    return (one.keys, one.nodes) == (other.keys, other.nodes) and all(
        np.array_equal(mine, theirs[name], equal_nan=mine.dtype == np.float64)
        for name, mine in one.columns().items()
    )


def key(number: int) -> str:
    """A key whose order is that of the numbers."""
    return f"{number:08x}-0000-5000-8000-000000000000"


def comparison(number: int, source: str, relation: str = ">", **changes: Any) -> Comparison:
    plain = Comparison(
        key=key(number),
        type="flag" if relation == "flag" else "parameter",
        name=f"{source}_",
        source=source,
        file="src/node.cpp",
        lineno=10 + number,
        column=7,
        function="Node::step",
        distance=1,
        relation=relation,
        topic="/cmd",
        source_code=f"if (value {relation} {source}_) {{",
        other_thresholds=0,
        param_reads=(Place("src/node.cpp", 3),),
        publishes=(Place("src/node.cpp", 40),),
        transform=None,
        default=None,
        read_at=Place("src/node.cpp", 3),
        exposed_at=Place("src/node.cpp", 40),
    )
    return replace(plain, **changes)


def link_unit(
    comparisons: Iterable[Comparison],
    reads: Iterable[ParameterRead] = (),
    source_root: str = "/nowhere",
) -> LinkUnit:
    return LinkUnit(
        link_unit="node",
        package="robot",
        source_root=source_root,
        tool=Tool("tpc", "0.1.0", "19.1.7", "default"),
        status="ok",
        failure=None,
        counts=Counts(*[0] * 12),
        parameters=tuple(reads),
        exposing=(),
        comparisons=tuple(comparisons),
    )


def static_info(*comparisons: Comparison, source_root: str = "/nowhere") -> StaticInfo:
    return StaticInfo.of([link_unit(comparisons, source_root=source_root)])


def events(rows: Iterable[Sequence[Any]], node: str = "/node") -> Events:
    """Events from rows (seconds, number of the key, result, cmp, thresh[, node])."""
    builder = EventBuilder()
    for seconds, number, result, cmp, thresh, *other in rows:
        report = Report(key(number), bool(result), float(cmp), float(thresh), bool(result))
        builder.add(round(seconds * SECOND), other[0] if other else node, report)
    return builder.build()


def ns(seconds: float) -> int:
    return round(seconds * SECOND)


class BagFile:
    """Writes a ROS 1 bag with real rosgraph_msgs and std_msgs, as rosbag record would."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.writer = Writer(path)
        self.connections: dict[tuple[str, str], Any] = {}
        self.seq: dict[tuple[str, str], int] = {}

    def __enter__(self) -> BagFile:
        self.writer.open()
        return self

    def __exit__(self, *_: object) -> None:
        self.writer.close()

    def _write(self, topic: str, msgtype: str, caller: str, time_ns: int, message: Any) -> None:
        place = (topic, caller)
        if place not in self.connections:
            self.connections[place] = self.writer.add_connection(
                topic, msgtype, typestore=STORE, callerid=caller
            )
        raw = STORE.serialize_ros1(message, msgtype)
        self.writer.write(self.connections[place], time_ns, raw)

    def log(
        self,
        seconds: float,
        node: str,
        text: str,
        *,
        seq: int | None = None,
        stamp: float | None = None,
        topic: str = "/rosout",
    ) -> None:
        """A log message; its number is the node's next one, its stamp the bag's time."""
        counter = (topic, node)
        number = self.seq.get(counter, 0) if seq is None else seq
        self.seq[counter] = number + 1
        stamped = ns(seconds if stamp is None else stamp)
        types = STORE.types
        header = types["std_msgs/msg/Header"](
            seq=number,
            stamp=types["builtin_interfaces/msg/Time"](
                sec=stamped // SECOND, nanosec=stamped % SECOND
            ),
            frame_id="",
        )
        message = types["rosgraph_msgs/msg/Log"](
            header=header,
            level=2,
            name=node,
            msg=text,
            file="node.cpp",
            function="Node::step",
            line=12,
            topics=["/rosout", "/cmd"],
        )
        self._write(topic, "rosgraph_msgs/msg/Log", node, ns(seconds), message)

    def text(self, seconds: float, topic: str, caller: str, text: str) -> None:
        message = STORE.types["std_msgs/msg/String"](data=text)
        self._write(topic, "std_msgs/msg/String", caller, ns(seconds), message)

    def mark(self, seconds: float, topic: str, marked: float | None = None) -> None:
        at = ns(seconds if marked is None else marked)
        time = STORE.types["builtin_interfaces/msg/Time"](sec=at // SECOND, nanosec=at % SECOND)
        message = STORE.types["std_msgs/msg/Time"](data=time)
        self._write(topic, "std_msgs/msg/Time", "/observer", ns(seconds), message)


def line(number: int, result: int, cmp: float, thresh: float) -> str:
    """A report as the rosout sink writes it."""
    return (
        f"threshold_information:{key(number)},{result},"
        f"cmp:{shortest(cmp)},thresh:{shortest(thresh)},res:{result}"
    )


def shortest(value: float) -> str:
    text = repr(float(value))
    return text.removesuffix(".0")


def close(left: float, right: float) -> bool:
    return bool(np.isclose(left, right, rtol=1e-9, atol=0.0))


def mission_run(folder: Path, **changes: object) -> MissionRun:
    plain = MissionRun(
        bag=folder / "mission.bag",
        params=folder / "params.yaml",
        ended="done",
        sim_s=40.0,
        wall_s=10.0,
        reports=10,
        messages={"/camera/picture": 1, "/mark_action": 2},
        lost={},
        missed_before={},
    )
    return replace(plain, **changes)  # type: ignore[arg-type]
