"""Records a graph of ROS 2 that runs: mission.mcap, run.json, and the values of parameters."""

from __future__ import annotations

import contextlib
import os
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import yaml

from pytpc.base.atomic import write_atomic
from pytpc.base.errors import MissingToolError, RunError, TpcError
from pytpc.base.folder_lock import alone_in
from pytpc.base.signals import Stop
from pytpc.base.wording import many
from pytpc.ingest.decoders import ROS2
from pytpc.ingest.file_counts import NO_FILES, FileCounts
from pytpc.ingest.messages import REPORTS, ROSOUT
from pytpc.ingest.parameter_events import TOPIC, TYPE, decode_parameter_event
from pytpc.ingest.ros2 import decode_log
from pytpc.recording.graph_file import GRAPH_FILE, write_graph
from pytpc.recording.marks import MarkMessages
from pytpc.recording.parameter_values import ParameterValues, SetValue
from pytpc.ros.intake import CLOCK, Recorder
from pytpc.ros.mission_run import (
    MCAP_FILE,
    MissionRun,
    Progress,
    RecorderStatus,
    RecordOptions,
    keep_earlier_marks,
    keep_static,
    refuse_earlier,
    save_run,
)
from pytpc.ros.ros2.address import Ros2Address
from pytpc.ros.ros2.agent_process import Agent, Graph
from pytpc.ros.ros2.command_lines import CommandLines
from pytpc.ros.ros2.found_nodes import is_somebody, nobody, visible
from pytpc.ros.ros2.interpreter import launch_interpreter
from pytpc.ros.ros2.mcap_file import McapFile
from pytpc.ros.ros2.node_values import NodeValues
from pytpc.ros.source import Source
from pytpc.values.origins import PARAMS_FILE, START_FILE
from pytpc.values.recording import MISSION_PATIENCE_S, save_origins, try_trace
from pytpc.values.trace import Trace

KNOWN = {
    ROSOUT: "rcl_interfaces/msg/Log",
    REPORTS: "std_msgs/msg/String",
    CLOCK: "rosgraph_msgs/msg/Clock",
    TOPIC: TYPE,
}
"""The topics that TPC receives of each graph, and their types."""
_TOLD_S = 0.2
_POLL_S = 0.05
# What a publisher sent before the recorder began is not of the mission, and comes at once when the
# recorder is connected to it. Later messages of that time are new ones, by a clock that is behind.
_HISTORY_S = 3.0
_LOOK_NS = 2 * 10**9
_QUIET_S = 10.0
NO_COMMAND_LINES = "no process of this machine has the nodes, and no launch file was given"
_SIM_TIME = "use_sim_time"


class Looked(NamedTuple):
    """What a mission is besides its graph: whether it is over, and what its files have."""

    is_over: bool = False
    files: FileCounts = NO_FILES


_NOTHING = Looked()


def record_ros2_graph(
    options: RecordOptions,
    stop: threading.Event | Stop,
    env: Mapping[str, str] | None = None,
    launch_env: Mapping[str, str] | None = None,
) -> MissionRun:
    """Record /rosout, /threshold_information, all marks, parameters, and the topics asked for.

    The folder gets mission.mcap, run.json, params_start.yaml, params.yaml and origins.json.

    Args:
        options: the folder, and when the recording ends beside ``stop``.
        stop: ends the recording; if it is set again, no node is waited for.
        env: says which graph it is; None: that of this process.
        launch_env: in which the launch file is read; None: ``env``.

    Raises:
        MissingToolError: no interpreter has rclpy.
        RunError: ROS 2 does not work, the folder has a recording, or the file can no longer be
            written; it is closed, and has what was written before.
        OSError: the file cannot be opened.
    """
    options.out_dir.mkdir(parents=True, exist_ok=True)
    known = os.environ if env is None else env
    with alone_in(options.out_dir):
        refuse_earlier(options.out_dir)
        keep_static(options)
        began = time.monotonic()
        agent = Agent(Ros2Address.of_env(known), known)
        recording = GraphRecording.of(agent, options)
        launched = LaunchReading(known if launch_env is None else launch_env, options)
        try:
            kept = keep_earlier_marks(options.out_dir)
            if kept and options.on_kept is not None:
                options.on_kept(kept)
            if options.on_graph is not None:
                options.on_graph(str(agent.address), "")
            launched.start()
            ended = recording.run(stop, began)
            recording.keep_graph()
        finally:
            # What was recorded until then is a whole file, unless that cannot be written.
            status, fault = recording.finish(_hurries(stop))
        run = MissionRun.of(status, options.out_dir, ended, time.monotonic() - began)
        run = replace(run, bag=options.out_dir / MCAP_FILE)
        save_run(run, options)
        recording.save_origins(*launched.ended(lambda: _hurries(stop)), launched.env, is_own=False)
        if fault:
            raise RunError(f"the recording ended: {fault}; what came until then is in it", run.bag)
        return run


