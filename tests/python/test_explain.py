"""Questions to the static information: by key, by parameter, by line."""

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result
from static_units import KEYS, comparison, counts, not_exposed, spot, step, unit

from pytpc.base.errors import InputError
from pytpc.cli.main import main
from pytpc.static.explanations import look_up, why_no_comparison
from pytpc.static.link_unit import LinkUnit
from pytpc.static.static_info import StaticInfo


def read(name: str, lineno: int) -> dict[str, Any]:
    (sample,) = unit()["parameters"]
    return {**sample, "name": name, "lineno": lineno}


# min_coverage_limit is compared on line 40 (distance 3) and on line 60 (distance 1); gain is lost
# on line 20; noise is compared on line 70, where nothing depends on it; idle goes nowhere.
def sample() -> dict[str, Any]:
    return unit(
        counts=counts(not_exposed=1, blind_spots=300, dynamic_names=1, indirect_calls=17),
        parameters=[
            read("min_coverage_limit", 12),
            read("gain", 13),
            read("noise", 14),
            read("idle", 15),
            read("~arm/reach", 16),
        ],
        comparisons=[
            comparison(distance=3),
            comparison(key=KEYS[1], lineno=60, path=[step("compare", 60, "compared: [red] x")]),
        ],
        not_exposed=[not_exposed("noise", 70)],
        blind_spots=[
            spot("lost_value", "gain", 20, "mixed with another variable"),
            spot("indirect_call", None, 90, "calls a function that is not known"),
        ],
    )


@pytest.fixture
def static(tmp_path: Path) -> StaticInfo:
    return StaticInfo.of([LinkUnit.from_json(sample(), tmp_path)])


def keys(static: StaticInfo, question: str) -> list[str]:
    return [found.comparison.key for found in look_up(static, question).comparisons]


def test_a_parameter_has_its_comparisons_the_nearest_first(static: StaticInfo) -> None:
    assert keys(static, "min_coverage_limit") == [KEYS[1], KEYS[0]]


def test_a_key_or_its_beginning_is_one_comparison(static: StaticInfo) -> None:
    assert keys(static, KEYS[0]) == [KEYS[0]]
    assert keys(static, KEYS[0][:8]) == [KEYS[1], KEYS[0]]


@pytest.mark.parametrize(
    ("place", "expected"),
    [
        ("src/detector.cpp:40", [KEYS[0]]),
        ("detector.cpp:40", [KEYS[0]]),
        ("./src/detector.cpp:40:16", [KEYS[0]]),
        ("/ws/src/face/src/detector.cpp:60", [KEYS[1]]),
        # Not a comparison's line, but on the way of the first.
        ("detector.cpp:41", [KEYS[0]]),
    ],
)
def test_a_line_is_found_by_the_end_of_its_path(
    static: StaticInfo, place: str, expected: list[str]
) -> None:
    assert keys(static, place) == expected


def test_a_line_without_a_comparison_has_what_else_is_known(static: StaticInfo) -> None:
    lost = look_up(static, "detector.cpp:20")
    assert [found.parameter for _, found in lost.blind_spots] == ["gain"]
    unexposed = look_up(static, "detector.cpp:70")
    assert [found.source for _, found in unexposed.not_exposed] == ["noise"]


@pytest.mark.parametrize(
    ("name", "reasons"),
    [
        ("gain", ["mixed with another variable, at src/detector.cpp:20"]),
        ("noise", ["compared at src/detector.cpp:70, but nothing exposed depends on it"]),
        ("idle", ["read, and never compared"]),
        ("min_coverage_limit", []),
    ],
)
def test_a_parameter_without_a_comparison_has_reasons(
    static: StaticInfo, name: str, reasons: list[str]
) -> None:
    assert why_no_comparison(look_up(static, name)) == reasons


def test_the_same_reason_in_two_units_is_said_once(tmp_path: Path) -> None:
    units = [sample(), {**sample(), "link_unit": "other", "comparisons": []}]
    static = StaticInfo.of(LinkUnit.from_json(data, tmp_path) for data in units)
    explanation = look_up(static, "noise")
    assert len(explanation.not_exposed) == 2
    assert len(why_no_comparison(explanation)) == 1


def test_a_name_without_its_namespace_is_enough(static: StaticInfo) -> None:
    for name in ("reach", "arm/reach", "~arm/reach"):
        assert [found.name for _, found in look_up(static, name).reads] == ["~arm/reach"]
    for name in ("each", "rm/reach", "a.m/reach"):
        with pytest.raises(InputError):
            look_up(static, name)


def test_the_name_in_a_mission_is_that_of_the_source(tmp_path: Path) -> None:
    parts = [read("<dynamic>/radius", 12), read("~arm/reach", 13), read("<dynamic>", 14)]
    compared = [comparison(source="<dynamic>/radius")]
    document = {**sample(), "parameters": parts, "comparisons": compared}
    static = StaticInfo.of([LinkUnit.from_json(document, tmp_path)])
    for name in ("<dynamic>/radius (object 2)", "/move_base/local/radius", "radius"):
        assert keys(static, name) == [KEYS[0]]
        assert [found.lineno for _, found in look_up(static, name).reads] == [12]
    assert [found.lineno for _, found in look_up(static, "/node/arm/reach").reads] == [13]
    assert [found.lineno for _, found in look_up(static, "<dynamic> (object 2)").reads] == [14]
    with pytest.raises(InputError):
        look_up(static, "/move_base/local/diameter")


