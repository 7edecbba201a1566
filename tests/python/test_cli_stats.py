"""The command stats: what it writes where, and one line for each error."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from mission_samples import BagFile, comparison, key, line, static_info

from pytpc.cli.main import main

TREATMENT = {
    "name": "high",
    "type": "type2",
    "parameter": "~limit",
    "node": "/node",
    "old": 3,
    "new": 9,
    "launch": {},
    "effect": "waits",
}


@pytest.fixture
def study(tmp_path) -> Path:
    """Two missions of a treatment in a folder, static information and the treatment beside."""
    static_info(comparison(0, "~limit"), comparison(1, "~other")).save(tmp_path / "static.json")
    (tmp_path / "treatments" / "high").mkdir(parents=True)
    (tmp_path / "treatments" / "high" / "treatment.json").write_text(json.dumps(TREATMENT))
    (tmp_path / "treatments" / "high" / "params.yaml").write_text("{}\n")
    for seed in (2, 1):
        folder = tmp_path / "missions" / f"m{seed}"
        folder.mkdir(parents=True)
        args = {"seed": str(seed), "treatment": "/gone/high/params.yaml"}
        (folder / "run.json").write_text(json.dumps({"args": args, "bag": "mission.bag"}))
        with BagFile(folder / "mission.bag") as bag:
            bag.log(100, "/node", line(0, 0, 1, 9))
            bag.log(104, "/node", line(0, 0, 5, 9))
            bag.log(105, "/node", line(1, 1, 5, 4))
            bag.log(110, "/node", line(0, 0, 6, 9))
            bag.mark(106 + seed, "/marks0/mark_no_action")
    return tmp_path


def stats(study: Path, *arguments: object, missions: str = "missions") -> Result:
    command = ["stats", study / missions, "--static", study / "static.json"]
    command += ["--treatments", study / "treatments", *arguments]
    return CliRunner().invoke(main, [str(argument) for argument in command])


# Each mission takes 10 s. ~limit: 3 evaluations in each, 6 / 20 s. It should have flopped at 104 s
# (5 is above 3), the marks are at 107 and 108 s.
def test_json_of_all_tables(study):
    result = stats(study, "--json")
    assert result.exit_code == 0, result.output
    tables = {table["thesis"]: table for table in json.loads(result.stdout)}
    assert list(tables) == ["6.12", "6.13", "6.14", "6.15", "6.16"]
    (limit, _) = tables["6.12"]["rows"]
    assert (limit["parameter"], limit["comparisons"], limit["frequency per s"]) == (
        "~limit",
        6,
        0.3,
    )
    assert [row["marks0 delay s"] for row in tables["6.14"]["rows"]] == [3.0, 4.0]
    assert [row["trial"] for row in tables["6.14"]["rows"]] == ["high trial 1", "high trial 2"]
    assert tables["6.13"]["rows"] == [
        {"treatment": "Treatment Type II", "type i marks": 0, "type ii marks": 2}
    ]


def test_tables_are_chosen_by_name_or_number(study):
    by_name = stats(study, "--table", "delays", "--table", "6.13")
    by_number = stats(study, "--table", "6.14", "--table", "confusion")
    assert by_name.stdout == by_number.stdout
    lines = by_name.stdout.splitlines()
    assert lines[0] == (
        "Delays from error to the first mark by the users, in seconds (as table 6.14)"
    )
    cells = [text.split() for text in lines if text.strip().startswith("high trial")]
    assert cells == [
        ["high", "trial", "1", "4.00", "3.00", "3.00"],
        ["high", "trial", "2", "4.00", "4.00", "4.00"],
    ]
    assert "0 of 2 marks are of the wrong type." in lines


# The mark of the first trial is at 107 s. In the 12 s before it ~limit is 1 and 5 against 9:
# (8 + 4) / 2 / (9 - 1) = 0.75. In the 2 s before it nothing was compared with it.
def test_table_6_16_with_another_window(study):
    def score(*arguments):
        (table,) = json.loads(stats(study, "--table", "6.16", "--json", *arguments).stdout)
        return table["rows"][0]["type ii rank"], table["rows"][0]["type ii score"]

    assert score() == (1, 0.75)
    assert score("--window", "2") == (0, 9999.9)


def test_csv_is_one_table_or_a_folder_of_them(study, tmp_path):
    one = stats(study, "--table", "6.14", "--format", "csv")
    rows = list(csv.reader(io.StringIO(one.stdout)))
    assert rows == [
        ["trial", "error began at s", "marks0 delay s", "mean delay s"],
        ["high trial 1", "4", "3", "3"],
        ["high trial 2", "4", "4", "4"],
    ]
    several = stats(study, "--format", "csv")
    assert several.exit_code == 2
    assert "several tables as CSV" in several.output
    out = stats(study, "--format", "csv", "-o", tmp_path / "out")
    assert out.exit_code == 0, out.output
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == [
        "confusion.csv",
        "delays.csv",
        "found.csv",
        "marks.csv",
        "runtime.csv",
    ]
    assert (tmp_path / "out" / "delays.csv").read_text() == one.stdout


@pytest.mark.parametrize(
    ("form", "begins"), [("text", "Runtime"), ("markdown", "## Runtime"), ("latex", r"{\foot")]
)
def test_a_file_of_all_tables(study, tmp_path, form, begins):
    result = stats(study, "--format", form, "-o", tmp_path / "out" / "study")
    assert result.exit_code == 0, result.output
    assert result.stdout == ""
    text = (tmp_path / "out" / "study").read_text()
    assert text.startswith(begins)
    assert "high trial 2" in text


def test_figures(study, tmp_path):
    figures = tmp_path / "figures"
    more = ["--figure-format", "svg", "--state", "/nothing.x"]
    result = stats(study, "--table", "6.13", "--figures", figures, *more)
    assert result.exit_code == 0, result.output
    assert sorted(path.name for path in figures.iterdir()) == [
        "high-trial-1.svg",
        "high-trial-2.svg",
        "runtime.svg",
    ]
    assert "high trial 1: " in result.stderr
    assert "no topic /nothing" in result.stderr
    assert ">~limit<" in (figures / "runtime.svg").read_text()


def test_a_bag_alone_has_no_treatment(study):
    bag = study / "alone.bag"
    with BagFile(bag) as writer:
        writer.log(100, "/node", line(0, 0, 1, 9))
        writer.log(101, "/node", "threshold_information:broken")
    result = stats(study, missions="alone.bag")
    assert result.exit_code == 0, result.output
    assert result.stdout.count("No mission has anything for it.") == 3
    assert "alone: its treatment is unknown" in result.stderr
    assert "alone: 1 broken report left out" in result.stderr


def test_errors_are_one_line(study, tmp_path):
    static_info(comparison(7, "~else")).save(tmp_path / "else.json")
    (tmp_path / "blocked").write_text("")
    for arguments, said in (
        (["--static", tmp_path / "else.json"], "it is of another build"),
        (["--treatments", tmp_path / "none"], "none: no such folder of treatments"),
        (["-o", tmp_path / "blocked" / "out"], "cannot be written"),
        (["--table", "6.13", "--figures", tmp_path / "blocked"], "cannot be written"),
        ([study / "missions" / "m1"], "m1: this mission is given twice"),
        ([tmp_path / "gone"], "gone: no such bag, file or folder"),
    ):
        result = stats(study, *arguments)
        assert result.exit_code == 1, arguments
        (error,) = [text for text in result.stderr.splitlines() if ": error: " in text]
        assert said in error
        assert "Traceback" not in result.output


def test_broken_missions_are_one_line_each(study):
    mission = study / "missions" / "m1"
    for name, data, said in (
        ("treatment.json", b"{", "treatment.json:1: not JSON"),
        ("run.json", b"[]", "run.json: not a run's file"),
        ("mission.bag", (mission / "mission.bag").read_bytes()[:3000], "mission.bag: "),
    ):
        before = (mission / name).read_bytes() if (mission / name).exists() else None
        (mission / name).write_bytes(data)
        result = stats(study)
        assert result.exit_code == 1, name
        (error,) = result.stderr.splitlines()
        assert error.startswith("pytpc: error: ")
        assert said in error
        if before is None:
            (mission / name).unlink()
        else:
            (mission / name).write_bytes(before)
    assert stats(study).exit_code == 0


def test_the_words_of_the_help():
    result = CliRunner().invoke(main, ["stats", "--help"])
    assert result.exit_code == 0
    assert "6.12" in result.output
    assert CliRunner().invoke(main, ["stats"]).exit_code == 2


def test_reports_of_objects_are_of_this_build(study):
    with BagFile(study / "bare.bag") as bag:
        for at, result in ((100, 0), (104, 1)):
            bag.log(at, "/node", line(0, result, 5, 4).replace(key(0), f"{key(0)}#2"))
        bag.mark(106, "/marks0/mark_action")
    result = stats(study, "--table", "runtime", "--json", missions="bare.bag")
    assert result.exit_code == 0, result.output
    ranked = CliRunner().invoke(
        main, ["rank", str(study / "bare.bag"), "--static", str(study / "static.json")]
    )
    assert ranked.exit_code == 0, ranked.output
    assert "~limit" in ranked.stdout