def _hurries(stop: threading.Event | Stop) -> bool:
    return isinstance(stop, Stop) and stop.in_a_hurry


class LaunchReading(threading.Thread):
    """Reads the launch file, if one is given, while the mission is recorded."""

    def __init__(self, env: Mapping[str, str], options: RecordOptions) -> None:
        super().__init__(name="launch file", daemon=True)
        self.env = env
        self._launch, self._args = options.launch, options.args
        self._found: tuple[Trace | None, str] | None = None

    def run(self) -> None:
        """Read it."""
        if self._launch is not None:
            try:
                python = launch_interpreter(self.env)
            except MissingToolError as error:
                self._found = None, str(error)
                return
            self._found = try_trace(self.env, self._launch, self._args, python)

    def ended(self, hurry: Callable[[], bool]) -> tuple[Trace | None, str]:
        """Wait for the launch file to be read; its values, or why they are not known."""
        limit = time.monotonic() + 2 * MISSION_PATIENCE_S
        while self.is_alive() and time.monotonic() < limit and not hurry():
            self.join(_POLL_S)
        if self._launch is None:
            return None, ""
        return self._found or (None, f"{self._launch} was not read in time")


class GraphRecording:
    """A recording of a graph, which others may extend by what they look at."""

    @classmethod
    def of(cls, agent: Agent, options: RecordOptions) -> GraphRecording:
        """Begin; where that fails, the agent leaves the graph."""
        try:
            return cls(agent, options)
        except BaseException:
            agent.close()
            raise

    def __init__(self, agent: Agent, options: RecordOptions) -> None:
        """Subscribe to all that is known; the rest is found as it appears."""
        self._agent = agent
        self._options = options
        topics = [f"/{one.lstrip('/')}" for one in options.topics]
        until = f"/{options.until.lstrip('/')}" if options.until else None
        always = [ROSOUT, REPORTS, TOPIC] if options.reports else [TOPIC]
        recorded = dict.fromkeys([*always, *topics, *([until] if until else [])])
        self._file = McapFile(options.out_dir / MCAP_FILE)
        self._recorder = Recorder(self._file, list(recorded), until, False, ROS2)
        self._recorder.hold()
        self._recorder.tell_marks(options.on_mark)
        self._topics = dict.fromkeys([*recorded, CLOCK])
        self.command_lines = CommandLines(agent.address.domain)
        self._values = NodeValues(agent)
        self._set: list[SetValue] = []
        # The node and the parameter of each full name: both may have slashes.
        self._names: dict[str, tuple[str, str]] = {}
        self._seen: Graph | None = None
        self._is_simulated = False
        self._missed = 0
        self._on_quiet = options.on_quiet
        self._event_source: Source | None = None
        self._began_ns = time.time_ns()
        # Until when what a logger said before the recording comes.
        self._history_until: dict[bytes, float] = {}
        for topic in self._topics:
            # A node's log from before its subscriber was found would be lost otherwise.
            history = topic == ROSOUT if topic in KNOWN else None
            agent.subscribe(topic, KNOWN.get(topic, ""), history=history)

    def run(
        self,
        stop: threading.Event | Stop,
        began: float,
        look: Callable[[], Looked] = lambda: _NOTHING,
    ) -> str:
        """Record until the end; the word of ``MissionRun.ended``.

        Args:
            stop: ends it.
            began: when the mission did, on the monotonic clock.
            look: asked several times a second whether the mission is over, and for its files.
        """
        told = 0.0
        on_progress, timeout_s = self._options.on_progress, self._options.timeout_s
        while True:
            self.step(_POLL_S)
            status = self._status()
            wall_s = time.monotonic() - began
            seen = look()
            if on_progress is not None and time.monotonic() - told > _TOLD_S:
                told = time.monotonic()
                progress = Progress.of(status, wall_s, seen.files)
                on_progress(replace(progress, is_found=self._agent.has_found(is_somebody)))
            in_files = seen.files.reports + seen.files.summaries
            if wall_s > _QUIET_S and not status.is_reporting and not in_files:
                self._tell_quiet()
            if stop.is_set() or self._agent.fault:
                return "interrupted"
            if status.done:
                return "done"
            if seen.is_over:
                return "ended"
            if timeout_s is not None and wall_s > timeout_s:
                return "timeout"

    def _tell_quiet(self) -> None:
        """Say once what it looks like where nothing is reported."""
        on_quiet, self._on_quiet = self._on_quiet, None
        if on_quiet is None:
            return
        graph = self._agent.graph
        nodes = visible(graph.nodes)
        built = [one for one in graph.nodes if one.endswith("/_tpc")]
        if not nodes:
            on_quiet(nobody(self._agent.address), False)
        elif not built:
            on_quiet(
                f"no reports: none of {many(len(nodes), 'node')} reports to this graph; were they"
                ' built with TPC, and started after: eval "$(pytpc env --setup WORKSPACE)"?',
                True,
            )
        else:
            on_quiet(
                f"no reports yet: {many(len(built), 'node')} can report, and may have compared"
                " nothing so far, write files or be off; see: pytpc sink",
                False,
            )

    def finish(self, hurry: bool) -> tuple[RecorderStatus, str]:
        """Take what is on the way, leave the graph and close the file; also: what went wrong.

        Raises:
            RunError: it cannot be written.
        """
        fault = self._agent.fault
        try:
            try:
                if not hurry:
                    self.wait_for_values()
                if not fault:
                    with contextlib.suppress(RunError):
                        self._agent.drain()
                self.step(0.0)
            finally:
                self._agent.close()
            self._take_values()
            self._recorder.put_early()
        finally:
            self._file.close()
        self._save_values()
        return self._status(closed=True), fault

    def keep_graph(self) -> None:
        """Write who speaks to whom, while the nodes still run.

        Without it only less is known of the messages.
        """
        with contextlib.suppress(TpcError):
            found = self._agent.connections()
            write_graph(found.topics, self._options.out_dir / GRAPH_FILE, found.services)

    def wait_for_values(self, hurries: Callable[[], bool] = lambda: False) -> None:
        """Wait for the values of nodes that have only just been found, unless one ``hurries``."""
        while self._values.are_asked_for(self._agent.patience_s):
            if self._agent.fault or hurries():
                return
            self.step(_POLL_S)

    def _is_history(self, stamp_ns: int, data: bytes) -> bool:
        """Whether a message on /rosout was sent before the recording."""
        if not 0 < stamp_ns < self._began_ns:
            return False
        with contextlib.suppress(ValueError):
            now = time.monotonic()
            return now < self._history_until.setdefault(decode_log(data).node, now + _HISTORY_S)
        return False

    def step(self, timeout_s: float) -> None:
        """Take the messages that have come."""
        self._look()
        for source, stamp_ns, data in self._agent.poll(timeout_s):
            if source.topic == ROSOUT and self._is_history(stamp_ns, data):
                self._missed += 1
                continue
            if source.topic == TOPIC:
                self._see_event(data)
            # Who reads the file says what is wrong with a message.
            with contextlib.suppress(ValueError):
                self._recorder.take(source, data)
        self._take_values()
        self._file.keep()

    def _look(self) -> None:
        graph = self._agent.graph
        if graph is not self._seen:
            self._seen = graph
            for topic in graph.topics:
                if MarkMessages.message_type(topic) is not None and topic not in self._topics:
                    self._topics[topic] = None
                    self._recorder.add_topic(topic)
                    self._agent.subscribe(topic)
            # The process of a new node may not live long.
            self.command_lines.look()
            self._values.see(graph.nodes)
        simulated = graph.clock > 0 or self._is_simulated
        if simulated or self._recorder.waited_ns > _LOOK_NS:
            self._recorder.see_sim_time(simulated)
        self._recorder.settle()

    def _take_values(self) -> None:
        """Put the values that nodes told into the file, as if these had just set them."""
        if self._event_source is None:
            self._event_source = self._agent.source_of(TOPIC)
        if self._event_source is not None:
            for event in self._values.told():
                self._see_event(event)
                self._recorder.take(self._event_source, event)

    def _see_event(self, data: bytes) -> None:
        with contextlib.suppress(ValueError):
            event = decode_parameter_event(data)
            if event.is_of_tpc:
                return
            self._values.see_event(event.node)
            now_ns = event.stamp_ns or self._recorder.now_ns()
            self._is_simulated |= event.values.get(_SIM_TIME) is True
            for parameter, value in event.values.items():
                name = f"{event.node.rstrip('/')}/{parameter}"
                self._names[name] = (event.node, parameter)
                self._set.append(SetValue(now_ns, name, value))

    def _status(self, *, closed: bool = False) -> RecorderStatus:
        account = self._recorder.status(closed=closed)
        lost = dict(account.lost)
        for topic, count in self._agent.lost.items():
            # The numbers of batches say it for each node.
            if topic in self._topics and not (topic == REPORTS and lost):
                lost[topic] = lost.get(topic, 0) + count
        missed = {**account.missed_before}
        if self._missed:
            missed[ROSOUT] = self._missed
        return replace(account, lost=lost, missed_before=missed)

    def _save_values(self) -> None:
        """Write the values at the start and at the end, as files that `ros2` reads, too."""
        values, folder = ParameterValues(self._set), self._options.out_dir
        if values.names():
            write_params(folder / START_FILE, self._by_node(values.first()))
            write_params(folder / PARAMS_FILE, self._by_node(values.last()))

    def _by_node(self, values: Mapping[str, object]) -> dict[str, dict[str, object]]:
        nodes: dict[str, dict[str, object]] = {}
        for name, value in sorted(values.items()):
            node, parameter = self._names[name]
            nodes.setdefault(node, {})[parameter] = value
        return nodes

    def save_origins(
        self, launched: Trace | None, reason: str, env: Mapping[str, str], *, is_own: bool
    ) -> None:
        """Write origins.json, where values are known.

        Args:
            launched: what the launch file sets; None where it is not known, or there is none.
            reason: why it is not known; empty without a launch file.
            env: in which the launch file was read.
            is_own: whether TPC has started the nodes.

        Raises:
            TpcError: the file cannot be written.
        """
        first = ParameterValues(self._set).first()
        trace = self.command_lines.trace(first, launched, is_own=is_own)
        why = [reason or NO_COMMAND_LINES] if trace is None else [*filter(None, [reason])]
        why += self.command_lines.faults
        folder = self._options.out_dir
        save_origins(folder, folder / PARAMS_FILE, trace, "; ".join(why), env)


def write_params(path: Path, nodes: Mapping[str, Mapping[str, object]]) -> None:
    """Write the values of nodes as a parameters file of ROS 2.

    Raises:
        TpcError: the file cannot be written.
    """
    document = {node: {"ros__parameters": dict(found)} for node, found in nodes.items()}
    write_atomic(path, yaml.safe_dump(document, sort_keys=True).encode())
