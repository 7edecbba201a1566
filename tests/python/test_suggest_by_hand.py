"""Suggestions worked out by hand: each relation, both errors, thresholds computed in five ways.

The threshold is 25 and the compared values are 4 and 100. What would do is one of four sets of
thresholds T, whatever the relation:

    A: T <= 4    B: T < 4    C: T >= 100    D: T > 100

Type I. `cmp < 25` is False for 100 and True for 4. Had the flop been from False to True (100, then
4), both were False for T <= 100 and T <= 4: A. From True to False both are True for T > 4 and
T > 100: D. Likewise `<=`: both False for T < 4 (B), both True for T >= 100 (C); `>`: False to True
is 4, then 100: both False for T >= 100 (C), both True for T < 4 (B); `>=`: D and A.

Type II. With both values in the window one evaluation goes the other way where either does:
`<`: 4 < T is False for T <= 4, 100 < T is True for T > 100: A or D. `<=` and `>`: B or C; `>=`: A
or D.

The parameter x that gives T, and what the sets are in its unit:

    T = x         now 25   A x <= 4       B x < 4      C x >= 100           D x > 100
    T = 2x + 1    now 12   A x <= 1.5     B x < 1.5    C x >= 49.5          D x > 49.5
    T = 45 - 2x   now 10   A x >= 20.5    B x > 20.5   C x <= -27.5         D x < -27.5
    T = x^2       now 5    A -2..2        B within     C x <= -10, x >= 10  D beyond
    T = 100 / x   now 4    A x >= 25 or x < 0          C 0 < x <= 1         D 0 < x < 1
                                          B x > 25 or x < 0
"""

from __future__ import annotations

import pytest
from asking import suggested
from mission_samples import comparison, events

from pytpc.diagnosis.thresholds.intervals import words
from pytpc.static.link_unit import Transform

WAYS = {
    "x": (None, 25.0),
    "2x+1": (Transform("affine", 2.0, 1.0, "2 * x + 1"), 12.0),
    "45-2x": (Transform("affine", -2.0, 45.0, "45 - 2 * x"), 10.0),
    "x^2": (Transform("expression", text="x^2", tree=("pow", "x", 2.0)), 5.0),
    "100/x": (Transform("expression", text="100 / x", tree=("/", 100.0, "x")), 4.0),
}
SETS = {
    ("x", "A"): "at most 4",
    ("x", "B"): "below 4",
    ("x", "C"): "at least 100",
    ("x", "D"): "above 100",
    ("2x+1", "A"): "at most 1.5",
    ("2x+1", "B"): "below 1.5",
    ("2x+1", "C"): "at least 49.5",
    ("2x+1", "D"): "above 49.5",
    ("45-2x", "A"): "at least 20.5",
    ("45-2x", "B"): "above 20.5",
    ("45-2x", "C"): "at most -27.5",
    ("45-2x", "D"): "below -27.5",
    ("x^2", "A"): "from -2 to 2",
    ("x^2", "B"): "above -2 to below 2",
    ("x^2", "C"): "at most -10 or at least 10",
    ("x^2", "D"): "below -10 or above 10",
    ("100/x", "A"): "below 0 or at least 25",
    ("100/x", "B"): "below 0 or above 25",
    ("100/x", "C"): "above 0 to 1",
    ("100/x", "D"): "above 0 to below 1",
}
# The end itself where it does; else the next number of three digits.
VALUES = {
    "x": {"A": 4, "B": 3.99, "C": 100, "D": 101},
    "2x+1": {"A": 1.5, "B": 1.49, "C": 49.5, "D": 49.6},
    "45-2x": {"A": 20.5, "B": 20.6, "C": -27.5, "D": -27.6},
    "x^2": {"A": 2, "B": 1.99, "C": 10, "D": 10.1},
    "100/x": {"A": 25, "B": 25.1, "C": 1, "D": 0.999},
}
# Whole numbers of x: those beyond the ends.
WHOLE = {
    "x": {"A": 4, "B": 3, "C": 100, "D": 101},
    "2x+1": {"A": 1, "B": 1, "C": 50, "D": 50},
    "45-2x": {"A": 21, "B": 21, "C": -28, "D": -28},
    "x^2": {"A": 2, "B": 1, "C": 10, "D": 11},
    "100/x": {"A": 25, "B": 26, "C": 1},
}
# To True, then to False.
FIRST = {"<": ("A", "D"), "<=": ("B", "C"), ">": ("C", "B"), ">=": ("D", "A")}
SECOND = {"<": "AD", "<=": "BC", ">": "BC", ">=": "AD"}
LOW_FIRST = {"<": True, "<=": True, ">": False, ">=": False}


