"""The reports of a rewritten program, worked out by hand from its text."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hook_samples import instrumented, listed, register, reports, taking

from pytpc.python_runtime import sites
from pytpc.python_runtime.rewrite import rewrite


def test_a_comparison_reports_both_sides_and_its_outcome() -> None:
    source = "limit = 3\nfor x in (2, 4.5):\n    if x > limit:\n        pass\n"
    # 2 > 3 is false, 4.5 > 3 is true.
    assert reports(source, listed(3, 8, ">")) == [
        ("3:8", False, 2.0, 3.0, False),
        ("3:8", True, 4.5, 3.0, True),
    ]


def test_the_threshold_may_be_the_left_operand() -> None:
    # `limit < x` is `x > limit` with the threshold on the right-hand side, as the relation has it.
    source = "limit = 3\nx = 5\ny = limit < x\n"
    assert reports(source, listed(3, 5, ">")) == [("3:5", True, 5.0, 3.0, True)]


@pytest.mark.parametrize(
    ("source", "changes", "cmp", "thresh"),
    [
        ("x = 5\nself_limit = 3\nx == self_limit\n", {"operand": "right"}, 5.0, 3.0),
        ("x = 5\nself_limit = 3\nself_limit == x\n", {"operand": "left"}, 5.0, 3.0),
        # Without the operand the name of the threshold tells it.
        ("x = 5\nself_limit = 3\nself_limit == x\n", {"name": "self_limit"}, 5.0, 3.0),
        ("x = 5\nself_limit = 3\nself_limit == 5\n", {}, 5.0, 3.0),
    ],
)
def test_the_side_of_the_threshold_of_an_equality(source, changes, cmp, thresh) -> None:
    ((_, _, found_cmp, found_thresh, _),) = reports(source, listed(3, 1, "==", **changes))
    assert (found_cmp, found_thresh) == (cmp, thresh)


def test_two_parameters_in_one_comparison() -> None:
    source = "low = 1\nhigh = 2\nlow < high\n"
    of_high = listed(3, 1, "<", key="high")
    of_low = listed(3, 1, ">", key="low")
    assert reports(source, of_high, of_low) == [
        ("high", True, 1.0, 2.0, True),
        ("low", True, 2.0, 1.0, True),
    ]


def test_links_of_a_chain() -> None:
    source = "for x in (0, 5, 20):\n    if 1 < x < 10 != 11:\n        pass\n"
    # Columns: `1` 8, `x` 12, `10` 16. For 0 the chain ends with its first link, for 20 with its
    # second; the third is not listed.
    assert reports(source, listed(2, 8, ">"), listed(2, 12, "<")) == [
        ("2:8", False, 0.0, 1.0, False),
        ("2:8", True, 5.0, 1.0, True),
        ("2:12", True, 5.0, 10.0, True),
        ("2:8", True, 20.0, 1.0, True),
        ("2:12", False, 20.0, 10.0, False),
    ]


def test_a_later_link_alone() -> None:
    source = "calls = []\ndef t(x):\n    calls.append(x)\n    return x\nr = t(1) < t(2) < t(3)\n"
    names: dict[str, object] = {}
    with taking() as taken:
        exec(instrumented(source, listed(5, 12, "<")), names)
    assert names["calls"] == [1, 2, 3]
    assert names["r"] is True
    assert taken.rows == [("5:12", True, 2.0, 3.0, True)]


def test_what_is_not_evaluated_is_not_reported() -> None:
    source = "a, b = 1, 2\nif a > 5 and b > 1:\n    pass\n"
    assert reports(source, listed(2, 4, ">"), listed(2, 14, ">")) == [
        ("2:4", False, 1.0, 5.0, False)
    ]


def test_flags() -> None:
    source = (
        "class S: pass\n"
        "self = S()\n"
        "self.on, off, text = 2, 0, ''\n"
        "if self.on and not off:\n"
        "    x = text or off or 7\n"
    )
    places = [(4, 4), (4, 20), (5, 9), (5, 17)]
    # A flag has its value as both numbers; a text its truth. `not` is no part of it.
    assert reports(source, *(listed(*place, "flag") for place in places)) == [
        ("4:4", True, 2.0, 2.0, True),
        ("4:20", False, 0.0, 0.0, False),
        ("5:9", False, 0.0, 0.0, False),
        ("5:17", False, 0.0, 0.0, False),
    ]


def test_a_flag_as_a_value_stays_the_value() -> None:
    names: dict[str, object] = {"flag": [1]}
    with taking():
        exec(instrumented("x = flag or 3\n", listed(1, 5, "flag")), names)
    assert names["x"] is names["flag"]


def test_walrus_ternary_comprehension_assert_lambda() -> None:
    source = (
        "n = 3\n"
        "if (m := n) > 2: pass\n"
        "y = 1 if n < 2 else 0\n"
        "z = [i for i in (1, 9) if i > n]\n"
        "assert n >= 3\n"
        "f = lambda x: x != n\n"
        "f(4)\n"
    )
    places = [(2, 4, ">"), (3, 10, "<"), (4, 27, ">"), (5, 8, ">="), (6, 15, "!=")]
    found = reports(source, *(listed(*place) for place in places))
    assert [(row[0], row[1], row[2], row[3]) for row in found] == [
        ("2:4", True, 3.0, 2.0),
        ("3:10", False, 3.0, 2.0),
        ("4:27", False, 1.0, 3.0),
        ("4:27", True, 9.0, 3.0),
        ("5:8", True, 3.0, 3.0),
        ("6:15", True, 4.0, 3.0),
    ]


def test_a_loop_over_a_range() -> None:
    source = (
        "for i in range(2):\n    pass\nfor j in range(9):\n    break\nfor k in [1]:\n    pass\n"
    )
    found = reports(source, listed(1, 10, "<"), listed(3, 10, "<"), listed(5, 10, "<"))
    # A loop that is left has no end; what is no range is no comparison.
    assert found == [
        ("1:10", True, 0.0, 2.0, True),
        ("1:10", True, 1.0, 2.0, True),
        ("1:10", False, 2.0, 2.0, False),
        ("3:10", True, 0.0, 9.0, True),
    ]


def test_match_on_a_parameter_and_with_one_among_the_values() -> None:
    source = (
        "def f(mode, Limits):\n"
        "    match mode:\n"
        "        case 'slow' if Limits: r = 1\n"
        "        case Limits.level | 7: r = 2\n"
        "        case _: r = 3\n"
        "    match mode:\n"
        "        case 1: r += 10\n"
        "    return r\n"
        "got = [f(mode, L) for mode in ('slow', 4, 7, 9)]\n"
    )
    names: dict[str, object] = {"L": SimpleNamespace(level=4)}
    places = [listed(2, 11, "flag"), listed(4, 14, "==", operand="right"), listed(6, 11, "flag")]
    with taking() as taken:
        exec(instrumented(source, *places), names)
    assert names["got"] == [1, 2, 2, 3]
    # The last case of the first `match` takes everything: as `default:` of C, it is no case.
    assert [row[:4] for row in taken.rows] == [
        ("2:11", True, 1.0, 1.0),
        ("6:11", False, 0.0, 0.0),
        ("4:14", True, 4.0, 4.0),
        ("2:11", True, 4.0, 4.0),
        ("6:11", False, 4.0, 4.0),
        ("4:14", False, 7.0, 4.0),
        ("2:11", True, 7.0, 7.0),
        ("6:11", False, 7.0, 7.0),
        ("4:14", False, 9.0, 4.0),
        ("2:11", False, 9.0, 9.0),
        ("6:11", False, 9.0, 9.0),
    ]


def test_a_value_within_a_pattern_is_said_not_to_be_reported() -> None:
    source = "match x:\n    case (Limits.level, 1): pass\n"
    place = listed(2, 11, "==")
    rewritten = rewrite(source, "p.py", (place,), register)
    assert (rewritten.instrumented, rewritten.unsupported) == (0, [place])


@pytest.mark.parametrize(
    ("left", "right", "result", "cmp", "thresh"),
    [
        ("True", "2", True, 1.0, 2.0),
        ("10**400", "1", False, math.inf, 1.0),
        ("-10**400", "1", True, -math.inf, 1.0),
        ("np.float32(0.5)", "1", True, 0.5, 1.0),
        ("np.int64(3)", "1", False, 3.0, 1.0),
        # Texts, and what is no number, have the outcome as both.
        ("'a'", "'b'", True, 1.0, 1.0),
        ("(2,)", "(1,)", False, 0.0, 0.0),
    ],
)
def test_numbers(left, right, result, cmp, thresh) -> None:
    found = reports(f"{left} < {right}\n", listed(1, 1, "<"), np=np)
    assert found == [("1:1", result, cmp, thresh, result)]


def test_nan_and_none() -> None:
    ((_, result, cmp, thresh, _),) = reports("nan < 1\n", listed(1, 1, "<"), nan=math.nan)
    assert (result, math.isnan(cmp), thresh) == (False, True, 1.0)
    assert reports("x is None\n", listed(1, 1, "=="), x=None) == [("1:1", True, 1.0, 1.0, True)]


def test_a_duration_of_ros_is_its_seconds() -> None:
    class Duration:
        def __init__(self, secs, nsecs):
            self.secs, self.nsecs = secs, nsecs

        def __lt__(self, other):
            return (self.secs, self.nsecs) < (other.secs, other.nsecs)

    Duration.__module__ = "genpy.rostime"
    found = reports("a < b\n", listed(1, 1, "<"), a=Duration(1, 500_000_000), b=Duration(2, 0))
    assert found == [("1:1", True, 1.5, 2.0, True)]


def test_an_outcome_without_a_truth_is_not_asked() -> None:
    array = np.array([1, 5])
    names: dict[str, object] = {"array": array}
    with taking() as taken:
        exec(instrumented("mask = array > 3\n", listed(1, 8, ">")), names)
    assert list(names["mask"]) == [False, True]
    assert taken.rows == []
    with taking(), pytest.raises(ValueError, match="ambiguous"):
        exec(instrumented("if array > 3: pass\n", listed(1, 4, ">")), {"array": array})


def test_methods_are_called_once_and_by_the_program() -> None:
    source = (
        "import sys\n"
        "calls = []\n"
        "class Own:\n"
        "    def __gt__(self, other):\n"
        "        calls.append(('gt', sys._getframe(1).f_code.co_name))\n"
        "        return self\n"
        "    def __bool__(self):\n"
        "        calls.append(('bool', sys._getframe(1).f_code.co_name))\n"
        "        return True\n"
        "    def __float__(self):\n"
        "        calls.append('float')\n"
        "        return 1.0\n"
        "def caller():\n"
        "    if Own() > 3:\n"
        "        return 1\n"
        "caller()\n"
    )
    names: dict[str, object] = {}
    with taking() as taken:
        exec(instrumented(source, listed(14, 8, ">")), names)
    assert names["calls"] == [("gt", "caller"), ("bool", "caller")]
    assert taken.rows == [("14:8", True, 1.0, 1.0, True)]


def test_operands_are_released_as_before() -> None:
    source = (
        "import weakref\n"
        "class Own:\n"
        "    def __lt__(self, other): return True\n"
        "def g():\n"
        "    o = Own()\n"
        "    r = weakref.ref(o)\n"
        "    x = [o].pop() < 1 < 2\n"
        "    del o\n"
        "    return r()\n"
        "left = g()\n"
    )
    names: dict[str, object] = {}
    with taking():
        exec(instrumented(source, listed(7, 9, "<"), listed(7, 21, "<")), names)
    assert names["left"] is None


def test_a_report_that_fails_is_not_the_programs_error() -> None:
    def broken(*_: object) -> None:
        raise OSError("disk")

    with taking():
        sites.set_take(broken)
        exec(instrumented("r = 1 < 2\n", listed(1, 5, "<")), names := {})
    assert names["r"] is True


def test_optimised_and_future_and_docstring() -> None:
    source = (
        '"""doc"""\n'
        "from __future__ import annotations\n"
        "assert x > 3\n"
        "y: int = 1 if __debug__ else 2\n"
    )
    code = rewrite(source, "p.py", (listed(3, 8, ">"),), register, optimize=1).code
    names: dict[str, object] = {"x": 0}
    with taking() as taken:
        exec(code, names)
    assert (names["__doc__"], names["y"], taken.rows) == ("doc", 2, [])
    assert names["__annotations__"] == {"y": "int"}
    without: dict[str, object] = {"x": 0}
    exec(rewrite(source, "p.py", (listed(3, 8, ">"),), register, optimize=2).code, without)
    assert without.get("__doc__") is None


def test_a_comparison_that_is_not_there_is_missing() -> None:
    wrong_place, wrong_relation = listed(1, 2, "<"), listed(1, 1, "==")
    rewritten = rewrite("a < b\n", "p.py", (wrong_place, wrong_relation), register)
    assert (rewritten.instrumented, rewritten.missing) == (0, [wrong_place, wrong_relation])


def test_positions_count_bytes() -> None:
    # The two letters before the comparison take four bytes.
    source = "y = 'äö' if 1 < 2 else 0\n"
    assert reports(source, listed(1, 15, "<")) == [("1:15", True, 1.0, 2.0, True)]


def test_the_stack_that_a_method_sees_is_as_before() -> None:
    source = (
        "import sys\n"
        "seen = []\n"
        "class Own:\n"
        "    def __lt__(self, other):\n"
        "        frame = sys._getframe()\n"
        "        while frame.f_code.co_name != '<module>':\n"
        "            seen.append(frame.f_code.co_name)\n"
        "            frame = frame.f_back\n"
        "        return True\n"
        "def caller():\n"
        "    return Own() < 1\n"
        "caller()\n"
    )
    names: dict[str, object] = {}
    with taking():
        exec(instrumented(source, listed(11, 12, "<")), names)
    assert names["seen"] == ["__lt__", "caller"]
