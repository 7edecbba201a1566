"""The command ``margins``: how near each comparison came to turning."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import click

from pytpc.api.measuring import Margins, MissionMargins
from pytpc.base.closest import did_you_mean
from pytpc.base.errors import InputError
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import JSON, PATH, as_object
from pytpc.cli.console import console, print_json, progress
from pytpc.cli.options import STATIC, check, recording_of
from pytpc.cli.sources import static_for
from pytpc.diagnosis.behaviour import by_nearest
from pytpc.diagnosis.results.behaviour import Behaviour
from pytpc.present.as_json import turn_group_json
from pytpc.present.margin_tables import (
    behaviour_json,
    over_json,
    print_behaviours,
    print_over_missions,
)
from pytpc.static.parameters import meant_by

_Order = Callable[[Behaviour], tuple[float, str]]
_SORTS: dict[str, _Order] = {
    "nearest": by_nearest,
    "misses": lambda one: (-one.near_misses, one.parameter),
    "turns": lambda one: (-one.turns, one.parameter),
    "undecided": lambda one: (-(one.undecided or 0.0), one.parameter),
    "drift": lambda one: (_left(one), one.parameter),
    "parameter": lambda one: (0.0, one.parameter),
}


def _left(one: Behaviour) -> float:
    """The seconds until the margin is 0 at its drift."""
    left = None if one.drift is None else one.drift.turns_in_s
    return math.inf if left is None else left


@dataclass(frozen=True)
class _MarginsArguments:
    recordings: tuple[Path, ...]
    static_source: Path | None
    parameter: str | None
    order: str
    top: int
    as_json: bool


@click.command("margins")
@click.argument("recordings", type=PATH, nargs=-1, required=True, metavar="RECORDING...")
@STATIC
@click.option("--parameter", metavar="NAME", help="Show only the comparisons with this parameter.")
@click.option(
    "--sort",
    "order",
    type=click.Choice(list(_SORTS)),
    default="nearest",
    show_default=True,
    help="Sort the rows by this.",
)
@click.option(
    "--top",
    type=click.IntRange(min=1),
    default=20,
    show_default=True,
    metavar="N",
    help="Show this many comparisons.",
)
@JSON
@as_object(_MarginsArguments)
def margins_command(given: _MarginsArguments) -> None:
    """Show how near each comparison came to turning in each RECORDING.

    The margin is how far the compared value was from the threshold, in the parameter's unit. For
    each comparison: its margins over time, near misses, turns, the share of time in which it was
    undecided, and whether the margin drifts. Comparisons that turn together, or one after the
    other, are named as groups. With several RECORDINGs, in their order, a table shows how the
    margins change from mission to mission. Marks are not needed.
    """
    missions = []
    for source in given.recordings:
        recording = recording_of(source)
        static = static_for(given.static_source, source, recording)
        check(recording, static, source)
        with progress(f"measuring {source.name}") as advance:
            advance(0, 1)
            missions.append(MissionMargins.of(recording, static, source))
    found = Margins(tuple(missions))
    names = _asked(given.parameter, found)
    if given.as_json:
        print_json(_document(found, names))
        return
    for mission in missions:
        _print(mission, names, given)
    if len(missions) > 1:
        rows = [one for one in found.over if one.parameter in names]
        rows.sort(key=lambda one: (math.inf if one.zero_in is None else one.zero_in, one.parameter))
        shown = rows[: given.top]
        labels = [one.name for one in missions]
        print_over_missions(console(), labels, shown, len(rows) - len(shown))


def _asked(parameter: str | None, found: Margins) -> frozenset[str]:
    """The names that are shown.

    Raises:
        InputError: nothing compares with ``parameter``.
    """
    names = sorted({one.parameter for mission in found for one in mission})
    if parameter is None:
        return frozenset(names)
    meant = meant_by(parameter, names)
    if not meant:
        hint = did_you_mean(parameter, names)
        raise InputError(f"no recorded comparison with a parameter {plain(parameter)}{hint}")
    return frozenset(meant)


def _print(mission: MissionMargins, names: frozenset[str], given: _MarginsArguments) -> None:
    rows = sorted(_of(mission, names), key=_SORTS[given.order])
    shown = rows[: given.top]
    groups = [one for one in mission.groups if not names.isdisjoint(one.parameters)]
    title = f"{mission.name}: {many(len(rows), 'comparison')} evaluated in {mission.seconds:.1f} s"
    print_behaviours(console(), title, shown, groups, len(rows) - len(shown))


def _of(mission: MissionMargins, names: frozenset[str]) -> Sequence[Behaviour]:
    return [one for one in mission if one.parameter in names]


def _document(found: Margins, names: frozenset[str]) -> dict[str, object]:
    return {
        "missions": [
            {
                "mission": mission.name,
                "seconds": mission.seconds,
                "comparisons": [behaviour_json(one) for one in _of(mission, names)],
                "groups": [turn_group_json(one) for one in mission.groups],
            }
            for mission in found
        ],
        "over": [over_json(one) for one in found.over if one.parameter in names],
    }


COMMANDS: list[click.Command] = [margins_command]
