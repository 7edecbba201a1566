"""The quick validator of static information refuses what the slow one refuses, and says as much."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from static_units import comparison, unit

from pytpc.base import checked_json
from pytpc.base.checked_json import UNIT_SCHEMA, check_unit
from pytpc.base.errors import InputError

PATH = Path("unit.json")
KEY = "6f1c0f4e-7a1b-5c3d-8e2f-{:012x}"


def large(count: int = 10_000) -> dict[str, Any]:
    """A unit with so many comparisons."""
    return unit(comparisons=[comparison(key=KEY.format(number)) for number in range(count)])


def test_the_place_of_a_fault_among_10000_comparisons_is_named() -> None:
    found = large()
    found["comparisons"][9_876]["path"][1]["lineno"] = "forty"
    with pytest.raises(InputError) as caught:
        check_unit(found, PATH, "/units/3")
    assert str(caught.value) == (
        "unit.json: /units/3/comparisons/9876/path/1/lineno: 'forty' is not of type 'integer'"
        "; if another version of TPC wrote it, rebuild with `pytpc build`"
    )


def test_a_fault_of_the_whole_comes_before_those_of_its_items() -> None:
    found = large(50)
    found["comparisons"][40]["lineno"] = None
    del found["package"]
    with pytest.raises(InputError, match="/: 'package' is a required property"):
        check_unit(found, PATH)


def test_a_unit_that_failed_has_no_comparisons_however_many_it_has() -> None:
    with pytest.raises(InputError, match="is expected to be empty"):
        check_unit({**large(3), "status": "failed", "failure": "no memory"}, PATH)


@pytest.mark.parametrize("lineno", [5.0, 40.5, True, 10**30, -1])
def test_a_line_is_a_whole_number_that_can_be_counted_with(lineno: object) -> None:
    found = unit(comparisons=[comparison(lineno=lineno)])
    if lineno == 10**30:
        check_unit(found, PATH)
        return
    with pytest.raises(InputError, match="/comparisons/0/lineno: "):
        check_unit(found, PATH)


def places(value: object, above: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    """The path of each value in a document."""
    if isinstance(value, dict):
        below = list(value.items())
    elif isinstance(value, list):
        below = list(enumerate(value))
    else:
        return [above]
    return [above, *(place for key, item in below for place in places(item, (*above, key)))]


UNIT = unit()
WRONG = st.none() | st.booleans() | st.integers(-2, 5) | st.floats(0, 9).map(round).map(float)
WRONG |= st.text(max_size=4) | st.just([]) | st.just({}) | st.just("a\nb\0") | st.just("x\n")


@settings(max_examples=400, deadline=None)
@given(st.sampled_from([place for place in places(UNIT) if place]), WRONG)
def test_both_validators_agree(place: tuple[str | int, ...], value: object) -> None:
    found: Any = copy.deepcopy(UNIT)
    holder = found
    for step in place[:-1]:
        holder = holder[step]
    holder[place[-1]] = value
    slow = checked_json._validator(UNIT_SCHEMA, "pytpc.base").is_valid(found)
    quick = checked_json._quick_validator(UNIT_SCHEMA, "pytpc.base").is_valid(found)
    # The slow one decides what the quick one refuses; so it may refuse more, never less.
    assert slow or not quick
