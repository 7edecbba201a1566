"""The few numbers that the study is about, each with its target."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from pytpc.study.data import LABELS
from pytpc.study.metrics import Estimate
from pytpc.study.report.confidence import false_accusations
from pytpc.study.report.parts import Part
from pytpc.study.report.positions import Position
from pytpc.study.report.ranked import (
    BASELINE,
    BESIDE_CLEAN,
    CHANCE,
    CHANCE_OF_DIFFERENT,
    OURS,
    TARGET_PLACES,
    TARGETS,
    changed_rows,
    percent,
    top,
)
from pytpc.study.report.repairs import TARGET, Repair, first_try, gone
from pytpc.study.suggestion_chains import RANKED, RANKED_REFERENCE, Chain


@dataclass(frozen=True, slots=True)
class Headline:
    """One number: ``name`` for programs, ``text`` for people; ``shown`` has its interval."""

    name: str
    text: str
    value: float
    unit: str
    shown: str
    target: str
    hit: bool

    def to_json(self) -> dict[str, Any]:
        """As an object for JSON."""
        return asdict(self)


_RANKED = {
    "": ("", OURS),
    "-with-clean-run": (", with a clean run", BESIDE_CLEAN),
    "-thesis": (", by the thesis's ranking", BASELINE),
    "-chance": (", by chance", CHANCE),
    "-chance-of-different": (
        ", by chance among what differs from a clean run",
        CHANCE_OF_DIFFERENT,
    ),
}
"""Whose shares are told: the end of the name, words, and the method."""

_VARIANTS = {
    "smallest": "the smallest change",
    RANKED: "the suggested value of the parameter that is ranked first",
    RANKED_REFERENCE: "the clean run's value of the parameter that is ranked first",
}
"""The variants of suggestions that are told beside the headline, of their first tries."""

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
    text = f"Error gone with the suggested value, {part.title}"
    found += _share(f"suggestions-gone-{part.name}", text, gone(repairs, part), TARGET)
    for variant, words in _VARIANTS.items():
        name = f"suggestions-gone-{variant}-{part.name}"
        text = f"Error gone with {words}, {part.title}"
        found += _share(name, text, first_try(chains, variant), TARGET)
    # What is clean or has a fault belongs to no round: it is told of the halves.
    for kind, what in (("clean", "clean missions"), ("fault", "faults in the source")):
        for end, (words, method) in _RANKED.items():
            if part.since > 1 or method not in (OURS, BESIDE_CLEAN):
                continue
            count, verdicts = false_accusations(positions, part.half, kind, method)
            if verdicts:
                text = f"Confident accusations on {what}{words}, {part.title}"
                name = f"accusations-{kind}{end}-{part.name}"
                said = f"{count} of {verdicts}"
                found.append(Headline(name, text, count, "verdicts", said, "0", count == 0))
    return found


def _share(name: str, text: str, share: Estimate, target: float) -> list[Headline]:
    if not share.treatments:
        return []
    aimed = f">={100 * target:.0f}"
    value = 100 * share.value
    return [Headline(name, text, value, "%", percent(share), aimed, share.value >= target)]
