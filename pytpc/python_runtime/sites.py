"""The functions that a rewritten comparison calls.

``a < b`` has become ``SITE.compare(a, b).__next__()``, where SITE is a constant of the code.
`compare` returns an iterator, and its ``__next__`` the outcome. The reason: where ``a < b`` runs
code of the program, or may raise, no frame of ours may be between the program and its method. Then
tracebacks, ``sys._getframe`` and the depth of recursion are as before. ``map(report, (a,), (b,),
map(operator.lt, (a,), (b,)))`` is all C until it calls ``report`` with the outcome. Comparing
Python's own numbers and texts runs no code of the program and raises nothing: there `compare`
compares at once, and returns one of two iterators, for True and for False.

A report never calls methods of the program's objects. It reads numbers by the methods of the base
classes; for anything else it has the outcome alone.

Every function that a rewritten program calls returns an iterator. So it can be exchanged for a
class in C under a tracer, and what a signal handler raises within it is raised by C on the
program's own line: see `pytpc.python_runtime.quiet`.
"""

from __future__ import annotations

import math
import operator
from itertools import repeat, tee
from typing import TYPE_CHECKING, Any

from pytpc.python_runtime.quiet import Site, caller, flat, hidden, is_programs, raising

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from pytpc.python_runtime.quiet import Function

    Operator = Callable[[Any, Any], Any]
    Held = dict[int, tuple[object, object]]
    Take = Callable[["Reported", bool, float, float, bool], None]

TRUE = repeat(True)
FALSE = repeat(False)


class Reported:
    """One key that reports, with what the sinks keep for it."""

    __slots__ = ("file", "key", "last", "meter", "node", "number", "swapped")

    def __init__(self, key: str, number: int, swapped: bool) -> None:
        """``swapped``: the threshold is the left operand. Numbers begin with 1."""
        self.key = key
        self.number = number
        self.swapped = swapped
        # Whose it is, if not the node's that the process is named after.
        self.node = ""
        self.file: object = None
        self.last = -1
        self.meter = [0, 0]


def _ordinary(function: Operator) -> Operator:
    return lambda a, b: map(function, (a,), (b,))


_PLAIN_OPERATIONS: dict[str, Operator] = {
    "Lt": operator.lt,
    "LtE": operator.le,
    "Gt": operator.gt,
    "GtE": operator.ge,
    "Eq": operator.eq,
    "NotEq": operator.ne,
    "Is": operator.is_,
    "IsNot": operator.is_not,
}
# Name of the operator in `ast` -> a function that returns an iterator over the outcome, all in C.
_LAZY_OPERATIONS: dict[str, Operator] = {
    **{name: _ordinary(function) for name, function in _PLAIN_OPERATIONS.items()},
    "In": lambda a, b: map(operator.contains, (b,), (a,)),
    "NotIn": lambda a, b: map(operator.not_, map(operator.contains, (b,), (a,))),
}

# Comparing these with one another raises nothing and runs no code of the program.
NUMBERS = frozenset({int, float, bool})
# Nor does testing the truth of these.
_PLAIN = frozenset(
    {int, float, bool, str, bytes, type(None), list, tuple, dict, set, frozenset, complex, range}
)
_DURATIONS = frozenset({"genpy.rostime", "rospy.rostime"})
_DURATIONS_OF_RCLPY = frozenset({"rclpy.time", "rclpy.duration"})


def nothing(_reported: Reported, _result: bool, _cmp: float, _thresh: float, _res: bool) -> None:
    """Takes reports while nobody wants them."""


_take: Take = nothing
_whole: Take = nothing
_over: list[Callable[[Take], Take]] = []
_counts = {"unknown_outcomes": 0}


def set_take(take: Take) -> None:
    """Set the function that takes all reports from now on."""
    global _take, _whole  # noqa: PLW0603
    _whole = take
    for over in _over:
        take = over(take)
    _take = take


def put_over(over: Callable[[Take], Take]) -> None:
    """Let ``over`` make the function that takes reports, from each one that is set."""
    _over.append(over)
    set_take(_whole)


