"""What a mission was flown with, as one number: where it is another, the mission is flown again.

No folder's name is in it, so a study may be moved, and continued from another checkout.
"""

from __future__ import annotations

from collections.abc import Iterable
from hashlib import sha256
from pathlib import Path

from pytpc.base.errors import InputError
from pytpc.base.paths import cmake_file, defer_plugin, log_library, plugin, project_root
from pytpc.static.static_info import StaticInfo
from pytpc_evaluation.demo.demo_examples import SHARED_PACKAGE, Example
from pytpc_evaluation.study.plan import Flight
from pytpc_evaluation.study.verdict_digest import digest_of

VERSION = 2
"""Counts what the study itself does to a mission: another number has all flown again."""

_NO_INPUT = frozenset({"treatments", "__pycache__"})
_NO_INPUT_ENDINGS = frozenset({".md", ".json", ".pyc"})
_PEOPLE = SHARED_PACKAGE / "src"
EYES = tuple(_PEOPLE / "simulated_world" / name for name in ("bag.py", "sights.py"))
"""How a bag becomes sights. The bag is not kept: where these are others, all is flown again."""
_ANALYSIS = project_root() / "pytpc" / "python_analysis"


def sources_digest(example: Example) -> str:
    """Of all that a robot is built from and launched with, and of its observer's eyes.

    Raises:
        InputError: a file cannot be read.
    """
    own = [path for path in _files(example.folder) if path.name != "demo.py"]
    files = _files(SHARED_PACKAGE)
    shared = [path for path in files if path in EYES or not path.is_relative_to(_PEOPLE)]
    return digest_of([_contents(own, example.folder), _contents(shared, SHARED_PACKAGE)])


def tools_digest() -> str:
    """Of what analyses and instruments: another build is made where it is another.

    It is not in that of a mission: the reports of a robot that was built again are the same.

    Raises:
        MissingToolError: the C++ half is not installed.
        InputError: a file cannot be read.
    """
    halves = [cmake_file(), plugin(), defer_plugin(), log_library()]
    python = _contents(_files(_ANALYSIS), _ANALYSIS)
    return digest_of([[sha256(_read(path)).hexdigest() for path in halves], python])


def build_digest(example: Example, static: StaticInfo) -> str:
    """Of a robot as it is built: its sources, and the comparisons that were found in them.

    Raises:
        InputError: a file cannot be read.
    """
    return digest_of([sources_digest(example), sorted(static.thresholds)])


def people_digest() -> str:
    """Of those who look on: what they make of the sights, and when they press a key.

    Raises:
        InputError: a file cannot be read.
    """
    return digest_of(_contents([path for path in _files(_PEOPLE) if path not in EYES], _PEOPLE))


def flight_digest(flight: Flight, build: str, rate: float, settle_s: float) -> str:
    """Of a flight: the build, what the treatment and its decoys set, the seed and the rate.

    Raises:
        InputError: a file of the treatment cannot be read.
    """
    treatment = flight.treatment
    return digest_of(
        [
            VERSION,
            build,
            _read(flight.overlay).decode("utf-8", "replace"),
            sorted(treatment.launch.items()),
            sorted(flight.settings().items()),
            flight.seed,
            rate,
            settle_s,
            flight.example.watched,
        ]
    )


def marks_digest(flight: Flight, people: str) -> str:
    """Of what was made of a flight: the people, and their seed."""
    return digest_of([VERSION, people, flight.people])


def _files(folder: Path) -> list[Path]:
    return sorted(
        path
        for path in folder.rglob("*")
        if path.is_file()
        and path.suffix not in _NO_INPUT_ENDINGS
        and not _NO_INPUT & set(path.relative_to(folder).parts)
    )


def _contents(files: Iterable[Path], folder: Path) -> list[tuple[str, str]]:
    return [(str(path.relative_to(folder)), sha256(_read(path)).hexdigest()) for path in files]


def _read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", path) from error
