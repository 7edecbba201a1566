"""The few numbers that the study is about, each with its target."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

from pytpc.study.data import LABELS
from pytpc.study.metrics import Estimate
from pytpc.study.report.confidence import false_accusations
from pytpc.study.report.positions import Position
from pytpc.study.report.ranked import OURS, TARGETS, changed_rows, percent, top
from pytpc.study.report.repairs import TARGET, Repair, gone


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


def headlines(
    positions: Sequence[Position], repairs: Sequence[Repair], half: str
) -> list[Headline]:
    """The numbers of one half; those for which there is no data are left out."""
    found = []
    for labels in LABELS:
        own = changed_rows(positions, half)
        ours = [row for row in own if (row.method, row.labels) == (OURS, labels)]
        text = f"Changed parameter in the top 3, {labels} marks, {half} half"
        found += _share(f"top3-{labels}-{half}", text, top(ours, 3), TARGETS[labels])
    text = f"Error gone with the suggested value, {half} half"
    found += _share(f"suggestions-gone-{half}", text, gone(repairs, half), TARGET)
    for kind, what in (("clean", "clean missions"), ("fault", "faults in the source")):
        count, verdicts = false_accusations(positions, half, kind)
        if verdicts:
            text = f"Confident accusations on {what}, {half} half"
            name = f"accusations-{kind}-{half}"
            found.append(
                Headline(name, text, count, "verdicts", f"{count} of {verdicts}", "0", count == 0)
            )
    return found


def _share(name: str, text: str, share: Estimate, target: float) -> list[Headline]:
    if not share.treatments:
        return []
    aimed = f">={100 * target:.0f}"
    value = 100 * share.value
    return [Headline(name, text, value, "%", percent(share), aimed, share.value >= target)]
