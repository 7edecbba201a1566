"""All that is wrong with a robot's parameters."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

from pytpc.base.wording import many
from pytpc.lint.angles import units_of_angles
from pytpc.lint.facts import Facts, Unjudged, last_part
from pytpc.lint.finding import KINDS, Finding, Kind, Spot
from pytpc.lint.limits import contradicting
from pytpc.lint.recorded import never_crossed, without_effect
from pytpc.lint.settings import deprecated, set_twice, unset
from pytpc.lint.unread import unread
from pytpc.lint.values import out_of_range, wrong_type


@dataclass(frozen=True, slots=True)
class Checked:
    """What was found, in the order of files and lines.

    ``used`` are the lines whose values nodes read, or may read.
    ``settings`` and ``nodes`` are how many there were. ``unjudged`` are the parameters of which it
    is not known whether a node reads them. ``ignored`` counts the findings that a comment in the
    file takes back.
    """

    findings: tuple[Finding, ...]
    used: frozenset[Spot] = frozenset()
    settings: int = 0
    nodes: int = 0
    unjudged: Unjudged = field(default_factory=Unjudged)
    ignored: int = 0


def check(facts: Facts, kinds: Collection[Kind] = tuple(KINDS)) -> Checked:
    """Check one robot.

    Args:
        facts: what is known of it.
        kinds: those that are looked for.
    """
    unused = unread(facts)
    found: list[Finding] = [
        *unused.findings,
        *set_twice(facts),
        *unset(facts),
        *deprecated(facts),
        *wrong_type(facts),
        *out_of_range(facts),
        *contradicting(facts),
        *units_of_angles(facts),
        *without_effect(facts),
        *never_crossed(facts),
    ]
    wanted = sorted((one for one in found if one.kind in kinds), key=Finding.order)
    return Checked(
        tuple(wanted), unused.used, len(facts.settings), len(facts.nodes), unused.unjudged
    )


def joined(checks: Sequence[Checked]) -> Checked:
    """The findings of several robots, or of one that is started in several ways, each once.

    What a line sets is read by no node only if that is so wherever the line is used.
    """
    reasons = defaultdict[str, set[str]](set)
    for one in checks:
        for why, names in one.unjudged.reasons.items():
            reasons[why] |= names
    used = frozenset[Spot]().union(*(each.used for each in checks))
    found = {
        (one.kind, one.spot, one.text): one
        for each in checks
        for one in each.findings
        if one.kind != "unread" or one.spot not in used
    }.values()
    return Checked(
        tuple(_once(sorted(found, key=Finding.order))),
        used,
        sum(each.settings for each in checks),
        sum(each.nodes for each in checks),
        Unjudged({why: frozenset(names) for why, names in reasons.items()}),
        sum(each.ignored for each in checks),
    )


def _once(findings: Iterable[Finding]) -> Iterator[Finding]:
    """One finding for a line that sets the value of several names, as for two costmaps."""
    alike = defaultdict[tuple[object, ...], list[Finding]](list)
    for one in findings:
        places = tuple(spot for _, spot in one.evidence)
        alike[one.kind, one.spot, last_part(one.parameter), places].append(one)
    for first, *others in alike.values():
        more = f" (and so {many(len(others), 'more name')})" if others else ""
        yield replace(first, text=f"{first.text}{more}")


def without_ignored(checked: Checked, ignored: Iterable[Finding]) -> Checked:
    """The same without findings that a comment takes back."""
    left_out = set(ignored)
    kept = tuple(one for one in checked.findings if one not in left_out)
    return replace(checked, findings=kept, ignored=len(checked.findings) - len(kept))
