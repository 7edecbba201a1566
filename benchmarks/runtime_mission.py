"""What reports cost a robot: the image capture mission with each sink, beside the same with `off`.

The mission is built once with TPC. In each round it is flown with each setting, one after the
other, and what a setting costs is taken against `off` of the same round; medians of the rounds.
CPU is read from /proc while the mission runs, and is given for a second of the mission's own
(simulated) time: the share of one core that it would take on the robot. The mission runs four times
as fast as that; `topic` sends by wall time, so that in a second of the robot's it would send up to
four times as many messages. Messages are those of all the nodes' topics without /clock, of /rosout
without rosout's copy /rosout_agg, and of /threshold_information.
"""

from __future__ import annotations

import contextlib
import os
import statistics
import sys
import tempfile
import xmlrpc.client
from dataclasses import dataclass, field
from pathlib import Path

from figures import figure

from pytpc.build.build import build_workspace, workspace_env
from pytpc.ros.left_processes import GRAPH_WORD
from pytpc.ros.mission_run import MISSION_DONE, MissionRun, Progress, RecordOptions
from pytpc.ros.ros1.record_mission import run_mission
from pytpc_evaluation.demo.demo_examples import IMAGE_CAPTURE, link_package

TOPIC = "runtime-cost"
ROUNDS = 5
SETTINGS: dict[str, dict[str, str]] = {
    "off": {"TPC_SINK": "off"},
    "rosout": {"TPC_SINK": "rosout"},
    "topic": {"TPC_SINK": "topic"},
    "file": {"TPC_SINK": "file"},
    "file_edges": {"TPC_SINK": "file", "TPC_POLICY": "edges"},
}
REPORTS = "/threshold_information"
# After the start and before the end, so that neither is measured.
FROM_S, TIMEOUT_S = 5.0, 150.0
_TICKS = os.sysconf("SC_CLK_TCK")


@dataclass
class Cpu:
    """CPU seconds of a graph's processes, read while a mission runs."""

    home: str
    first: tuple[float, float, float] | None = None
    last: tuple[float, float, float] = (0.0, 0.0, 0.0)
    topics: set[str] = field(default_factory=set)

    def look(self, progress: Progress) -> None:
        """Read it, and once the topics of the graph."""
        if progress.sim_s < FROM_S:
            return
        now = (progress.sim_s, *self._read())
        self.first = self.first or now
        # A process that has ended has no time any more: the sums must not go back.
        if now[2] >= self.last[2]:
            self.last = now

    def shares(self) -> tuple[float, float]:
        """Of the instrumented nodes and of all processes, in percent of a core."""
        if self.first is None or self.last[0] <= self.first[0]:
            raise SystemExit("the mission was too short")
        seconds = self.last[0] - self.first[0]
        nodes, every = (100 * (self.last[i] - self.first[i]) / seconds for i in (1, 2))
        return nodes, every

    def _read(self) -> tuple[float, float]:
        nodes = every = 0.0
        for entry in Path("/proc").iterdir():
            if not entry.name.isdigit():
                continue
            with contextlib.suppress(OSError, ValueError):
                environment = (entry / "environ").read_bytes().split(b"\0")
                if f"ROS_HOME={self.home}".encode() not in environment:
                    continue
                if not any(word.startswith(f"{GRAPH_WORD}=".encode()) for word in environment):
                    continue
                fields = (entry / "stat").read_text(encoding="utf-8").rpartition(")")[2].split()
                seconds = (int(fields[11]) + int(fields[12])) / _TICKS
                every += seconds
                if b"/lib/image_capture/" in (entry / "cmdline").read_bytes().partition(b"\0")[0]:
                    nodes += seconds
                    self._see_topics(environment)
        return nodes, every

    def _see_topics(self, environment: list[bytes]) -> None:
        if self.topics:
            return
        uri = next(w for w in environment if w.startswith(b"ROS_MASTER_URI=")).partition(b"=")[2]
        with contextlib.suppress(OSError, xmlrpc.client.Error):
            master = xmlrpc.client.ServerProxy(uri.decode())
            found = master.getPublishedTopics("/benchmark", "")
            self.topics = {str(topic) for topic, _ in found[2]}  # type: ignore[index, union-attr]