def ask(relation, cmps, kind, way, *, whole=False):
    transform, now = WAYS[way]
    kept = {"transform": transform, "type": "derived" if transform else "parameter"}
    found = comparison(0, "limit", relation, default=int(now) if whole else now, **kept)
    held = {"<": float.__lt__, "<=": float.__le__, ">": float.__gt__, ">=": float.__ge__}[relation]
    rows = [(90 + t, 0, held(float(cmp), 25.0), cmp, 25.0) for t, cmp in enumerate(cmps)]
    return suggested(events(rows), found, 100, kind)


def assert_is_across_zero(found, those):
    """Nothing is suggested that nobody would try, and what would do is said."""
    assert (found.value, found.direction) == (None, None)
    assert found.reason == f"only a value of the other sign would have prevented it: {those}"
    assert words(found.feasible) == those


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("relation", FIRST)
@pytest.mark.parametrize("to", [True, False], ids=["to-true", "to-false"])
def test_the_last_flop(way, relation, to):
    # `<` is True of 4, so that a flop to True is 100, then 4.
    cmps = (100, 4) if to == LOW_FIRST[relation] else (4, 100)
    name = FIRST[relation][0 if to else 1]
    found = ask(relation, cmps, "I", way)
    assert words(found.feasible) == SETS[way, name]
    assert found.current == WAYS[way][1]
    if VALUES[way][name] < 0:
        assert_is_across_zero(found, SETS[way, name])
        return
    assert found.value == VALUES[way][name]
    assert found.direction == ("raise" if found.value > found.current else "lower")


@pytest.mark.parametrize("way", ["x", "2x+1", "45-2x", "x^2", "100/x"])
@pytest.mark.parametrize("relation", FIRST)
@pytest.mark.parametrize("to", [True, False], ids=["to-true", "to-false"])
def test_the_last_flop_of_whole_numbers(way, relation, to):
    cmps = (100, 4) if to == LOW_FIRST[relation] else (4, 100)
    name = FIRST[relation][0 if to else 1]
    found = ask(relation, cmps, "I", way, whole=True)
    if name not in WHOLE[way]:
        # Between 0 and 1 there is none.
        assert found.reason == "no whole number would do: above 0 to below 1"
        assert words(found.feasible) == "above 0 to below 1"
        return
    if WHOLE[way][name] < 0:
        assert_is_across_zero(found, SETS[way, name])
        return
    assert type(found.value) is int
    assert found.value == WHOLE[way][name]


# The nearest of what would do: of x from 25 the 4, 21 away, not the 100; of 2x + 1 from 12 the 1.5;
# of 45 - 2x from 10 the 20.5 (10.5 away, and -27.5 is 37.5); of x^2 from 5 the 2 (3 away, 10 is 5);
# of 100 / x from 4 the 1 (3 away; below 0 is 4 away and turns the sign).
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("relation", SECOND)
def test_the_window(way, relation):
    found = ask(relation, (4, 100), "II", way)
    low, high = SECOND[relation]
    parts = set(f"{SETS[way, low]} or {SETS[way, high]}".split(" or "))
    if way == "100/x":
        # Below 0 and above 0 are apart by the 0 alone.
        end = {"A": "at least 25", "B": "above 25"}[low]
        parts = {"below 0", SETS[way, high], end}
    assert set(words(found.feasible).split(" or ")) == parts
    near = high if way == "100/x" else low
    assert found.value == VALUES[way][near]


# One value alone in the window: `4 < 25` goes the other way for T <= 4 alone; and so on.
@pytest.mark.parametrize(
    ("relation", "cmp", "name"),
    [
        ("<", 4, "A"), ("<", 100, "D"), ("<=", 4, "B"), ("<=", 100, "C"),
        (">", 4, "B"), (">", 100, "C"), (">=", 4, "A"), (">=", 100, "D"),
    ],
)  # fmt: skip
@pytest.mark.parametrize("way", WAYS)
def test_a_window_with_one_outcome(way, relation, cmp, name):
    found = ask(relation, (cmp, cmp), "II", way)
    assert words(found.feasible) == SETS[way, name]
    if VALUES[way][name] < 0:
        assert_is_across_zero(found, SETS[way, name])
        return
    assert found.value == VALUES[way][name]


# The sign: 100 / x <= 4 from x = 4 is nearer at any negative number, which nobody means.
def test_the_sign_is_kept_without_need():
    found = ask("<", (100, 4), "I", "100/x")
    assert (found.value, found.limited_by) == (25, "sign")
    assert found.text == "raise limit from 4 to 25 (at least 25; sign)"
    # With need it is not, which is said: 45 - 2x >= 100 has no positive x.
    found = ask(">", (4, 100), "I", "45-2x")
    assert_is_across_zero(found, "at most -27.5")