def take(one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
    """Pass a report to the current function."""
    _take(one, result, cmp, thresh, res)


def unknown_outcomes() -> int:
    """The number of evaluations not reported because testing them could run the program's code."""
    return _counts["unknown_outcomes"]


def count_unknown() -> None:
    """Count an evaluation whose truth only the program may test."""
    _counts["unknown_outcomes"] += 1


def number_of(value: Any) -> float | None:  # noqa: ANN401
    """``value`` as a number; None if it is none, or if only its own code could convert it.

    Numbers are Python's and those of derived classes (by the method of the base), numpy's scalars,
    and ROS times and durations in seconds.
    """
    try:
        return _number_of(value, type(value))
    except OverflowError:
        return math.inf if int.__gt__(value, 0) else -math.inf
    except Exception:
        return None


def _number_of(value: Any, kind: type) -> float | None:  # noqa: ANN401
    found: float | None = None
    if issubclass(kind, float):
        found = float.__float__(value)
    elif issubclass(kind, int):
        found = int.__float__(value)
    elif kind.__module__ == "numpy":
        # An array of one element has __float__ too, but is not a number to the program.
        is_scalar = hasattr(kind, "dtype") and kind.__name__ not in ("ndarray", "matrix")
        found = float(value) if is_scalar else None
    elif kind.__module__ in _DURATIONS:
        found = float(value.secs) + value.nsecs * 1e-9
    elif kind.__module__ in _DURATIONS_OF_RCLPY:
        found = value.nanoseconds * 1e-9
    return found


def truth_of(value: object) -> bool | None:
    """The truth of ``value`` if testing it runs no code of the program, else None."""
    if value is True or value is False:
        return bool(value)
    kind = type(value)
    if kind in _PLAIN or (kind.__module__ == "numpy" and kind.__name__ in ("bool_", "bool")):
        return bool(value)
    return None


def values(cmp: object, thresh: object, outcome: bool) -> tuple[float, float]:
    """The two numbers of a report; where one value is not a number, both are the outcome."""
    left = number_of(cmp)
    right = number_of(thresh)
    if left is None or right is None:
        return float(outcome), float(outcome)
    return left, right


class ComparisonSite(Site):
    """One link of a comparison; see the module's docstring.

    A link with others behind it keeps its right operand and its outcome for the current frame. The
    code that follows gets them at once from `right`, `outcome` or `failed`.
    """

    __slots__ = ("compare", "failed", "link", "outcome", "right", "truth")

    def __init__(self, operation: str, reported: tuple[Reported, ...]) -> None:
        """``operation`` is the name of the operator's class in `ast`."""
        held: Held = {}

        def right() -> Iterator[object]:
            """The right operand of the link that was just evaluated in the calling frame."""
            return repeat(held.pop(caller())[0])

        def outcome() -> Iterator[object]:
            """Its outcome."""
            return repeat(held.pop(caller())[1])

        def failed() -> Iterator[bool]:
            """False, for a false outcome that is used for its truth alone."""
            del held[caller()]
            return FALSE

        compare, truth = _comparer(operation, reported)
        self.offer(
            compare=compare,
            truth=truth,
            link=_linker(operation, reported, held),
            right=right,
            outcome=outcome,
            failed=failed,
        )


def logger(reported: tuple[Reported, ...]) -> Callable[[Any, Any, bool], None]:
    """The function that reports an outcome under each key. Exceptions are the program's own."""

    def log(a: object, b: object, outcome: bool) -> None:
        try:
            left, right = values(a, b, outcome)
            for one in reported:
                if one.swapped:
                    _take(one, outcome, right, left, outcome)
                else:
                    _take(one, outcome, left, right, outcome)
        except Exception as error:
            # A failed report must not stop the node.
            if is_programs(error):
                raise

    return log


def _comparer(
    operation: str, reported: tuple[Reported, ...]
) -> tuple[Callable[[Any, Any], Iterator[Any]], Callable[[Any, Any], Iterator[Any]]]:
    """`compare`, whose iterator gives the outcome, and `truth`, whose iterator gives its truth.

    Where the program tests the truth of a comparison once and uses nothing else, ``truth`` tests it
    in C, so that the report knows it.
    """
    lazy = _LAZY_OPERATIONS[operation]
    later = _later(reported)
    at_once = _at_once(operation, reported)

    def compare(a: object, b: object) -> Iterator[Any]:
        return flat(map(hidden(later), (a,), (b,), lazy(a, b)))

    def truth(a: object, b: object) -> Iterator[Any]:
        return flat(map(hidden(later), (a,), (b,), map(operator.truth, lazy(a, b))))

    return at_once(compare), at_once(truth)


def _later(reported: tuple[Reported, ...]) -> Function:
    """The function that reports a comparison after its outcome, and returns the outcome."""
    log = logger(reported)

    def later(a: object, b: object, outcome: object) -> Iterator[Any]:
        try:
            truth = truth_of(outcome)
            if truth is None:
                count_unknown()
            else:
                log(a, b, truth)
        except BaseException as error:
            return raising(error)
        return repeat(outcome, 1)

    return later


def _at_once(operation: str, reported: tuple[Reported, ...]) -> Callable[[Function], Function]:
    """Puts a shortcut before ``compare``, for one key and two operands of int, float or bool."""
    if operation not in _PLAIN_OPERATIONS or len(reported) != 1:
        # The right operand of `in` is not a number.
        return lambda slowly: slowly
    plain = _PLAIN_OPERATIONS[operation]
    numbers = NUMBERS
    log = logger(reported)
    (one,) = reported
    swapped = one.swapped

    def at_once(slowly: Function) -> Function:
        def compare(a: Any, b: Any) -> Iterator[Any]:  # noqa: ANN401
            try:
                if type(a) not in numbers or type(b) not in numbers:
                    return slowly(a, b)
                outcome = plain(a, b)
                try:
                    if swapped:
                        _take(one, outcome, b + 0.0, a + 0.0, outcome)
                    else:
                        _take(one, outcome, a + 0.0, b + 0.0, outcome)
                except OverflowError:
                    # An integer too large for a double.
                    log(a, b, outcome)
                except Exception as error:
                    if is_programs(error):
                        raise
                return TRUE if outcome else FALSE
            except BaseException as error:
                return raising(error)

        return compare

    return at_once


def _linker(operation: str, reported: tuple[Reported, ...], held: Held) -> Function:
    """`link`: a link of a chain with others behind it. Its iterator gives the truth.

    It keeps the right operand for the next link, which gets it from `ComparisonSite.right`. Where
    the chain ends it keeps its outcome, which the program gets from `ComparisonSite.outcome`.
    """
    lazy = _LAZY_OPERATIONS[operation]
    log = logger(reported)

    def later(a: object, b: object, outcome: object, truth: bool) -> Iterator[bool]:
        try:
            log(a, b, truth)
        except BaseException as error:
            return raising(error)
        held[caller()] = b, outcome
        return TRUE if truth else FALSE

    def link(a: object, b: object) -> Iterator[bool]:
        outcome, again = tee(lazy(a, b))
        return flat(map(hidden(later), (a,), (b,), outcome, map(operator.truth, again)))

    return link


class FlagSite(Site):
    """A parameter that is a condition itself.

    `truth` is for a program that only tests it, `value` for one that keeps the value.
    """

    __slots__ = ("truth", "value")

    def __init__(self, reported: tuple[Reported, ...]) -> None:
        log = logger(reported)

        def later(value: object, truth: bool) -> Iterator[bool]:
            try:
                log(value, value, truth)
            except BaseException as error:
                return raising(error)
            return TRUE if truth else FALSE

        def truth(value: object) -> Iterator[bool]:
            return flat(map(hidden(later), (value,), map(operator.truth, (value,))))

        def value(value: object) -> Iterator[object]:
            try:
                known = truth_of(value)
                if known is None:
                    count_unknown()
                else:
                    log(value, value, known)
            except BaseException as error:
                return raising(error)
            return repeat(value)

        self.offer(truth=truth, value=value)
