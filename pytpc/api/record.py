"""Records a mission: of a launch file, or of the running graph."""

from __future__ import annotations

import os
import shlex
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from pytpc.base.errors import InputError, RunError, TpcError
from pytpc.base.paths import MERGED_FILE
from pytpc.base.signals import Stop
from pytpc.base.wording import listed
from pytpc.build.nodes_env import DEVEL, nodes_env
from pytpc.ingest.file_counts import FileCounter
from pytpc.python_runtime.config import NAMES
from pytpc.ros.caller_env import with_callers
from pytpc.ros.mission_run import DEFAULT_TOPICS, MissionRun, Progress, RecordOptions
from pytpc.ros.node_start import STATIC, files_folder, mission_env, without_python
from pytpc.ros.ros1.launch_files import find_launch
from pytpc.ros.ros1.record_mission import record_graph, run_mission
from pytpc.ros.ros2.found_programs import find_in_package, find_program
from pytpc.ros.ros2.graph_recording import record_ros2_graph
from pytpc.ros.ros2.record_mission import Programs, run_ros2_mission
from pytpc.ros.running import RunningRecording, announced, process_start
from pytpc.ros.which import asked_ros, sign_of_ros2
from pytpc.values.launch_kinds import is_ros2_launch
from pytpc.values.origins import ORIGINS_FILE, read_document
from pytpc.workspace.colcon import Bases
from pytpc.workspace.packages import package_folders, read_manifest

_LISTED = 4
_NO_WALL_TIME = (
    "--wall-time is for ROS 1 and changes nothing here; on ROS 2 the launch file gives each node"
    " its use_sim_time"
)
_ONE_LAUNCH = "a launch file is run by itself, with NAME:=VALUE alone; leave out {}"
_LAUNCH_OF_ROS2 = (".py", ".launch.xml", ".yaml", ".yml")
__all__ = ["DEFAULT_TOPICS", "MissionRun", "Progress", "RecordOptions"]
__all__ += ["NodeFiles", "node_files", "record_launch", "record_ros2", "record_running"]
__all__ += ["files_folder", "sink_settings"]
__all__ += ["is_of_ros2", "package_of_launch", "why_no_origins"]


def record_launch(
    workspace: Path,
    options: RecordOptions,
    *,
    python: bool = True,
    use_sim_time: bool | None = True,
    stop: Stop | None = None,
) -> MissionRun:
    """Run a launch file of a built workspace on a ROS graph of its own, and record it.

    On ROS 2 it runs in the domain of the caller's shell, and may be executables instead.

    The settings of sinks in the caller's environment (TPC_SINK, TPC_POLICY, ...) hold for all
    nodes. Packages of other workspaces that the caller has sourced are found, too.

    Args:
        workspace: the workspace.
        options: the launch file, when to end, and where the recording goes.
        python: Python nodes report, too.
        use_sim_time: the graph's clock is the topic /clock. None: the launch file says so, or not.
        stop: ends the mission; whenever it is set, the recording is complete.

    Raises:
        WorkspaceError: the workspace is not built.
        RunError: see `pytpc.ros.ros1.record_mission.run_mission`, and that of ROS 2.
    """
    if is_of_ros2(workspace, options):
        asked = Stop() if stop is None else stop
        if use_sim_time is False and options.on_doubt is not None:
            options.on_doubt(_NO_WALL_TIME)
        return _record_ros2_launch(workspace, options, python=python, stop=asked)
    if options.programs or options.arguments:
        raise RunError(_ONE_LAUNCH.format((*options.programs, "--")[0]))
    sourced = with_callers(nodes_env(workspace), os.environ)
    env = {**sourced, **sink_settings(os.environ)}
    static = Bases.of(workspace).static_info
    if python:
        env = mission_env(env, static)
    if options.package and options.launch is not None:
        launch = find_launch(env, options.package, str(options.launch))
        options = replace(options, launch=launch, package="")
    elif options.launch is not None and not options.launch.is_file():
        raise RunError(f"no such launch file{_hint(workspace, options.launch)}", options.launch)
    options = replace(options, static=static)
    with _announced(options, workspace, static) as told:
        return run_mission(env, told, use_sim_time=use_sim_time, stop=stop)


