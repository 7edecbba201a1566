"""Runs the nodes of the suite with and without the passes and compares what they publish.

Every variant of a node runs in a namespace of its own on one graph, all are fed the same seeded
input, and every message that they publish is kept as the bytes that were sent. Only what actionlib
puts into its messages by the clock cannot be the same: its times and identifiers are taken out, and
the status that it sends five times a second is left out.
"""

from __future__ import annotations

import functools
import io
import json
import random
import re
import signal
import sys
import time
import zlib
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

import genpy
from genpy.dynamic import generate_dynamic

from pytpc.base.errors import RunError
from pytpc.ingest.ros1 import decode_log
from pytpc.ros.intake import BATCH, REPORT
from pytpc.ros.ros1.graph import GraphProcess, RosGraph
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.subscriber import RawSubscriber
from pytpc.ros.source import Source
from suite.expectations import PACKAGE, load

NODES_AT_ONCE = 12
INPUTS = 150
START_PATIENCE_S = 90.0
SETTLED_S = 0.4
QUIET_S = 0.6
LATEST_S = 8.0
LONGEST_S = 120.0
_FEEDER = Path(__file__).with_name("feeder.py")
_WORDS = re.compile(r'"([A-Za-z_ ]{1,12})"')
_BY_THE_CLOCK = re.compile(r"^actionlib_msgs/|Action(Goal|Result|Feedback)$")
_FED = {"input": "std_msgs/Float64", "aux": "std_msgs/Float64", "text": "std_msgs/String"}

Topics = dict[str, list[bytes]]


@dataclass(frozen=True, slots=True)
class Variant:
    """One way in which all nodes are run: their programs and what is in their environment."""

    name: str
    programs: Mapping[str, Path]
    env: Mapping[str, str] = field(default_factory=dict)


@dataclass(slots=True)
class Published:
    """What one node published in one variant: the messages of each topic, in order.

    ``reports`` counts the messages of the instrumentation on /rosout, ``status`` is how it ended.
    """

    topics: Topics = field(default_factory=dict)
    reports: int = 0
    status: int | None = None


Results = dict[str, dict[str, Published]]


def input_of(node: str, seed: int, package: Path = PACKAGE) -> dict[str, list[Any]]:
    """What a node is fed: numbers within [-10, 10], whole ones among them, and words it knows."""
    draw = random.Random(zlib.crc32(node.encode()) ^ seed)
    nan = load(node, package).nan

    def number() -> float:
        if nan and draw.random() < 0.1:
            return float("nan")
        value = draw.uniform(-10, 10)
        return float(round(value)) if draw.random() < 0.3 else value

    folder = package / "nodes"
    sources = [folder / f"{node}{suffix}" for suffix in (".cpp", ".py")]
    sources += [*sorted((folder / node).glob("*.cpp")), *sorted((folder / node).glob("*.py"))]
    known = [path.read_text("utf-8") for path in sources if path.is_file()]
    words = sorted({"", "word", *(word for text in known for word in _WORDS.findall(text))})
    return {
        "input": [number() for _ in range(INPUTS)],
        "aux": [number() for _ in range(INPUTS)],
        "text": [draw.choice(words) for _ in range(INPUTS)],
    }


def run_all(
    variants: Sequence[Variant],
    env: Mapping[str, str],
    folder: Path,
    *,
    seed: int = 1,
    package: Path = PACKAGE,
    at_once: int = NODES_AT_ONCE,
    least_s: float = 0.0,
) -> Results:
    """Run all nodes that all variants have; ``results[node][variant]``.

    Args:
        variants: the ways in which they are run.
        env: the environment of the installed workspace.
        folder: for ROS's home, its logs and the output of all processes.
        seed: of the input.
        package: the suite, with the lists of its nodes.
        at_once: how many nodes run at the same time.
        least_s: how long each runs at the least.

    Raises:
        RunError: a node ends by itself, or never comes up.
    """
    names = sorted(set.intersection(*(set(variant.programs) for variant in variants)))
    results: Results = {}
    with RosGraph(env, folder) as graph:
        for first in range(0, len(names), at_once):
            batch = names[first : first + at_once]
            results |= _Batch(graph, variants, batch, seed, package, least_s=least_s).run()
    return results


