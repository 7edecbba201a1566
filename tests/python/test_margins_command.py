"""The command margins: tables, JSON, several missions, and one line for each error."""

from __future__ import annotations

import json

import pytest
from click.testing import CliRunner
from mission_samples import BagFile, comparison, line, static_info

import pytpc
from pytpc.api import margins
from pytpc.cli.main import main


def write(path, level):
    """``faces >= 3`` turns at 5 s and 9 s; ``coverage > 0.6`` has a value of ``level``."""
    with BagFile(path) as bag:
        for step in range(120):
            t = 1 + step / 10
            high = 5 <= t < 9
            bag.log(t, "/uav", line(0, int(high), 4 if high else 1, 3))
            bag.log(t, "/uav", line(1, int(level > 0.6), level, 0.6))
    return path


@pytest.fixture
def static(tmp_path):
    file = tmp_path / "static.json"
    static_info(comparison(0, "faces", ">="), comparison(1, "coverage")).save(file)
    return file


def run(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def test_one_mission(tmp_path, static):
    result = run("margins", write(tmp_path / "m.bag", 0.3), "--static", static)
    assert result.exit_code == 0, result.output
    lines = result.stdout.splitlines()
    assert lines[0] == "m: 2 comparisons evaluated in 11.9 s"
    # faces: margins 2 and 1 of a range of 1 to 4; coverage 0.3 of a range of 0.3.
    (faces,) = [row.split() for row in lines if row.strip().startswith("faces ")]
    assert faces[:6] == ["faces", "33", "%", "2", "1", "to"]
    assert "src/node.cpp:10" in faces
    (coverage,) = [row.split() for row in lines if row.strip().startswith("coverage ")]
    assert coverage[:4] == ["coverage", "100", "%", "0.3"]


def test_json_and_the_parameter(tmp_path, static):
    bag = write(tmp_path / "m.bag", 0.3)
    result = run("margins", bag, "--static", static, "--json", "--parameter", "faces")
    (mission,) = json.loads(result.stdout)["missions"]
    (found,) = mission["comparisons"]
    assert (found["parameter"], found["turns"], found["evaluations"]) == ("faces", 2, 120)
    assert found["margins"]["least"] == 1
    assert mission["groups"] == []


def test_several_missions_have_a_trend(tmp_path, static):
    levels = (0.05, 0.15, 0.25, 0.35, 0.45, 0.55)
    bags = [write(tmp_path / f"m{n}.bag", level) for n, level in enumerate(levels)]
    result = run("margins", *bags, "--static", static)
    assert result.exit_code == 0, result.output
    last = result.stdout[result.stdout.index("6 missions") :]
    (coverage,) = [row for row in last.splitlines() if row.strip().startswith("coverage ")]
    assert coverage.split()[1:7] == ["0.55", "0.45", "0.35", "0.25", "0.15", "0.05"]
    assert "-0.1 a mission: 0 in 1 mission" in coverage
    document = json.loads(run("margins", *bags, "--static", static, "--json").stdout)
    (over,) = [one for one in document["over"] if one["parameter"] == "coverage"]
    assert over["trend"] == pytest.approx(-0.1)
    assert over["zero_in"] == pytest.approx(0.5)


def test_sorted_and_cut(tmp_path, static):
    bag = write(tmp_path / "m.bag", 0.3)
    result = run("margins", bag, "--static", static, "--sort", "turns", "--top", 1)
    assert "faces" in result.stdout
    assert "coverage " not in result.stdout
    assert "and 1 more: --top shows more" in result.stdout


def test_a_parameter_that_is_not_there(tmp_path, static):
    bag = write(tmp_path / "m.bag", 0.3)
    result = run("margins", bag, "--static", static, "--parameter", "face")
    assert result.exit_code == 1
    assert "pytpc: error: no recorded comparison with a parameter face" in result.stderr
    assert "faces" in result.stderr


def test_the_library(tmp_path, static):
    found = margins([write(tmp_path / "m.bag", 0.3)], static)
    assert pytpc.api.margins is margins
    text = str(found.table())
    assert text.splitlines()[0].startswith("parameter  node  nearest")
    assert [one.parameter for one in found[0]] == ["coverage", "faces"]
    assert found.over[0].trend is None
