"""A program does the same with and without the hook (see `hook_programs`)."""

from __future__ import annotations

import ast

import pytest
from hook_places import others
from hook_programs import STATEMENTS, difference
from hook_samples import PATH, everywhere, outcome, reports, taking
from hypothesis import given, settings
from hypothesis import strategies as st

# What raises where its truth is asked for, and what compares to it.
RAISING = """class Raising:
    def __bool__(self): raise ValueError
class Odd:
    def __lt__(self, other): return Raising()
r, odd, y = Raising(), Odd(), 1
"""
CONDITIONS = [
    "if (r):\n  pass",
    "if (y and\n  r):\n  pass",
    "if (y < 3 and\n  r):\n  pass",
    "if not r:\n  pass",
    "if not y: pass\nelif r:\n  pass",
    "while r:\n  pass",
    "assert r",
    "x = [1, 2 if r else 3]",
    "x = [1, 2 if (y<2 and r) else 3]",
    "if (r if y else 2): pass",
    "if (odd < 2 if y else r): pass",
    "if (y < 2 if y else 3) and r: pass",
    "x = 1, [i for i in (1, 2) if i and r]",
    "x = list(i for i in (1, 2) if i < 3 if r)",
    "x = 1, (y and r and 2)",
    "x = 1, (not r)",
    "x = 1, (not (odd < 2))",
    "match y:\n  case 1 if r: pass",
    "if (w := r): pass",
    "if 1 < 2 < 3 and r: pass",
    "if str(y < 2) and r: pass",
]


@settings(max_examples=300, deadline=None)
@given(st.integers(min_value=0, max_value=2**40))
def test_a_program_does_the_same(seed: int) -> None:
    assert not difference(seed)


@pytest.mark.parametrize("condition", CONDITIONS)
def test_the_place_of_an_error_in_a_truth(condition: str) -> None:
    source = RAISING + condition + "\n"
    expected = outcome(compile(source, PATH, "exec"), {})
    with taking():
        assert outcome(everywhere(source), {}) == expected
    # It ends with the error, which comes from line 2.
    assert expected[0][0] == "ValueError"
    assert expected[0][2][-1][:2] == ("__bool__", 2)


def test_a_program_with_its_own_exception_has_the_same_traceback() -> None:
    source = "def f(a, b):\n    return 1 < (a\n        < b)\nf(1, None)\n"
    expected = outcome(compile(source, PATH, "exec"), {})
    with taking():
        assert outcome(everywhere(source), {}) == expected
    # In line 2, from the `a` of `a < b` to line 3.
    assert expected[0][2][-1][:3] == ("f", 2, 3)


def test_a_condition_that_is_chosen_asks_once() -> None:
    source = (
        "asked = []\nclass Asked:\n    def __bool__(self):\n        asked.append(1)\n"
        "        return False\na = Asked()\nif (a and 1) if asked == [] else a:\n    pass\n"
        "assert asked == [1]\n"
    )
    flag = next(one for one in others(ast.parse(source)) if one.key.startswith("7:4:7:35"))
    # The parts of `a and 1` are asked by themselves; `a` behind `else` is not evaluated.
    assert reports(source, flag) == []


def test_a_match_with_a_default_within_with_has_the_same_lines() -> None:
    source = (
        "from contextlib import nullcontext\nx = 3\nwith nullcontext():\n    match x:\n"
        "        case 1:\n            pass\n        case _:\n            print(end='')\n"
    )
    expected = outcome(compile(source, PATH, "exec"), {})
    with taking() as taken:
        assert outcome(everywhere(source), {}) == expected
    # The case 1 is compared, then the subject is no case's.
    assert [row[1] for row in taken.rows] == [False, False]


def test_a_range_that_is_longer_than_c_counts() -> None:
    source = "for i in range(10**30):\n    if i == 2:\n        break\n"
    (loop,) = [one for one in others(ast.parse(source)) if one.key.endswith("loop")]
    # Turns 0, 1 and 2, and no end behind a `break`.
    assert reports(source, loop) == [
        (loop.key, True, 0.0, 1e30, True),
        (loop.key, True, 1.0, 1e30, True),
        (loop.key, True, 2.0, 1e30, True),
    ]


def test_loops_of_the_programs_end() -> None:
    (loop,) = [text for text in STATEMENTS if text.startswith("for i in range")]
    source = loop.replace("@v if @e else 2", "10**400").replace("@v", "10**400").replace("#", "1")
    names: dict[str, list[int]] = {"log": []}
    exec(source, names)
    assert names["log"] == [0, 1, 2, 3, 4]
