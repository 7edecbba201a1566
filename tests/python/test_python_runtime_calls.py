"""Comparisons inside library functions: what they report, and that the calls do not change."""

from __future__ import annotations

import math
import operator
from typing import Any

import numpy as np
import pytest
from hook_samples import PATH, instrumented, listed, outcome, reports, taking, without_addresses

from pytpc.python_runtime import sites

# Text of the call, relation, operand -> cmp, thresh, outcome.
CALLS: dict[tuple[str, str, str], tuple[float, float, bool]] = {
    # min(a, b) gives b where b < a.
    ("min(5, 3)", ">", "choice 2"): (5.0, 3.0, True),
    ("min(2, 3)", ">", "choice 2"): (2.0, 3.0, False),
    ("min(3, 2)", "<", "choice 1"): (2.0, 3.0, True),
    ("min(9, 8.5, 3)", ">", "choice 3"): (8.5, 3.0, True),
    ("min(3, 8.5, 9)", "<", "choice 1"): (8.5, 3.0, False),
    # max(a, b) gives b where b > a.
    ("max(1, 3)", "<", "choice 2"): (1.0, 3.0, True),
    ("max(3, 4)", ">", "choice 1"): (4.0, 3.0, True),
    ("max(1, 2, 3)", "<", "choice 3"): (2.0, 3.0, True),
    ("max(2**53 + 1, 2**53)", "<", "choice 2"): (2.0**53, 2.0**53, False),
    ("np.minimum(5, np.float64(3))", ">", "choice 2"): (5.0, 3.0, True),
    ("np.clip(7, 1, 5)", "<", "choice 2 of 1"): (7.0, 1.0, False),
    ("np.clip(7, 1, 5)", ">", "choice 3 of 1"): (7.0, 5.0, True),
    ("np.clip(0, a_max=5, a_min=1)", "<", "choice a_min of 1"): (0.0, 1.0, True),
    ("operator.gt(5, 3)", ">", "argument 2"): (5.0, 3.0, True),
    ("operator.gt(5, 3)", "<", "argument 1"): (3.0, 5.0, True),
    ("operator.eq('a', 'b')", "==", "argument 2"): (0.0, 0.0, False),
    ("np.less(1, 2)", "<", "argument 2"): (1.0, 2.0, True),
    ("math.isclose(5, 5.25, abs_tol=0.5)", "==", "argument 2"): (5.0, 5.25, True),
    ("math.isclose(5, 6, abs_tol=0.5)", "<=", "within abs_tol"): (1.0, 0.5, False),
}


@pytest.mark.parametrize("call", CALLS)
def test_what_is_reported(call: tuple[str, str, str]) -> None:
    text, relation, operand = call
    place = listed(1, 5, relation, end_lineno=1, end_column=5 + len(text), operand=operand)
    cmp, thresh, res = CALLS[call]
    names = {"np": np, "math": math, "operator": operator}
    assert reports(f"y = {text}\n", place, **names) == [("1:5", res, cmp, thresh, res)]


def test_both_bounds_of_one_call() -> None:
    text = "y = np.clip(x, 1, 5)\n"
    where = {"end_lineno": 1, "end_column": 21}
    low = listed(1, 5, "<", key="low", operand="choice 2 of 1", **where)
    high = listed(1, 5, ">", key="high", operand="choice 3 of 1", **where)
    assert reports(text, low, high, np=np, x=9) == [
        ("low", False, 9.0, 1.0, False),
        ("high", True, 9.0, 5.0, True),
    ]


def test_the_call_is_told_by_its_end() -> None:
    # Three calls begin in column 1; the inner one is the one of the first argument.
    text = "f(1, 2)(3, 4)(5, 6)\n"
    place = listed(1, 1, "<", end_lineno=1, end_column=14, operand="argument 2")
    less = operator.lt
    names = {"f": lambda *_: lambda a, b: (less(a, b) and less) or less}
    with taking() as taken:
        exec(instrumented(text, place), dict(names))
    # It gives a function, whose truth only the program may ask for.
    assert taken.rows == []


