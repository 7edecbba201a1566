"""The values that parameters had in the course of a mission."""

from __future__ import annotations

from bisect import bisect_right
from collections import defaultdict
from collections.abc import Iterable, Iterator
from typing import NamedTuple


class SetValue(NamedTuple):
    """From a time on (ns) the parameter with this full name has this value; None: it is deleted."""

    time_ns: int
    name: str
    value: object


class ValueChange(NamedTuple):
    """A parameter that was set anew while the mission ran."""

    time_ns: int
    name: str
    old: object
    new: object


class ParameterValues:
    """The values of parameters at any time.

    Args:
        found: the values as they were set, in any order; those of one time in the given one.
    """

    def __init__(self, found: Iterable[SetValue] = ()) -> None:
        """See the class."""
        self._times: dict[str, list[int]] = defaultdict(list)
        self._values: dict[str, list[object]] = defaultdict(list)
        for time_ns, name, value in sorted(found, key=lambda one: one.time_ns):
            values = self._values[name]
            if values and _same(values[-1], value):
                continue
            self._times[name].append(time_ns)
            values.append(value)

    def names(self) -> list[str]:
        """The full names of all parameters, sorted."""
        return sorted(self._values)

    def at(self, name: str, time_ns: int) -> object:
        """The value at a time; before the first one that is known, that one. None: no value."""
        values = self._values.get(name)
        if not values:
            return None
        return values[max(0, bisect_right(self._times[name], time_ns) - 1)]

    def history(self, name: str) -> list[tuple[int, object]]:
        """The values of a parameter, each with the time (ns) from which on it had it."""
        return list(zip(self._times.get(name, ()), self._values.get(name, ()), strict=True))

    def changes(self) -> Iterator[ValueChange]:
        """Each change, in order of time."""
        found = [
            ValueChange(time_ns, name, old, new)
            for name, values in self._values.items()
            for time_ns, old, new in zip(self._times[name][1:], values, values[1:], strict=False)
        ]
        yield from sorted(found, key=lambda one: (one.time_ns, one.name))

    def kept(self) -> tuple[SetValue, ...]:
        """What ``ParameterValues`` can be made of again, by time and name."""
        found = [
            SetValue(time_ns, name, value)
            for name, values in self._values.items()
            for time_ns, value in zip(self._times[name], values, strict=True)
        ]
        return tuple(sorted(found, key=lambda one: (one.time_ns, one.name)))

    def last(self) -> dict[str, object]:
        """The values at the end, by full names; deleted ones are left out."""
        found = {name: self._values[name][-1] for name in self.names()}
        return {name: value for name, value in found.items() if value is not None}

    def first(self) -> dict[str, object]:
        """The values at the beginning, by full names."""
        return {name: self._values[name][0] for name in self.names()}


def _same(one: object, other: object) -> bool:
    # NaN is NaN, and 1 is not 1.0.
    return repr(one) == repr(other)
