"""The command ``study report``, the figures of the benchmark, and what is missing on the page."""

from __future__ import annotations

import importlib.util
import json
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner
from study_pages import row_of
from study_samples import fly, plan, write_rows

from pytpc.base.errors import InputError
from pytpc_evaluation.commands.study_commands import study_group
from pytpc_evaluation.study.report.making import ReportOptions, make_report

ROOT = Path(__file__).parents[2]


def test_the_command(own_study, tmp_path):
    page = tmp_path / "docs/study.md"
    words = [
        "report",
        "--out",
        str(own_study),
        "--docs",
        str(page),
        "--half",
        "held-back",
        "--json",
    ]
    result = CliRunner().invoke(study_group, words)
    assert result.exit_code == 0
    document = json.loads(result.stdout)
    assert document == json.loads((page.parent / "study/results.json").read_text())
    assert "warning: The clean reference of alpha is missing" in result.stderr
    assert "Only the held-back half" in page.read_text()


def benchmark():
    spec = importlib.util.spec_from_file_location("study_figures", ROOT / "benchmarks/study.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_figures_of_the_benchmark(study, made_study, tmp_path, capsys, monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    results = made_study.page.parent / "study/figures.json"
    benchmark().main(["--out", str(tmp_path / "none"), "--results", str(results)])
    committed = capsys.readouterr().out.splitlines()
    benchmark().main(["--out", str(study), "--results", str(tmp_path / "none.json")])
    fresh = capsys.readouterr().out.splitlines()
    assert committed[0].startswith("# from ") and str(results) in committed[0]
    assert fresh[0].startswith("# from ") and str(study) in fresh[0]
    assert committed[1:] == fresh[1:]
    assert committed[1:] == [
        "FIGURE study top3-typed value=75 unit=% target=>=90 verdict=miss",
        "FIGURE study top3-typed-thesis value=37.5 unit=% target=>=90 verdict=miss",
        "FIGURE study top3-untyped value=100 unit=% target=>=80 verdict=hit",
        "FIGURE study top3-confused value=25 unit=% target=>=80 verdict=miss",
        "FIGURE study suggestions-gone value=25 unit=% target=>=80 verdict=miss",
        "FIGURE study suggestions-gone-none-new value=25 unit=% target=>=80 verdict=miss",
        "FIGURE study suggestions-gone-smallest value=100 unit=% target=>=80 verdict=hit",
        "FIGURE study suggestions-gone-none-new-smallest value=0 unit=% target=>=80 verdict=miss",
        "FIGURE study top3-typed-second-round value=100 unit=% target=>=90 verdict=hit",
        "FIGURE study top3-typed-thesis-second-round value=0 unit=% target=>=90 verdict=miss",
        "FIGURE study top3-untyped-second-round value=100 unit=% target=>=80 verdict=hit",
        "FIGURE study top3-confused-second-round value=0 unit=% target=>=80 verdict=miss",
        "FIGURE study suggestions-gone-second-round value=0 unit=% target=>=80 verdict=miss",
        "FIGURE study suggestions-gone-none-new-second-round value=0 unit=% target=>=80"
        " verdict=miss",
    ]


def test_without_results_the_rest_is_there(own_study, tmp_path):
    shutil.rmtree(own_study / "results")
    made = make_report(own_study, tmp_path / "study.md", ReportOptions(draw=False))
    text = made.page.read_text()
    assert "Nothing has been ranked yet." in made.troubles
    assert "Nothing has been flown again as suggested yet." in made.troubles
    assert "- Nothing has been ranked yet." in text
    assert "No result can be judged yet." in text
    tables = (tmp_path / "study/tables.md").read_text()
    assert row_of(tables, "alpha: ranks at marks", "type1_low")[0] == "1"
    assert made.numbers["figures"] == []


@pytest.mark.parametrize(
    ("spoil", "said"),
    [
        (lambda s: (s / "systems/alpha/static.json").unlink(), "alpha is left out: systems/alpha"),
        (
            lambda s: (s / "missions/alpha/clean/seed-1/done.json").unlink(),
            "missions/alpha/clean/seed-1 is left out: it was not flown to its end.",
        ),
        (
            lambda s: (s / "missions/alpha/clean/seed-1/events.parquet").write_text("x"),
            "missions/alpha/clean/seed-1 is left out: missions/alpha/clean/seed-1/events.parquet:",
        ),
        (
            lambda s: (s / "missions/alpha/clean/seed-1/treatment.json").unlink(),
            "missions/alpha/clean/seed-1 is left out: it has no treatment.json.",
        ),
        (
            lambda s: write_rows(s / "results/positions.parquet", [{"system": "alpha"}]),
            "positions.parquet is left out: no column treatment.",
        ),
        (lambda s: shutil.rmtree(s / "missions"), "No mission has been flown."),
    ],
    ids=["static", "unfinished", "events", "treatment", "positions", "nothing"],
)
def test_what_is_missing_is_said(own_study, tmp_path, spoil, said):
    spoil(own_study)
    made = make_report(own_study, tmp_path / "study.md", ReportOptions(draw=False))
    assert any(trouble.startswith(said) for trouble in made.troubles), made.troubles
    assert str(own_study) not in made.page.read_text()


def test_missions_that_failed_or_went_wrong_are_on_the_page(own_study, tmp_path):
    document = json.loads((own_study / "study.json").read_text())
    failed = {"state": "failed", "error": "the node died"}
    document["missions"] += [
        plan("alpha", "type1_x", 1, "tuning", **failed),
        plan("alpha", "type1_x", 2, "tuning", state="planned"),
    ]
    document["missions"][0]["remarks"] = ["the observer saw nothing"]
    document["systems"] = [{"name": "alpha"}, {"name": "omega"}]
    (own_study / "study.json").write_text(json.dumps(document))
    made = make_report(own_study, tmp_path / "study.md", ReportOptions(draw=False))
    assert "missions/alpha/type1_x/seed-1 failed: the node died." in made.troubles
    assert "Still to be flown: 1 mission of alpha." in made.troubles
    assert "No mission of omega has been flown." in made.troubles
    page = made.page.read_text().replace("\\", "")
    assert "- alpha/type1_low/seed-1: the observer saw nothing" in page


def test_a_mission_that_is_not_planned_is_in_no_half(own_study, tmp_path):
    treatment = {"type": "type1", "parameter": "~low", "node": "/node", "old": 8, "new": 5}
    fly(own_study, ("alpha", "type1_new", 1), treatment, [])
    made = make_report(own_study, tmp_path / "study.md", ReportOptions(draw=False))
    tables = (tmp_path / "study/tables.md").read_text()
    assert row_of(tables, "The treatments", "alpha", "type1_new")[1] == "unknown"
    assert "type1_new" not in json.dumps(made.numbers["tables"]["repairs-all"])


def test_no_study_there(tmp_path):
    with pytest.raises(InputError, match="no such folder"):
        make_report(tmp_path / "none", tmp_path / "study.md")
    (tmp_path / "study.json").write_text("[]")
    with pytest.raises(InputError, match="an object is expected"):
        make_report(tmp_path, tmp_path / "study.md")
