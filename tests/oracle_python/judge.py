"""Compares what runs of a program show with what the analysis says of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from oracle_python.instrument import Place
from oracle_python.runner import Compiled, Outcome, Run
from pytpc.python_analysis.analysis import analyse
from pytpc.python_analysis.comparisons.gather import Found, span_of
from pytpc.python_analysis.ir.program import Program
from pytpc.python_analysis.rules_file import load_rules
from pytpc.python_analysis.sources.packages import entry_of

INPUTS = (1, 2, 3)
_WAYS = ("all", "first")
_TURNED = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}
_SIX = {"is": "==", "is not": "!=", "in": "==", "not in": "!="}
Key = tuple[str, tuple[int, int, int, int], str, str, str]
"""File, span, operand (``left``, ``right``, ``-`` for a flag), parameter, relation."""


@dataclass
class Verdict:
    """``wanted``: shown by runs. ``missed``: of these, what the analysis does not say.

    ``mixed``: wanted and left out, since the operand may be something measured, too, to which no
    run came. ``unseen``: what the analysis says of places that were evaluated, where no run had
    that parameter. ``is_sound`` is False where the program itself fails.
    """

    wanted: set[Key] = field(default_factory=set)
    found: set[Key] = field(default_factory=set)
    unseen: set[Key] = field(default_factory=set)
    followed: set[Key] = field(default_factory=set)
    is_sound: bool = True

    @property
    def missed(self) -> set[Key]:
        """Wanted and not found."""
        return self.wanted - self.found - self.followed

    @property
    def mixed(self) -> set[Key]:
        """See above."""
        return self.wanted & self.followed - self.found


def judge(modules: Mapping[str, str], folder: Path) -> Verdict:
    """Run a program, and ask the analysis.

    Args:
        modules: sources by name, the script is ``node``.
        folder: where they are written for the analysis.
    """
    compiled = Compiled(modules)
    before = {seed: Run(compiled, seed).run() for seed in INPUTS}
    verdict = Verdict(is_sound=all(one.is_whole for one in before.values()))
    if not verdict.is_sound:
        return verdict
    _ask(verdict, modules, folder)
    turned: list[Outcome] = []
    for number, place in enumerate(compiled.places):
        keys = set(_shown(number, place, before.values()))
        if keys and _matters(compiled, number, before, turned):
            verdict.wanted |= keys
    _look_for_unseen(verdict, compiled, [*before.values(), *turned])
    return verdict


def _ask(verdict: Verdict, modules: Mapping[str, str], folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, source in modules.items():
        (folder / f"{name}.py").write_text(source)
    program = Program(entry_of(folder / "node.py"))
    program.load()
    analysed = analyse(program, load_rules())
    verdict.found = {_key(each) for each in analysed.found}
    distance = analysed.slice.distance
    verdict.followed = {
        _key(Found(each.at, each.operand, each.fact.name, [each.fact], inside=each.inside))
        for each in analysed.follower.compared.values()
        if any(predicate in distance for predicate in each.predicates)
    }


def _key(found: Found) -> Key:
    start, end = span_of(found.at, found.operand)
    operand = ("left", "right")[found.operand] if found.operand >= 0 else "-"
    file = found.at.function.module.path
    return file, (*start, *end), operand, found.parameter, found.relation


def _keys(place: Place, side: int, parameters: set[str]) -> Iterator[Key]:
    relation, operand = place.sign, "-"
    if relation != "flag":
        relation = _SIX.get(relation, relation)
        operand = ("left", "right")[side]
        if side == 0:
            relation = _TURNED.get(relation, relation)
    for parameter in sorted(parameters):
        yield place.file, place.span, operand, parameter, relation


def _shown(number: int, place: Place, runs: object) -> Iterator[Key]:
    """The comparisons with a parameter that is the operand whenever it is no constant."""
    for run in runs:  # type: ignore[attr-defined]
        for side in (0, 1):
            seen = run.seen.get((number, side))
            everywhere = [
                other.seen[number, side]
                for other in runs  # type: ignore[attr-defined]
                if (number, side) in other.seen
            ]
            if seen is not None and all(each.is_sure for each in everywhere):
                yield from _keys(place, side, seen.parameters)


def _matters(
    compiled: Compiled, number: int, before: Mapping[int, Outcome], turned: list[Outcome]
) -> bool:
    """True where turning the outcome changes what is published."""
    if not compiled.places[number].can_turn:
        return False
    for seed, plain in before.items():
        for how in _WAYS:
            after = Run(compiled, seed, number, how).run()
            turned.append(after)
            if after.is_whole and after.published != plain.published:
                return True
    return False


def _look_for_unseen(verdict: Verdict, compiled: Compiled, runs: list[Outcome]) -> None:
    seen: set[Key] = set()
    evaluated: set[tuple[str, tuple[int, int, int, int]]] = set()
    for run in runs:
        for (number, side), what in run.seen.items():
            place = compiled.places[number]
            evaluated.add((place.file, place.span))
            seen.update(_keys(place, side, what.parameters))
    verdict.unseen = {key for key in verdict.found - seen if (key[0], key[1]) in evaluated}
