from __future__ import annotations

import base64
import hashlib
import math
import re
import weakref
from dataclasses import replace
from html import unescape
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from mission_samples import SummaryBuilder, comparison, events, key, ns, static_info
from report_samples import NASTY, Page, mission, written

from pytpc.api.report import MissionReport, write_missions
from pytpc.base.errors import TpcError
from pytpc.base.wording import percent
from pytpc.diagnosis.full_names import with_full_names
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.blame import blame
from pytpc.diagnosis.ranking.mark_ranking import rank_marks
from pytpc.diagnosis.suggestion.advise import join_advice
from pytpc.diagnosis.suggestion.whole_mission import answer_mission
from pytpc.present.page.series import (
    BINS,
    BOTH,
    FALSE,
    NOTHING,
    TRUE,
    lane,
    plot_data,
    runs,
    thin,
    with_gaps,
)
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import Mark
from pytpc.recording.mission import MalformedRecord, Recording
from pytpc.recording.summaries import Summary
from pytpc.values.origins import Origin

NAN = math.nan


# Spans of 10 points each (times 0 to 39, most = 16: 4 spans). Lowest and highest of span 0 are at 3
# and 7; the others are flat, so that only their ends (and a first lowest and last highest) stay.
def test_thin_keeps_ends_and_extremes():
    time = np.arange(40.0)
    values = np.zeros(40)
    values[3], values[7], values[5] = -5.0, 9.0, NAN
    kept = thin(time, values, 16).tolist()
    assert {0, 3, 7, 9, 10, 19, 20, 29, 30, 39} <= set(kept)
    assert 5 not in kept
    assert len(kept) <= 16
    assert thin(time, values, 40).tolist() == list(range(40))


# The largest double is not yet infinity.
def test_thin_keeps_infinities():
    most = np.finfo(np.float64).max
    values = np.array([0.0, most, np.inf, most, 0.0, -most, -np.inf, 0.0, 0.0, 0.0])
    assert {2, 6} <= set(thin(np.arange(10.0), values, 4).tolist())


@given(
    st.lists(st.tuples(st.floats(0, 1e6), st.floats()), max_size=300),
    st.integers(4, 50),
)
def test_thin_holds_its_promise(points, most):
    points = sorted(points, key=lambda point: point[0])
    time = np.array([point[0] for point in points])
    values = np.array([point[1] for point in points])
    kept = thin(time, values, most)
    assert len(kept) <= max(most, 4)
    assert sorted(set(kept.tolist())) == kept.tolist()
    known = values[~np.isnan(values)]
    if known.size:
        assert np.nanmin(values[kept]) == known.min()
        assert np.nanmax(values[kept]) == known.max()


# Steps of 1 s, then one of 15 s (over 10 medians), then of 1 s.
def test_gaps_are_not_bridged():
    time = np.array([0.0, 1.0, 2.0, 17.0, 18.0])
    parts = with_gaps(time, np.arange(5.0))
    assert np.isnan(parts[0]).tolist() == [False] * 3 + [True] + [False] * 2
    assert np.isnan(parts[1]).tolist() == [False] * 3 + [True] + [False] * 2


def recorded(table):
    """A mission of 60 s."""
    return Recording("m", table, (), 0, ns(60))


# 600 columns over 60 s, 0.1 s each: key 0 is True at 0 s, False at 0.15 s and both in column 59 at
# 5.9 s; key 1 is nobody's business. The last moment belongs to the last column.
def test_lane_and_runs():
    table = events(
        [
            (0, 0, 1, 1, 0),
            (0.15, 0, 0, 0, 0),
            (5.9, 0, 1, 1, 0),
            (5.95, 0, 0, 0, 0),
            (0.17, 1, 1, 1, 0),
            (60, 0, 1, 1, 0),
        ]
    )
    states = lane(recorded(table), key(0))
    assert (states[0], states[1], states[59], states[BINS - 1]) == (TRUE, FALSE, BOTH, TRUE)
    assert states[2] == NOTHING
    assert lane(recorded(table), key(1))[1] == TRUE
    assert runs(states) == [(TRUE, 0, 1), (FALSE, 1, 1), (BOTH, 59, 1), (TRUE, BINS - 1, 1)]


