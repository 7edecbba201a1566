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
from hypothesis import given, settings
from hypothesis import strategies as st
from mission_samples import SummaryBuilder, comparison, events, key, ns, static_info
from report_samples import NASTY, Page, mission, written

from pytpc.api.comparing import RecordedRun, beside
from pytpc.api.report import MissionReport, write_missions
from pytpc.base.errors import TpcError
from pytpc.base.wording import exact, percent
from pytpc.diagnosis.diagnose import diagnose_mission
from pytpc.diagnosis.full_names import with_full_names
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.mark_ranking import rank_marks
from pytpc.diagnosis.results.advice import BlamedAdvice, Remedy
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.diagnosis.results.differences import Difference, RunDifferences, SetValue
from pytpc.diagnosis.results.mission_answer import MissionAnswer
from pytpc.diagnosis.results.suspects import Accused, Blame, Evaluation
from pytpc.diagnosis.suggestion.whole_mission import answer_mission
from pytpc.present.page.html import page_text as page_text_of
from pytpc.present.page.reported_mission import ReportedMission
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
    assert text.count("At this mark alone, by the score of type I ") == 2
    assert text.count("At this mark alone, by the score of type II ") == 1
    assert text.count("At this mark alone, by the score of type I and type II ") == 1
    # faces >= 3 became true with 4 faces: above 4 it would not have, and there are whole faces.
    assert "It became true 1.00 s before the mark, with 4 against 3." in text
    assert "Any value above 4 would do at least once." in text
    assert "1 faces 3; smallest change: raise to 5" in text
    assert "Smallest changeraise faces from 3 to 5 (above 4)" in text
    assert "On this recording5 answers 2 of 2 marks; away from marks it turns" in text
    # The nearest evaluation in the window has coverage 0.5 of 0.6: true below 0.5. From 23 to 35 s
    # there are 121 evaluations, both ends with them.
    assert "1 coverage changed 0.6; smallest change: lower to 0.499" in text
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


def test_the_marks_alone_are_folded(page_text):
    found = re.findall('<details class="mark" id="(m1-[0-9])"( open)?>', page_text)
    assert found == [("m1-1", ""), ("m1-2", ""), ("m1-3", "")]


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
    assert "No marks, so no verdict." in text
    assert "Add marks with pytpc mark, and write this page again." in text
    assert "Not enough evidence: no" in text
    assert "Not enough evidence to suspect any parameter." in text
    assert "No missions." in "".join(Page(written(tmp_path)).text)


def test_progress_counts_every_figure(tmp_path):
    seen = []
    written(tmp_path, mission(tmp_path), on_progress=lambda *step: seen.append(step))
    # One timeline, the first suspect; marks of type I, II and none with 2, 3 and 3 suspects.
    assert seen == [(n, 10) for n in range(1, 11)]


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
    assert "coverage changed 0.6; smallest change: lower to 0.45" in " ".join(text.split())


def test_the_package_brings_its_templates():
    folder = Path(__file__).parents[2] / "pytpc" / "present" / "page" / "templates"
    assert {p.name for p in folder.iterdir()} == {
        *("report.html.j2", "report.css"),
        *("theme.js", "cards.js", "report.js", "report-figures.js", "report-timeline.js"),
        *("tpcs.html.j2", "tpcs.css", "tpcs.js"),
        *("fleet.html.j2", "fleet.css", "fleet.js"),
        *("fleet-ranking.html.j2", "fleet-drifts.html.j2"),
        *("fleet-outliers.html.j2", "fleet-found.html.j2"),
    }


# What all marks say together comes before what any of them says, in the words of the diagnosis;
# where the marks are outside of the log (it ends at 6.9 s) it says why there is nothing.
def test_all_marks_together_come_first(tmp_path):
    static = static_info(comparison(0, "<b>gate"), comparison(1, "safe"))
    rows = [(t / 10, 0, t >= 50, t / 10, 5) for t in range(70)]
    rows += [(t / 10, 1, False, 1 + t / 100, 9) for t in range(70)]
    recording = Recording("m", events(rows), (Mark(ns(6), "I"), Mark(ns(6.5), "I")), 0, ns(60))
    report = MissionReport("m", recording, static, rank_marks(recording, static))
    page = written(tmp_path, report)
    text = " ".join("".join(Page(page).text).split())
    found = diagnose_mission(recording, static)
    headline = f"{found.headline[0].upper()}{found.headline[1:]}."
    said = f"All 2 marks together: 2 of type I {headline}"
    assert said in text
    assert text.index(said) < text.index("Each mark alone")
    # None of the parameters is likelier than the first one: nothing is to be tried, and no value is
    # in large letters.
    assert found.is_none_likeliest
    assert claims(page) == [headline]
    first = found.shown[0].accused
    assert f"The likeliest of the compared parameters ({percent(first.probability)}): <b>" in text
    # One list of all suspects, with what is folded: none is set above the others.
    assert re.search(rf"Suspects {first.parameter} +{percent(first.probability)}", text)
    assert "Other suspects" not in text
    late = replace(recording, marks=(Mark(ns(50), "I"),))
    report = MissionReport("m", late, static, rank_marks(late, static))
    text = " ".join("".join(Page(written(tmp_path, report)).text).split())
    assert (
        "The one mark: 1 of type I Not enough evidence to suspect any parameter. "
        "Mark 1: the last report up to the mark is 43.1 s before it." in text
    )
    report = replace(report, recording=replace(late, marks=()), rankings=[])
    assert "The one mark" not in written(tmp_path, report)


