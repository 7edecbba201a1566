"""What differs between good runs and a mission, and the good runs of a mission."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

from pytpc.api.missions import (
    Source,
    about_mission,
    load_static,
    read,
    reported_keys,
    with_names_of,
)
from pytpc.api.static_of_mission import recorded_static
from pytpc.base.errors import InputError, TpcError
from pytpc.base.paths import MERGED_FILE, OWN_FOLDER
from pytpc.base.regular_files import has_same_content
from pytpc.diagnosis.differences import RunValues, changes_of, differences
from pytpc.diagnosis.full_names import with_keys_of
from pytpc.diagnosis.question import WINDOW_S, Question
from pytpc.diagnosis.results.differences import RunDifferences
from pytpc.ingest.reading import holds_mission
from pytpc.recording.events import Events
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_values import ParameterValues
from pytpc.recording.profile import is_profile, runs_in
from pytpc.ros.graphs import values_at
from pytpc.ros.mission_run import BAG_FILE, MCAP_FILE
from pytpc.static.builds import Build, build_of
from pytpc.static.other_builds import keys_in, renamed
from pytpc.static.parameters import base_key
from pytpc.static.static_info import StaticInfo
from pytpc.values.origins import PARAMS_FILE, read_origins
from pytpc.values.recording import is_of_ros, params_file, read_parameters

_FIRST = 64


@dataclass(frozen=True)
class RecordedRun:
    """A recording and its path, beside which the values of its parameters are; None: not known.

    What is beside it is read once. Of a robot that runs, ``server`` has the values of the
    parameters, and ``built`` is the file of static information of its build.
    """

    recording: Recording
    source: Path | None = None
    server: Mapping[str, object] | None = None
    built: Path | None = None

    @classmethod
    def of(cls, given: RecordedRun | Recording | Source) -> RecordedRun:
        """Read a run, unless it was read before.

        Raises:
            InputError: it cannot be read.
        """
        if isinstance(given, RecordedRun):
            return given
        if isinstance(given, Recording):
            return cls(given)
        return cls(read(given), Path(given))

    @property
    def name(self) -> str:
        """The name of its folder, or of its file; a mission's bag has its folder's name."""
        if self.source is None:
            return self.recording.name
        source = self.source.absolute()
        return source.parent.name if source.name in (BAG_FILE, MCAP_FILE) else source.name

    @cached_property
    def values(self) -> RunValues:
        """The run with the recorded values of its parameters.

        Raises:
            InputError: params.yaml or origins.json is there and cannot be read.
        """
        path = None if self.source is None else params_file(self.source)
        if path is None or self.source is None:
            server = self.server
            if server is None and self.recording.values:
                server = ParameterValues(self.recording.values).last()
            return RunValues(self.name, self.recording, server)
        values = {
            name: value for name, value in read_parameters(path).items() if not is_of_ros(name)
        }
        # A dump that was interrupted is empty; the server itself never is.
        if not values:
            return RunValues(self.name, self.recording)
        places = {name: origin.words() for name, origin in read_origins(self.source).items()}
        return RunValues(self.name, self.recording, values, places)

    def in_build(self, static_info: StaticInfo) -> RecordedRun:
        """The run with the keys of a build, if it was recorded with another one.

        What this build does not have keeps its key, and counts nowhere.
        """
        names = {} if self.static_file is None else _names_in(static_info, self.static_file)
        recording = self.recording
        if names.keys().isdisjoint(map(base_key, reported_keys(recording))):
            return self
        return replace(self, recording=recording.with_keys(lambda key: renamed(key, names)))

    @cached_property
    def static_file(self) -> Path | None:
        """The static information of its build; None if it is not known."""
        if self.source is None:
            return self.built
        return recorded_static(self.source, self.recording)

    @cached_property
    def build(self) -> Build | None:
        """What its nodes were built from; None if its folder does not say it."""
        if self.static_file is None:
            return None
        try:
            return build_of(StaticInfo.load(self.static_file))
        except TpcError:
            return None


def _names_in(static_info: StaticInfo, other: Path) -> Mapping[str, str]:
    """The keys in this build by those of another one; worked out once for runs of one build."""
    known: dict[str, Mapping[str, str]] = static_info.__dict__.setdefault("_other_builds", {})
    try:
        digest = hashlib.sha256(other.read_bytes()).hexdigest()
        if digest not in known:
            known[digest] = keys_in(static_info, StaticInfo.load(other))
    except (OSError, TpcError):
        return {}
    return known[digest]


def is_recording(source: Path) -> bool:
    """Whether a file or folder is a recording, and not a build or its static information."""
    if source.is_dir():
        return not (source / OWN_FOLDER / MERGED_FILE).is_file() and holds_mission(source)
    try:
        with source.open("rb") as stream:
            return not stream.read(_FIRST).lstrip().startswith(b"{")
    except OSError:
        return False


Run = RecordedRun | Recording | Source


def diff(good: Run | Sequence[Run], bad: Run, static_info: StaticInfo | Source) -> RunDifferences:
    """What differs, where it acts, and which decisions would have come out otherwise.

    Args:
        good: a good run, or several with the last one last; a parameter differs if it had a value
            in the mission, at the end or while it ran, that it had in none of them.
        bad: the mission. Marks are not needed.
        static_info: what the analysis found.

    Raises:
        InputError: something cannot be read.
        ValueError: there is no good run.
    """
    given = load_static(static_info)
    mission = RecordedRun.of(bad)
    named = with_names_of(mission.recording, given, mission.source)
    runs = [run.in_build(given) for run in _runs(good)]
    return _differences(runs, mission, given, named)


def diff_running(
    good: Run | Sequence[Run], master: str, static_info: StaticInfo | None = None
) -> RunDifferences:
    """The parameters of a running robot that differ from those of good runs.

    Args:
        good: one or several, of which at least one has the values of its parameters.
        master: the URI of the robot's ROS master.
        static_info: what the analysis found; None: where the parameters act is not said.

    Raises:
        RunError: the master does not answer.
        InputError: a run cannot be read, or none has the values of its parameters.
        ValueError: there is no good run.
    """
    static = StaticInfo.of([]) if static_info is None else static_info
    runs = [replace(run.values, build=run.build) for run in _runs(good)]
    if runs and all(run.values is None for run in runs):
        raise InputError(
            f"no {PARAMS_FILE} beside it, so nothing can be compared with the running robot;"
            f" `rosparam dump BAG.{PARAMS_FILE}` writes one for a bag",
            runs[0].name,
        )
    values = {name: value for name, value in values_at(master).items() if not is_of_ros(name)}
    nothing = Recording("the running robot", Events.empty(), (), 0, 0)
    running = RunValues(nothing.name, nothing, values, build=build_of(static))
    return differences(running, runs, static)


def beside(
    question: Question,
    good: Run | Sequence[Run],
    mission: RecordedRun,
    static_info: StaticInfo,
    named: StaticInfo,
) -> Question:
    """The question with good runs, and with what differs from them.

    Without other changes in the question, the differences count as the changes since the robot
    worked, if the values of all parameters were recorded.

    Args:
        question: about the mission.
        good: a good run, or several; may be empty.
        mission: the mission.
        static_info: of the build.
        named: the same with the names of this mission, from ``with_names_of``.

    Raises:
        InputError: the values of a run cannot be read.
    """
    runs = [run.in_build(static_info) for run in _runs(good)]
    if not runs:
        return about_mission(question, static_info, named)
    found = _differences(runs, mission, static_info, named, question.window_s)
    changes = question.changes
    if not changes and found.is_complete:
        changes = changes_of(found)
    asked = replace(
        question,
        references=[run.recording for run in runs],
        differences=found,
        changes=changes,
    )
    return about_mission(asked, static_info, named)


def _runs(good: Run | Sequence[Run]) -> list[RecordedRun]:
    every = [good] if isinstance(good, RecordedRun | Recording | str | os.PathLike) else good
    return [RecordedRun.of(run) for one in every for run in _unfolded(one)]


def _unfolded(run: Run) -> Sequence[Run]:
    """The run itself, or the runs of a profile."""
    if isinstance(run, RecordedRun | Recording):
        return [run]
    return with_learned([Path(run)])


def with_learned(sources: Sequence[Path]) -> list[Path]:
    """The recordings, with the runs of a profile in its place.

    Raises:
        InputError: a profile is broken, or has no run.
    """
    found: list[Path] = []
    for source in sources:
        if not is_profile(source):
            found.append(source)
            continue
        runs = runs_in(source)
        if not runs:
            raise InputError("no good run in this profile; add one with `pytpc learn`", source)
        found += [source / run.folder for run in runs]
    return found


def _differences(
    good: Sequence[RecordedRun],
    mission: RecordedRun,
    static_info: StaticInfo,
    named: StaticInfo,
    window_s: float = WINDOW_S,
) -> RunDifferences:
    runs = []
    *builds, build = _builds((*good, mission), static_info)
    for one, own in zip(good, builds, strict=True):
        recording = with_keys_of(one.recording, static_info, named)
        runs.append(replace(one.values, recording=recording, build=own))
    return differences(replace(mission.values, build=build), runs, named, window_s)


def _builds(runs: Sequence[RecordedRun], static_info: StaticInfo) -> list[Build | None]:
    """The build of each run; its file is read only if the files of the runs are not the same."""
    files = [run.static_file for run in runs]
    if files[-1] is None:
        return [None] * len(files)
    if all(file is not None and has_same_content(file, files[-1]) for file in files):
        return [build_of(static_info)] * len(files)
    return [run.build for run in runs]
