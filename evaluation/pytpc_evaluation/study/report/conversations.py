"""Conversations of ``pytpc fix`` that were flown: is the error gone, and what did the tries cost?

A try that was taken back has left nothing behind, whatever it did while it was flown.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from pytpc_evaluation.study.metrics import Estimate, exact_share
from pytpc_evaluation.study.report.folder import FlownMission
from pytpc_evaluation.study.report.parts import Part
from pytpc_evaluation.study.report.ranked import percent, verdict_of
from pytpc_evaluation.study.report.repairs import chains_in
from pytpc_evaluation.study.suggestion_chains import FIX_RUNS, MOST_TRIES, Chain, Try
from pytpc_evaluation.tables import Cell, Column, Table

FIX_TARGETS = {"fix": 0.60, "fix-2-runs": 0.85}
"""The share of treatments in which the error is to be gone within all tries."""


def conversations_table(
    chains: Sequence[Chain], parts: Sequence[Part], flights: Sequence[FlownMission]
) -> Table:
    """What came of each variant within so many tries, by part; chains that wait are left out.

    So are missions that nobody marked, or in which nothing was wrong to be seen.
    """
    headings = (
        *("Part", "Tries", "Treatments", "Error gone %", "Gone, and no new one %"),
        *("Rightly ended %", "Wrongly ended %", "New error, of tries %", "New error, at the end %"),
        *("Missions waiting", "Target", "Verdict"),
    )
    lines: list[tuple[str, tuple[Cell, ...]]] = []
    for part in parts:
        own = chains_in(chains, part, flights)
        for variant in FIX_RUNS:
            begun = [one for one in own if one.variant == variant and _can_be_judged(one)]
            for most in range(1, MOST_TRIES[variant] + 1):
                done = [one for one in begun if one.is_done(most)]
                if not begun:
                    continue
                went = share_of(done, most, _is_gone)
                target = FIX_TARGETS[variant] if most == MOST_TRIES[variant] else None
                cells: tuple[Cell, ...] = (
                    part.name,
                    most,
                    went.treatments,
                    percent(went),
                    *(percent(share_of(done, most, of)) for of in (_is_well, _is_right, _is_wrong)),
                    percent(_new_errors(done, most)),
                    percent(share_of(done, most, _is_worse)),
                    len(begun) - len(done),
                    None if target is None else f">= {100 * target:.0f}",
                    None if target is None else verdict_of(went, target),
                )
                lines.append((variant, cells))
    columns = tuple(Column(heading, 0) for heading in headings)
    return Table("conversations", "Fixed try by try", columns, tuple(lines), (), "Variant")


def gone_by_fix(chains: Sequence[Chain], variant: str) -> Estimate:
    """The share of treatments in which a try of a variant took the error away."""
    most = MOST_TRIES[variant]
    own = [one for one in chains if one.variant == variant and _can_be_judged(one)]
    return share_of([one for one in own if one.is_done(most)], most, _is_gone)


def share_of(chains: Sequence[Chain], most: int, of: Callable[[Sequence[Try]], bool]) -> Estimate:
    """The share of treatments of which something holds after ``most`` tries."""
    held = [float(of(_flown(one)[:most])) for one in chains]
    return exact_share(held, [(one.system, one.treatment) for one in chains])


def _new_errors(chains: Sequence[Chain], most: int) -> Estimate:
    """The share of tries that made a new error, as a mean over treatments."""
    tries = [(chain, one) for chain in chains for one in _flown(chain)[:most]]
    units = [(chain.system, chain.treatment) for chain, _ in tries]
    return exact_share([float(one.new_error is True) for _, one in tries], units)


def _can_be_judged(chain: Chain) -> bool:
    return bool(chain.observer) and not any(
        one.is_flown and one.gone is None for one in chain.tries
    )


def _flown(chain: Chain) -> list[Try]:
    return [one for one in chain.tries if one.is_flown]


def _is_gone(tries: Sequence[Try]) -> bool:
    return any(one.gone for one in tries)


def _is_well(tries: Sequence[Try]) -> bool:
    return any(one.gone and not one.new_error for one in tries)


def _is_right(tries: Sequence[Try]) -> bool:
    """Whether the observer saw nothing any more, and the error is gone."""
    return any(one.verdict == "fixed" and one.gone is True for one in tries)


def _is_wrong(tries: Sequence[Try]) -> bool:
    """The same though it is still there: the observer marked nothing."""
    return any(one.verdict == "fixed" and not one.gone for one in tries)


def _is_worse(tries: Sequence[Try]) -> bool:
    """Whether what stays changed makes a new error."""
    stay = [one for one in tries if one.verdict in {"fixed", "better"}]
    return bool(stay) and stay[-1].new_error is True
