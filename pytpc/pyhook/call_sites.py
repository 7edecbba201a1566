"""What a rewritten call of a library function calls, where the function compares inside.

``min(a, b)`` has become ``SITE.call(min, a, b).__next__()``: the function and its arguments are
evaluated as before, and the function is called by an iterator of C, with no frame of ours between
the program and what the function runs. See `pytpc.pyhook.sites`.
"""

from __future__ import annotations

import operator
from functools import partial
from itertools import starmap
from typing import TYPE_CHECKING, Any, NamedTuple

from pytpc.pyhook import sites
from pytpc.pyhook.sites import number_of, truth_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from pytpc.pyhook.sites import Reported

    Given = tuple[tuple[Any, ...], dict[str, Any]]

_RELATIONS = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}
_NUMBERS = frozenset({int, float, bool})


class Inside(NamedTuple):
    """One comparison of a call: its key, its relation, and its operand as in docs/formats.md."""

    reported: Reported
    relation: str
    operand: str


class LibraryCall:
    """A call whose function compares; ``inside`` is what it compares."""

    __slots__ = ("_log",)

    def __init__(self, inside: tuple[Inside, ...]) -> None:
        """All comparisons of the place."""
        self._log = tuple(map(_logger, inside))

    def call(self, function: Any, /, *arguments: Any, **keywords: Any) -> Iterator[Any]:  # noqa: ANN401
        """An iterator that gives what ``function`` returns, and reports."""
        whole = partial(function, **keywords) if keywords and callable(function) else function
        later = partial(self._later, (arguments, keywords))
        return map(later, starmap(whole, (arguments,)))

    def _later(self, given: Given, result: object) -> object:
        for log in self._log:
            try:
                log(given, result)
            except Exception:
                # A report that cannot be made is not worth a node.
                continue
        return result


def _logger(one: Inside) -> Callable[[Given, object], None]:
    """What reports one comparison of a call with these arguments and this result."""
    kind, name, *first_alone = one.operand.split()
    compared = _RELATIONS[one.relation]

    def parts(given: Given) -> tuple[object, list[object]]:
        """The threshold, and what it is compared with."""
        arguments, keywords = given
        if not name.isdigit():
            return keywords[name], list(arguments[: 1 if first_alone else 2])
        place = int(name) - 1
        if first_alone:
            others = list(arguments[:1])
        elif kind == "argument":
            others = [arguments[1 - place]]
        else:
            others = [each for at, each in enumerate(arguments) if at != place]
        return arguments[place], others

    def chosen(given: Given, _: object) -> None:
        """The result is one of the arguments: the threshold, or the nearest of the others."""
        threshold, others = parts(given)
        values: list[Any] = [*others, threshold]
        if not all(type(each) in _NUMBERS for each in values):
            values = [number_of(each) for each in values]
            if None in values:
                sites.count_unknown()
                return
        # Where the largest is chosen all others stand below it, where the smallest is, above.
        is_first = name == "1"
        nearest = min if (one.relation == "<") == is_first else max
        cmp, thresh = nearest(values[:-1]), values[-1]
        _report(one.reported, cmp, thresh, compared(cmp, thresh))

    def outcome(given: Given, result: object) -> None:
        """The result says how the comparison went."""
        truth = truth_of(result)
        if truth is None:
            sites.count_unknown()
            return
        threshold, others = parts(given)
        if kind != "within":
            _report(one.reported, others[0], threshold, truth)
            return
        left, right = map(number_of, others)
        distance = truth if left is None or right is None else abs(left - right)
        _report(one.reported, distance, threshold, truth)

    return chosen if kind == "choice" else outcome


def _report(reported: Reported, cmp: object, thresh: object, outcome: bool) -> None:
    left, right = sites.values(cmp, thresh, outcome)
    sites.take(reported, outcome, left, right, outcome)
