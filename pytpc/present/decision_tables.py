"""What two recordings decided differently: for a terminal, and as JSON."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict

from rich.console import Console
from rich.text import Text

from pytpc.base.wording import many, percent, plain, show, shown_value
from pytpc.diagnosis.results.decisions import Decided, DecisionChange, RunDecisions
from pytpc.present.as_json import Json, without_nan

_SHOWN = 20


def print_decisions(out: Console, found: RunDecisions, *, everything: bool = False) -> None:
    """Print what two runs decided, the largest difference first.

    Args:
        out: where to.
        found: the comparisons.
        everything: whether those that decided alike are printed, too, and all others.
    """
    out.print(Text(plain(title_of(found)), style="bold"), highlight=False, soft_wrap=True)
    shown = found.found if everything else found.differing[:_SHOWN]
    for one in shown:
        for line in _lines(one):
            out.print(line, highlight=False, soft_wrap=True)
    left = len(found.found) - len(shown)
    if left:
        text = f"{many(left, 'other comparison')}: --all lists {'it' if left == 1 else 'them'}"
        out.print(Text(text, style="dim"))


def title_of(found: RunDecisions) -> str:
    """How many comparisons did not decide alike."""
    lengths = [f"{name} ({seconds:.1f} s)" for name, seconds in _runs(found)]
    return (
        f"{len(found.differing):,} of {many(len(found.found), 'comparison')} did not decide alike"
        f" in OLD {lengths[0]} and NEW {lengths[1]}"
    )


def _runs(found: RunDecisions) -> Sequence[tuple[str, float]]:
    return list(zip((found.old, found.new), found.seconds, strict=True))


def _lines(one: DecisionChange) -> Iterator[Text]:
    yield Text("")
    yield Text.assemble((plain(one.parameter), "bold"), plain(f"  {one.place}  {one.source_code}"))
    yield Text(plain(f"  {one.what}"), style="" if one.is_alike else "yellow")
    for name, run in (("OLD", one.old), ("NEW", one.new)):
        if run is not None:
            yield Text(plain(f"  {name}  {_run(run)}"))


def _run(run: Decided) -> str:
    parts = [f"{many(run.evaluations, 'evaluation')}, {percent(run.true)} true"]
    first = "" if run.turned_s is None else f", first at {run.turned_s:.1f} s"
    parts.append(f"{many(run.flops, 'flop')}{first}")
    if run.low is not None:
        ends = [show(value) for value in (run.low, run.middle, run.high)]
        parts.append(f"margin {ends[0]} to {ends[2]}, median {ends[1]}")
    if run.thresholds:
        more = f" and {run.more:,} more" if run.more else ""
        parts.append(f"threshold {', '.join(map(show, run.thresholds))}{more}")
    if run.value.value is not None:
        place = f" ({run.value.place})" if run.value.place else ""
        parts.append(f"parameter {shown_value(run.value.value)}{place}")
    return "; ".join(parts)


def decisions_json(found: RunDecisions) -> Json:
    """The document of ``compare --json`` for two recordings."""
    return {
        "kind": "recordings",
        "old": {"name": found.old, "seconds": found.seconds[0], "unknown": found.unknown[0]},
        "new": {"name": found.new, "seconds": found.seconds[1], "unknown": found.unknown[1]},
        "comparisons": [_change_json(one) for one in found.found],
    }


def _change_json(one: DecisionChange) -> Json:
    return {
        "key": one.key,
        "parameter": one.parameter,
        "place": one.place,
        "source_code": one.source_code,
        "relation": one.relation,
        "what": one.what,
        "is_alike": one.is_alike,
        "earlier_s": one.earlier_s,
        "old": None if one.old is None else _decided_json(one.old),
        "new": None if one.new is None else _decided_json(one.new),
    }


def _decided_json(run: Decided) -> Json:
    return {name: without_nan(value) for name, value in asdict(run).items()}
