"""Records a mission: of a launch file, or of the running graph."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from pytpc.build.build import installed, workspace_env
from pytpc.python_runtime.config import NAMES
from pytpc.ros.mission_run import DEFAULT_TOPICS, MissionRun, Progress, RecordOptions
from pytpc.ros.node_start import mission_env
from pytpc.ros.ros1.record_mission import record_graph as record_running
from pytpc.ros.ros1.record_mission import run_mission
from pytpc.workspace.colcon import Bases

__all__ = ["DEFAULT_TOPICS", "MissionRun", "Progress", "RecordOptions"]
__all__ += ["record_launch", "record_running", "sink_settings"]


def record_launch(
    workspace: Path, options: RecordOptions, *, python: bool = True, use_sim_time: bool = True
) -> MissionRun:
    """Run a launch file of a built workspace on a ROS graph of its own, and record it.

    The settings of sinks in the caller's environment (TPC_SINK, TPC_POLICY, ...) hold for all
    nodes.

    Args:
        workspace: the workspace.
        options: the launch file, when to end, and where the recording goes.
        python: Python nodes report, too.
        use_sim_time: the graph's clock is the topic /clock.

    Raises:
        WorkspaceError: the workspace is not built.
        RunError: see `pytpc.ros.ros1.record_mission.run_mission`.
    """
    env = {**workspace_env(installed(workspace)), **sink_settings(os.environ)}
    if python:
        env = mission_env(env, Bases.of(workspace).static_info)
    return run_mission(env, options, use_sim_time=use_sim_time)


def sink_settings(env: Mapping[str, str]) -> dict[str, str]:
    """The settings of sinks in ``env``, all that a mission's nodes get of the caller's environment.

    A relative folder becomes absolute, as the nodes run elsewhere.
    """
    names = (f"TPC_{name.upper()}" for name in NAMES)
    settings = {name: env[name] for name in names if env.get(name)}
    if "TPC_FOLDER" in settings:
        settings["TPC_FOLDER"] = str(Path(settings["TPC_FOLDER"]).absolute())
    return settings