def test_arrays_and_texts_are_counted_and_not_reported() -> None:
    before = sites.unknown_outcomes()
    array = np.array([1.0, 9.0])
    choice = listed(1, 5, ">", end_lineno=1, end_column=21, operand="choice 2")
    assert reports("y = np.minimum(a, 3)\n", choice, np=np, a=array) == []
    argument = listed(1, 5, ">", end_lineno=1, end_column=21, operand="argument 2")
    assert reports("y = np.greater(a, 3)\n", argument, np=np, a=array) == []
    text = listed(1, 5, ">", end_lineno=1, end_column=18, operand="choice 2")
    assert reports("y = min('a', 'b')\n", text) == []
    assert sites.unknown_outcomes() == before + 3


def test_a_flag_and_a_call_at_one_place() -> None:
    place = listed(1, 4, ">", key="call", end_lineno=1, end_column=13, operand="choice 2")
    flag = listed(1, 4, "flag", key="flag", end_lineno=1, end_column=13)
    assert reports("if min(x, 2):\n    pass\n", place, flag, x=5) == [
        ("call", True, 5.0, 2.0, True),
        ("flag", True, 2.0, 2.0, True),
    ]


SIDES = """log = []
def t(number, value):
    log.append(number)
    return value
class Odd:
    def __init__(self, name, fails=False):
        self.name, self.fails = name, fails
    def __lt__(self, other):
        import sys
        log.append(("lt", self.name, sys._getframe(1).f_code.co_name, sys._getframe(1).f_lineno))
        if self.fails:
            raise ValueError(self.name)
        return False
def run():
    return {call}
try:
    log.append(run())
except StopIteration as error:
    log.append(repr(error))
"""
SAME = {
    "t(0, min)(t(1, 5), t(2, 3))": "choice 2",
    "t(0, min)(t(1, 5), t(2, 3), key=t(3, lambda x: -x))": "choice 2",
    "t(0, min)(*t(1, [5, 3]))": "choice 2",
    "t(0, max)(\n        t(1, 5), t(2, 3),\n        key=t(3,\n              abs))": "choice 2",
    "min(Odd('a'), Odd('b'))": "choice 2",
    "min(Odd('a'), Odd('b', True))": "choice 2",
    "min(\n        Odd('a'),\n        t(1, Odd('b', True)))": "choice 2",
    "t(0, 5)(t(1, 1), t(2, 2))": "choice 2",
    "t(0, 5)(t(1, 1), key=t(2, 2))": "choice 2",
    "min(t(1, 1), t(2, 2), keys=3)": "choice 2",
    "t(0, next)(t(1, iter(())))": "argument 1",
    "min(t(1, 1), t(2, 1 / 0))": "choice 2",
    "t(0, lambda a, b: a < b)(Odd('a', True), 2)": "argument 2",
    "[i for i in (1, 2) if min(i, t(1, 2)) > 1]": None,
}


@pytest.mark.parametrize("call", SAME)
def test_the_program_does_the_same(call: str) -> None:
    source = SIDES.replace("{call}", call)
    at = source[: source.index("return " + call)].count("\n") + 1
    lines = call.split("\n")
    column = 12 + (call.index("min(i") if SAME[call] is None else 0)
    end = column + len("min(i, t(1, 2))") if SAME[call] is None else len(lines[-1]) + 1
    if SAME[call] is not None and len(lines) == 1:
        end = column + len(call)
    place = listed(
        at, column, ">", end_lineno=at + len(lines) - 1, end_column=end,
        operand=SAME[call] or "choice 1",
    )  # fmt: skip
    plain: dict[str, Any] = {}
    reporting: dict[str, Any] = {}
    before = outcome(compile(source, PATH, "exec"), plain)
    with taking():
        after = outcome(instrumented(source, place), reporting)
    assert after == before
    assert without_addresses(repr(reporting["log"])) == without_addresses(repr(plain["log"]))


def test_numbers_of_derived_classes_are_read_by_their_base() -> None:
    place = listed(1, 5, ">", end_lineno=1, end_column=14, operand="choice 2")
    asked: list[str] = []

    class Int(int):
        def __lt__(self, other: object) -> bool:
            asked.append("lt")
            return int.__lt__(self, other)  # type: ignore[operator]

    assert reports("y = min(x, p)\n", place, x=Int(5), p=Int(3)) == [("1:5", True, 5.0, 3.0, True)]
    # `min` asks once, the report never.
    assert asked == ["lt"]