# The good run had another limit of coverage, so that is to blame. Its evidence is that of the mark
# where it is most suspicious, with the value of the good run in the legend.
def test_the_evidence_is_that_of_the_first_suspect(tmp_path):
    report = accused_coverage(tmp_path)
    found = diagnose_mission(report.recording, report.static_info, report.question)
    assert (found.accused, found.advice[0].remedy.value) == ("/node/coverage", 0.25)
    page = written(tmp_path, report)
    assert claims(page)[1].startswith("▼ Lower /node/coverage from 0.6 to 0.25 (")
    text = " ".join("".join(Page(page).text).split())
    assert re.search(r"The evidence for /node/coverage changed, at mark \d of 2 ", text)
    assert "to try: 0.25 " in text
    lead = report.answered().answer.lead
    assert lead is not None
    places = [ranking.position_of("/node/coverage") for ranking in report.rankings]
    assert lead.number == places.index(min(places)) + 1
    assert (lead.suggested, lead.accused.type) == (0.25, "II")


def claims(page):
    """What the page says in large letters."""
    found = re.findall(r'<p class="claim[^"]*">(.*?)</p>', page, re.DOTALL)
    return [" ".join(unescape(re.sub("<[^>]*>", "", one)).split()) for one in found]


NAMES = ("~limit", "/a/b", "<i>gate", "speed_deg", "flag", "~rate of")


@st.composite
def diagnoses(draw):
    """A diagnosis of any probabilities, with or without values to try and silent differences."""
    names = draw(st.lists(st.sampled_from(NAMES), max_size=5, unique=True))
    weights = [draw(st.floats(0.0, 1.0)) for _ in range(len(names) + 1)]
    total = sum(weights) or 1.0
    shares = sorted((weight / total for weight in weights[1:]), reverse=True)
    last = Evaluation(ns(1), True, 1.0, 2.0, True, "/node")
    suspects = tuple(
        Accused(place, False, name, share, "I", key(place), comparison(place, name), last)
        for place, (name, share) in enumerate(zip(names, shares, strict=True), start=1)
    )
    advice = []
    for one in suspects:
        value = draw(st.none() | st.sampled_from([0.5, 3, True]))
        reason = "nothing would do" if value is None else None
        text = f"lower {one.parameter} from 2 to {exact(value)} (why)" if reason is None else reason
        way = "lower" if reason is None else None
        told = Remedy(one.parameter, 2, way, value, None, text, reason, "I", one.key, None)
        advice.append(BlamedAdvice(one, told, None))
    silent = Difference("/n/silent", SetValue(1), SetValue(2), "used", ("a:1",), (), ())
    differing = draw(
        st.sampled_from([None, (), (silent,)]).map(
            lambda found: None if found is None else RunDifferences(("g",), "b", found, True)
        )
    )
    blamed = Blame(suspects, weights[0] / total, len(names), (Mark(ns(1), "I"),), ())
    return Diagnosis(blamed, tuple(advice), differing)


# No parameter is named in large letters unless the diagnosis' own headline or action names it, and
# nothing is to be tried in large letters where it is not sure, or "none of them" is likelier.
@given(diagnoses())
@settings(max_examples=40, deadline=None)
def test_large_letters_say_what_the_diagnosis_says(found):
    empty = Recording("m", events([]), (Mark(ns(1), "I"),), 0, ns(2))
    question = Question(differences=found.differences)
    answer = MissionAnswer(question, (), found, None, ())
    page = page_text_of([ReportedMission("m", empty, static_info(), answer)], "t", lambda: None)
    said = claims(page)
    own = [found.headline, *([found.action] if found.action and found.accused else [])]
    assert len(said) == len(own)
    for shown, meant in zip(said, own, strict=True):
        plain = shown.removeprefix("▼ ").removesuffix(" changed").removesuffix(".").casefold()
        assert plain == " ".join(meant.split()).casefold()
    if found.is_none_likeliest:
        assert len(said) == 1
    rest = page[: page.index('<h3 id="terms">')]
    others = found.next_suspects if found.accused else ()
    assert rest.count("Other suspects</h3>") == bool(others)
    assert rest.count(">Suspects</h3>") == (not found.accused and bool(found.shown))


