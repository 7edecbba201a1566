"""The suspects that the log cannot tell apart by when they turned."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from pytpc.diagnosis.results.suspects import Accused, Suspected
from pytpc.diagnosis.results.turn_groups import SuspectGroup, TurnGroup


def suspect_groups(
    suspects: Sequence[Suspected], groups: Iterable[TurnGroup]
) -> tuple[SuspectGroup, ...]:
    """The groups of suspects whose deciding comparisons turn as one, the likeliest first.

    Args:
        suspects: the likeliest first.
        groups: of the comparisons in the log.
    """
    found = []
    for group in groups:
        deciding = {(one.key, one.node) for one in group.members}
        members = [
            one
            for one in suspects
            if isinstance(one, Accused) and (one.key, one.last.node) in deciding
        ]
        if len(members) > 1:
            total = sum(one.probability for one in members)
            found.append(SuspectGroup(tuple(one.parameter for one in members), total, group))
    return tuple(sorted(found, key=lambda one: -one.probability))
