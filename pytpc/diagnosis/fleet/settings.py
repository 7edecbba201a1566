"""Which value each parameter had in each mission of a fleet.

A value comes from the recorded parameters, where they were recorded, else from the thresholds of
the parameter's comparisons. Numbers that differ by less than a 32-bit float resolves are one value.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pyarrow as pa

from pytpc.base.columns import Bools, Floats, Int32s, Int64s, frozen
from pytpc.base.wording import listed, shown_value, tidy
from pytpc.diagnosis.fleet.rows import Rows, each_pair, numbers_of, without_robot, words_of
from pytpc.static.parameters import resolved

_BITS = 24
_LISTED = 4
_LONGEST = 40


class Setting(NamedTuple):
    """A value of a parameter: in words, and as a number if it is one."""

    text: str
    number: float | None


@dataclass(frozen=True, eq=False)
class Settings:
    """One entry for each mission in which a parameter's value is known.

    Attributes:
        parameters: the names; those of ``Rows.parameters`` come first, in their order.
        flags: bool[p], whether the numbers of each are true and false.
        numbers: float64[v], the different values, nan for what is no number; a limit that is off
            may be infinite.
        texts: what the values are called that are no numbers, by their code.
        together: the codes of the values that a parameter had in one mission, by theirs.
        parameter: int32[e], sorted; ``mission`` int32[e], rising in each parameter.
        value: int32[e], codes of the values; those of numbers come first and rise with them.
    """

    parameters: tuple[str, ...]
    flags: Bools
    numbers: Floats
    texts: dict[int, str]
    together: dict[int, tuple[int, ...]]
    parameter: Int32s
    mission: Int32s
    value: Int32s

    @classmethod
    def of(cls, rows: Rows, values: pa.Table | None = None) -> Settings:
        """The values of the missions of ``rows``.

        Args:
            rows: the digests.
            values: the recorded parameters of any missions, with the columns ``mission``,
                ``robot``, ``name`` (full names), ``time_ns`` (none: at the beginning), ``value``
                (JSON) and ``number``; None if there are none. A value that changed during a mission
                is one of its own, ``0.5, 0.8``.

        Raises:
            InputError: a column is missing or of another type.
        """
        found = [_compared(rows)]
        names = list(rows.parameters)
        if values is not None and values.num_rows:
            found.append(_recorded(rows, values, names))
        return _settings(names, found, rows)

    def entries(self, parameter: int) -> slice:
        """Those of one parameter."""
        first, last = np.searchsorted(self.parameter, [parameter, parameter + 1])
        return slice(int(first), int(last))

    def setting(self, parameter: int, value: int) -> Setting:
        """A value of a parameter, for people."""
        if value in self.together:
            every = [self.setting(parameter, one).text for one in self.together[value]]
            return Setting(listed(every, _LISTED), None)
        if value in self.texts:
            return Setting(self.texts[value], None)
        number = float(tidy(float(self.numbers[value])))
        is_truth = bool(self.flags[parameter]) and number in (0.0, 1.0)
        return Setting(shown_value(bool(number) if is_truth else number), number)


class _Found(NamedTuple):
    """Values before they have codes: ``numbers`` float64[e], nan where ``texts`` has a word.

    ``word`` int32[e] are codes into ``texts``, -1 for numbers. Entries of one mission and parameter
    are in the order of time. ``truths`` are the parameters of whom a value was true or false.
    """

    parameter: Int32s
    mission: Int32s
    numbers: Floats
    word: Int32s
    texts: list[str]
    truths: frozenset[int]


def _compared(rows: Rows) -> _Found:
    """What the thresholds say; those of derived comparisons only where nothing else does."""
    kinds = [one.kind for one in rows.series]
    derived = np.array([kind == "derived" for kind in kinds], np.bool_)
    known = ~np.isnan(rows.thresh)
    plain = known & ~derived[rows.which] if len(rows) else known
    width = len(rows.parameters) or 1
    place = rows.mission.astype(np.int64) * width + rows.parameter
    told = np.isin(place, np.unique(place[plain]))
    used = plain | (known & ~told)
    flags = {int(rows.of_series[n]) for n, kind in enumerate(kinds) if kind == "flag"}
    number = rows.thresh[used]
    return _Found(
        rows.parameter[used],
        rows.mission[used],
        number,
        np.full(number.size, -1, np.int32),
        [],
        frozenset(flags),
    )


def _recorded(rows: Rows, values: pa.Table, names: list[str]) -> _Found:
    """What the recorded parameters say; new names are added to ``names``."""
    missions, mission = words_of(values, "mission")
    robots, robot = words_of(values, "robot")
    full, name = words_of(values, "name")
    words, word = words_of(values, "value")
    time_ns = numbers_of(values, "time_ns", maybe=True)
    own_mission = each_pair(
        robot, mission, lambda r, m: rows.places.get((robots[r], missions[m]), -1)
    )
    meant, place_of = _meant(rows), {one: place for place, one in enumerate(names)}

    def place(r: int, n: int) -> int:
        short = without_robot(full[n], robots[r])
        short = meant.get(short, short)
        if short not in place_of:
            place_of[short] = len(names)
            names.append(short)
        return place_of[short]

    kept = np.flatnonzero(own_mission >= 0)
    begin = np.where(np.isnan(time_ns), -np.inf, time_ns)[kept]
    kept = kept[np.argsort(begin, kind="stable")]
    which = each_pair(robot[kept], name[kept], place)
    parsed = [_parsed(one) for one in words]
    numbers = np.array([one for one, _ in parsed] or [np.nan])
    truth = np.array([one in ("true", "false") for one in words] or [False])
    texts = [text for _, text in parsed]
    number = numbers[word[kept]]
    return _Found(
        which,
        own_mission[kept],
        number,
        np.where(np.isnan(number), word[kept], -1).astype(np.int32),
        texts,
        frozenset(which[truth[word[kept]]].tolist()),
    )


def _meant(rows: Rows) -> dict[str, str]:
    """The parameter that each full name means in the nodes that compare it."""
    return {resolved(one.parameter, one.node): one.parameter for one in rows.series}


def _parsed(text: str) -> tuple[float, str]:
    """A value's JSON as a number, or nan and its text."""
    try:
        value = json.loads(text)
    except (ValueError, RecursionError):
        return np.nan, shown_value(text, _LONGEST)
    if isinstance(value, bool | int | float):
        try:
            number = float(value)
        except OverflowError:
            number = np.inf
        if not np.isnan(number):
            return number, ""
    return np.nan, shown_value(value, _LONGEST)


