"""What is known of the nodes of a robot and their topics: of a mission, or of a launch file."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from pytpc.recording.graph_file import read_recorded_graph
from pytpc.recording.mission import Recording
from pytpc.static.wiring import RunningNode, Wiring
from pytpc.values.origins import origins_file
from pytpc.values.ros2_trace import trace_any_launch
from pytpc.values.target import read_target
from pytpc.values.trace import LaunchNode


def wiring_of_mission(recording: Recording, source: Path | None) -> Wiring:
    """The nodes of a recorded mission.

    Args:
        recording: what was read from it.
        source: its folder or bag, beside which the launch file's nodes and the graph may have been
            recorded; None: not known.

    Raises:
        InputError: one of these files is broken.
    """
    if source is None:
        return Wiring(evaluated=recording.nodes_of)
    nodes: tuple[RunningNode, ...] = ()
    if origins_file(source).is_file():
        folder = origins_file(source).parent
        nodes = _running(read_target(folder, {}, {}).nodes)
    graph = read_recorded_graph(source if source.is_dir() else source.parent)
    return Wiring(nodes, recording.nodes_of, graph.topics, graph.services)


def with_wiring(recording: Recording, source: Path | None) -> Recording:
    """The recording with what is known of its nodes, unless it has that.

    Raises:
        InputError: as `wiring_of_mission`.
    """
    if recording.wiring is not None:
        return recording
    return replace(recording, wiring=wiring_of_mission(recording, source))


def wiring_of_launch(
    launch: Path, workspaces: Iterable[Path] = (), env: Mapping[str, str] = os.environ
) -> Wiring:
    """The nodes that a launch file starts, with its arguments' defaults.

    Args:
        launch: the file.
        workspaces: built ones, in which ``$(find ...)`` finds its packages; others are passed over.
        env: says what else is sourced.

    Raises:
        InputError: it is not there, or cannot be read.
        MissingToolError: roslaunch, or launch, is not installed.
    """
    known = dict(env)
    for workspace in workspaces:
        if workspace.is_dir():
            # Its import takes longer than that of what needs no workspace.
            from pytpc.build.nodes_env import nodes_env  # noqa: PLC0415
            from pytpc.ros.caller_env import with_callers  # noqa: PLC0415

            known = with_callers(nodes_env(workspace), known)
    return Wiring(_running(trace_any_launch(known, launch, {}).nodes))


def _running(nodes: Iterable[LaunchNode]) -> tuple[RunningNode, ...]:
    return tuple(
        RunningNode(node.name, f"{node.package}/{node.program}", node.remaps) for node in nodes
    )
