"""The command ``record``."""

from __future__ import annotations

import os
import shlex
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path

import click
from rich.markup import escape

from pytpc.api.missions import convert
from pytpc.api.record import (
    MissionRun,
    Progress,
    RecordOptions,
    node_files,
    package_of_launch,
    record_launch,
    record_ros2,
    record_running,
    why_no_origins,
)
from pytpc.api.static_of_mission import GIVE, NONE_FOUND, static_to_keep
from pytpc.base.errors import InputError, RunError
from pytpc.base.folder_lock import alone_in
from pytpc.base.signals import Stop
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import PATH, as_object
from pytpc.cli.console import progress, tell_next, waiting, warn
from pytpc.cli.launch_words import LaunchWords, MissionCommand, folder_for, node_args
from pytpc.cli.lines import progress_console, say
from pytpc.cli.mission_options import MISSION_OPTIONS, MissionArguments
from pytpc.cli.running_graph import ROS, ros2_here, tell
from pytpc.recording.faults import faults_of
from pytpc.recording.mission import REPORTS_FOLDER, RUN_FILE, read_run
from pytpc.ros.mission_run import BAG_FILE, refuse_earlier
from pytpc.ros.ros1.master import Master, uri_of
from pytpc.ros.ros2.address import is_ros2, words_of

_SILENT_S = 5.0
_CLOCK_S = 30.0
_CALLER = "/tpc_record"
STOPPING = "pytpc: stopping; press Ctrl-C again not to wait for the nodes"
_WITH_SUMMARIES = (
    "reports include summaries, of which each stands for many evaluations;"
    " TPC_POLICY=every reports them one by one"
)
_IN_FILES = "TPC_SINK=file TPC_POLICY=light TPC_PROCESS_CAP=0"
"""Files cost a node less than messages, so that its changes need no cap for all of them."""


@dataclass(frozen=True)
class _RecordArguments(MissionArguments):
    words: tuple[str, ...]
    launched: Path | None
    static_source: Path | None
    parquet: bool


@click.command("record", cls=MissionCommand)
@click.argument("words", nargs=-1, metavar="[WORKSPACE [PACKAGE] LAUNCH] [NAME:=VALUE]...")
@MISSION_OPTIONS
@ROS
@click.option(
    "--launch",
    "launched",
    type=PATH,
    help="Launch file that started the running graph; it tells where parameter values came from.",
)
@click.option(
    "--static",
    "static_source",
    type=PATH,
    metavar="FILE_OR_FOLDER",
    help="Static information of a running graph, which the recording keeps: a static.json, a build"
    " base or a built workspace. [default: the one found in this folder or a sourced workspace]",
)
@click.option("--parquet", is_flag=True, help="Convert the bag afterwards, as `convert` does.")
@as_object(_RecordArguments)
def record_command(given: _RecordArguments) -> None:
    """Record a mission: the running graph, or a LAUNCH file of a built WORKSPACE.

    Without WORKSPACE and LAUNCH, the graph at ROS_MASTER_URI, or that of ROS 2 in ROS_DOMAIN_ID, is
    recorded until Ctrl-C. With them,
    the launch file runs on a ROS graph of its own: give its path, or PACKAGE and its name, as to
    roslaunch. Its Python nodes report, and TPC_SINK, TPC_POLICY and so on apply to all nodes. On
    ROS 2 it runs in the domain of the shell, and PACKAGE EXECUTABLE... [-- ARGUMENT...] starts
    nodes without a launch file.

    `mark`, `watch` and `sink` in another terminal find the recording by themselves. Ctrl-C ends it
    at any time, and it is complete; a second Ctrl-C waits no longer for nodes to end. Marks of all
    observers are recorded as they appear.
    """
    words = LaunchWords.of(given.words, node_args())
    if words.workspace is not None and given.launched is not None:
        raise click.UsageError("--launch is only for a running graph; here LAUNCH names the file")
    if words.workspace is not None and given.static_source is not None:
        raise click.UsageError("--static is only for a running graph; here WORKSPACE has it")
    words = with_package(words)
    output = folder_for(words.launch or given.launched, given.output)
    stop = Stop(STOPPING if words.workspace else "")
    began_ns, elsewhere = time.time_ns(), 0
    with stop.on_signals():
        if words.workspace is None:
            run = _record_running(given, words, output, stop)
            elsewhere = _tell_files(began_ns, output)
        else:
            run = record_mission(words, output, given, stop)
        show_run(run, output, launched=words.workspace is not None)
        if given.launched is not None or words.launch is not None:
            tell_of_origins(output)
    if given.parquet:
        outcome = convert([output], output)
        for fault in faults_of(outcome.recording):
            say(plain(f"warning: {fault}"))
        click.echo(f"{many(outcome.events, 'report')} in Parquet: {output}")
    if not elsewhere:
        tell_next(_next_command(run, output, words.workspace))