class _Batch:
    """Some nodes in all variants at the same time."""

    def __init__(
        self,
        graph: RosGraph,
        variants: Sequence[Variant],
        names: Sequence[str],
        seed: int,
        package: Path,
        *,
        least_s: float,
    ) -> None:
        self._graph = graph
        self._variants = variants
        self._names = names
        self._seed = seed
        self._package = package
        self._least_s = least_s
        self._results = {
            node: {variant.name: Published() for variant in variants} for node in names
        }
        self._processes: dict[tuple[str, str], GraphProcess] = {}

    def run(self) -> Results:
        feeder = None
        try:
            for node in self._names:
                for variant in self._variants:
                    self._start(variant, node)
            published, subscribed = self._wait_until_up()
            subscriber = RawSubscriber(
                Master(self._graph.uri, "/recorder"),
                "127.0.0.1",
                [*sorted(published), "/rosout"],
            )
            try:
                self._wait_for_connections(subscriber, published)
                feeder, done = self._feed(subscribed)
                self._record(subscriber, done)
            finally:
                subscriber.close()
            self._graph.check()
        finally:
            self._end(feeder)
        return self._results

    def _start(self, variant: Variant, node: str) -> None:
        space = f"/{variant.name}/{node}"
        for name, value in load(node, self._package).params.items():
            self._graph.call("setParam", f"{space}/{name.replace('~', f'{node}/')}", value)
        self._processes[node, variant.name] = self._graph.start(
            f"{variant.name}-{node}",
            [str(variant.programs[node])],
            env={"ROS_NAMESPACE": space, **variant.env},
        )

    def _topics(self) -> tuple[dict[str, set[str]], dict[str, set[str]]]:
        """Topics of this batch that are published, and subscribed to, with the nodes."""
        state = cast(list[list[Any]], self._graph.call("getSystemState"))
        spaces = tuple(f"/{variant}/{node}/" for node, variant in self._processes)
        published, subscribed = (
            {topic: set(who) for topic, who in part if topic.startswith(spaces)}
            for part in state[:2]
        )
        return published, subscribed

    def _wait_until_up(self) -> tuple[dict[str, set[str]], dict[str, set[str]]]:
        """Wait until every node has topics, all variants of it the same, and none is new."""
        until = time.monotonic() + START_PATIENCE_S
        before = self._topics()
        settled = time.monotonic()
        while True:
            time.sleep(0.05)
            self._graph.check()
            now = self._topics()
            if now != before:
                before, settled = now, time.monotonic()
            elif time.monotonic() - settled > SETTLED_S and self._is_complete(now):
                return now
            elif time.monotonic() > until:
                raise RunError(f"of {', '.join(self._names)} some do not come up")

    def _is_complete(self, topics: tuple[dict[str, set[str]], dict[str, set[str]]]) -> bool:
        for node in self._names:
            shapes = {
                tuple(
                    tuple(
                        sorted(
                            topic.removeprefix(f"/{variant.name}/")
                            for topic in part
                            if topic.startswith(f"/{variant.name}/{node}/")
                        )
                    )
                    for part in topics
                )
                for variant in self._variants
            }
            if len(shapes) != 1 or not any(shapes.pop()):
                return False
        return True

    def _wait_for_connections(
        self, subscriber: RawSubscriber, published: Mapping[str, set[str]]
    ) -> None:
        wanted = {(topic, node) for topic, who in published.items() for node in who}
        until = time.monotonic() + START_PATIENCE_S
        while not wanted <= subscriber.connections():
            for source, data in subscriber.poll(0.05):
                self._take(source, data)
            if time.monotonic() > until:
                raise RunError(f"no connection to {sorted(wanted - subscriber.connections())}")
        # A publisher answers the handshake a moment before it counts the subscriber.
        time.sleep(0.1)

    def _feed(self, subscribed: Mapping[str, set[str]]) -> tuple[GraphProcess, Path]:
        prepared = {node: input_of(node, self._seed, self._package) for node in self._names}
        topics = []
        for topic, who in sorted(subscribed.items()):
            _, _, node, rest = topic.split("/", 3)
            if rest in _FED:
                topics.append(
                    {
                        "name": topic,
                        "type": _FED[rest],
                        "subscribers": len(who),
                        "values": prepared[node][rest],
                    }
                )
        folder = self._graph.folder
        spec, done = folder / "feed.json", folder / "fed"
        spec.write_text(json.dumps(topics), encoding="utf-8")
        done.unlink(missing_ok=True)
        argv = [sys.executable, str(_FEEDER), str(spec), str(done)]
        return self._graph.start("feeder", argv), done

    def _record(self, subscriber: RawSubscriber, done: Path) -> None:
        """Take messages until all variants said the same and nothing more, or nothing comes."""
        latest = time.monotonic()
        fed = latest
        least = latest + self._least_s
        while True:
            for source, data in subscriber.poll(0.05):
                if self._take(source, data):
                    latest = time.monotonic()
            if not done.exists():
                self._graph.check()
                fed = latest = time.monotonic()
            if time.monotonic() - fed > LONGEST_S:
                raise RunError(f"of {', '.join(self._names)} some publish without end")
            quiet = time.monotonic() - latest
            if time.monotonic() < least:
                continue
            if quiet > LATEST_S or (quiet > QUIET_S and not any(self._different())):
                return

    def _take(self, source: Source, data: bytes) -> bool:
        """File a message; False for one of /rosout: a node may report as long as it runs."""
        is_log = source.topic == "/rosout"
        _, variant, name, *rest = (source.node if is_log else source.topic).split("/", 3)
        if name not in self._results or source.type == "actionlib_msgs/GoalStatusArray":
            return False
        result = self._results[name][variant]
        if not is_log:
            if _BY_THE_CLOCK.search(source.type):
                data = timeless(source.type, source.definition, data)
            result.topics.setdefault(rest[0], []).append(data)
            return True
        result.reports += decode_log(data).msg.startswith((REPORT, BATCH))
        return False

    def _different(self) -> Iterator[str]:
        return (text for node in self._names for text in differences(node, self._results[node]))

    def _end(self, feeder: GraphProcess | None) -> None:
        for process in self._processes.values():
            process.popen.send_signal(signal.SIGINT)
        for (node, variant), process in self._processes.items():
            self._results[node][variant].status = self._graph.stop(process)
        if feeder is not None:
            self._graph.stop(feeder)


