"""What is asked about: a recorded mission, and the static information of the build that flew it."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from pytpc.base.errors import InputError
from pytpc.diagnosis.ranking.clocks import two_clocks
from pytpc.diagnosis.ranking.complaints import complaints
from pytpc.ingest.reading import read as read_recording
from pytpc.recording.declaration import Declared
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo, read_static
from pytpc.values.declared import declared_in

Source = str | os.PathLike[str]
Warn = Callable[[str], None]


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


def read_named(source: Path, on_progress: Callable[[int, int], None] | None = None) -> Recording:
    """A recorded mission; one that is a folder has the name of the folder.

    The bags of all missions have the same name, their folders have not.

    Raises:
        InputError: it cannot be read.
    """
    found = read_recording(source, on_progress)
    return replace(found, name=source.absolute().name) if source.is_dir() else found


def read_marked(mission: Recording | Source) -> Recording:
    """The mission, which has to have marks.

    Raises:
        InputError: it has none, or cannot be read.
    """
    recording = read(mission)
    if not recording.marks:
        raise InputError("has no marks; add some with `pytpc mark`", recording.name)
    return recording


def check_reports(recording: Recording, static_info: StaticInfo, source: Path) -> None:
    """See that the recording has a report that the static information knows.

    Without, it would be ranked as if nothing were suspicious.

    Raises:
        InputError: it has none.
    """
    reported = {*recording.events.keys, *recording.summaries.keys}
    if not reported:
        raise InputError(
            "no threshold reports: was /rosout recorded, and the workspace built with TPC? "
            " Files of the sink `file` belong in the same folder, or in its folder tpc",
            source,
        )
    if reported.isdisjoint(static_info.comparisons):
        raise InputError(
            "none of its reports is in the static information, which is of another build;"
            " give the static.json of the build that was recorded",
            source,
        )


def faults_of(recording: Recording, static_info: StaticInfo | None) -> list[str]:
    """A line for each thing that is wrong with a recording, and for what was left out of it.

    Two clocks in it matter where it is diagnosed, by the static information.
    """
    clocks = [] if static_info is None else two_clocks(recording)
    return [*complaints(recording, static_info), *clocks]


def find_declared(
    static_info: StaticInfo, source: Path | None, on_skipped: Warn | None = None
) -> list[Declared]:
    """The ranges that are declared in the analysed sources, and in a mission's folder."""
    return declared_in(static_info, [] if source is None else [source], on_skipped)