def test_a_mistyped_parameter_is_answered_with_the_closest(static: StaticInfo) -> None:
    with pytest.raises(InputError) as error:
        look_up(static, "min_coverage_limits")
    assert str(error.value) == (
        "no parameter, key or FILE:LINE 'min_coverage_limits' in this static information;"
        " did you mean min_coverage_limit? (1 read put the name together at run time)"
    )


def test_a_line_that_no_file_has_is_no_line(static: StaticInfo) -> None:
    with pytest.raises(InputError, match="key or FILE:LINE 'a"):
        look_up(static, f"a.cpp:{'9' * 5000}")


def test_a_line_on_which_nothing_is_says_where_something_is(static: StaticInfo) -> None:
    with pytest.raises(InputError, match=r"line 59 of detector\.cpp; .* on line 40, 60$"):
        look_up(static, "detector.cpp:59")
    with pytest.raises(InputError, match=r"nothing was found in a file other/detector\.cpp"):
        look_up(static, "other/detector.cpp:40")


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "detector.json"
    path.write_text(json.dumps(sample()), encoding="utf-8")
    return path


def test_explain_shows_the_way_with_the_source_lines(file: Path) -> None:
    result = run("explain", file, KEYS[0])
    assert result.exit_code == 0
    lines = [line.rstrip() for line in result.stdout.splitlines()]
    assert lines[0] == (
        "min_coverage_limit  src/detector.cpp:40  parameter, distance 3, in face/detector,"
        f" key {KEYS[0]}"
    )
    assert [line.split("  ")[1] for line in lines[1:] if "src/" in line] == [
        "read", "compare", "expose",
    ]  # fmt: skip
    assert lines[2].strip() == "line 12;"
    assert lines[5].endswith("src/detector.cpp:41  published on capture")


def test_explain_shows_the_nearest_and_with_all_the_others_too(file: Path) -> None:
    one, every = (
        run("explain", file, "min_coverage_limit"),
        run("explain", file, "min_coverage_limit", "--all"),
    )
    assert "compared: [red] x" in one.stdout
    assert "1 more comparison (use --all to show their paths):" in one.stdout
    assert "published on capture" not in one.stdout
    assert "published on capture" in every.stdout
    assert "--all" not in every.stdout


def test_explain_says_why_there_is_none(file: Path) -> None:
    result = run("explain", file, "noise")
    assert result.exit_code == 0
    assert [line.rstrip() for line in result.stdout.splitlines()] == [
        "noise  read at src/detector.cpp:14 in face/detector",
        "no comparison of it is reported:",
        "  compared at src/detector.cpp:70, but nothing exposed depends on it",
    ]


def test_explain_of_an_older_file_says_that_it_has_no_way(tmp_path: Path) -> None:
    data = unit()
    del data["comparisons"][0]["path"], data["blind_spots"], data["not_exposed"]
    del data["counts"]["blind_spots"], data["counts"]["not_exposed"]
    path = tmp_path / "old.json"
    path.write_text(json.dumps(data), encoding="utf-8")
    result = run("explain", path, "min_coverage_limit")
    assert result.exit_code == 0
    assert "this static information contains no paths" in result.stdout


def test_explain_as_json_has_all_of_it(file: Path) -> None:
    told = json.loads(run("explain", file, "min_coverage_limit", "--json").stdout)
    assert [found["key"] for found in told["comparisons"]] == [KEYS[1], KEYS[0]]
    assert told["comparisons"][1]["path"] == comparison()["path"]
    assert told["comparisons"][1]["link_unit"] == "detector"
    gain = json.loads(run("explain", file, "gain", "--json").stdout)
    assert [found["kind"] for found in gain["blind_spots"]] == ["lost_value"]
    assert gain["why_no_comparison"] == ["mixed with another variable, at src/detector.cpp:20"]


def test_explain_of_nothing_is_one_line(file: Path) -> None:
    result = run("explain", file, "nothing_like_it")
    assert result.exit_code == 1
    assert result.stderr.startswith("pytpc: error: no parameter, key or FILE:LINE")
    assert len(result.stderr.splitlines()) == 1


# 300 blind spots were counted, and 2 of them are in the file.
def test_blind_spots_are_listed_and_counted(file: Path) -> None:
    result = run("blind-spots", file)
    assert result.exit_code == 0
    assert "src/detector.cpp:20" in result.stdout
    assert result.stdout.splitlines()[-1] == (
        "300 blind spots: 1 value lost, 1 call of unknown function; 298 more are not listed;"
        " 17 calls of unknown functions with those inside libraries"
    )
    told = json.loads(run("blind-spots", file, "--json").stdout)
    assert [found["lineno"] for found in told] == [20, 90]
    assert told[0]["link_unit"] == "detector"


def test_blind_spots_name_the_units_that_are_too_large(tmp_path: Path) -> None:
    path = tmp_path / "detector.json"
    path.write_text(json.dumps(unit(counts=counts(given_up=3))), encoding="utf-8")
    assert run("blind-spots", path).stdout.endswith(
        "; too large to tell which reads see a write: detector\n"
    )
