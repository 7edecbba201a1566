"""A parameter that is read, compared and exposed in three link units of one process."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from static_units import KEYS, comparison, not_exposed, spot, step, unit

from pytpc.cli.main import main
from pytpc.conditions.lookup import look_up_conditions
from pytpc.conditions.sarif import sarif_log
from pytpc.conditions.tpc_details import Details, details
from pytpc.present.page.catalogue import render
from pytpc.present.page.source import way_of
from pytpc.static.across import across, changes, units_of
from pytpc.static.coverage import Covered, coverage
from pytpc.static.link_unit import LinkUnit, PathStep
from pytpc.static.static_info import StaticInfo

DRIVE, FIELD = "robot/drive", "robot/drive@field"


def read(name: str, lineno: int) -> dict[str, Any]:
    (sample,) = unit()["parameters"]
    return {**sample, "name": name, "file": "src/limits.cpp", "lineno": lineno}


def path() -> list[dict[str, Any]]:
    return [
        step("read", 3, "far read", file="/ws/src/nav/src/limits.cpp", unit="nav/limits"),
        {**step("omitted", 0, "4 steps left out", file="", source_code=None), "column": 0},
        step("compare", 7, "compared: x > far", file="src/direct.cpp", unit="nav/direct"),
        step("expose", 9, "published", file="/ws/src/robot/src/drive.cpp", unit=DRIVE),
    ]


# nav/limits reads far (line 3), near (4), off (5) and gain (6). nav/direct compares far (line 7)
# and near (line 8, in the process of the field alone), off without effect, and loses gain. Its own
# comparison, with inner, stays in it.
def sample() -> list[dict[str, Any]]:
    place = {"file": "src/direct.cpp", "function": "Direct::mayGo()"}
    return [
        unit(
            link_unit="limits",
            package="nav",
            source_root="/ws/src/nav",
            processes=[DRIVE, FIELD],
            parameters=[read(n, at) for at, n in enumerate(("far", "near", "off", "gain"), 3)],
            exposing=[],
            comparisons=[],
            blind_spots=[spot("lost_value", "far", 30, "used as an index")],
        ),
        unit(
            link_unit="direct",
            package="nav",
            source_root="/ws/src/nav",
            processes=[DRIVE, FIELD],
            parameters=[{**read("inner", 2), "file": "src/direct.cpp"}],
            comparisons=[
                comparison(
                    **place,
                    source="far",
                    lineno=7,
                    param_reads=[{"file": "src/limits.cpp", "lineno": 3}],
                    path=path(),
                    processes=[DRIVE, FIELD],
                ),
                comparison(
                    **place,
                    key=KEYS[1],
                    source="near",
                    lineno=8,
                    param_reads=[{"file": "src/limits.cpp", "lineno": 4}],
                    processes=[FIELD],
                ),
                comparison(
                    **place,
                    key=KEYS[2],
                    source="inner",
                    lineno=10,
                    param_reads=[{"file": "src/direct.cpp", "lineno": 2}],
                    path=[step("read", 2, "inner read", unit="nav/direct")],
                    processes=[DRIVE],
                ),
            ],
            not_exposed=[{**not_exposed("off", 11), "file": "src/direct.cpp"}],
            blind_spots=[{**spot("lost_value", "gain", 12, "mixed"), "file": "src/direct.cpp"}],
        ),
        unit(
            link_unit="alone",
            package="robot",
            source_root="/ws/src/robot",
            parameters=[read("far", 3)],
            comparisons=[],
        ),
    ]


@pytest.fixture
def static(tmp_path: Path) -> StaticInfo:
    return StaticInfo.of([LinkUnit.from_json(each, tmp_path) for each in sample()])


@pytest.fixture
def file(tmp_path: Path, static: StaticInfo) -> str:
    static.save(tmp_path / "static.json")
    return str(tmp_path / "static.json")


def steps() -> list[PathStep]:
    return [PathStep(**each) for each in path()]


def run(*words: str) -> str:
    result = CliRunner().invoke(main, words, env={"COLUMNS": "200"})
    assert result.exit_code == 0, result.output
    return result.output


def all_details(static: StaticInfo) -> list[Details]:
    answers = look_up_conditions(static, static.tpcs)
    return [details(static, tpc, answers[tpc.key]) for tpc in static.tpcs]


def test_a_path_names_the_units_that_it_leads_through() -> None:
    assert units_of(steps()) == ("nav/limits", "nav/direct", DRIVE)
    # What was left out lies in any of them.
    assert changes(steps()) == ["nav/limits", None, "nav/direct", DRIVE]


@pytest.mark.parametrize(
    ("units", "words"),
    [
        (("a/r", "a/c", "a/e"), "read in a/r -> compared in a/c -> exposed in a/e"),
        (("a/r", "a/r", "a/e"), "read and compared in a/r -> exposed in a/e"),
        (("a/r", "a/c", "a/c"), "read in a/r -> compared and exposed in a/c"),
        (("a/r", "a/c", "a/r"), "read in a/r -> compared in a/c -> exposed in a/r"),
        (("a/r", "a/r", "a/r"), ""),
        ((None, None, None), ""),
    ],
)
def test_each_part_has_its_unit(units: tuple[str | None, ...], words: str) -> None:
    kinds = ("read", "compare", "expose")
    made = [step(kind, 1, kind, unit=of) for kind, of in zip(kinds, units, strict=True)]
    assert across([PathStep(**each) for each in made]) == words


def test_units_between_are_named() -> None:
    units = (
        ("read", "a/e"),
        ("pass", "a/p"),
        ("compare", "a/e"),
        ("call", "a/q"),
        ("expose", "a/e"),
    )
    way = [PathStep(**step(kind, 1, kind, unit=of)) for kind, of in units]
    assert across(way) == "read, compared and exposed in a/e, through a/p, a/q"


def test_a_file_without_units_reads_and_writes_none(tmp_path: Path) -> None:
    found = LinkUnit.from_json(unit(), tmp_path)
    assert all(each.unit is None for each in found.comparisons[0].path)
    assert changes(found.comparisons[0].path) == [None, None, None]
    assert "unit" not in found.to_json()["comparisons"][0]["path"][0]


def test_a_unit_survives_the_file(static: StaticInfo, file: str) -> None:
    assert StaticInfo.load(Path(file)).comparisons[KEYS[0]] == static.comparisons[KEYS[0]]


def test_explain_names_libraries_and_processes(file: str) -> None:
    said = [line.strip() for line in run("explain", file, "far").splitlines()]
    assert f"read in nav/limits -> compared in nav/direct -> exposed in {DRIVE}" in said
    assert f"found in 2 processes: {DRIVE}, {FIELD}" in said
    entered = [line.split()[1] for line in said if line.startswith("in ")]
    assert entered == ["nav/limits", "nav/direct", DRIVE]


def test_explain_names_no_library_of_a_path_within_one(file: str) -> None:
    said = [line.strip() for line in run("explain", file, "inner").splitlines()]
    assert f"found in process {DRIVE}" in said
    assert not [line for line in said if line.startswith("in ")]


def test_list_says_what_lies_in_several_units(file: str) -> None:
    far, near, inner = json.loads(run("list", file, "--json"))
    assert (far["processes"], far["units"]) == (
        [DRIVE, FIELD],
        ["nav/limits", "nav/direct", DRIVE],
    )
    assert (near["processes"], near["units"]) == ([FIELD], [])
    assert (inner["processes"], inner["units"]) == ([DRIVE], ["nav/direct"])
    rows = [line.split("│") for line in run("list", file).splitlines() if "direct.cpp" in line]
    cells = {row[1].strip(): [row[5].strip(), row[6].strip()] for row in rows}
    assert cells == {
        "far": [f"{DRIVE} and 1 more", "3 units"],
        "near": [FIELD, ""],
        "inner": [DRIVE, ""],
    }


def test_list_has_no_column_for_units_that_were_analysed_alone(tmp_path: Path) -> None:
    StaticInfo.of([LinkUnit.from_json(unit(), tmp_path)]).save(tmp_path / "static.json")
    said = run("list", str(tmp_path / "static.json"))
    assert "Process" not in said
    assert "Across" not in said
    (only,) = json.loads(run("list", str(tmp_path / "static.json"), "--json"))
    assert (only["processes"], only["units"]) == ([], [])


@pytest.mark.parametrize(
    ("names", "parameters"),
    [([DRIVE], ["far", "inner"]), ([FIELD], ["far", "near"]), (["robot/alone"], [])],
)
def test_list_of_one_process(file: str, names: list[str], parameters: list[str]) -> None:
    words = [word for name in names for word in ("--process", name)]
    found = json.loads(run("list", file, *words, "--json"))
    assert [each["source"] for each in found] == parameters


def test_a_unit_that_was_analysed_alone_is_a_process_of_its_name(tmp_path: Path) -> None:
    StaticInfo.of([LinkUnit.from_json(unit(), tmp_path)]).save(tmp_path / "static.json")
    file = str(tmp_path / "static.json")
    (found,) = json.loads(run("list", file, "--process", "face/detector", "--json"))
    assert found["source"] == "min_coverage_limit"


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("robot/drve", f"; did you mean {DRIVE}"),
        ("zzz", "; `pytpc processes` lists the processes\n"),
    ],
)
def test_an_unknown_process_is_one_line(file: str, name: str, hint: str) -> None:
    result = CliRunner().invoke(main, ["list", file, "--process", name])
    assert result.exit_code == 1
    assert len(result.stderr.splitlines()) == 1
    assert f"no process {name} in this static information{hint}" in result.stderr


def covered(static: StaticInfo) -> dict[tuple[str, str], Covered]:
    return {(each.link_unit, each.parameter): each for each in coverage(static)}


def test_what_another_unit_of_the_process_does_counts_for_the_reader(static: StaticInfo) -> None:
    found = covered(static)
    assert {name: each.state for name, each in found.items()} == {
        ("limits", "far"): "compared",
        ("limits", "near"): "compared",
        ("limits", "off"): "hidden",
        ("limits", "gain"): "lost",
        ("direct", "inner"): "compared",
        # It reads far, too, and is in no process with the others.
        ("alone", "far"): "used",
    }
    far = found["limits", "far"]
    assert far.comparisons == ("src/direct.cpp:7 in nav/direct",)
    assert far.lost[0].place == "src/detector.cpp:30"
    assert found["limits", "off"].hidden == ("src/direct.cpp:11 in nav/direct",)
    assert found["limits", "gain"].lost[0].place == "src/direct.cpp:12 in nav/direct"
    assert found["direct", "inner"].comparisons == ("src/direct.cpp:10",)


def test_units_of_different_processes_keep_what_they_say(tmp_path: Path) -> None:
    limits, direct, _ = sample()
    units = [{**limits, "processes": ["robot/other"]}, direct]
    found = covered(StaticInfo.of([LinkUnit.from_json(each, tmp_path) for each in units]))
    assert found["limits", "near"].state == "used"
    assert found["direct", "near"].state == "compared"


def test_of_two_readers_the_one_whose_value_is_compared_has_the_comparison(tmp_path: Path) -> None:
    limits, direct, _ = sample()
    other = {**limits, "link_unit": "other", "parameters": [read("far", 99)], "blind_spots": []}
    units = [limits, direct, other]
    found = covered(StaticInfo.of([LinkUnit.from_json(each, tmp_path) for each in units]))
    assert found["limits", "far"].state == "compared"
    assert found["other", "far"].state == "used"


def test_coverage_prints_where(file: str) -> None:
    assert "compared at src/direct.cpp:7 in nav/direct" in run("coverage", file)


def test_sarif_has_units_and_processes(static: StaticInfo) -> None:
    log = sarif_log(static, all_details(static))
    far, near, _ = log["runs"][0]["results"]
    assert far["properties"]["processes"] == [DRIVE, FIELD]
    assert near["properties"]["processes"] == [FIELD]
    ways = far["codeFlows"][0]["threadFlows"][0]["locations"]
    assert [each.get("module") for each in ways] == ["nav/limits", None, "nav/direct", DRIVE]
    assert ways[2]["location"]["logicalLocations"] == [
        {"fullyQualifiedName": "face::Detector::onImage", "kind": "function"},
        {"fullyQualifiedName": "nav/direct", "kind": "module"},
    ]
    plain = near["codeFlows"][0]["threadFlows"][0]["locations"]
    assert not any("module" in each for each in plain)


def test_the_page_and_show_have_units_and_processes(static: StaticInfo, file: str) -> None:
    page = render(static, all_details(static), "Limits")
    assert f"<dt>Found in</dt><dd>{DRIVE}, {FIELD}</dd>" in page
    assert "read in nav/limits -&gt; compared in nav/direct" in page
    assert page.count('<span class="muted">in</span> <code>nav/direct</code>') == 1
    entered = [each.entered for each in way_of(static.comparisons[KEYS[0]])]
    assert entered == ["nav/limits", "", "nav/direct", DRIVE]
    shown = run("show", file, "far")
    assert f"{DRIVE}, {FIELD}" in shown
    (answer,) = json.loads(run("show", file, "far", "--json"))["comparisons"]
    assert answer["processes"] == [DRIVE, FIELD]
    assert answer["units"] == ["nav/limits", "nav/direct", DRIVE]
