"""The commands about what was found, as a user meets them."""

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner, Result
from file_api import reply, target
from static_units import KEYS, comparison, failed_unit, unit

from pytpc.cli.main import main
from pytpc.static.link_unit import LinkUnit
from pytpc.static.static_info import StaticInfo


def run(*arguments: str | Path) -> Result:
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.fixture
def build_base(tmp_path: Path) -> Path:
    base = tmp_path / "build"
    units = {
        "face/tpc/detector.json": unit(
            comparisons=[comparison(source_code="if (x[red] > limit_)  // [/red]")]
        ),
        "arm/tpc/mover.json": unit(
            package="arm",
            link_unit="mover",
            source_root="/ws/src/arm",
            comparisons=[
                comparison(key=KEYS[1], source_code=None, topic=None, source="min_height")
            ],
        ),
        "arm/tpc/broken.json": failed_unit(package="arm"),
    }
    for place, data in units.items():
        (base / place).parent.mkdir(parents=True, exist_ok=True)
        (base / place).write_text(json.dumps(data), encoding="utf-8")
    return base


def test_collect_writes_one_file_and_warns(build_base: Path, tmp_path: Path) -> None:
    output = tmp_path / "out/static.json"
    result = run("collect", build_base, "-o", output)
    assert (result.exit_code, result.stderr) == (
        0,
        "pytpc: warning: arm/broken was not analysed and reports nothing:"
        " the instrumented module does not verify\n",
    )
    assert result.stdout.splitlines()[-1] == f"2 comparisons in 3 link units: {output}"
    assert len(json.loads(output.read_text(encoding="utf-8"))["units"]) == 3


def test_collect_shows_the_numbers_of_each_unit(build_base: Path, tmp_path: Path) -> None:
    data = unit()
    data["counts"].update(comparisons=31, parameter_reads=47, exposing_statements=59)
    (build_base / "face/tpc/detector.json").write_text(json.dumps(data), encoding="utf-8")
    result = run("collect", build_base, "-o", tmp_path / "static.json")
    (row,) = (line for line in result.stdout.splitlines() if "detector" in line)
    assert [cell.strip() for cell in row.strip("│").split("│")] == [
        "face", "detector", "31", "47", "59", "ok",
    ]  # fmt: skip


def test_collect_of_a_folder_without_any_writes_nothing(tmp_path: Path) -> None:
    result = run("collect", tmp_path, "-o", tmp_path / "static.json")
    assert result.exit_code == 1
    assert result.stderr == (
        f"pytpc: error: {tmp_path}: no static information here; run `pytpc build {tmp_path}`\n"
    )
    assert list(tmp_path.iterdir()) == []


def test_list_shows_source_lines_as_they_are(build_base: Path) -> None:
    result = run("list", build_base)
    assert result.exit_code == 0
    assert "if (x[red] > limit_)  // [/red]" in result.stdout
    assert "face/src/detector.cpp:40" in result.stdout
    assert "> min_coverage_limit_" in result.stdout
    assert result.stdout.splitlines()[-1] == "2 comparisons in 3 link units"


def test_list_as_json_holds_every_field(build_base: Path) -> None:
    listed = json.loads(run("list", build_base, "--json").stdout)
    expected: list[dict[str, Any]] = [
        {
            "package": "arm",
            "link_unit": "mover",
            **comparison(key=KEYS[1], source_code=None, topic=None, source="min_height"),
            "absolute_file": "/ws/src/arm/src/detector.cpp",
            "keys": [{"key": KEYS[1], "package": "arm", "link_unit": "mover", "distance": 1}],
            "processes": [],
            "units": [],
        },
        {
            "package": "face",
            "link_unit": "detector",
            **comparison(source_code="if (x[red] > limit_)  // [/red]"),
            "absolute_file": "/ws/src/face/src/detector.cpp",
            "keys": [{"key": KEYS[0], "package": "face", "link_unit": "detector", "distance": 1}],
            "processes": [],
            "units": [],
        },
    ]
    assert listed == expected


CONSTANT = comparison(
    key=KEYS[2], type="constant", source=None, name="7", read_at=None, param_reads=[], default=None
)


def test_constants_are_listed_where_that_is_asked_for(tmp_path: Path) -> None:
    source = tmp_path / "static.json"
    source.write_text(json.dumps(unit(comparisons=[comparison(), CONSTANT])), encoding="utf-8")
    assert run("list", source).stdout.splitlines()[-1] == "1 comparison in 1 link unit"
    assert "constant" not in run("list", source).stdout
    with_constants = run("list", source, "--constants").stdout
    assert [row[1] for row in rows(run("list", source, "--constants"))] == ["parameter", "constant"]
    assert with_constants.splitlines()[-1] == "1 comparison in 1 link unit; and 1 with constants"
    alone = run("list", source, "--type", "constant").stdout
    assert alone.splitlines()[-1] == (
        "0 shown of 1 comparison in 1 link unit; and 1 with constants"
    )
    assert len(json.loads(run("list", source, "--json").stdout)) == 1
    assert json.loads(run("list", source, "--json", "--constants").stdout)[1]["name"] == "7"


