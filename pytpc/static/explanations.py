"""Explains from the static information why a comparison was found, and others were not.

``look_up`` takes a key, a parameter's name or ``FILE:LINE``, and returns all that the static
information says about it. ``pytpc explain`` prints that.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from pytpc.base.closest import did_you_mean
from pytpc.base.errors import InputError
from pytpc.static.link_unit import (
    BlindSpot,
    Comparison,
    LinkUnit,
    NotExposed,
    ParameterRead,
    PathStep,
)
from pytpc.static.parameters import same_parameter, without_object
from pytpc.static.static_info import StaticInfo

_CLOSEST = 5
_FILE_LINE = re.compile(r"(?P<file>[^:]+):(?P<line>[0-9]{1,9})(:[0-9]+)?")
_KEY = re.compile(r"(?P<key>[0-9a-f]{4,8}(-[0-9a-f-]*)?)(#[0-9]+)?")


@dataclass(frozen=True)
class FoundComparison:
    """A comparison that answers the question, with its link unit."""

    unit: LinkUnit
    comparison: Comparison


@dataclass(frozen=True)
class Explanation:
    """Everything known about a key, a parameter or a line.

    ``comparisons`` begin with the nearest to its exposing statement. The others are the reads, the
    comparisons on which nothing exposed depends, and the blind spots of the same parameter or line,
    each with its unit.
    """

    question: str
    comparisons: tuple[FoundComparison, ...]
    reads: tuple[tuple[LinkUnit, ParameterRead], ...] = ()
    not_exposed: tuple[tuple[LinkUnit, NotExposed], ...] = ()
    blind_spots: tuple[tuple[LinkUnit, BlindSpot], ...] = ()


def look_up(static: StaticInfo, question: str) -> Explanation:
    """What ``static`` says about a key (or its beginning), a parameter or ``FILE:LINE``.

    Raises:
        InputError: nothing has this name; the message lists the parameters with the closest names,
            or the known lines of the file.
    """
    place = _FILE_LINE.fullmatch(question)
    if place is not None:
        return _at(static, question, place["file"], int(place["line"]))
    if key := _KEY.fullmatch(question):
        # Of an instance, too: what is known of the source holds for all of them.
        by_key = [found for found in _all(static) if found.comparison.key.startswith(key["key"])]
        if by_key:
            return _explained(static, question, by_key, lambda _: False)
    return _of_parameter(static, question)


def _all(static: StaticInfo) -> Iterator[FoundComparison]:
    return (FoundComparison(unit, found) for unit in static.units for found in unit.comparisons)


def _of_parameter(static: StaticInfo, name: str) -> Explanation:
    explanation = _explained(
        static,
        name,
        (each for each in _all(static) if _same(each.comparison.source, name)),
        lambda found: _same(_parameter(found), name),
    )
    if not explanation.reads and not explanation.comparisons:
        raise InputError(_nothing_like(static, name))
    return explanation


def _explained(
    static: StaticInfo,
    question: str,
    comparisons: Iterable[FoundComparison],
    is_asked: Callable[[ParameterRead | NotExposed | BlindSpot], bool],
) -> Explanation:
    units = static.units
    return Explanation(
        question,
        tuple(sorted(comparisons, key=lambda each: each.comparison.distance)),
        reads=tuple((unit, of) for unit in units for of in unit.parameters if is_asked(of)),
        not_exposed=tuple((unit, of) for unit in units for of in unit.not_exposed if is_asked(of)),
        blind_spots=tuple((unit, of) for unit in units for of in unit.blind_spots if is_asked(of)),
    )


def _parameter(found: ParameterRead | NotExposed | BlindSpot) -> str | None:
    if isinstance(found, ParameterRead):
        return found.name
    return found.source if isinstance(found, NotExposed) else found.parameter


def _same(name: str | None, asked: str) -> bool:
    """Whether a name matches: ``arm/limit`` and ``limit`` also match ``~arm/limit``.

    So does what a mission calls it: ``/node/arm/limit``, or ``<dynamic>/limit (object 2)``.
    """
    if name is None:
        return False
    asked = without_object(asked)
    return (
        name == asked
        or re.search(f"[~/]{re.escape(asked)}$", name) is not None
        or same_parameter(asked, name)
    )


def _nothing_like(static: StaticInfo, name: str) -> str:
    known = {read.name for unit in static.units for read in unit.parameters}
    known |= {each.comparison.source for each in _all(static) if each.comparison.source}
    hint = did_you_mean(name, sorted(known))
    dynamic = sum(unit.counts.dynamic_names for unit in static.units)
    if dynamic:
        hint += f" ({dynamic} read{'' if dynamic == 1 else 's'} put the name together at run time)"
    return f"no parameter, key or FILE:LINE {name!r} in this static information{hint}"


def _at(static: StaticInfo, question: str, file: str, line: int) -> Explanation:
    def here(place: Comparison | ParameterRead | NotExposed | BlindSpot | PathStep) -> bool:
        return place.lineno == line and same_file(place.file, file)

    found = [each for each in _all(static) if here(each.comparison)]
    found = found or [each for each in _all(static) if any(map(here, each.comparison.path))]
    explanation = _explained(static, question, found, here)
    if not any((found, explanation.reads, explanation.not_exposed, explanation.blind_spots)):
        raise InputError(_nothing_at(static, file, line))
    return explanation


def same_file(known: str, asked: str) -> bool:
    """Whether ``known`` is ``asked``, or ends with it, a folder at a time; either may be longer."""
    known_parts, asked_parts = known.split("/"), asked.removeprefix("./").split("/")
    shared = min(len(known_parts), len(asked_parts))
    return known_parts[-shared:] == asked_parts[-shared:]


def _nothing_at(static: StaticInfo, file: str, line: int) -> str:
    lines = {
        each.comparison.lineno for each in _all(static) if same_file(each.comparison.file, file)
    }
    if not lines:
        return f"nothing was found in a file {file}{_which_files(static, file)}"
    nearest = sorted(sorted(lines, key=lambda other: abs(other - line))[:_CLOSEST])
    shown = ", ".join(str(number) for number in nearest)
    return f"nothing was found on line {line} of {file}; comparisons are on line {shown}"


def _which_files(static: StaticInfo, file: str) -> str:
    files = {each.comparison.file for each in _all(static)}
    # Mostly a wrong folder, else a typing mistake in the name.
    name = file.rpartition("/")[2]
    same = sorted(known for known in files if known.rpartition("/")[2] == name)
    return did_you_mean(file, same or files) or "; `pytpc list` shows the files"


def where(place: Comparison | ParameterRead | NotExposed | BlindSpot | PathStep) -> str:
    """``FILE:LINE``, or a text saying that it is unknown."""
    return f"{place.file}:{place.lineno}" if place.file else "a place that is not known"


def why_no_comparison(explanation: Explanation) -> list[str]:
    """Why a parameter has no reported comparison: what became of its value, each reason once."""
    if explanation.comparisons:
        return []
    reasons = [
        f"compared at {where(found)}, but nothing exposed depends on it"
        for _, found in explanation.not_exposed
    ]
    reasons += [
        f"{spot.what}, at {where(spot)}"
        for _, spot in explanation.blind_spots
        if spot.kind != "lost_outcome"
    ]
    return list(dict.fromkeys(reasons)) or ["read, and never compared"]