def is_of_ros2(workspace: Path, options: RecordOptions) -> bool:
    """Whether a mission is one of ROS 2: as the user says, its launch file, or the packages.

    Raises:
        InputError: TPC_ROS is neither 1 nor 2, or a package.xml is broken.
    """
    asked, launch = asked_ros(os.environ), options.launch
    if asked is not None or launch is None:
        return asked == 2
    if launch.is_file() and not options.package:
        return is_ros2_launch(launch)
    if launch.name.endswith(_LAUNCH_OF_ROS2):
        return True
    manifests = [read_manifest(folder) for folder in package_folders(workspace)]
    own = [one.ros for one in manifests if one.name == options.package and one.ros]
    found = set(own or filter(None, (one.ros for one in manifests)))
    return found == {"2"} or (len(found) > 1 and bool(sign_of_ros2(os.environ)))


def _record_ros2_launch(
    workspace: Path, options: RecordOptions, *, python: bool, stop: Stop
) -> MissionRun:
    """``record_launch`` on the graph of ROS 2 that the shell names."""
    sourced = {**nodes_env(workspace, os.environ), **sink_settings(os.environ)}
    static = Bases.of(workspace).static_info
    env = mission_env(sourced, static) if python else without_python(sourced)
    launch, programs = options.launch, None
    if options.package and launch is not None:
        found, is_launch = find_in_package(env, options.package, launch.name)
        launch = found if is_launch else None
        if not is_launch:
            more = [find_program(env, options.package, word) for word in options.programs]
            programs = Programs([found, *more], options.arguments)
    elif launch is not None and not launch.is_file():
        raise RunError(f"no such launch file{_hint(workspace, launch)}", launch)
    if programs is None and (options.programs or options.arguments):
        raise RunError(_ONE_LAUNCH.format((*options.programs, "--")[0]))
    if programs is not None and options.args:
        name = next(iter(options.args))
        raise RunError(f"{name}:=... is for a launch file; give a parameter with -- --ros-args -p")
    options = replace(options, launch=launch, package="", static=static)
    with _announced(options, workspace, static) as told:
        return run_ros2_mission(env, told, programs, stop=stop)


def record_running(
    options: RecordOptions,
    stop: threading.Event | Stop,
    env: Mapping[str, str] | None = None,
) -> MissionRun:
    """Record the graph that runs; see `pytpc.ros.ros1.record_mission.record_graph`.

    The launch file is read with the packages of the workspace whose static information is given,
    which need not be sourced.

    Raises:
        RunError: the master does not answer, the folder has a recording, or the bag can no longer
            be written; it is closed, and has what was written before.
        OSError: the bag cannot be opened.
    """
    with _announced(options, None, options.static) as told:
        return record_graph(
            told, stop, env, _launch_env(options, os.environ if env is None else env)
        )


def record_ros2(
    options: RecordOptions,
    stop: threading.Event | Stop,
    env: Mapping[str, str] | None = None,
) -> MissionRun:
    """Record the graph of ROS 2; see `pytpc.ros.ros2.graph_recording.record_ros2_graph`.

    Raises:
        MissingToolError: no interpreter has rclpy.
        RunError: ROS 2 does not work, the folder has a recording, or the file can no longer be
            written; it is closed, and has what was written before.
        OSError: the file cannot be opened.
    """
    with _announced(options, None, options.static) as told:
        known = os.environ if env is None else env
        return record_ros2_graph(told, stop, env, _launch_env(options, known, is_ros2=True))


def _launch_env(
    options: RecordOptions, env: Mapping[str, str], *, is_ros2: bool = False
) -> Mapping[str, str]:
    """The environment in which the launch file of a running robot is read."""
    static = options.static
    if options.launch is None or static is None or options.is_static_guessed:
        return env
    workspace = static if static.is_dir() else static.parent.parent
    try:
        return nodes_env(workspace, env) if is_ros2 else with_callers(nodes_env(workspace), env)
    except TpcError:
        # A static.json alone.
        return env


