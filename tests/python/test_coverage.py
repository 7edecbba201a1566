"""What became of every parameter: ``pytpc coverage``."""

import json
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from static_units import comparison, not_exposed, spot, unit

from pytpc.cli.main import main
from pytpc.static.coverage import STATES, Covered, Lost, coverage, totals
from pytpc.static.link_unit import LinkUnit
from pytpc.static.static_info import StaticInfo


def read(name: str, lineno: int) -> dict[str, Any]:
    (sample,) = unit()["parameters"]
    return {**sample, "name": name, "lineno": lineno}


def sample() -> dict[str, Any]:
    return unit(
        parameters=[read(name, n) for n, name in enumerate(("min_coverage_limit", *OTHERS), 12)],
        comparisons=[comparison()],
        not_exposed=[not_exposed("hidden", 70)],
        blind_spots=[
            spot("lost_value", "min_coverage_limit", 19, "used as an index"),
            spot("lost_value", "gain", 20, "mixed with another variable"),
            spot("unread", "gain", 21, "stored into Gain, and nothing here reads it"),
            spot("unread", "sent", 22, "stored into Out, and nothing here reads it"),
            spot("indirect_call", None, 90, "calls a function that is not known"),
        ],
    )


OTHERS = ("hidden", "gain", "sent", "frame")


def covered(data: dict[str, Any], folder: Path) -> dict[str, Covered]:
    found = coverage(StaticInfo.of([LinkUnit.from_json(data, folder)]))
    return {each.parameter: each for each in found}


def test_each_parameter_that_is_read_has_a_state(tmp_path: Path) -> None:
    found = covered(sample(), tmp_path)
    states = {name: each.state for name, each in found.items()}
    assert states == {
        "min_coverage_limit": "compared",
        "hidden": "hidden",
        "gain": "lost",
        "sent": "unread",
        "frame": "used",
    }
    assert totals(found.values()) == dict.fromkeys(STATES, 1)


def test_a_place_says_where_and_why(tmp_path: Path) -> None:
    found = covered(sample(), tmp_path)
    assert found["gain"].lost == (Lost("src/detector.cpp:20", "mixed with another variable"),)
    assert found["gain"].unread[0].place == "src/detector.cpp:21"
    # Also of a parameter that is compared elsewhere.
    assert found["min_coverage_limit"].lost[0].why == "used as an index"
    assert found["min_coverage_limit"].comparisons == ("src/detector.cpp:40",)
    assert found["frame"].reads == ("src/detector.cpp:16",)


def test_an_entry_of_a_table_is_read_with_the_table(tmp_path: Path) -> None:
    data = unit(parameters=[read("~arm", 12)], comparisons=[comparison(source="~arm/reach")])
    found = covered(data, tmp_path)
    assert found["~arm/reach"].state == "compared"
    assert found["~arm/reach"].reads == found["~arm"].reads == ("src/detector.cpp:12",)


@pytest.mark.parametrize(
    ("options", "names"),
    [
        ((), ["frame", "gain", "hidden", "min_coverage_limit", "sent"]),
        (("--state", "lost", "--state", "used"), ["frame", "gain"]),
    ],
)
def test_the_command(tmp_path: Path, options: tuple[str, ...], names: list[str]) -> None:
    file = tmp_path / "static.json"
    StaticInfo.of([LinkUnit.from_json(sample(), tmp_path)]).save(file)
    said = CliRunner().invoke(main, ["coverage", str(file), *options])
    assert said.exit_code == 0
    assert said.output.splitlines()[-1].endswith("1 compared, 1 hidden, 1 lost, 1 unread, 1 used")
    told = json.loads(CliRunner().invoke(main, ["coverage", str(file), *options, "--json"]).output)
    assert [each["parameter"] for each in told["parameters"]] == names
    assert told["totals"]["lost"] == 1