# Every second over 60 s, 10 columns each: F at 0 s holds up to the T at 1 s; after 10 s a pause.
def test_a_result_holds_until_the_next_one():
    table = events([(t, 0, t % 2, t % 2, 0) for t in (*range(11), *range(50, 60))])
    states = lane(recorded(table), key(0))
    assert states[:20].tolist() == [FALSE] * 10 + [TRUE] * 10
    assert states[100:102].tolist() == [FALSE, NOTHING]
    assert set(states[101:500].tolist()) == {NOTHING}


# A mark at 50 s of a mission from 10 to 52 s. Without flops: from 30 to 52 s. With the last flop up
# to the mark at 25 s: from 21 s. The later flop at 51 s is shown, but moves nothing.
def test_evidence_reaches_back_to_the_last_flop():
    rows = [(t, 0, 1, 5, 3) for t in range(10, 53)]
    calm = plot_data(Recording("m", events(rows), (), ns(10), ns(52)), key(0), ns(50))
    assert (calm.begin, calm.end, calm.evaluations) == (20, 42, 23)
    assert (calm.steps.tolist(), calm.outcome.tolist()) == ([20], [True])
    rows[:15] = [(t, 0, 0, 1, 3) for t in range(10, 25)]
    rows[-2:] = [(t, 0, 0, 1, 3) for t in (51, 52)]
    changed = plot_data(Recording("m", events(rows), (), ns(10), ns(52)), key(0), ns(50))
    assert (changed.begin, changed.flops.tolist()) == (11, [15, 41])
    assert changed.steps.tolist() == [11, 15, 41]
    assert changed.outcome.tolist() == [False, True, False]


