"""One place in the source that several link units have, as one TPC with several keys."""

from pathlib import Path
from typing import Any

from static_units import KEYS, comparison, unit

from pytpc.static.link_unit import LinkUnit
from pytpc.static.places import KeyIn, merge_places

HEADER = "/ws/install/include/common/limits.h"
ORIGINAL = "/ws/src/common/include/common/limits.h"


def units(*data: dict[str, Any]) -> list[LinkUnit]:
    return [LinkUnit.from_json(each, Path("x.json")) for each in data]


def two_units(**second: Any) -> list[LinkUnit]:
    """The same comparison in two nodes of one package, the second one with changes."""
    return units(
        unit(comparisons=[comparison(distance=3)]),
        unit(link_unit="other", comparisons=[comparison(key=KEYS[1], distance=2, **second)]),
    )


def test_a_source_file_of_two_targets_is_one_place_with_two_keys() -> None:
    (tpc,) = merge_places(two_units())
    # The nearest first: distance 2 is in the second unit.
    assert tpc.keys == (
        KeyIn(KEYS[1], "face", "other", 2),
        KeyIn(KEYS[0], "face", "detector", 3),
    )
    assert (tpc.key, tpc.distance) == (KEYS[1], 2)
    assert tpc.link_units == ("face/detector", "face/other")
    assert (tpc.file, tpc.place) == ("/ws/src/face/src/detector.cpp", "src/detector.cpp")


def test_whatever_differs_in_the_place_is_another_tpc() -> None:
    differing: list[dict[str, Any]] = [
        {"file": "src/other.cpp"},
        {"lineno": 41},
        {"column": 17},
        {"source": "other_limit"},
        {"relation": ">="},
        {"type": "flag", "relation": "flag"},
    ]
    for change in differing:
        assert len(merge_places(two_units(**change))) == 2, change


def test_what_may_differ_between_units_of_one_place() -> None:
    # A topic that is remapped by the constructor's argument, another variable, another function.
    change = {"topic": None, "name": "limit_", "function": "f<int>()", "default": 7}
    assert len(merge_places(two_units(**change))) == 1


def test_constants_are_told_apart_by_what_they_are() -> None:
    constant: dict[str, Any] = {
        "type": "constant", "source": None, "read_at": None, "param_reads": [], "default": None,
    }  # fmt: skip
    found = merge_places(
        units(
            unit(
                comparisons=[
                    comparison(name="7", **constant),
                    comparison(key=KEYS[1], name="8", **constant),
                ]
            ),
            unit(link_unit="other", comparisons=[comparison(key=KEYS[2], name="7", **constant)]),
        )
    )
    assert [(tpc.parameter, tpc.name, len(tpc.keys)) for tpc in found] == [
        (None, "7", 2),
        (None, "8", 1),
    ]


def header_users() -> list[LinkUnit]:
    """The package's own test of its header, and a node of another package that has a copy."""
    return units(
        unit(
            package="common",
            source_root="/ws/src/common",
            comparisons=[comparison(file="include/common/limits.h")],
        ),
        unit(
            package="arm",
            source_root="/ws/src/arm",
            comparisons=[comparison(key=KEYS[1], file=HEADER)],
        ),
    )


def test_a_copy_is_the_file_that_it_is_a_copy_of() -> None:
    (tpc,) = merge_places(header_users(), {HEADER: ORIGINAL})
    assert (tpc.file, tpc.package, tpc.place) == (ORIGINAL, "common", "include/common/limits.h")
    assert [each.package for each in tpc.keys] == ["arm", "common"]


def test_without_a_known_original_two_files_are_two_places() -> None:
    found = merge_places(header_users())
    assert [(tpc.package, tpc.place) for tpc in found] == [
        ("arm", HEADER),
        ("common", "include/common/limits.h"),
    ]


def test_the_owner_is_the_package_of_the_innermost_folder() -> None:
    outer, inner = units(
        unit(source_root="/ws", comparisons=[comparison(file="inner/a.cpp", distance=1)]),
        unit(
            package="inner",
            source_root="/ws/inner",
            comparisons=[comparison(key=KEYS[1], file="a.cpp", distance=2)],
        ),
    )
    (tpc,) = merge_places([outer, inner])
    assert (tpc.package, tpc.place, tpc.distance) == ("inner", "a.cpp", 1)


def test_the_order_does_not_depend_on_that_of_the_units() -> None:
    given = header_users()
    assert merge_places(given) == merge_places(reversed(given))
