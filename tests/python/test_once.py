"""What a command needs of a mission is read once and worked out once."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

import click
import pytest
from click.testing import CliRunner
from test_same_code import FOUR, asked, folders, marks_at

from pytpc.api import comparing, diagnosing, report, suggesting
from pytpc.cli import options
from pytpc.cli.main import main
from pytpc.cli.run_mission import _answer

__all__ = ["folders"]


@pytest.fixture
def done(monkeypatch) -> Counter:
    """Counts what is read, by the name of its folder, and the diagnoses."""
    found = Counter()

    def counted(module, name, what):
        real = getattr(module, name)

        def spy(*given, **settings):
            is_file = isinstance(given[0], Path)
            place = given[0].parent.name if is_file and given[0].is_file() else ""
            place = given[0].name if is_file and given[0].is_dir() else place
            found[f"{what} {place}".strip()] += 1
            return real(*given, **settings)

        monkeypatch.setattr(module, name, spy)

    for module in (diagnosing, report, suggesting):
        counted(module, "diagnose_mission", "diagnosis")
    counted(options, "read_named", "recording")
    counted(comparing, "read_parameters", "parameters")
    return found


@pytest.fixture
def runs(folders):
    marks = marks_at(FOUR, "II")
    bad = [folders(name, 12.0, marks=marks) for name in ("tuesday", "friday")]
    return folders("monday", 5.0), *bad


ONCE = {"recording monday": 1, "recording tuesday": 1, "parameters monday": 1,
        "parameters tuesday": 1, "diagnosis": 1}  # fmt: skip
TWICE = {**ONCE, "recording friday": 1, "parameters friday": 1, "diagnosis": 2}


@pytest.mark.parametrize("words", ["rank", "rank --json", "suggest", "report", "report --json"])
def test_one_mission(words, runs, done, tmp_path, monkeypatch):
    good, bad, _ = runs
    monkeypatch.chdir(tmp_path)
    asked(*words.split(), bad, "--reference", good)
    assert done == ONCE


@pytest.mark.parametrize("words", ["rank", "rank --json", "report", "report --json"])
def test_the_good_run_of_several_missions(words, runs, done, tmp_path, monkeypatch):
    good, bad, other = runs
    monkeypatch.chdir(tmp_path)
    asked(*words.split(), bad, other, "--reference", good)
    assert done == TWICE


# `run` has read the recording before, to count its marks.
def test_the_end_of_run(runs, done):
    good, bad, _ = runs
    with click.Context(main), CliRunner().isolation() as (out, _err, _both):
        _answer(options.recording_of(bad), bad, [good])
    said = out.getvalue().decode()
    assert done == ONCE
    assert "blame ~fastest" in said
    assert f"1 mission with 4 marks: {bad / 'report.html'}" in said
    assert f"next: pytpc apply {bad} fastest 5" in said
    assert (bad / "report.html").is_file()


def test_report_and_rank_say_the_same(runs, tmp_path):
    good, bad, _ = runs
    page = tmp_path / "page.html"
    (ranked, *_) = json.loads(asked("rank", bad, "--reference", good, "--json"))
    (told,) = json.loads(asked("report", bad, "--reference", good, "--json", "-o", page))[
        "missions"
    ]
    assert told["diagnosis"] == ranked["diagnosis"]
