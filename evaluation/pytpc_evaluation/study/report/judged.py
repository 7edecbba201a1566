"""How often verdicts on the half that is held back were made: ``results/judged.json``.

It is to be judged once, when the ranking is done. Whoever makes the page again after a change of
the ranking has judged it again, and the page has to say so.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from datetime import datetime, timezone
from hashlib import sha256
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc_evaluation.study.listed import read_list
from pytpc_evaluation.study.plan import Half

JUDGED_FILE = Path("results") / "judged.json"
HELD_BACK: Half = "held-back"


@dataclass(frozen=True, slots=True)
class Judging:
    """Verdicts on ``missions`` that are held back were made: when (UTC, ISO 8601), by which code.

    ``digest`` is of the methods that made them, all together.
    """

    time: str
    digest: str
    missions: int


def load_judgings(folder: Path) -> list[Judging]:
    """All of them, the oldest first; none where there is no such file.

    Args:
        folder: the study's.

    Raises:
        InputError: the file cannot be read, or is not about that.
    """
    return read_list(folder / JUDGED_FILE, lambda one: Judging(**one), "not a list of judgings")


def save_judging(folder: Path, methods: Iterable[tuple[str, str]], missions: int) -> None:
    """Append that verdicts were made just now.

    Args:
        folder: the study's.
        methods: those that made them, with the digest of the code of each.
        missions: on how many missions.

    Raises:
        InputError: what is there cannot be read.
        TpcError: the file cannot be written.
    """
    now = datetime.now(timezone.utc).isoformat(timespec="seconds")
    digest = sha256(json.dumps(sorted(methods)).encode()).hexdigest()
    found = [*load_judgings(folder), Judging(now, digest, missions)]
    text = json.dumps([asdict(one) for one in found], indent=1)
    write_atomic(folder / JUDGED_FILE, text.encode() + b"\n")


def told_judgings(judgings: Sequence[Judging]) -> str:
    """How often, when, and by how many states of the methods, in a sentence; empty if never."""
    if not judgings:
        return ""
    states = len({one.digest for one in judgings})
    often = "once" if len(judgings) == 1 else f"{len(judgings)} times"
    by = "one state" if states == 1 else f"{states} states"
    first, last = judgings[0].time, judgings[-1].time
    when = f"on {first}" if len(judgings) == 1 else f"from {first} to {last}"
    what = "In this folder the half that is held back was judged"
    return f"{what} {often}, {when}, by {by} of the methods."
