"""The survey's figures: rows, statistics, order of the trees, and what counts as one comparison."""

import json
import math
from pathlib import Path
from typing import Any

import pytest
from static_units import KEYS, comparison, failed_unit, unit
from survey_samples import AFTER, BAD, build, found, result

from pytpc.base.errors import InputError
from pytpc.static.link_unit import LinkUnit
from pytpc_evaluation.survey.static_tables import tables
from pytpc_evaluation.survey.trees import (
    Tree,
    TreePackage,
    TreeResult,
    build_order,
    found_in,
    needed_trees,
)
from pytpc_evaluation.tables import statistics


def tree(name: str, **packages: str) -> Tree:
    """A tree with packages, each with the names that it needs, separated by spaces."""
    path = Path("/src") / name
    return Tree(
        name,
        path,
        tuple(
            TreePackage(package, path / package, "catkin", frozenset(needs.split()))
            for package, needs in packages.items()
        ),
    )


def units(*data: dict[str, Any]) -> list[LinkUnit]:
    return [LinkUnit.from_json(one, Path("x.json")) for one in data]


def test_statistics() -> None:
    # 2, 4, 9: mean 15/3, deviations -3, -1, 4, squares 9 + 1 + 16 = 26, over n - 1 = 2: 13.
    assert statistics([2, 4.0, 9]) == {
        "mean": 5.0,
        "median": 4.0,
        "std": pytest.approx(math.sqrt(13)),
        "min": 2.0,
        "max": 9.0,
        "sum": 15.0,
    }


def test_what_is_not_known_is_in_no_statistic() -> None:
    assert statistics([None, 6, "not analysed"]) == {
        "mean": 6.0,
        "median": 6.0,
        "std": None,
        "min": 6.0,
        "max": 6.0,
        "sum": 6.0,
    }
    assert set(statistics([None]).values()) == {None}


def test_the_first_table() -> None:
    results = [
        result("arm", 10.0, 15.0, found=found(4, python=2)),
        result("leg", 30.0, 33.0, found=found(1)),
    ]
    table = tables(results)[0]
    headings = [column.heading for column in table.columns]
    assert headings[:7] == ["Time", "Time Factor", "TPCs", "C++", "Python", "Unique", "Files"]
    assert table.rows[0] == ("arm", (10.0, 1.5, 6, 4, 2, 2, 2, 3, 0))
    assert table.rows[1] == ("leg", (30.0, pytest.approx(1.1), 1, 1, 0, 1, 1, 3, 0))
    summary = dict(table.summary)
    assert list(summary) == ["mean", "median", "std", "min", "max", "sum"]
    # The factor of the sums is 48 / 40, not 1.5 + 1.1.
    assert summary["sum"] == (40.0, pytest.approx(1.2), 7.0, 5.0, 2.0, 3.0, 3.0, 6.0, 0.0)
    assert summary["mean"][:4] == (20.0, pytest.approx(1.3), 3.5, 2.5)


def test_the_second_table() -> None:
    table = tables([result("arm", 1.0, 1.0)])[1]
    values = dict(zip((column.heading for column in table.columns), table.rows[0][1], strict=True))
    assert values == {
        "C++ Files": 2,
        "C++ Lines": 300,
        "Header Files": 1,
        "Header Lines": 50,
        "Python Files": 1,
        "Python Lines": 10,
        "Total Files": 4,
        "Total Lines": 360,
        "Other Files": 3,
        "Other Lines": 42,
    }


def test_builds_of_different_packages_are_not_compared() -> None:
    worse = result("arm", 10.0, build(12.0, BAD))
    assert [fault.package for fault in worse.broken] == ["bad"]
    assert worse.partial
    assert worse.factor("processor") is None
    same = result("arm", build(10.0, BAD, AFTER), build(12.0, BAD, AFTER))
    assert same.broken == ()
    assert same.partial
    assert same.factor("processor") == pytest.approx(1.2)
    nothing = result("arm", build(1.0, BAD), build(1.5, BAD), packages=1)
    assert nothing.factor("processor") is None
    assert result("arm", None, 12.0).factor("wall") is None


def test_a_factor_of_nothing_compiled_is_none() -> None:
    assert result("messages", 0.0, 1.0).factor("compile") is None


def test_one_place_in_several_units_is_one_comparison(tmp_path: Path) -> None:
    source = str(tmp_path / "arm")
    outside = comparison(key=KEYS[2], file="/usr/include/filter.h", source="other")
    node = unit(source_root=source, comparisons=[comparison(), outside])
    # The same line with the same parameter, from a second unit, whose root is elsewhere.
    again = comparison(key=KEYS[1], file="../arm/src/detector.cpp")
    second = unit(link_unit="second", source_root=str(tmp_path / "leg"), comparisons=[again])
    both = found_in(units(node, second), tmp_path, ["leg/native"])
    assert (both.comparisons, both.parameters, both.files, both.units) == (1, 1, 1, 2)
    assert both.without == ("leg/native",)


