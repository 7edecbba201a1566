"""``import pytpc``: what a notebook gets, and what it costs."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from mission_samples import comparison, events, ns, static_info

import pytpc
import pytpc_evaluation
from pytpc import api
from pytpc.api import diagnosing
from pytpc.base.errors import InputError
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.suggestion.advise import join_advice
from pytpc.present.answers import NotebookTable
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc_evaluation.stats import notebook_tables

EXAMPLE = Path(__file__).parents[2] / "examples/recorded_mission"
BAD = '~a<script>alert("1")</script>\x1b[2J'

# ~limit stays 1 below its 3, then 2 below; ~far 5 below its 9 all the time. Window of the mark at
# 10 s: ~limit D = ((3-2) + (3-1)) / 2 / (3 - 1) = 0.75; ~far ((9-4) + (9-3)) / 2 / (9 - 3) = 0.917.
STATIC = static_info(comparison(0, "~limit"), comparison(1, "~far"))
EVENTS = events([(1, 0, 0, 2, 3), (2, 1, 0, 4, 9), (3, 0, 0, 1, 3), (4, 1, 0, 3, 9)])
MISSION = Recording("m", EVENTS, (Mark(ns(10), "II"),), 0, ns(12))


# The 12 s before 20 s have nothing; the 19 s before it have ~limit's 2 and 1
# against 3 (D as above), of which 2 > 3 turns below 2.
def test_advice_looks_at_the_window_that_ranked():
    later = replace(MISSION, marks=(Mark(ns(20), "II"),))
    rankings = pytpc.rank(later, STATIC, window_s=19)
    assert rankings[0].suspects[0].score == 0.75
    (first, _) = pytpc.suggest(rankings, declared=())
    assert (first.suggestion.boundary, first.what_if.answered) == (2, 1)


def test_import_is_lazy():
    code = "import sys, pytpc; print('numpy' in sys.modules, 'pytpc.api.diagnosing' in sys.modules)"
    said = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert said.stdout.split() == ["False", "False"]


def test_all_names_are_there_and_documented():
    assert set(pytpc.__all__) <= set(dir(api))
    for name in pytpc.__all__:
        assert getattr(pytpc, name) is getattr(api, name)
        assert getattr(pytpc, name).__doc__
        assert name in dir(pytpc)
    for name in pytpc_evaluation.__all__:
        assert getattr(pytpc_evaluation, name) is getattr(notebook_tables, name)
        assert name in dir(pytpc_evaluation)
    with pytest.raises(AttributeError, match="no_such_name"):
        pytpc.no_such_name  # noqa: B018


# A folder of the package must not stand in the way of a function of the same name.
def test_no_name_is_that_of_a_module():
    folder = Path(api.__file__).parent
    modules = {path.stem for path in folder.iterdir()}
    assert not modules & set(pytpc.__all__)
    assert not modules & set(api._MODULES)


@pytest.mark.parametrize("name", sorted(api._MODULES))
def test_the_one_door_has_every_verb(name):
    assert getattr(api, name).__doc__


# The same settings, one by one and as one object; both at once are a slip.
def test_a_question_has_all_settings():
    asked = Question(types="ignore", window_s=8, top=1)
    single = pytpc.rank(MISSION, STATIC, types="ignore", window_s=8)
    assert pytpc.rank(MISSION, STATIC, question=asked).rankings == single.rankings
    asked = Question(types="ignore", top=1)
    found = pytpc.diagnose(MISSION, STATIC, asked)
    assert found == pytpc.diagnose(MISSION, STATIC, types="ignore", top=1)
    with pytest.raises(TypeError, match=r"^give a question or single settings, not both$"):
        pytpc.rank(MISSION, STATIC, Question(types="ignore"), types="doubt")
    with pytest.raises(TypeError, match=r"^give a question or single settings, not both$"):
        pytpc.diagnose(MISSION, STATIC, asked, top=1)


def test_a_ranking_as_rows_and_as_text():
    rankings = pytpc.rank(MISSION, STATIC)
    assert len(rankings) == 1
    assert rankings[0] is next(iter(rankings))
    (first, second) = rankings.rows()
    assert (first["parameter"], second["parameter"]) == ("~limit", "~far")
    assert first["score"] == pytest.approx(0.75)
    assert second["score"] == pytest.approx(5.5 / 6)
    assert (first["mark"], first["seconds"], first["position"]) == (1, 10.0, 1)
    assert str(rankings).splitlines() == [
        "mark      at  type  #  parameter  rank  score  compared at",
        "   1  10.0 s  II    1  ~limit     1.00   0.75  src/node.cpp:10",
        "   1  10.0 s  II    2  ~far       0.50  0.917  src/node.cpp:11",
    ]
    assert rankings[0:1] == (rankings[0],)


def test_nothing_is_ranked_without_marks_or_evidence():
    with pytest.raises(InputError, match="no marks"):
        pytpc.rank(replace(MISSION, marks=()), STATIC)
    early = replace(MISSION, marks=(Mark(0, "II"),))
    text = str(pytpc.rank(early, STATIC))
    assert pytpc.rank(early, STATIC)[0].reason in text


# To go below 2 and 1, ~limit (cmp > 3) has to be lowered; just below 2 is the smallest change.
def test_suggestions():
    rankings = pytpc.rank(MISSION, STATIC)
    (one,) = pytpc.suggest(rankings, 1, top=1)
    assert one.suggestion.direction == "lower"
    assert 1 < float(one.suggestion.value or 0) < 2
    # The value to try is that of the command line, for all marks that say the same.
    assert one.remedy is not None
    assert one.tried is not None
    (group,) = join_advice(MISSION, STATIC, list(rankings), Question(top=1))
    assert one.remedy == group.suspects[0].remedy
    assert one.tried.value == one.remedy.value
    said = str(pytpc.suggest(rankings, 1, top=1))
    assert f"lower to {one.remedy.value}" in said
    assert said.endswith(f"lower to {one.suggestion.value}")
    with pytest.raises(IndexError, match="mark 2 of 1"):
        pytpc.suggest(rankings, 2)
    then = pytpc.what_if(MISSION, STATIC, "limit", 0.5, kind="II")
    assert (then.answered, then.marks, then.evaluations) == (1, 1, 2)


def test_html_is_escaped():
    static = static_info(comparison(0, BAD), comparison(1, "~far"))
    rankings = pytpc.rank(MISSION, static)
    for html in (rankings._repr_html_(), pytpc.suggest(rankings)._repr_html_()):
        assert "<script" not in html
        assert "\x1b" not in html
        assert "&lt;script&gt;alert(&quot;1&quot;)" in html
    assert "\x1b" not in str(rankings)


def test_a_table_of_wide_characters():
    table = NotebookTable(("a", "n"), (("漢字", "1"), ("x", "10")), frozenset({1}), "t")
    assert str(table).splitlines() == ["t", "a      n", "漢字   1", "x     10"]
    assert table._repr_html_().startswith("<table><caption>t</caption>")


def test_paths_do_as_well_as_objects(tmp_path: Path):
    rankings = pytpc.rank(EXAMPLE, str(EXAMPLE / "static.json"), types="doubt")
    assert len(rankings) == 5
    # What was changed in this mission, and at how many marks of which type: treatment.json.
    table = pytpc_evaluation.study_tables([EXAMPLE], EXAMPLE / "static.json", ["confusion"])[
        "confusion"
    ]
    assert list(table.rows()[0].values()) == ["Treatment Type II", 1, 4]
    assert "Treatment Type II" in table._repr_html_()
    assert "Treatment Type II" in str(table)
    page = pytpc.write_report(tmp_path / "page.html", rankings)
    assert "~min_coverage_limit" in page.read_text()
    # What had been done to the robot is in the mission's folder: only a study shows it.
    effect = "The UAV hovers in front of the person and never takes the picture."
    assert effect not in page.read_text()
    assert effect in pytpc.write_report(page, rankings, with_treatment=True).read_text()
    read = pytpc.rank(pytpc.read(EXAMPLE), EXAMPLE / "static.json")
    assert effect not in pytpc.write_report(page, read, with_treatment=True).read_text()


# The example shows lines of the sources beside it, which may have been edited since.
def test_the_example_fits_its_sources():
    static = pytpc.load_static(EXAMPLE / "static.json")
    assert static.comparisons
    for key, found in static.comparisons.items():
        lines = static.source_path(key).read_text().splitlines()
        assert lines[found.lineno - 1].strip() == found.source_code.strip()


# In [2, 10] there is the 1 of ~limit alone: below 1 it goes the other way; in twelve seconds the 2.
def test_what_is_made_of_a_ranking_has_its_window(tmp_path: Path):
    rankings = pytpc.rank(MISSION, STATIC, window_s=8, types="ignore")
    for ranked, boundary in ((rankings, 1), (pytpc.rank(MISSION, STATIC), 2)):
        found = {one.suspect.parameter: one.suggestion for one in pytpc.suggest(ranked)}
        assert found["~limit"].boundary == boundary
    page = pytpc.write_report(tmp_path / "page.html", rankings).read_text()
    assert "In the 8 s before the mark" in page
    assert "ignored: ranked by both scores combined" in page


# What the packages declare is in the library's page as it is in the command line's.
def test_declared_ranges_are_on_the_page(tmp_path: Path):
    (tmp_path / "package.xml").write_text("<package/>")
    (tmp_path / "node.cfg").write_text(
        "from dynamic_reconfigure.parameter_generator_catkin import *\n"
        "gen = ParameterGenerator()\n"
        'gen.add("limit", double_t, 0, "A limit", 3.0, 1.5, 5.0)\n'
    )
    static = static_info(comparison(0, "~limit"), comparison(1, "~far"), source_root=str(tmp_path))
    page = pytpc.write_report(tmp_path / "page.html", pytpc.rank(MISSION, static)).read_text()
    assert "double from 1.5 to 5" in page


# ~limit is the one whose value comes nearer. The first line is which marks they are, the second the
# verdict, the third of one mark that it is not sure.
def test_all_marks_together():
    found = pytpc.diagnose(MISSION, STATIC)
    lines = str(found).splitlines()
    assert lines[0] == "The one mark: 1 of type II"
    assert lines[1] == found.blame.text
    assert [row["parameter"] for row in found.rows()] == [s.parameter for s in found.blame.suspects]
    assert {row["place"] for row in found.rows()} == {"src/node.cpp:10", "src/node.cpp:11"}
    assert found.confidence == found.rows()[0]["probability"]
    assert found.accused in {None, found.rows()[0]["parameter"]}
    assert len(pytpc.diagnose(MISSION, STATIC, top=1).advice) == 1
    # What is not as it was is the likelier.
    for name in ("~limit", "~far"):
        changed = pytpc.diagnose(MISSION, STATIC, changes=[pytpc.Change(name, "", 1, 2)])
        plainly = {row["parameter"]: row["probability"] for row in found.rows()}
        chances = {row["parameter"]: row["probability"] for row in changed.rows()}
        assert chances[name] > plainly[name]
    reference = replace(MISSION, marks=())
    same = pytpc.diagnose(MISSION, STATIC, reference=reference)
    assert same.blame.none > found.blame.none
    with pytest.raises(InputError, match="no marks"):
        pytpc.diagnose(replace(MISSION, marks=()), STATIC)


def test_all_marks_together_are_escaped():
    found = pytpc.diagnose(MISSION, static_info(comparison(0, BAD), comparison(1, "~far")))
    assert "<script" not in found._repr_html_()
    assert "\x1b" not in found._repr_html_() + str(found)
    nobody = pytpc.diagnose(replace(MISSION, marks=(Mark(ns(100), "II"),)), STATIC)
    assert str(nobody).splitlines()[1:] == [
        "not enough evidence to suspect any parameter",
        "mark 1: the last report up to the mark is 96 s before it",
    ]
    assert "<table" not in nobody._repr_html_()


def test_a_misspelt_setting_of_diagnose_is_an_error():
    with pytest.raises(TypeError, match=r"^there is no setting typs$"):
        pytpc.diagnose(MISSION, STATIC, typs="ignore")


@pytest.mark.parametrize(
    ("verb", "settings"),
    [
        (pytpc.rank, {"reference": MISSION}),
        (pytpc.rank, {"flown": (1.0,)}),
        (pytpc.curves, {"top": 3}),
        (pytpc.diagnose, {"declared": ()}),
    ],
)
def test_a_setting_of_another_verb_is_an_error(verb, settings):
    with pytest.raises(TypeError, match=f"^there is no setting {next(iter(settings))}$"):
        verb(MISSION, STATIC, **settings)


def test_declared_ranges_are_looked_for_once(monkeypatch):
    looked = []
    monkeypatch.setattr(diagnosing, "find_declared", lambda *_: looked.append(1) or [])
    rankings = pytpc.rank(MISSION, STATIC)
    assert rankings.declared == [] and len(looked) == 1
    asked = replace(rankings, question=replace(rankings.question, declared=[]))
    assert asked.declared == [] and len(looked) == 1
