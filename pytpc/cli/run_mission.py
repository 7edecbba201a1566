"""A mission in one terminal, from its start to the verdict: the larger half of ``run``."""

from __future__ import annotations

import os
import shlex
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import click
from rich.markup import escape

from pytpc.api.comparing import RecordedRun
from pytpc.api.flown_mission import FlownMission
from pytpc.api.live_diagnosis import LiveDiagnosis, asked_of_graph
from pytpc.api.live_mission import WatchedMission, fresh_watching
from pytpc.api.missions import find_declared
from pytpc.api.report import report_of
from pytpc.base.errors import InputError
from pytpc.base.signals import Stop
from pytpc.base.wording import exact, plain
from pytpc.cli.console import console, waiting
from pytpc.cli.launch_words import LaunchWords, folder_for
from pytpc.cli.lines import progress_console, say
from pytpc.cli.mark_commands import check_observer, mark_in_terminal, marks_target
from pytpc.cli.mission_commands import (
    STOPPING,
    kept_if_it_fails,
    progress_words,
    record_mission,
    show_run,
    where_nodes_print,
    with_package,
)
from pytpc.cli.mission_options import MissionArguments, tell_died
from pytpc.cli.options import (
    asked_mission,
    good_runs,
    offer_good_run,
    recording_of,
    warn_plainly,
)
from pytpc.cli.report_commands import draw, page_of, tell_page
from pytpc.cli.running_graph import tell
from pytpc.cli.sources import known_static_file, static_for, static_of, warn_of_changed
from pytpc.cli.watch_commands import opened_graph
from pytpc.diagnosis.question import PLAIN
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.present.marking_terminal import Showing
from pytpc.present.ranking_tables import print_diagnosis
from pytpc.present.watch_screen import WatchOptions
from pytpc.recording.mission import Recording
from pytpc.ros.mission_run import DiedNode, MissionRun
from pytpc.ros.ros2.address import is_ros2, words_of

_TURN_S = 0.2
_NOTES = 3


def run_mission(
    words: LaunchWords,
    given: MissionArguments,
    observer: str | None,
    references: Sequence[Path] = (),
) -> None:
    """Run and record a mission, then diagnose it.

    Args:
        words: what is launched.
        given: the options.
        observer: who marks in this terminal; None: nobody does.
        references: recordings of good runs.

    Raises:
        TpcError: the mission failed, or has no reports.
    """
    check_observer(observer or "")
    words = with_package(words)
    assert words.workspace is not None
    output = folder_for(words.launch, given.output)
    stop = Stop(STOPPING if observer is None else "")
    with stop.on_signals():
        if observer is None:
            run = record_mission(words, output, given, stop)
        else:
            run = _with_keys(words, output, given, _Observer(observer, references), stop)
    # From here on, Ctrl-C ends it.
    try:
        recording = _read(run, output, words.workspace)
        _answer(recording, output, references)
    except KeyboardInterrupt:
        tell(f"the recording is complete; for the verdict: pytpc rank {shlex.quote(str(output))}")
        raise


def _read(run: MissionRun, output: Path, workspace: Path) -> Recording:
    """Read the recording, and say how the mission went.

    Raises:
        InputError: it has no reports, or cannot be read.
    """
    marks = None
    try:
        if not run.has_reports:
            why = "; ".join(each.words for each in run.died) or (
                f"does the launch file start nodes of {workspace}? See"
                f" `pytpc doctor {shlex.quote(str(workspace))}`"
            )
            raise InputError(f"no reports arrived, so there is nothing to diagnose: {why}", output)
        recording = recording_of(output)
        marks = len(recording.marks)
    finally:
        show_run(run, output, launched=True, marks=marks)
    return recording


class _Observer(NamedTuple):
    """Who marks in this terminal, and the good runs beside which the screen judges."""

    name: str
    references: Sequence[Path]


class _Notes:
    """What is told while the screen is on; it has the last lines, which are ``shown``.

    For the end it keeps how each node died last, and why nothing was reported.
    """

    def __init__(self) -> None:
        self.shown: list[str] = []
        self.reasons: list[str] = []
        self.nodes: dict[str, DiedNode] = {}

    def quiet(self, line: str, _is_fault: bool) -> None:
        """Nodes report nothing."""
        self.reasons.append(plain(line))
        self._show(plain(line))

    def died(self, node: DiedNode) -> None:
        """A node died; one that roslaunch starts again may do so every second."""
        self.nodes[node.name] = node
        self._show(plain(": ".join([node.words, *node.said[-1:]])))

    def _show(self, line: str) -> None:
        self.shown.append(line)
        del self.shown[:-_NOTES]