def test_list_finds_what_is_here(
    build_base: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run("list").stdout.splitlines()[-1] == "2 comparisons in 3 link units"
    StaticInfo.of([LinkUnit.from_json(unit(), tmp_path)]).save(tmp_path / "static.json")
    assert run("list").stdout.splitlines()[-1] == "1 comparison in 1 link unit"


def test_a_broken_file_is_one_line_with_its_place(tmp_path: Path) -> None:
    path = tmp_path / "static.json"
    path.write_text('{"schema": 1,\n"units": [', encoding="utf-8")
    result = run("list", path)
    assert result.exit_code == 1
    assert result.stdout == ""
    assert result.stderr == f"pytpc: error: {path}:2: not JSON: Expecting value, column 11\n"


def test_an_output_that_cannot_be_written_is_one_line(build_base: Path) -> None:
    result = run("collect", build_base, "-o", build_base / "face/tpc/detector.json/static.json")
    assert result.exit_code == 1
    assert result.stderr.startswith(f"pytpc: error: {build_base}/face/tpc/detector.json/static")
    assert result.stderr.count("\n") == 1


def test_collect_says_what_it_left_out(build_base: Path, tmp_path: Path) -> None:
    reply(build_base / "face", [target("other", "EXECUTABLE"), target("more", "EXECUTABLE")])
    result = run("collect", build_base, "-o", tmp_path / "static.json")
    assert result.stderr.splitlines()[-1] == (
        "pytpc: warning: face/detector with 1 key left out: its target no longer exists"
        f" ({build_base}/face/tpc/detector.json)"
    )
    assert result.stdout.splitlines()[-1].startswith("1 comparison in 2 link units: ")


def test_list_leaves_out_what_is_no_longer_built_too(build_base: Path) -> None:
    reply(build_base / "face", [target("other", "EXECUTABLE"), target("more", "EXECUTABLE")])
    result = run("list", build_base)
    assert "its target no longer exists" in result.stderr
    assert result.stdout.splitlines()[-1] == "1 comparison in 2 link units"


@pytest.fixture
def shared(tmp_path: Path) -> Path:
    """Two nodes of one package with a file in common, which is there, and one of their own."""
    root = tmp_path / "src/face"
    (root / "src").mkdir(parents=True)
    lines = ["#define OVER(x, limit) ((x) > (limit))", "void publish();"]
    lines += ["void f(double coverage, double min_coverage_limit_) {"]
    lines += [""] * (38 - len(lines))
    lines += [
        "  if (coverage > 7 ||",
        "      coverage > min_coverage_limit_)",
        "    publish();",
        "}",
    ]
    (root / "src/detector.cpp").write_text("\n".join(lines), encoding="utf-8")
    here: dict[str, Any] = {"source_code": "coverage > min_coverage_limit_)"}
    flag = comparison(
        key=KEYS[2], type="flag", relation="flag", source="~use_gps", file="src/gps.cpp",
        topic="fix", distance=4, column=7, source_code="if (use_gps_)", default=True,
    )  # fmt: skip
    StaticInfo.of(
        LinkUnit.from_json(data, tmp_path)
        for data in (
            unit(source_root=str(root), comparisons=[comparison(distance=2, **here), flag]),
            unit(
                source_root=str(root),
                link_unit="other",
                comparisons=[comparison(key=KEYS[1], default=None, **here)],
            ),
        )
    ).save(tmp_path / "static.json")
    return tmp_path / "static.json"


def rows(result: Result) -> list[list[str]]:
    """The cells of the rows of a table, without its head."""
    lines = [line for line in result.stdout.splitlines() if line.startswith("│")]
    return [[cell.strip() for cell in line.strip("│").split("│")] for line in lines]


def test_a_place_is_one_row_with_the_number_of_its_units(shared: Path) -> None:
    result = run("list", shared)
    assert rows(result) == [
        [
            "min_coverage_limit", "parameter", "face/src/detector.cpp:40", "1", "2", "capture",
            "coverage > min_coverage_limit_)",
        ],
        ["~use_gps", "flag", "face/src/gps.cpp:40", "4", "", "fix", "if (use_gps_)"],
    ]  # fmt: skip
    assert result.stdout.splitlines()[-1] == "2 comparisons (3 keys) in 2 link units"


@pytest.mark.parametrize(
    ("options", "found"),
    [
        ("--type flag", ["~use_gps"]),
        ("--parameter use_*", ["~use_gps"]),
        ("--parameter min_* --parameter ~use_gps", ["min_coverage_limit", "~use_gps"]),
        ("--file detector.cpp", ["min_coverage_limit"]),
        ("--file src/g*", ["~use_gps"]),
        ("--package face --file nothing.cpp", []),
        ("--sort type", ["~use_gps", "min_coverage_limit"]),
        ("--sort distance", ["min_coverage_limit", "~use_gps"]),
    ],
)
def test_filters_and_sorting(shared: Path, options: str, found: list[str]) -> None:
    assert [row[0] for row in rows(run("list", shared, *options.split()))] == found


def test_what_is_filtered_is_said(shared: Path) -> None:
    result = run("list", shared, "--type", "flag")
    assert result.stdout.splitlines()[-1] == "1 shown of 2 comparisons (3 keys) in 2 link units"
    result = run("list", shared, "--package", "fac")
    assert (result.exit_code, result.stderr) == (
        1,
        "pytpc: error: no package fac in this static information; did you mean face?\n",
    )


def test_show_has_everything(shared: Path) -> None:
    for question in (KEYS[0], KEYS[1], "min_coverage_limit", "detector.cpp:40"):
        shown = run("show", shared, question).stdout
        lines = [" ".join(line.split()) for line in shown.splitlines()]
        assert lines[0] == "min_coverage_limit face/src/detector.cpp:40:16", question
        # Lines 39 and 40 of the file.
        assert lines[1:3] == ["coverage > 7 ||", "coverage > min_coverage_limit_"]
        assert lines[3:-1] == [
            "Condition of if, lines 39 to 40; parsed without the flags of the build",
            "Compared > min_coverage_limit_, compared with the parameter as it is",
            "Type parameter",
            "Default none in the source, 0.25",
            "Read at src/detector.cpp:12",
            "Exposed at src/detector.cpp:41 (capture)",
            "Function face::Detector::onImage(int)",
            "Distance 1",
            f"2 keys {KEYS[1]} face/other, distance 1",
            f"{KEYS[0]} face/detector, distance 2",
        ]


def test_the_beginning_of_a_key_is_enough(shared: Path) -> None:
    # All three keys begin so, two of them are of one place.
    shown = run("show", shared, KEYS[0][:8]).stdout
    assert [line.split()[0] for line in shown.splitlines() if line.strip() and line[0] != " "] == [
        "min_coverage_limit", "~use_gps",
    ]  # fmt: skip


def test_show_falls_back_to_the_line(shared: Path) -> None:
    shown = run("show", shared, "use_gps").stdout
    assert "if (use_gps_)" in shown
    assert "the line alone: the source file is not on this machine" in shown


def test_show_as_json(shared: Path) -> None:
    answer = json.loads(run("show", shared, "min_coverage_limit", "--json").stdout)
    (found,) = answer["comparisons"]
    assert found["condition"]["text"] == "coverage > 7 ||\n      coverage > min_coverage_limit_"
    assert (found["condition"]["kind"], found["condition"]["end_lineno"]) == ("if", 40)
    assert [each["key"] for each in found["keys"]] == [KEYS[1], KEYS[0]]
    assert found["defaults"] == [None, 0.25]


def test_show_of_what_is_not_there_is_one_line(shared: Path) -> None:
    result = run("show", shared, "max_coverage_limit")
    assert result.exit_code == 1
    assert result.stderr.count("\n") == 1
    assert "did you mean min_coverage_limit" in result.stderr


def test_show_of_a_parameter_without_a_comparison_says_why(tmp_path: Path) -> None:
    path = tmp_path / "static.json"
    path.write_text(json.dumps(unit(comparisons=[])), encoding="utf-8")
    shown = run("show", path, "min_coverage_limit").stdout
    assert "no comparison of it is reported:" in shown
    assert "read, and never compared" in shown


def test_without_a_source_it_is_what_is_here(shared: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(shared.parent)
    assert run("show", "min_coverage_limit").exit_code == 0
    assert run("export", "--html", "out.html").exit_code == 0


def test_several_sources_are_one(build_base: Path) -> None:
    result = run("list", build_base / "face", build_base / "arm")
    assert result.stdout.splitlines()[-1] == "2 comparisons in 3 link units"


def test_export_writes_both(shared: Path, tmp_path: Path) -> None:
    html, sarif = tmp_path / "out/a.html", tmp_path / "out/a.sarif"
    result = run("export", shared, "--html", html, "--sarif", sarif, "--type", "flag")
    assert result.stdout.splitlines() == [f"1 comparison: {sarif}", f"1 comparison: {html}"]
    assert "use_gps" in html.read_text(encoding="utf-8")
    (result_,) = json.loads(sarif.read_text(encoding="utf-8"))["runs"][0]["results"]
    assert result_["properties"]["parameter"] == "~use_gps"


def test_export_of_nothing_is_a_usage_error(shared: Path) -> None:
    result = run("export", shared)
    assert result.exit_code == 2
    assert "give --sarif FILE, --html FILE or both" in result.stderr


def test_every_command_has_help() -> None:
    for name in ("collect", "list", "show", "export"):
        result = run(name, "--help")
        assert result.exit_code == 0
        assert result.stdout.startswith(f"Usage: main {name} ")