@functools.cache
def _message_class(kind: str, definition: str) -> type[genpy.Message]:
    return cast(type[genpy.Message], generate_dynamic(kind, definition)[kind])


def timeless(kind: str, definition: str, data: bytes) -> bytes:
    """A message of actionlib without times, sequence numbers and identifiers of goals."""
    message = _message_class(kind, definition)().deserialize(data)
    _take_out_times(message)
    out = io.BytesIO()
    message.serialize(out)
    return out.getvalue()


def _take_out_times(message: genpy.Message) -> None:
    for name, kind in zip(message.__slots__, message._slot_types, strict=True):
        value = getattr(message, name)
        if isinstance(value, genpy.Message):
            _take_out_times(value)
        elif kind == "time":
            setattr(message, name, genpy.Time())
        elif (message._type, name) in (("actionlib_msgs/GoalID", "id"), ("std_msgs/Header", "seq")):
            setattr(message, name, type(value)())


def differences(node: str, results: Mapping[str, Published]) -> Iterator[str]:
    """How the variants of one node differ from the first one: one line each."""
    first, *others = results
    reference = results[first]
    for other in others:
        for topic in sorted({*reference.topics, *results[other].topics}):
            wanted = reference.topics.get(topic, [])
            got = results[other].topics.get(topic, [])
            if wanted != got:
                at = next(
                    (
                        n
                        for n, pair in enumerate(zip(wanted, got, strict=False))
                        if pair[0] != pair[1]
                    ),
                    min(len(wanted), len(got)),
                )
                yield (
                    f"{node}: {topic}: {first} published {len(wanted)} messages, {other}"
                    f" {len(got)}; the first difference is at {at}"
                )
        if reference.status is not None and reference.status != results[other].status:
            yield f"{node}: {first} ended with {reference.status}, {other} {results[other].status}"


def totals(results: Results) -> dict[str, Counter[str]]:
    """Messages and reports of each variant."""
    counted: dict[str, Counter[str]] = defaultdict(Counter)
    for variants in results.values():
        for name, published in variants.items():
            counted[name]["messages"] += sum(map(len, published.topics.values()))
            counted[name]["reports"] += published.reports
    return counted
