"""The few numbers that the study is about, each with its target."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from pytpc_evaluation.study.data import LABELS
from pytpc_evaluation.study.metrics import Estimate
from pytpc_evaluation.study.report.confidence import false_accusations
from pytpc_evaluation.study.report.conversations import FIX_TARGETS, gone_by_fix
from pytpc_evaluation.study.report.parts import Part
from pytpc_evaluation.study.report.positions import Position
from pytpc_evaluation.study.report.ranked import (
    BASELINE,
    BESIDE_CLEAN,
    CHANCE,
    CHANCE_OF_DIFFERENT,
    OPEN,
    OURS,
    TARGET_PLACES,
    TARGETS,
    changed_rows,
    holds_target,
    percent,
    top,
)
from pytpc_evaluation.study.report.repairs import TARGET, Repair, first_try, gone
from pytpc_evaluation.study.suggestion_chains import (
    FIX_RUNS,
    MOST_TRIES,
    RANKED,
    RANKED_REFERENCE,
    Chain,
)


@dataclass(frozen=True, slots=True)
class Headline:
    """One number: ``name`` for programs, ``text`` for people; ``shown`` has its interval.

    ``hit`` is by the number itself; ``open`` is whether its interval holds the target.
    """

    name: str
    text: str
    value: float
    unit: str
    shown: str
    target: str
    hit: bool
    open: bool = False

    @property
    def verdict(self) -> str:
        """In words."""
        word = "hit" if self.hit else "miss"
        return f"{word}, {OPEN}" if self.open else word

    def to_json(self) -> dict[str, Any]:
        """As an object for JSON."""
        return asdict(self)


_RANKED = {
    "": ("", OURS),
    "-with-clean-run": (", with a good run", BESIDE_CLEAN),
    "-thesis": (", by the thesis's ranking", BASELINE),
    "-chance": (", by chance", CHANCE),
    "-chance-of-different": (
        ", by chance among the parameters that differ from a good run",
        CHANCE_OF_DIFFERENT,
    ),
}
"""Whose shares are told: the end of the name, words, and the method."""

_VARIANTS = {
    "smallest": "the smallest change of the changed parameter",
    RANKED: "the value that TPC suggests for its first suspect (confused marks)",
    RANKED_REFERENCE: "the good run's value of TPC's first suspect (confused marks; a right"
    " ranking puts back the value before the treatment)",
}
"""The variants of suggestions that are told beside the headline, of their first tries."""

_GONE = {False: "gone", True: "gone-none-new"}
TOP = f"top{TARGET_PLACES}-"
"""The names of shares begin with it."""


def headlines(
    positions: Sequence[Position], repairs: Sequence[Repair], chains: Sequence[Chain], part: Part
) -> list[Headline]:
    """The numbers of one part, of which the chains are; those without data are left out."""
    found = []
    own = changed_rows(positions, part)
    for labels in LABELS:
        for end, (words, method) in _RANKED.items():
            rows = [row for row in own if (row.method, row.labels) == (method, labels)]
            text = (
                f"Changed parameter in the top {TARGET_PLACES}, {labels} marks{words}, {part.title}"
            )
            name = f"{TOP}{labels}{end}-{part.name}"
            found += _share(name, text, top(rows, TARGET_PLACES), TARGETS[labels])
    found += _suggested(repairs, chains, part)
    # What is clean or has a fault belongs to no round: it is told of the halves.
    for kind, what in (("clean", "clean missions"), ("fault", "faults in the source")):
        for end, (words, method) in _RANKED.items():
            if part.round is not None or method not in (OURS, BESIDE_CLEAN):
                continue
            made = false_accusations(positions, part.half, kind, method)
            # Where nobody set a mark nobody could be accused.
            if made.marked:
                text = f"Confident accusations on {what}{words}, {part.title}"
                name = f"accusations-{kind}{end}-{part.name}"
                count = made.accused
                found.append(Headline(name, text, count, "missions", made.said, "0", count == 0))
    return found


def _suggested(repairs: Sequence[Repair], chains: Sequence[Chain], part: Part) -> list[Headline]:
    """What came of the first tries: is the error gone, and has no other one come?"""
    told = {False: "gone", True: "gone and no new one"}
    found = []
    for clean, what in told.items():
        text = f"Error {what} with TPC's value for the changed parameter"
        name = f"suggestions-{_GONE[clean]}-{part.name}"
        share = gone(repairs, part, clean=clean)
        found += _share(name, f"{text}, {part.title}", share, TARGET)
    for variant, words in _VARIANTS.items():
        for clean, what in told.items():
            name = f"suggestions-{_GONE[clean]}-{variant}-{part.name}"
            text = f"Error {what} with {words}, {part.title}"
            found += _share(name, text, first_try(chains, variant, clean=clean), TARGET)
    for variant, target in FIX_TARGETS.items():
        runs = FIX_RUNS[variant]
        beside = f"beside {runs} good runs" if runs else "by the log alone"
        text = f"Error gone within {MOST_TRIES[variant]} tries of pytpc fix, {beside}, one observer"
        share = gone_by_fix(chains, variant)
        found += _share(f"{variant}-gone-{part.name}", f"{text}, {part.title}", share, target)
    return found


def _share(name: str, text: str, found: Estimate, target: float) -> list[Headline]:
    if not found.treatments:
        return []
    aimed = f">={100 * target:.0f}"
    hit, still_open = found.value >= target, holds_target(found, target)
    value = 100 * found.value
    return [Headline(name, text, value, "%", percent(found), aimed, hit, still_open)]