def test_columns_and_parameters_tell_comparisons_apart(tmp_path: Path) -> None:
    three = [
        comparison(),
        comparison(key=KEYS[1], column=40, source="max_coverage"),
        comparison(key=KEYS[2], type="constant", source=None, param_reads=[], read_at=None),
    ]
    counted = found_in(units(unit(source_root=str(tmp_path), comparisons=three)), tmp_path)
    assert (counted.comparisons, counted.parameters, counted.files) == (2, 2, 1)


def test_units_that_were_left_as_they_were_are_named(tmp_path: Path) -> None:
    counted = found_in(units(failed_unit(package="arm")), tmp_path, (), ["arm/a: a.json: torn"])
    assert counted.failed == (
        "arm/a: a.json: torn",
        "arm/broken: the instrumented module does not verify",
    )


def test_places_in_python_are_counted_apart(tmp_path: Path) -> None:
    """Two scripts share a module; the parameter and the file are counted once with C++'s."""
    tool = {**unit()["tool"], "analysis": "python"}
    scripts = [
        unit(
            source_root=str(tmp_path),
            tool=tool,
            link_unit=name,
            comparisons=[
                comparison(key=KEYS[0], file="src/limits.py"),
                comparison(key=KEYS[1], file=f"scripts/{name}.py", source="own", lineno=9),
                comparison(key=KEYS[2], type="constant", source=None, param_reads=[], read_at=None),
            ],
        )
        for name in ("one", "two")
    ]
    counted = found_in(units(unit(source_root=str(tmp_path)), *scripts), tmp_path)
    # limits.py, and a line of each script.
    assert (counted.comparisons, counted.python, counted.units) == (1, 3, 3)
    # min_coverage_limit and own; detector.cpp, limits.py, one.py, two.py.
    assert (counted.parameters, counted.files) == (2, 4)


def test_a_tree_is_built_after_what_it_needs() -> None:
    nav = tree("nav", planner="costmap tf", costmap="")
    geometry = tree("geometry", tf="roscpp")
    comm = tree("comm", roscpp="")
    apps = tree("apps", app="planner")
    assert [one.name for one in build_order([apps, nav, geometry, comm])] == [
        "comm",
        "geometry",
        "nav",
        "apps",
    ]
    needed = needed_trees([apps, nav, geometry, comm])
    assert needed["/src/apps"] == ("/src/comm", "/src/geometry", "/src/nav")
    assert needed["/src/geometry"] == ("/src/comm",)
    assert needed["/src/comm"] == ()


def test_trees_that_need_each_other_are_built_all_the_same() -> None:
    ring = [tree("user", u="a"), tree("one", a="b"), tree("two", b="a")]
    assert [one.name for one in build_order(ring)] == ["one", "user", "two"]
    assert needed_trees(ring) == {
        "/src/one": (),
        "/src/user": ("/src/one",),
        "/src/two": ("/src/one",),
    }


def test_a_package_that_two_trees_have_comes_from_the_first() -> None:
    old, new = tree("old", tf=""), tree("new", tf="", more="tf")
    user = tree("user", u="tf")
    assert needed_trees([user, old, new])["/src/user"] == ("/src/old",)
    assert needed_trees([user, old, new])["/src/new"] == ()


def test_a_result_is_read_as_it_was_written() -> None:
    first = result("arm", build(10.0, BAD), build(12.0, BAD), found=found(3, without=("arm/x",)))
    data = json.loads(json.dumps(first.to_json()))
    assert data["processor_factor"] == pytest.approx(1.2)
    assert TreeResult.from_json(data, Path("x.json")) == first
    without = result("arm", None, 12.0)
    assert TreeResult.from_json(json.loads(json.dumps(without.to_json())), Path()) == without


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"version": 0}, ": not a survey's result of this version"),
        ({"lines": 1}, ": /lines: 1 is not"),
        ({"tpc": None}, ": /tpc: None is not"),
        ({"packages": "x"}, ": /packages: 'x' is not"),
    ],
)
def test_what_is_no_result_is_refused(change: dict[str, Any], fault: str) -> None:
    data = {**json.loads(json.dumps(result("arm", 1.0, 1.0).to_json())), **change}
    with pytest.raises(InputError, match=f"x.json{fault}"):
        TreeResult.from_json(data, Path("x.json"))