def fly(env: dict[str, str], name: str, out: Path, topics: list[str]) -> tuple[MissionRun, Cpu]:
    """One mission with a setting, with `topics` recorded as well."""
    cpu = Cpu(str(out.absolute() / "ros" / "home"))
    settings = {**env, "TPC_FOLDER": str(out / "files"), **SETTINGS[name]}
    options = RecordOptions(
        out,
        IMAGE_CAPTURE.launch,
        {"seed": "1"},
        TIMEOUT_S,
        until=MISSION_DONE,
        topics=topics,
        on_progress=cpu.look,
    )
    run = run_mission(settings, options)
    if run.ended != "done":
        raise SystemExit(f"{name}: the mission ended by {run.ended}")
    return run, cpu


def message_share(run: MissionRun) -> float:
    """What part of all messages is there for reports, in percent."""
    # On the topic many reports are one message, on /rosout each is one.
    reports = run.messages.get(REPORTS, 0) or run.reports
    return 100 * reports / sum(run.messages.values())


def main() -> None:
    """Prints what each setting costs against `off`, and the share of messages."""
    nodes: dict[str, list[float]] = {name: [] for name in SETTINGS}
    every: dict[str, list[float]] = {name: [] for name in SETTINGS}
    messages: dict[str, list[float]] = {name: [] for name in SETTINGS}
    with tempfile.TemporaryDirectory() as scratch:
        workspace = Path(scratch) / "ws"
        link_package(IMAGE_CAPTURE, workspace)
        print("building", file=sys.stderr)
        env = workspace_env(build_workspace(workspace).bases.install)
        _, found = fly(env, "off", Path(scratch) / "first", [])
        topics = sorted(found.topics - {"/rosout_agg", "/clock"})
        for turn in range(ROUNDS):
            # None is always the first one after another.
            names = list(SETTINGS)[turn:] + list(SETTINGS)[:turn]
            for name in names:
                print(f"round {turn + 1} of {ROUNDS}: {name}", file=sys.stderr)
                run, cpu = fly(env, name, Path(scratch) / f"{turn}-{name}", topics)
                of_nodes, of_all = cpu.shares()
                nodes[name].append(of_nodes)
                every[name].append(of_all)
                messages[name].append(message_share(run))
    figures(nodes, every, messages)


def figures(
    nodes: dict[str, list[float]], every: dict[str, list[float]], messages: dict[str, list[float]]
) -> None:
    """Print them; values in percent, one of each round."""
    for name in SETTINGS:
        is_file = name.startswith("file")
        for who, values in (("nodes", nodes), ("all", every)):
            if name == "off":
                value = statistics.median(values[name])
                figure(TOPIC, f"mission_cpu_{who}_off", value, unit="%", target="none", hit=True)
                continue
            pairs = list(zip(values[name], values["off"], strict=True))
            more = statistics.median(mine - off for mine, off in pairs)
            ratio = statistics.median(mine / off for mine, off in pairs)
            target, hit = ("<1", more < 1) if is_file else ("none", True)
            figure(TOPIC, f"mission_cpu_{who}_{name}_more", more, unit="%", target=target, hit=hit)
            figure(
                TOPIC, f"mission_cpu_{who}_{name}", ratio, unit="of_off", target="none", hit=True
            )
        share = statistics.median(messages[name])
        target, hit = ("<=0", share == 0) if is_file else ("<=16.1", share <= 16.1)
        figure(TOPIC, f"mission_messages_{name}", share, unit="%", target=target, hit=hit)


if __name__ == "__main__":
    main()
