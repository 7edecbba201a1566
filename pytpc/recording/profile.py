"""What a robot is like when it goes right: a folder of good runs, each made small.

``pytpc learn`` fills it, ``--reference`` takes it in place of the recordings
(docs/reference/formats.md#profiles-of-good-runs).
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError

PROFILE_FILE = "profile.json"
LEARNED_FILE = "learned.json"
_SCHEMA = 1
_LATEST = 2**63


@dataclass(frozen=True, slots=True)
class LearnedRun:
    """A good run in a profile: from which recording it was learned, and that one's size.

    ``folder`` is its name in the profile; ``reports`` counts evaluations that were reported one by
    one, and summaries; times are on the clock of the reports. ``digest`` is that of all reports.
    """

    folder: str
    source: str
    start_ns: int
    end_ns: int
    reports: int
    digest: str

    @property
    def name(self) -> str:
        """The name of the recording."""
        return Path(self.source).name


def is_profile(path: Path) -> bool:
    """Whether ``pytpc learn`` wrote this folder."""
    return (path / PROFILE_FILE).is_file()


def begin_profile(path: Path) -> None:
    """Make the folder, unless it is a profile already.

    Raises:
        InputError: it is a folder with something else in it, or a file.
        TpcError: it cannot be written.
    """
    if is_profile(path):
        _check(path / PROFILE_FILE)
        return
    if path.exists() and (not path.is_dir() or any(path.iterdir())):
        raise InputError("is there and is no profile of good runs; give another -o FOLDER", path)
    path.mkdir(parents=True, exist_ok=True)
    write_atomic(path / PROFILE_FILE, json.dumps({"schema": _SCHEMA}).encode() + b"\n")


def runs_in(profile: Path) -> list[LearnedRun]:
    """The runs of a profile, the oldest first.

    Raises:
        InputError: it is of a newer format, or a file in it is broken.
    """
    _check(profile / PROFILE_FILE)
    # What begins with a dot is not finished.
    files = [file for file in profile.glob(f"*/{LEARNED_FILE}") if file.parent.name[0] != "."]
    return sorted(map(read_learned, files), key=lambda run: (run.start_ns, run.folder))


def write_learned(run: LearnedRun, folder: Path) -> None:
    """Write ``learned.json`` of a run.

    Raises:
        TpcError: it cannot be written.
    """
    document = {"schema": _SCHEMA, **asdict(run)}
    del document["folder"]
    write_atomic(folder / LEARNED_FILE, json.dumps(document, indent=1).encode() + b"\n")


def read_learned(path: Path) -> LearnedRun:
    """Read the ``learned.json`` of a run.

    Raises:
        InputError: it is broken, or of a newer format.
    """
    document = _check(path)
    try:
        start_ns, end_ns, reports = (_whole(document, n) for n in ("start_ns", "end_ns", "reports"))
        source, digest = str(document["source"]), str(document["digest"])
        return LearnedRun(path.parent.name, source, start_ns, end_ns, reports, digest)
    except (KeyError, ValueError) as error:
        raise InputError(f"not a run of a profile: {error}", path) from error


def _whole(document: Mapping[str, object], name: str) -> int:
    number = document[name]
    if not isinstance(number, int) or isinstance(number, bool) or not 0 <= number < _LATEST:
        raise ValueError(f"{name} is no whole number below 2^63")
    return number


def _check(path: Path) -> dict[str, object]:
    """The document, whose format this version knows."""
    document = parse_json(path)
    if not isinstance(document, dict):
        raise InputError("not of a profile of good runs: an object is expected", path)
    if document.get("schema") != _SCHEMA:
        what = f"written by another TPC (format {document.get('schema')}; this one reads {_SCHEMA})"
        raise InputError(f"{what}; learn the good runs again with `pytpc learn`", path)
    return document