def _settings(names: list[str], found: list[_Found], rows: Rows) -> Settings:
    texts: list[str] = []
    words = []
    for one in found:
        words.append(np.where(one.word >= 0, one.word + len(texts), -1))
        texts += one.texts
    parameter, mission, numbers = (
        np.concatenate([getattr(one, name) for one in found])
        for name in ("parameter", "mission", "numbers")
    )
    source = np.repeat(np.arange(len(found)), [one.mission.size for one in found])
    values, code = _codes(numbers, np.concatenate(words), texts)
    kept = _of_the_last_source(parameter, mission, source, len(rows.missions))
    parameter, mission, code = parameter[kept], mission[kept], code[kept]
    order = np.lexsort((np.arange(mission.size), mission, parameter))
    parameter, mission, code = parameter[order], mission[order], code[order]
    new = np.ones(parameter.size, np.bool_)
    new[1:] = (parameter[1:] != parameter[:-1]) | (mission[1:] != mission[:-1])
    starts = np.flatnonzero(new)
    value = code[starts].astype(np.int32)
    flags = np.zeros(len(names), np.bool_)
    flags[sorted(set().union(*(one.truths for one in found)))] = True
    together: dict[tuple[int, ...], int] = {}
    for place, several in _several(starts, code, source[kept][order]):
        value[place] = together.setdefault(several, len(values[0]) + len(together))
    return Settings(
        tuple(names),
        frozen(flags),
        frozen(np.append(values[0], np.full(len(together), np.nan))),
        values[1],
        {own: several for several, own in together.items()},
        frozen(parameter[starts]),
        frozen(mission[starts]),
        frozen(value),
    )


def _of_the_last_source(
    parameter: Int32s, mission: Int32s, source: Int64s, missions: int
) -> Int64s:
    """The entries of the last source that knows the parameter's value in the mission."""
    place = parameter.astype(np.int64) * max(1, missions) + mission
    recorded = np.unique(place[source > 0])
    return np.flatnonzero((source > 0) | ~np.isin(place, recorded))


def same_numbers(values: Floats) -> Floats:
    """float64[n]: the values, equal where a 32-bit float does not tell them apart."""
    mantissa, exponent = np.frexp(values + 0.0)
    return np.asarray(np.ldexp(np.round(np.ldexp(mantissa, _BITS)), exponent - _BITS))


def _codes(
    numbers: Floats, word: Int64s, texts: list[str]
) -> tuple[tuple[Floats, dict[int, str]], Int64s]:
    """The different values, and the code of each entry; see `Settings`."""
    rounded = same_numbers(numbers)
    is_text = word >= 0
    different, code = np.unique(rounded[~is_text], return_inverse=True)
    first = np.full(different.size, np.nan)
    first[code[::-1]] = numbers[~is_text][::-1]
    names = sorted({texts[one] for one in np.unique(word[is_text]).tolist()})
    place_of = {name: different.size + place for place, name in enumerate(names)}
    table = np.array([place_of.get(one, -1) for one in texts] or [-1], np.int64)
    found = np.empty(numbers.size, np.int64)
    found[~is_text] = code
    found[is_text] = table[word[is_text]]
    values = np.append(first, np.full(len(names), np.nan))
    return (values, {place: name for name, place in place_of.items()}), found


def _several(starts: Int64s, code: Int64s, source: Int64s) -> Iterator[tuple[int, tuple[int, ...]]]:
    """The missions and parameters with more than one value, and these values.

    Recorded ones are in the order of time; thresholds have none.
    """
    if not starts.size:
        return
    ends = np.append(starts[1:], code.size)
    low, high = (ufunc.reduceat(code, starts) for ufunc in (np.minimum, np.maximum))
    for place in np.flatnonzero(low != high).tolist():
        own = code[starts[place] : ends[place]].tolist()
        timed = source[starts[place]] > 0
        yield place, tuple(dict.fromkeys(own if timed else sorted(own)))