def _with_keys(
    words: LaunchWords, output: Path, given: MissionArguments, observer: _Observer, stop: Stop
) -> MissionRun:
    """Run the mission with its suspects on the screen, and take keys.

    Raises:
        InputError: a good run cannot be read, or is of another build.
        TpcError: the mission failed; what there is of it is in the folder.
    """
    assert words.workspace is not None
    static = static_of([words.workspace])
    good = good_runs(observer.references, static)
    fresh = fresh_watching(static, PLAIN)
    screen = progress_console()
    notes = _Notes()
    flown = FlownMission(
        words.workspace,
        replace(given.options(output, words), on_quiet=notes.quiet, on_died=notes.died),
        stop,
        python=not given.no_python,
        use_sim_time=given.use_sim_time,
    )
    with kept_if_it_fails(output, lambda: bool(flown.master)):
        try:
            with waiting(screen, f"starting {words.launch}"):
                while not flown.wait_for_graph(_TURN_S):
                    pass
            if flown.master and not stop.is_set():
                if is_ros2(flown.master):
                    tell(f"the mission runs in {words_of(flown.master)}")
                else:
                    os.environ.update(ROS_MASTER_URI=flown.master, ROS_IP=flown.host)
                    os.environ.pop("ROS_HOSTNAME", None)
                tell(where_nodes_print(output, flown.master))
                mission, feed = opened_graph(flown.master, observer.name, fresh)
                judged = None
                if good:
                    file = known_static_file(words.workspace)
                    judged = LiveDiagnosis(asked_of_graph(flown.master, static, file, PLAIN, good))
                watched = WatchedMission(mission, feed, WatchOptions(), judged=judged)
                watched.about = notes.shown
                mark_in_terminal(
                    watched,
                    observer.name,
                    marks_target(output, observer.name, None),
                    Showing(watched.paint, True, lambda: flown.is_over, stop.is_set),
                )
        finally:
            # The observer has ended it, or something failed: the recording is to be complete.
            stop.set()
            with waiting(screen, "ending the mission") as status:
                while not flown.wait(_TURN_S):
                    told = "" if flown.progress is None else f": {progress_words(flown.progress)}"
                    status.update(f"ending the mission (Ctrl-C: do not wait){escape(told)}")
            for node in notes.nodes.values():
                tell_died(node)
        run = flown.result()
    if not run.has_reports:
        for line in notes.reasons:
            tell(line)
    return run


def _answer(recording: Recording, output: Path, references: Sequence[Path]) -> None:
    """Print what `rank` says, write the page of `report`, and say what to type next.

    Raises:
        InputError: a good run cannot be read, or does not fit.
        TpcError: the page cannot be written.
    """
    static = static_for(None, output, recording)
    declared = find_declared(static, output, warn_plainly)
    question = replace(PLAIN, declared=declared)
    good = good_runs(references, static)
    asked = asked_mission(RecordedRun(recording, output), static, question, good)
    if recording.marks:
        warn_of_changed(static, output)
        print_diagnosis(console(), asked.diagnosis)
    else:
        say("nothing was marked, so nothing is to blame")
    if not references:
        offer_good_run(output)
    page = page_of([output])
    mission = report_of(asked.rankings, diagnosed=asked.diagnosis)
    draw(page, [mission])
    tell_page(page, [mission])
    click.echo(plain(f"next: {_next_step(asked.diagnosis, output, marked=bool(recording.marks))}"))


def _next_step(found: Diagnosis, output: Path, *, marked: bool) -> str:
    """The command that puts the suggested value in, if a parameter is to blame."""
    if not marked:
        return f"if it went well, run it with --reference {shlex.quote(str(output))} next time"
    if found.accused is None or not found.action:
        return f"run it again and mark each error, or look at {page_of([output])}"
    tried = found.advice[0].remedy
    # A shell would take the tilde for a user's folder.
    name = tried.parameter.removeprefix("~")
    return shlex.join(["pytpc", "apply", str(output), name, exact(tried.value)])