def _static_of_shell(env: Mapping[str, str]) -> Iterator[Path]:
    """The static information of the build that ``pytpc env`` has named; it need not exist."""
    if env.get(STATIC):
        yield Path(env[STATIC])
    elif env.get(DEVEL):
        yield Path(env[DEVEL]).with_name(MERGED_FILE)


def package_of_launch(workspace: Path, launch: Path) -> str:
    """The package with the only launch file of this name in the workspace; empty if none has it.

    It is empty as well where ``launch`` is a file, or says in which folder it is.

    Raises:
        InputError: a package.xml is broken.
    """
    if launch.is_file() or launch != Path(launch.name):
        return ""
    found = list(_packages_with(workspace, launch.name))
    return found[0] if len(found) == 1 else ""


def _packages_with(workspace: Path, name: str) -> Iterator[str]:
    """The packages that have files of this name, once for each file."""
    for folder in package_folders(workspace):
        for path in folder.rglob("*.launch" if name.endswith(".launch") else "*"):
            if path.name == name and path.is_file():
                yield read_manifest(folder).name


def _hint(workspace: Path, launch: Path) -> str:
    """Where the workspace has launch files of this name."""
    found = [
        f"{package} {shlex.quote(launch.name)}"
        for package in dict.fromkeys(_packages_with(workspace, launch.name))
    ]
    if not found:
        return "; give its path, or its package and its name"
    return f"; give its path, or package and name: {listed(found, _LISTED)}"


@contextmanager
def _announced(
    options: RecordOptions, workspace: Path | None, static: Path | None
) -> Iterator[RecordOptions]:
    """The options with which other terminals find the recording as soon as it begins."""
    with ExitStack() as exits:

        def begin(master: str, host: str) -> None:
            pid, launch = os.getpid(), options.launch
            copy = options.out_dir / MERGED_FILE
            places = (
                *([static] if static is not None else []),
                copy,
                *_static_of_shell(os.environ),
            )
            known = next((one for one in places if one.is_file()), None)
            entry = RunningRecording(
                pid=pid,
                process_start=process_start(pid) or 0,
                master=master,
                host=host,
                folder=str(options.out_dir.absolute()),
                workspace="" if workspace is None else str(workspace.absolute()),
                static="" if known is None else str(known.absolute()),
                launch="" if launch is None else str(launch.absolute()),
                since=time.time(),
            )
            exits.enter_context(announced(entry))
            if options.on_graph is not None:
                options.on_graph(master, host)

        yield replace(options, on_graph=begin)


def why_no_origins(folder: Path) -> str:
    """Why the recording of a launch file does not know where values came from; empty if it does."""
    try:
        document = read_document(folder / ORIGINS_FILE)
    except InputError:
        return ""
    is_known = document.get("launch") is not None
    return "" if is_known else str(document.get("reason") or "")


def sink_settings(env: Mapping[str, str]) -> dict[str, str]:
    """The settings of sinks in ``env``, all that a mission's nodes get of TPC's variables there.

    A relative folder becomes absolute, as the nodes run elsewhere. A mission that is recorded needs
    no ring: it would keep the reports twice, and lose those of its beginning.
    """
    names = (f"TPC_{name.upper()}" for name in NAMES if not name.startswith("ring"))
    settings = {name: env[name] for name in names if env.get(name)}
    if "TPC_FOLDER" in settings:
        settings["TPC_FOLDER"] = str(Path(settings["TPC_FOLDER"]).absolute())
    return settings


class NodeFiles(NamedTuple):
    """Files that nodes wrote in the folder of this machine that has those of all missions."""

    folder: Path
    files: int


def node_files(since_ns: int) -> NodeFiles:
    """The files of nodes that were written since a time (ns since 1970), as far as they are here.

    A running robot's nodes write to a folder of their own, not to that of the recording
    (docs/reference/runtime.md). Files of rings are left out: what is in them also goes over the
    graph, unless the sink is `file`, and `pytpc keep` keeps them.
    """
    folder = files_folder(os.environ)
    return NodeFiles(folder, FileCounter(folder, since_ns, rings=False).count().files)
