"""Recordings of missions, read, checked and converted, and the static information about them."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from pytpc.base.errors import InputError
from pytpc.diagnosis.full_names import with_full_names, with_keys_of
from pytpc.diagnosis.question import Question
from pytpc.ingest.duplicates import TOLERANCE_NS
from pytpc.ingest.reading import opened
from pytpc.ingest.reading import read as read_recording
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import read_marks
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summaries
from pytpc.static.parameters import base_key
from pytpc.static.static_info import StaticInfo, read_static
from pytpc.values.declared import declared_in
from pytpc.values.origins import read_origins

Source = str | os.PathLike[str]
Progress = Callable[[int, int], None]
Warn = Callable[[str], None]

TOLERANCE_S = TOLERANCE_NS / 1e9
"""How far apart in time one report may be in two inputs."""


def load_static(source: StaticInfo | Source) -> StaticInfo:
    """The static information of a workspace that ``pytpc build`` built, or of a static.json.

    Raises:
        InputError: there is none, or it is broken.
    """
    return source if isinstance(source, StaticInfo) else read_static(Path(source))


def read(source: Recording | Source) -> Recording:
    """A recorded mission: a bag of ROS 1 or 2, a file or folder of any kind that ``convert`` takes.

    Its ``events`` are columns of numpy (`pytpc.recording.events.Events`);
    ``events.to_arrow().to_pandas()`` makes a data frame of them.

    Raises:
        InputError: it cannot be read.
    """
    return source if isinstance(source, Recording) else read_recording(Path(source))


def read_named(
    source: Path, on_progress: Progress | None = None, marks: Sequence[Path] = ()
) -> Recording:
    """A recorded mission, named after its folder, because the bags of all missions are named alike.

    Args:
        source: a file or folder.
        on_progress: called with (done, total).
        marks: more files with marks of it.

    Raises:
        InputError: it cannot be read, or one of ``marks`` is no file of marks.
    """
    for file in marks:
        read_marks(file)
    found = read_recording([source, *marks], on_progress)
    return replace(found, name=source.absolute().name) if source.is_dir() else found


def read_marked(mission: Recording | Source) -> Recording:
    """Read a mission that must have marks.

    Raises:
        InputError: it has none, or cannot be read.
    """
    recording = read(mission)
    if not recording.marks:
        raise InputError("has no marks; add some with `pytpc mark`", recording.name)
    return recording


def with_names_of(recording: Recording, static_info: StaticInfo, source: Path | None) -> StaticInfo:
    """The static information with the full names of parameters that a mission tells.

    Args:
        recording: the mission.
        static_info: of its build.
        source: its path, beside which the values of its parameters are; None: not known.

    Raises:
        InputError: origins.json is there and cannot be read.
    """
    origins = {} if source is None else read_origins(source)
    return with_full_names(
        static_info, recording, {name: origin.value for name, origin in origins.items()}
    )


def about_mission(question: Question, static_info: StaticInfo, named: StaticInfo) -> Question:
    """The question whose other runs have the keys of a mission (`with_keys_of`).

    Args:
        question: of any mission.
        static_info: of the build.
        named: the same with the names of this mission, from ``with_names_of``.
    """
    good, others = (
        [with_keys_of(one, static_info, named) for one in runs]
        for runs in (question.references, question.others)
    )
    return replace(question, references=good, others=others)


def check_reports(recording: Recording, static_info: StaticInfo, source: Path) -> None:
    """Check that the static information knows at least one report of the recording.

    Otherwise the ranking would say that nothing is suspicious.

    Raises:
        InputError: it knows none.
    """
    check_has_reports(recording, source)
    reported = reported_keys(recording)
    reported |= {base_key(key) for key in reported}
    if reported.isdisjoint(static_info.comparisons):
        raise InputError(
            "the static information knows none of its reports: it is of another build; give the one"
            " that was recorded, with --static WORKSPACE or --static FILE",
            source,
        )


def reported_keys(recording: Recording) -> set[str]:
    """The keys of all comparisons that were reported."""
    return {*recording.events.keys, *recording.summaries.keys}


def same_reports(one: Recording, other: Recording) -> bool:
    """Whether two recordings are of one mission: they have the same reports at the same times."""
    ours, theirs = one.events, other.events
    return (
        (len(ours), len(one.summaries)) == (len(theirs), len(other.summaries))
        and set(ours.keys) == set(theirs.keys)
        and np.array_equal(ours.time_ns, theirs.time_ns)
        and np.array_equal(ours.cmp, theirs.cmp, equal_nan=True)
        and np.array_equal(ours.thresh, theirs.thresh, equal_nan=True)
        and _same_columns(one.summaries, other.summaries)
    )


def _same_columns(one: Summaries, other: Summaries) -> bool:
    theirs = other.columns()
    return all(
        np.array_equal(ours, theirs[name], equal_nan=ours.dtype == np.float64)
        for name, ours in one.columns().items()
    )


def check_has_reports(recording: Recording, source: Path) -> None:
    """Check that a recording has a report.

    Raises:
        InputError: it has none.
    """
    if not reported_keys(recording):
        raise InputError(
            "no threshold reports: was /rosout recorded, and the workspace built with TPC?"
            " Files of the sink `file` belong in the same folder, or in its folder tpc",
            source,
        )


def find_declared(
    static_info: StaticInfo, source: Path | None, on_skipped: Warn | None = None
) -> list[Declared]:
    """The ranges that are declared in the analysed sources, and in a mission's folder."""
    return declared_in(static_info, [] if source is None else [source], on_skipped)


def question_of(
    question: Question | None, settings: Mapping[str, Any], known: Collection[str]
) -> Question:
    """The question that is given, or one with these settings, of which a verb knows some.

    Raises:
        TypeError: both are given, or a setting is not among ``known``.
    """
    if question is not None and settings:
        raise TypeError("give a question or single settings, not both")
    unknown = sorted(settings.keys() - known)
    if unknown:
        raise TypeError(f"there is no setting {', '.join(unknown)}")
    return Question(**settings) if question is None else question


@dataclass(frozen=True, slots=True)
class Converted:
    """What was written: the recording without its events, and their numbers."""

    recording: Recording
    events: int
    comparisons: int
    summaries: int


def convert(
    inputs: Sequence[Path],
    output: Path,
    *,
    tolerance_ns: int = TOLERANCE_NS,
    on_read: Progress | None = None,
    on_written: Progress | None = None,
) -> Converted:
    """Convert the recordings of one mission, with little memory.

    Args:
        inputs: bags, binary files, logs, CSV, folders of such files, converted missions.
        output: a folder, or a file: .parquet (the events) or .csv (the thesis's form). Its disk
            needs 36 bytes of temporary space per report.
        tolerance_ns: how far apart in time one report may be in two inputs.
        on_read: called with (bytes read, all bytes).
        on_written: called with (reports written, all reports).

    Raises:
        InputError: an input cannot be read.
        TpcError: the output cannot be written.
    """
    is_folder = output.is_dir()
    suffix = "" if is_folder else output.suffix
    scratch = output if is_folder else _existing_folder(output)
    with opened(inputs, scratch, on_read, tolerance_ns=tolerance_ns) as merged:
        if suffix == ".parquet":
            recording = merged.save_parquet(output, on_written)
        elif suffix == ".csv":
            recording = merged.save_csv(output, on_written)
        else:
            recording = merged.save(output, on_written)
    return Converted(recording, merged.events, merged.comparisons, merged.summaries)


def _existing_folder(path: Path) -> Path:
    """The nearest folder above ``path`` that exists."""
    return next((folder for folder in path.absolute().parents if folder.is_dir()), Path("/"))
