"""What rewritten code calls where it compares without an operator: `for`, `match`, library calls.

`pytpc.python_runtime.sites` explains how.
"""

from __future__ import annotations

import operator
import sys
from functools import partial
from itertools import chain, repeat, starmap
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple

from pytpc.python_runtime import sites
from pytpc.python_runtime.quiet import Site, caller, flat, hidden, is_programs, raising
from pytpc.python_runtime.sites import FALSE, NUMBERS, TRUE, logger, number_of, truth_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from pytpc.python_runtime.sites import Held, Reported

    Given = tuple[tuple[Any, ...], dict[str, Any]]

_RELATIONS = {
    "<": operator.lt,
    "<=": operator.le,
    ">": operator.gt,
    ">=": operator.ge,
    "==": operator.eq,
    "!=": operator.ne,
}


class Loop(Site):
    """``for i in range(limit)`` has become ``for i in LOOP.over(range(limit)).__next__()``.

    Like a ``for`` of C, it compares i with the limit before each turn, and once more at the end. A
    loop that ``break`` or ``return`` leaves has no end.
    """

    __slots__ = ("over", "turn")

    def __init__(self, reported: tuple[Reported, ...]) -> None:
        log = logger(reported)

        def turn(element: int, stop: int, is_turn: bool) -> Iterator[int]:
            try:
                log(element, stop, is_turn)
            except BaseException as error:
                return raising(error)
            return repeat(element, is_turn)

        def over(iterable: Any) -> Iterator[Any]:  # noqa: ANN401
            """The same elements, with reports; anything but a ``range`` is returned unchanged."""
            if type(iterable) is not range:
                return repeat(iterable)
            stop = iterable.stop
            elements: Iterable[int] = iterable
            is_turn: Iterable[bool] = repeat(True)
            if not iterable or iterable.index(iterable[-1]) < sys.maxsize:
                turns = len(iterable)
                elements = chain(iterable, (iterable.start + turns * iterable.step,))
                is_turn = chain(repeat(True, turns), (False,))
            # A longer range never ends in practice, and its length does not fit a C integer.
            # `turn` is looked up each time: a debugger that starts within the loop changes it.
            current = map(attrgetter("turn"), repeat(self))
            return repeat(flat(map(partial.__call__, current, elements, repeat(stop), is_turn)))

        # Both must be callable from C, and a `partial` is.
        self.offer(over=over, turn=partial(turn))


class Subject(Site):
    """``match subject`` has become ``match SUBJECT.hold(subject).__next__()``.

    The cases get the subject from `held`. Their guards call `taken`, `default` or `none`, which say
    which case was taken.
    """

    __slots__ = ("default", "held", "hold", "none", "taken")

    def __init__(self, reported: tuple[Reported, ...]) -> None:
        kept: Held = {}
        log = logger(reported)

        def hold(subject: object) -> Iterator[object]:
            """Keep the subject for the statement of the calling frame."""
            kept[caller()] = subject, None
            return repeat(subject)

        def held() -> Iterator[object]:
            """The subject."""
            return repeat(kept[caller()][0])

        def taken() -> Iterator[bool]:
            """A case that compares was taken."""
            return end(caller(), True, TRUE)

        def default() -> Iterator[bool]:
            """The case that matches everything was taken."""
            return end(caller(), False, TRUE)

        def none() -> Iterator[bool]:
            """No case was taken; nor is this one."""
            return end(caller(), False, FALSE)

        def end(frame: int, is_taken: bool, answer: Iterator[bool]) -> Iterator[bool]:
            subject, _ = kept.pop(frame)
            try:
                log(subject, subject, is_taken)
            except BaseException as error:
                return raising(error)
            return answer

        self.offer(hold=hold, held=held, taken=taken, default=default, none=none)


class ComparedInside(NamedTuple):
    """One comparison inside a call: its key, its relation and the name of its operand."""

    reported: Reported
    relation: str
    operand: str


class LibraryCall(Site):
    """A call of a function that compares; ``inside`` lists the comparisons.

    ``f(a, b, k=c)`` has become ``SITE.call(f, a, b, {"k": c}).__next__()``. The function and its
    arguments are evaluated as before. An iterator in C calls the function, so that no frame of ours
    is between the program and what the function runs.
    """

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


def _try(log: Callable[[Given, object], None], given: Given, result: object) -> None:
    try:
        log(given, result)
    except Exception as error:
        # A failed report must not stop the node.
        if is_programs(error):
            raise


def _logger(one: ComparedInside) -> Callable[[Given, object], None]:
    """The function that reports one comparison of a call from its arguments and its result."""
    kind, name, *first_alone = one.operand.split()
    compared = _RELATIONS[one.relation]
    log = logger((one.reported,))

    def parts(given: Given) -> tuple[object, list[object]]:
        """The threshold, and the values that it is compared with."""
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
        """For a result that is one of the arguments: the threshold, and the nearest other value."""
        threshold, others = parts(given)
        values: list[Any] = [*others, threshold]
        if not all(type(each) in NUMBERS for each in values):
            values = [number_of(each) for each in values]
            if None in values:
                sites.count_unknown()
                return
        # The largest argument is above all others, the smallest below.
        is_first = name == "1"
        nearest = min if (one.relation == "<") == is_first else max
        cmp, thresh = nearest(values[:-1]), values[-1]
        log(cmp, thresh, compared(cmp, thresh))

    def outcome(given: Given, result: object) -> None:
        """For a result that is the outcome."""
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
