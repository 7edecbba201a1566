"""What a rewritten call of a library function calls, where the function compares inside.

``f(a, b, k=c)`` has become ``SITE.call(f, a, b, {"k": c}).__next__()``: the function and its
arguments are evaluated as before, and the function is called by an iterator of C, with no frame of
ours between the program and what the function runs. See `pytpc.python_runtime.sites`.
"""

from __future__ import annotations

import operator
from functools import partial
from itertools import repeat, starmap
from typing import TYPE_CHECKING, Any, NamedTuple

from pytpc.python_runtime import sites
from pytpc.python_runtime.quiet import Site, flat, hidden, is_programs, keep, raising
from pytpc.python_runtime.sites import logger, number_of, truth_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from pytpc.python_runtime.sites import Reported

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


class ComparedInside(NamedTuple):
    """One comparison of a call: what reports it, its relation and the name of its operand."""

    reported: Reported
    relation: str
    operand: str


class LibraryCall(Site):
    """A call whose function compares; ``inside`` is what it compares."""

    __slots__ = ("call",)

    def __init__(self, inside: tuple[ComparedInside, ...]) -> None:
        logs = tuple(map(_logger, inside))

        def later(given: Given, result: object) -> Iterator[object]:
            try:
                for log in logs:
                    _try(log, given, result)
            except BaseException as error:
                return raising(error)
            return repeat(result, 1)

        def call(function: Any, *given: Any) -> Iterator[Any]:  # noqa: ANN401
            """What the function returns; its keywords come last."""
            try:
                arguments, keywords = given[:-1], given[-1]
                whole = (
                    partial(function, **keywords) if keywords and callable(function) else function
                )
                reporting = hidden(partial(later, (arguments, keywords)))
                return flat(map(reporting, starmap(whole, (arguments,))))
            except BaseException as error:
                return raising(error)

        self.offer(call=call)
        keep(self)


def _try(log: Callable[[Given, object], None], given: Given, result: object) -> None:
    try:
        log(given, result)
    except Exception as error:
        # A report that cannot be made is not worth a node.
        if is_programs(error):
            raise


def _logger(one: ComparedInside) -> Callable[[Given, object], None]:
    """What reports one comparison of a call with these arguments and this result."""
    kind, name, *first_alone = one.operand.split()
    compared = _RELATIONS[one.relation]
    log = logger((one.reported,))

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
        log(cmp, thresh, compared(cmp, thresh))

    def outcome(given: Given, result: object) -> None:
        """The result says how the comparison went."""
        truth = truth_of(result)
        if truth is None:
            sites.count_unknown()
            return
        threshold, others = parts(given)
        if kind != "within":
            log(others[0], threshold, truth)
            return
        left, right = map(number_of, others)
        distance = truth if left is None or right is None else abs(left - right)
        log(distance, threshold, truth)

    return chosen if kind == "choice" else outcome