@pytest.fixture(scope="module")
def page_text(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    return written(folder, mission(folder), title="<i>title</i>")


def test_the_page_asks_the_network_for_nothing(page_text):
    text = page_text
    page = Page(text)
    assert page.addresses == set()
    assert page.tags["link"] == page.tags["img"] == 0
    assert "@import" not in text
    # What the page may do is said in it: it may fetch nothing, and run what it was written with.
    policy = re.search('<meta http-equiv="Content-Security-Policy" content="([^"]*)">', text)
    assert policy is not None
    rules = dict(rule.strip().split(" ", 1) for rule in unescape(policy[1]).split(";"))
    assert rules["default-src"] == "'none'"
    assert set(rules) == {"default-src", "style-src", "img-src", "script-src"}
    assert rules["img-src"] == "data:"
    scripts = re.findall("<script>(.*?)</script>", text, re.DOTALL)
    digests = [hashlib.sha256(script.encode()).digest() for script in scripts]
    hashes = [f"'sha256-{base64.b64encode(digest).decode()}'" for digest in digests]
    assert rules["script-src"].split() == hashes
    assert page.tags["script"] == len(scripts) + 1


def test_ids_are_unique_and_every_reference_meets_one(tmp_path):
    page = Page(written(tmp_path, mission(tmp_path), mission(tmp_path)))
    assert page.tags["svg"] > 10
    assert [name for name, count in page.ids.items() if count > 1] == []
    assert {name.removeprefix("#") for name in page.references} <= set(page.ids)


def test_what_the_robot_says_is_escaped(page_text):
    page = Page(page_text)
    assert "<script>alert" not in page_text
    assert page.tags["i"] == page.tags["b"] == 0
    shown = "".join(page.text)
    assert NASTY in shown
    assert "night <flight>" in shown
    assert "by o<b>" in shown


# The first mark (type I): faces flopped a second before, at 30 s: 1 * 2 = 2; NASTY flops every
# 2.5 s, 12 times up to 31 s, the last at 30 s: 1 * 13 = 13. coverage has no flop: not ranked.
def test_what_it_says(page_text):
    text = " ".join("".join(Page(page_text).text).split())
    assert "Mark at 31.0 s type I: it did something that it should not have, by o<b>" in text
    assert "The changed parameter's position: not ranked." in text
    # Marks 1 and 3 name faces first: at 36 s both scores count, and faces, last changed 6 s before,
    # is first by type I: 6 * 2 = 12 against 1 * 15 = 15 of NASTY.
    assert "First suspect at marks 1, 3 of 3, by the score of type I." in text
    # faces >= 3 became true with 4 faces: above 4 it would not have, and there are whole faces. It
    # grew from 1 until the program acted: three times the way is 10, and above it are 11.
    assert "▲ Raise faces from 3 to 11" in text
    assert "It became true 1.00 s before the mark, with 4 against 3." in text
    assert "Any value above 4 would do at least once." in text
    assert "Why this valueabove 10: the value grew until the program acted" in text
    assert "On this recording11 answers 1 of 1 mark of type I" in text
    assert "Smallest changeraise faces from 3 to 5 (above 4)" in text
    # The nearest evaluation in the window has coverage 0.5 of 0.6: true below 0.5. From 23 to 35 s
    # there are 121 evaluations, both ends with them. They grow to it: what they had reached in the
    # middle, at 29 s, is 29/60 = 0.48333.
    assert "At mark 2 of 3: ▼ Lower coverage changed from 0.6 to 0.483" in text
    assert "Smallest changelower coverage from 0.6 to 0.499 (below 0.5)" in text
    assert "In the 12 s before the mark it was false all 121 times" in text
    assert (
        "the compared value came closest at 0.5, against 0.6."
        " Any value below 0.5 would do at least once." in text
    )
    assert "4 >= 3 was true, 0.00 s before the mark" in text
    assert "of 4 parameters have a score." in text
    assert re.search("Comparisons seen *3 of 4 found in the source", text)
    assert "coverage changed" in text
    assert "seconds since the recording began" in text


def test_source_text(page_text):
    text = page_text
    here = re.search(r'<span class="line here"><span class="lineno">11</span>([^\n]*)', text)
    assert here is not None
    assert here[1] == "    if (coverage &gt; coverage_) { // &lt;b&gt;"
    for number in (8, 14):
        assert f'<span class="lineno">{number}</span>int line{number};' in text
    assert '<span class="lineno">7</span>' not in text
    # The line in the file is another one by now, or the file is gone: what the analysis kept.
    assert "the source file has changed since the build" in text
    assert '<span class="lineno">5</span>not what is there now' in text
    assert "the source file is not on this machine" in text


# coverage is the only one with a way: it is on its card where it is ranked, folded.
def test_the_way_is_folded_on_the_card(page_text):
    ways = re.findall(r'<details class="way-of">(.*?)</details>', page_text, re.DOTALL)
    assert ways
    steps = [re.sub(r"\s+", " ", step) for step in re.findall(r"<li[^>]*>(.*?)</li>", ways[0])]
    assert steps == [
        'coverage read into &lt;i&gt; <span class="muted">src/node.cpp:3</span>'
        "<br><code>get(&amp;c); // &lt;b&gt;</code>",
        "7 steps left out",
        'compared: a &gt; b <span class="muted">src/node.cpp:11</span>'
        "<br><code>if (a &gt; b)</code>",
    ]
    assert ways[0].count('<li class="here">') == 1


def test_only_the_first_mark_is_unfolded(page_text):
    found = re.findall('<details class="mark" id="(m1-[0-9])"( open)?>', page_text)
    assert found == [("m1-1", " open"), ("m1-2", ""), ("m1-3", "")]


def test_the_same_missions_make_the_same_page(tmp_path):
    assert written(tmp_path, mission(tmp_path)) == written(tmp_path, mission(tmp_path))


def test_complaints_are_on_the_page(tmp_path):
    plain = mission(tmp_path)
    broken = MalformedRecord("/rosout", ns(1.5), "a key (a UUID) is expected, column 23", "x<y")
    recording = replace(
        plain.recording,
        malformed=1234,
        malformed_first=(broken,),
        lost={"/a": 2, "/b": 5},
        notes=("a note",),
    )
    text = "".join(Page(written(tmp_path, replace(plain, recording=recording))).text)
    assert "1,234 broken reports left out, the first on /rosout at 1.500 s" in text
    assert "7 log messages lost on the way to the recorder, most of /b (5)" in text
    assert "a note" in text


def test_missions_without_marks_or_reports(tmp_path):
    plain = mission(tmp_path)
    silent = replace(plain, recording=replace(plain.recording, marks=()), rankings=[])
    nothing = Recording("empty", events([]), (Mark(5, "II"),), 0, 10)
    empty = MissionReport(
        "empty", nothing, plain.static_info, rank_marks(nothing, silent.static_info)
    )
    text = "".join(Page(written(tmp_path, silent, empty)).text)
    assert "This recording has no marks. Add some with `pytpc mark`." in text
    assert "Not enough evidence: no" in text
    assert "No parameter has a score at any mark." in text
    assert "No missions." in "".join(Page(written(tmp_path)).text)


def test_progress_counts_every_figure(tmp_path):
    seen = []
    written(tmp_path, mission(tmp_path), on_progress=lambda *step: seen.append(step))
    # One timeline; marks of type I, II and none with 2, 3 and 3 suspects.
    assert seen == [(n, 9) for n in range(1, 10)]


def test_a_page_that_cannot_be_written_leaves_the_old_one(tmp_path, monkeypatch):
    path = tmp_path / "report.html"
    path.write_text("old")

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(TpcError, match=r"report\.html: cannot be written: No space left"):
        write_missions(path, [])
    assert path.read_text() == "old"
    assert [p.name for p in tmp_path.iterdir()] == ["report.html"]


def test_ties_and_what_is_not_enough_are_said(tmp_path):
    # Two parameters that flop at the same times have the same score.
    rows = [(t, n, t % 2, t % 2, 0.5) for t in range(20) for n in (0, 1)]
    recording = Recording("tie", events(rows), (Mark(ns(19), "I"),), 0, ns(20))
    static = static_info(comparison(0, "a"), comparison(1, "b"), comparison(2, "c"))
    rankings = rank_marks(recording, static)
    whole = written(tmp_path, MissionReport("tie", recording, static, rankings))
    assert whole.count('<td class="right number">1=</td>') == 2
    text = "".join(Page(whole).text)
    assert rankings[0].reason
    assert f"Not enough evidence: {rankings[0].reason}" in text


# The value is set in the first file, instead of in the second.
def test_where_the_value_came_from_is_on_the_card(tmp_path):
    origin = Origin(
        "/node/coverage",
        "yaml",
        0.6,
        Path("/a/very/long/way/robot/config/params<i>.yaml"),
        7,
        "coverage: 0.6  # <i>",
        via=("/launch/robot.launch:3",),
        overridden=("/else/where.yaml:9",),
    )
    report = mission(tmp_path, origins={origin.name: origin})
    found = report.static_info.comparisons[key(1)]
    static = static_info(replace(found, source="/node/coverage"), source_root=str(tmp_path))
    rankings = rank_marks(report.recording, static)
    page = Page(written(tmp_path, replace(report, static_info=static, rankings=rankings)))
    assert page.tags["i"] == 0
    text = " ".join("".join(page.text).split())
    assert "Value set in…/config/params<i>.yaml:7coverage: 0.6 # <i>" in text
    assert "Value set in/a/very/long/way/robot/config/params<i>.yaml:7coverage: 0.6" in text
    assert "loaded by /launch/robot.launch:3instead of /else/where.yaml:9" in text


# Below 0.5 would do; the highest of 0, 0.05, 0.1, ... below it is 0.45.
def test_what_is_declared_is_on_the_card(tmp_path):
    place = f"{tmp_path}/src/cfg/A.cfg:4"
    declared = Declared(
        "coverage", "double", 0.0, 0.55, 0.05, 0.5, (), "how much", place, package=str(tmp_path)
    )
    text = "".join(
        Page(written(tmp_path, mission(tmp_path, question=Question(declared=[declared])))).text
    )
    assert f"double from 0 to 0.55, in steps of 0.05 {place}" in text
    assert "Lower coverage changed from 0.6 to 0.45" in " ".join(text.split())


def test_the_package_brings_its_templates():
    folder = Path(__file__).parents[2] / "pytpc" / "present" / "page" / "templates"
    assert {p.name for p in folder.iterdir()} == {
        *("report.html.j2", "report.css"),
        *("report.js", "report-figures.js", "report-timeline.js"),
        *("tpcs.html.j2", "tpcs.css", "tpcs.js"),
    }


# Two comparisons are evaluated up to the marks at 5 and 6 s, one up to the three before: what those
# say is not what the page begins with, though they are more.
def test_marks_without_enough_evidence_do_not_make_the_answer(tmp_path):
    static = static_info(comparison(0, "alone"), comparison(1, "near"))
    rows = [(t / 10, 0, False, 1 if t < 5 else 0, 3) for t in range(70)]
    rows += [(t / 10, 1, False, 1 + t / 100, 2) for t in range(45, 70)]
    kinds = {1: "II", 2: "II", 3: "II", 5: "II", 6: "II"}
    marks = tuple(Mark(ns(second), kind) for second, kind in kinds.items())
    recording = Recording("m", events(rows), marks, 0, ns(7))
    report = MissionReport("m", recording, static, rank_marks(recording, static))
    text = " ".join("".join(Page(written(tmp_path, report)).text).split())
    first, _, rest = text.partition("The whole mission")
    assert first.index("Lower near from") < first.index("Lower alone from")
    assert "Raise" not in first
    assert "First suspect at marks 4-5 of 5" in first
    assert first.count("(not enough evidence)") == 1
    assert "Not enough evidence: only alone had been compared up to the mark." in rest
    # Where there are no others it is said before the answer.
    early = replace(recording, marks=marks[:3])
    report = replace(report, recording=early, rankings=rank_marks(early, static))
    text = " ".join("".join(Page(written(tmp_path, report)).text).split())
    why = (
        "Not enough evidence for this answer: only alone had been compared up to the mark. ▼ Lower"
    )
    assert why in text


# The marks at 26 and 31 s say the same, so that both cards and the answer have one value: what
# coverage had reached in the middle of the first one's window, 20/60. At the second alone it is
# 25/60.
def test_it_leads_with_the_value_of_pytpc_suggest(tmp_path):
    report = mission(tmp_path)
    marks = (Mark(ns(26), "II"), Mark(ns(31), "II"))
    recording = replace(report.recording, marks=marks)
    rankings = rank_marks(recording, report.static_info)
    (group,) = join_advice(recording, report.static_info, rankings)
    tried = group.suspects[0].remedy
    report = replace(report, recording=recording, rankings=rankings)
    text = " ".join("".join(Page(written(tmp_path, report)).text).split())
    claim = f"▼ Lower coverage changed from 0.6 to {tried.value}"
    assert (tried.parameter, tried.value) == ("coverage", 0.333)
    assert text.count(claim) == 3
    (alone,) = join_advice(recording, report.static_info, rankings[1:])
    assert alone.suspects[0].remedy.value == 0.416


# What all marks say together comes before what any of them says; where the marks are outside of the
# log (it ends at 6.9 s) it says why there is nothing.
def test_all_marks_together_come_first(tmp_path):
    static = static_info(comparison(0, "<b>gate"), comparison(1, "safe"))
    rows = [(t / 10, 0, t >= 50, t / 10, 5) for t in range(70)]
    rows += [(t / 10, 1, False, 1 + t / 100, 9) for t in range(70)]
    recording = Recording("m", events(rows), (Mark(ns(6), "I"), Mark(ns(6.5), "I")), 0, ns(60))
    report = MissionReport("m", recording, static, rank_marks(recording, static))
    text = " ".join("".join(Page(written(tmp_path, report)).text).split())
    found = blame(recording, static)
    said = f"All 2 marks together: 2 of type I. {found.text[0].upper()}{found.text[1:]}. To try: "
    assert said in text
    others = ", ".join(f"{s.parameter} ({percent(s.probability)})" for s in found.suspects[1:])
    assert f"Next: {others}." in text
    assert text.index(said) < text.index("First suspect at all 2 marks")
    late = replace(recording, marks=(Mark(ns(50), "I"),))
    report = MissionReport("m", late, static, rank_marks(late, static))
    text = " ".join("".join(Page(written(tmp_path, report)).text).split())
    assert (
        "The one mark: 1 of type I. Not enough evidence to suspect any parameter. "
        "Mark 1: the last report up to the mark is 43.1 s before it." in text
    )
    assert "To try: " not in text
    report = replace(report, recording=replace(late, marks=()), rankings=[])
    assert "The one mark" not in written(tmp_path, report)


# 30 summaries of 10 evaluations each, and no report.
def test_summaries_count_among_the_facts(tmp_path):
    builder = SummaryBuilder()
    for second in range(30):
        builder.add(
            Summary(
                key=key(0), node="/node", begin_ns=ns(second), end_ns=ns(second + 0.9), count=10,
                flops=0, far=10, odd=0, result=False, res=False, cmp=0.25, thresh=0.5,
                diff_min=-0.375, diff_max=-0.125, diff_mean=-0.25, abs_mean=0.25, low=0.125,
                high=0.5,
            )
        )  # fmt: skip
    static = static_info(comparison(0, "limit"), comparison(1, "never"))
    marks = (Mark(ns(20), "II"),)
    recording = Recording("m", events([]), marks, 0, ns(30), summaries=builder.build())
    report = MissionReport("m", recording, static, rank_marks(recording, static))
    text = " ".join("".join(Page(written(tmp_path, report)).text).split())
    assert re.search(r"Reports *0 \(0 per second\), and summaries of 300 evaluations", text)
    assert re.search("Comparisons seen *1 of 2 found in the source", text)
    assert re.search("Reporting nodes *1 ", text)


# Two objects evaluate the one comparison that was seen, of two in the source.
def test_objects_of_a_class_count_as_one_comparison_among_the_facts(tmp_path):
    table = events([(1, 0, 0, 1, 2), (2, 7, 0, 1, 2), (3, 7, 1, 3, 2)])
    keys = {key(0): key(0), key(7): f"{key(0)}#2"}
    table = replace(table, keys=tuple(keys[one] for one in table.keys))
    recording = Recording("m", table, (Mark(ns(5), "I"),), 0, ns(6))
    given = static_info(comparison(0, "<dynamic>/limit"), comparison(1, "never"))
    static = with_full_names(given, recording, {})
    report = MissionReport("m", recording, static, rank_marks(recording, static))
    text = " ".join("".join(Page(written(tmp_path, report)).text).split())
    assert re.search("Comparisons seen *1 of 2 found in the source", text)


# By both scores the first is faces, by type I, the second the one by type II.
def test_scores_of_both_types_say_which(tmp_path):
    report = mission(tmp_path)
    page = written(tmp_path, report)
    tables = page.split('<table class="ranking">')[1:]
    own = [set(re.findall('</span>|<span class="muted">(I+)</span></td>', one)) for one in tables]
    assert [{kind for kind in kinds if kind} for kinds in own] == [set(), set(), {"I", "II"}]
    assert "Types of the marks" not in page
    assert "doubted: suspects of the other" in written(
        tmp_path, replace(report, question=Question(types="doubt"))
    )


# With three missions the answer of the first, which has its curves, is gone when the third comes.
def test_answers_are_not_kept(tmp_path, monkeypatch):
    answers, held = [], []

    def remembered(*arguments):
        held.append(sum(answer() is not None for answer in answers))
        made = answer_mission(*arguments)
        answers.append(weakref.ref(made))
        return made

    monkeypatch.setattr("pytpc.api.report.answer_mission", remembered)
    write_missions(tmp_path / "report.html", [mission(tmp_path)] * 3)
    assert held == [0, 1, 1]