def with_package(words: LaunchWords) -> LaunchWords:
    """The words; a launch file that only one package of the workspace has is that package's.

    Raises:
        InputError: a package.xml is broken.
    """
    if words.workspace is None or words.launch is None or words.package or words.is_path:
        return words
    package = package_of_launch(words.workspace, words.launch)
    if package:
        tell(f"{words.launch} is not in this folder; taking that of package {package}")
    return words._replace(package=package)


def _next_command(run: MissionRun, output: Path, workspace: Path | None) -> str:
    """What to type after a recording."""
    folder = shlex.quote(str(output))
    if not run.has_reports:
        return f"pytpc doctor {'WORKSPACE' if workspace is None else shlex.quote(str(workspace))}"
    if run.marks:
        return f"pytpc rank {folder}"
    return f"pytpc mark {folder}, to mark what went wrong, and then: pytpc rank {folder}"


def _record_running(
    given: _RecordArguments, words: LaunchWords, output: Path, stop: Stop
) -> MissionRun:
    if given.launched is not None and not given.launched.is_file():
        raise InputError("no such launch file", given.launched)
    if output.is_dir():
        with alone_in(output):
            refuse_earlier(output)
    ros2 = ros2_here()
    graph = uri_of(os.environ) if ros2 is None else ros2.master
    try:
        if ros2 is None:
            Master(graph, _CALLER).call("getPid")
    except RunError as error:
        raise RunError(
            f"{error} Start the robot, or `export ROS_MASTER_URI=http://HOST:11311`, or let TPC"
            " start it: pytpc record WORKSPACE LAUNCH. For a robot with ROS 2: --ros 2"
        ) from error
    options = _with_static(
        replace(given.options(output, words), launch=given.launched), given.static_source
    )
    if given.launched is None and ros2 is None:
        tell(
            "the recording does not know which file sets which value; to have that in it, too:"
            " pytpc record --launch FILE [NAME:=VALUE]..."
        )
    tell(f"recording {words_of(graph)} in {output}; press Ctrl-C to stop")
    with mission_progress("recording", "s") as advance:
        options = replace(options, on_progress=advance)
        if ros2 is not None:
            return record_ros2(options, stop)
        return record_running(options, stop)


def _tell_files(since_ns: int, output: Path) -> int:
    """Say where the nodes of a running robot wrote reports meanwhile; the number of files."""
    folder, files = node_files(since_ns)
    if files:
        kept = output / REPORTS_FOLDER
        say(
            f"{many(files, 'file')} of reports, written meanwhile, are in {folder}; to have them"
            f" read with the recording, copy them into {kept}",
        )
    return files


def _with_static(options: RecordOptions, given: Path | None) -> RecordOptions:
    """The options with the static information that is given, or found; a line says what is kept.

    Raises:
        InputError: what is given is broken, or is not there.
    """
    with progress("looking for static information"):
        found = static_to_keep(given)
    if found is None:
        tell(f"{NONE_FOUND}, so the recording keeps none; {GIVE}")
        return options
    if given is None:
        tell(f"{found.words}; the recording keeps a copy")
    return replace(
        options,
        static=found.path,
        static_info=found.static,
        is_static_guessed=given is None,
    )


def record_mission(
    words: LaunchWords, output: Path, given: MissionArguments, stop: Stop
) -> MissionRun:
    """Run a launch file, and show how it goes.

    Raises:
        RunError: it fails; what there is of it is in the folder.
    """
    assert words.workspace is not None
    assert words.launch is not None

    has_begun = False

    def begun(master: str, _host: str) -> None:
        nonlocal has_begun
        has_begun = True
        with suppress(OSError):
            tell(f"recording {words_of(master)} in {output}; press Ctrl-C to stop")
            tell(where_nodes_print(output, master))

    with (
        mission_progress(words.launch.stem, "s") as advance,
        kept_if_it_fails(output, lambda: has_begun),
    ):
        options = replace(given.options(output, words), on_progress=advance, on_graph=begun)
        return record_launch(
            words.workspace,
            options,
            python=not given.no_python,
            use_sim_time=given.use_sim_time,
            stop=stop,
        )


def where_nodes_print(output: Path, master: str) -> str:
    """Where the output of a mission's nodes is, in a line."""
    ros = output / "ros"
    if is_ros2(master):
        return f"what the nodes print is in {ros / 'out'} and in {ros / 'log'}"
    return f"what the nodes print is in {ros / 'out/roslaunch.log'} and in {ros / 'log'}"


