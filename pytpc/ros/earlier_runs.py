"""Finds an earlier recording with which a mission can be compared."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

from pytpc.base.errors import InputError
from pytpc.recording.marks import read_marks
from pytpc.recording.marks_home import marks_home
from pytpc.recording.mission import RUN_FILE, read_run
from pytpc.ros.mission_run import marks_of

_MOST = 1000
_REPORTS = ("reports", "reports_in_files", "summaries_in_files")


def last_unmarked_run(mission: Path) -> Path | None:
    """The newest recording beside a mission, launched alike, with reports and without a mark.

    Nobody complained while it was recorded, so it is probably a good run. Launched alike are two
    missions of one launch file with the same arguments, which may choose another robot or world.

    Args:
        mission: the folder of a recorded mission, or its bag.

    Returns:
        A folder in the folder that holds the mission's; None if there is none, or if it is not
        known how the mission was launched.
    """
    folder = (mission if mission.is_dir() else mission.parent).absolute()
    own = read_run(folder)
    if own.get("launch") is None:
        return None
    found = []
    try:
        for other in islice(folder.parent.iterdir(), _MOST):
            # A link to this one (`latest`) is this one.
            if not other.is_dir() or other.samefile(folder):
                continue
            run = read_run(other)
            if run and _launched(run) == _launched(own) and _is_good(run, other):
                found.append(((other / RUN_FILE).stat().st_mtime_ns, other))
    except OSError:
        return None
    return max(found)[1] if found else None


def _launched(run: dict[str, object]) -> tuple[object, object]:
    return run.get("launch"), run.get("args") or {}


def _is_good(run: dict[str, object], folder: Path) -> bool:
    """Whether a mission went to its end, has reports, and nobody marked it.

    A time limit is an end like any other, unless a topic was to say that the mission is done.
    Files of version 0.2 do not say whether one was.
    """
    messages = run.get("messages")
    if run.get("ended") == "failed" or not isinstance(messages, dict):
        return False
    if run.get("ended") == "timeout" and run.get("until", "unknown"):
        return False
    if not any(run.get(name, 1) for name in _REPORTS):
        return False
    return not _marks_in(run, messages) and not _has_marks(folder)


def _marks_in(run: dict[str, object], messages: dict[object, object]) -> int:
    """The marks that were recorded; older files count those that were taken back, too."""
    marks = run.get("marks")
    if isinstance(marks, int):
        return marks
    return marks_of({str(topic): n for topic, n in messages.items() if isinstance(n, int)})


def _has_marks(folder: Path) -> bool:
    """Whether marks are in files of the recording; one that cannot be read may have some."""
    try:
        return any(read_marks(file) for file in marks_home(folder).files())
    except InputError:
        return True