def beside_good_run(report, number=0, thresh=5):
    """The mission, asked about with a good run in which one comparison had another threshold."""
    table = report.recording.events
    own = table.key == table.keys.index(key(number))
    seen = replace(table, thresh=np.where(own, thresh, table.thresh))
    run = RecordedRun(replace(report.recording, name="monday", events=seen, marks=()))
    static = report.static_info
    question = beside(report.question, [run], RecordedRun(report.recording), static, static)
    return replace(report, question=question)


# Only faces differs: 5 in the good run. Of its 400 evaluations the 100 from 30 s on, of 4 faces,
# would have been false.
def test_what_differs_is_on_the_first_screen(tmp_path):
    report = mission(tmp_path, treatment="", changed_parameter=None)
    alone = written(tmp_path, report)
    assert "Not compared with a good run." in "".join(Page(alone).text)
    assert '<span class="tag">' not in alone
    page = written(tmp_path, beside_good_run(report))
    text = " ".join("".join(Page(page).text).split())
    assert "1 parameter differs from the good run monday" in text
    assert text.index("differs from the good run") < text.index("The whole mission")
    said = "compared at src/node.cpp:5: 100 of 400 decisions would have come out otherwise"
    assert f"faces 5 3 not known {said}" in text
    # A user with a good run knows that it was changed.
    tagged = re.findall(r'<span class="parameter culprit">([^<]*)</span>', page)
    assert set(tagged) == {"faces"}


def test_without_marks_it_says_what_differs(tmp_path):
    report = beside_good_run(mission(tmp_path, treatment="", changed_parameter=None))
    calm = replace(report, recording=replace(report.recording, marks=()), rankings=[])
    text = " ".join("".join(Page(written(tmp_path, calm)).text).split())
    assert text.index("No marks, so no verdict.") < text.index("1 parameter differs from the good")


def test_the_command_that_changes_the_value(tmp_path):
    report = accused_coverage(tmp_path)
    text = " ".join("".join(Page(written(tmp_path, report)).text).split())
    assert "Where it is set /ws/config/p.yaml:7coverage: 0.6" in text.replace("set/ws", "set /ws")
    assert "pytpc apply '/out/a day' /node/coverage 0.25 Copy" in text
    # Nobody set it: the value goes into the launch file.
    (origin,) = report.origins.values()
    unset = replace(report, origins={"/node/other": replace(origin, name="/node/other")})
    text = " ".join("".join(Page(written(tmp_path, unset)).text).split())
    assert "pytpc apply '/out/a day' /node/coverage 0.25 --add Copy" in text
    # A line end in a path must not get into a terminal; of a bare recording there is no path.
    for source in (Path("/out/a\nb"), Path("/out/\u202eb"), None):
        assert "pytpc apply" not in written(tmp_path, replace(report, source=source))
    # It was given on the command line of roslaunch: no file can be changed.
    told = replace(report, origins={origin.name: replace(origin, kind="argument", path=None)})
    assert "pytpc apply" not in written(tmp_path, told)


def accused_coverage(tmp_path):
    """The mission with marks at which coverage is first, beside a good run with 0.25 for it."""
    report = mission(tmp_path, treatment="", changed_parameter=None)
    comparisons = report.static_info.comparisons
    found = replace(comparisons[key(1)], source="/node/coverage")
    static = static_info(comparisons[key(0)], found, source_root=str(tmp_path))
    recording = replace(report.recording, marks=(Mark(ns(26), "II"), Mark(ns(31), "II")))
    name = "/node/coverage"
    origin = Origin(name, "yaml", 0.6, Path("/ws/config/p.yaml"), 7, "coverage: 0.6")
    asked = replace(report, recording=recording, static_info=static, source=Path("/out/a day"))
    asked = replace(asked, rankings=rank_marks(recording, static), origins={name: origin})
    return beside_good_run(asked, 1, 0.25)


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


def test_doubted_types_are_a_fact(tmp_path):
    report = mission(tmp_path)
    assert "Types of the marks" not in written(tmp_path, report)
    assert "doubted: suspects of the other" in written(
        tmp_path, replace(report, question=Question(types="doubt"))
    )


# Low scores and high ranks are suspicious: both are explained on the card, in no table.
def test_score_and_rank_are_on_the_card(page_text):
    heads = re.findall('<th[^>]*scope="col">([^<]*)</th>', page_text)
    assert set(heads) == {"#", "Parameter", "Value", "Smallest change", "Compared at", "Drift"}
    text = " ".join("".join(Page(page_text).text).split())
    assert re.search(r"At this markscore [0-9.e-]+ of type I, rank 1\.00, distance 1", text)
    assert 'aria-describedby="term-score"' in page_text


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