@contextmanager
def kept_if_it_fails(output: Path, has_begun: Callable[[], bool]) -> Iterator[None]:
    """Say where the recording of a mission is that fails within the block.

    Of a mission that has not begun, nothing is said: the folder may have another one's files.
    """
    try:
        yield
    except RunError:
        if not has_begun():
            raise
        active = output / f"{BAG_FILE}.active"
        if (output / RUN_FILE).is_file():
            ask = f"; for the verdict: pytpc rank {shlex.quote(str(output))}"
            ask = ask if _has_reports(output) else ", without a report"
            tell(f"what was recorded until then is in {output}{ask}")
        elif active.is_file():
            tell(f"what was recorded until then is in {active}; recover it with rosbag reindex")
        raise


def _has_reports(output: Path) -> bool:
    """Whether a recording may have reports, as its description says."""
    run = read_run(output)
    counts = ("reports", "reports_in_files", "summaries_in_files", "is_reporting")
    return any(run.get(name, True) for name in counts)


def show_run(run: MissionRun, output: Path, *, launched: bool, marks: int | None = None) -> None:
    """Print what a recording has, and warn of what it has not.

    Args:
        run: how it went.
        output: its folder.
        launched: whether TPC started the graph.
        marks: how many its reader found; None: as many as the recorder received.
    """
    marks = run.marks if marks is None else marks
    lost = sum(run.lost.values())
    if lost:
        say(f"warning: {many(lost, 'log message')} lost by the recorder")
    for node, count in sorted(run.broken.items()):
        say(f"warning: {plain(node) or 'a node'} broke off {many(count, 'message')}")
    before = sum(run.missed_before.values())
    if before and not launched:
        say(
            f"{many(before, 'log message')} of {many(len(run.missed_before), 'node')} from before"
            " the recording are not in it. To have them, start `pytpc record` before the robot, or"
            " let it start the robot: pytpc record WORKSPACE LAUNCH",
        )
    dropped = sum(each.count for each in run.dropped)
    if dropped:
        places = len({each.key for each in run.dropped})
        kept = "" if run.files else f"; {_IN_FILES} keeps more"
        say(
            f"warning: {many(dropped, 'report')} of {many(places, 'comparison')} never left"
            f" {many(len({each.node for each in run.dropped}), 'node')}:"
            f" {output / RUN_FILE} has them{kept}",
        )
    if not run.params.is_file():
        why = "the parameter server did not answer"
        if run.bag.suffix == ".mcap":
            why = "no node told its parameters"
        elif not launched and shutil.which("rosparam") is None:
            why = "rosparam not found; install it with: apt-get install ros-core"
        say(f"warning: no {run.params.name}: {why}")
    if run.files:
        say(
            f"{many(run.reports_in_files, 'report')} and {run.summaries_in_files:,} summaries in"
            f" {many(run.files, 'file')}: {output / REPORTS_FOLDER}",
        )
    # The nodes may have another policy than this shell, but a graph of ours has its.
    if launched and run.reports and os.environ.get("TPC_POLICY", "light") != "every":
        say(_WITH_SUMMARIES)
    click.echo(
        f"{many(run.reports + run.reports_in_files, 'report')} and {many(marks, 'mark')} in"
        f" {run.sim_s:.1f} s ({run.ended}): {run.bag}"
    )


def tell_of_origins(output: Path) -> None:
    """Warn if the launch file could not be read, so that nothing is known about its values."""
    why = why_no_origins(output)
    if why:
        warn(f"where values came from is not known: {why}")


@contextmanager
def mission_progress(what: str, unit: str = "s simulated") -> Iterator[Callable[[Progress], None]]:
    """Show a mission's progress: one moving line on a terminal, or a line every 5 s if piped."""
    console = progress_console()
    status = waiting(console, what)
    told = time.monotonic()

    def advance(progress: Progress) -> None:
        nonlocal told
        line = f"{plain(what)}: {progress_words(progress, unit)}"
        # A terminal that was closed must not end the recording.
        with suppress(OSError):
            status.update(escape(line))
            if not console.is_terminal and time.monotonic() - told > _SILENT_S:
                told = time.monotonic()
                say(line)

    if console.is_terminal:
        status.start()
    try:
        yield advance
    finally:
        with suppress(OSError):
            status.stop()


def progress_words(progress: Progress, unit: str = "s") -> str:
    """How far a mission is, in a line."""
    if not progress.has_time and progress.wall_s > _CLOCK_S:
        return (
            f"no /clock for {progress.wall_s:.0f} s, and /use_sim_time is set: is the simulator"
            " running? For a robot in real time, set it to false, or use --wall-time"
        )
    reports = progress.reports + progress.in_files.reports
    line = f"{progress.sim_s:.0f} {unit}, {reports:,} reports"
    if progress.in_files.files:
        line += f" ({progress.in_files.reports:,} of them in files)"
    return f"{line}, {many(progress.marks, 'mark')}"


COMMANDS: list[click.Command] = [record_command]
