"""Rules that a change of the code may break: no new comparison, no undeclared parameter, ..."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Literal

from pytpc.base.wording import listed
from pytpc.static.build_changes import BuildChanges, ComparisonChange
from pytpc.static.parameter_changes import ParameterChange

Rule = Literal["new", "gone", "changed", "undeclared", "lost", "missing-unit"]
RULES: dict[Rule, str] = {
    "new": "a comparison is new",
    "gone": "a comparison is gone, although its link unit was built",
    "changed": "a comparison changed: its operator, parameter, default, ...",
    "undeclared": "a parameter is compared anew, and nothing declares it",
    "lost": "a parameter that is still read is not compared any more",
    "missing-unit": "a link unit of the old build is missing, or was not analysed",
}
"""What can be forbidden, and what breaks it."""

_NAMED = 3


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that breaks a rule: a short name, the place, and what it is."""

    name: str
    place: str
    text: str


@dataclass(frozen=True, slots=True)
class Verdict:
    """A rule, whether it was asked for, how many findings it allows, and what it found.

    ``is_budget``: it was asked for as a number of new comparisons.
    """

    rule: Rule
    is_asked: bool
    most: int
    findings: tuple[Finding, ...]
    is_budget: bool = False

    @property
    def is_broken(self) -> bool:
        """Whether it was asked for and found too much."""
        return self.is_asked and len(self.findings) > self.most

    @property
    def line(self) -> str:
        """What is wrong, in one line."""
        option = f"--budget {self.most}" if self.is_budget else f"--fail-on {self.rule}"
        places = listed([f"{one.name} at {one.place}" for one in self.findings], _NAMED)
        return f"{option}: {RULES[self.rule]} ({len(self.findings):,}): {places}"


def verdicts(
    changes: BuildChanges, rules: Collection[Rule], most_new: int | None = None
) -> list[Verdict]:
    """What each rule found, in the order of ``RULES``.

    Args:
        changes: between two builds.
        rules: those that were asked for.
        most_new: how many comparisons may be new; None: as many as ``rules`` says.
    """
    found: dict[Rule, Sequence[Finding]] = {
        "new": [_of(one) for one in changes.of("new")],
        "gone": [_of(one) for one in changes.of("gone") if not one.is_unbuilt],
        "changed": [_of(one) for one in changes.of("changed")],
        "undeclared": [
            _of(one) for one in changes.comparisons if one.has_new_parameter and not one.is_declared
        ],
        "lost": [_lost(one) for one in changes.parameters if one.kind == "uncompared"],
        "missing-unit": [
            *(Finding(name, name, "it is not in the new build") for name in changes.missing),
            *(Finding(*_unit_of(text), text) for text in changes.unanalysed),
        ],
    }
    judged = []
    for rule, findings in found.items():
        # A rule is stricter than a budget.
        is_budget = rule == "new" and most_new is not None and rule not in rules
        most = most_new or 0 if is_budget else 0
        judged.append(Verdict(rule, rule in rules or is_budget, most, tuple(findings), is_budget))
    return judged


def place_of(one: ComparisonChange) -> str:
    """``package/src/node.cpp:12``, where it is now, or was."""
    tpc = one.site.tpc
    file = tpc.file if tpc.place == tpc.file else f"{tpc.package}/{tpc.place}"
    return f"{file}:{tpc.lineno}"


def edits_text(one: ComparisonChange) -> str:
    """``operator > -> >=; default 1 -> 2``; empty if nothing was edited."""
    return "; ".join(f"{edit.what} {edit.old} -> {edit.new}" for edit in one.edits)


def _of(one: ComparisonChange) -> Finding:
    text = edits_text(one) or " ".join(one.site.source_line.split())
    return Finding(one.site.threshold, place_of(one), text)


def _lost(one: ParameterChange) -> Finding:
    why = f": {one.why}" if one.why else ""
    return Finding(one.parameter, listed(one.places, 1) or one.package, f"now {one.new}{why}")


def _unit_of(trouble: str) -> tuple[str, str]:
    name = trouble.partition(" ")[0]
    return name, name
