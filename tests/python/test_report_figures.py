"""The figures of the report page: those that stand still, and the numbers of those that move."""

from __future__ import annotations

import base64
import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest
from mission_samples import SummaryBuilder, comparison, events, key, ns, static_info
from report_samples import Page, mission, written

from pytpc.api.report import MissionReport
from pytpc.diagnosis.ranking.mark_ranking import rank_marks
from pytpc.present.page.series import FALSE, TRUE, results_of
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summary
from pytpc.static.link_unit import Transform

NAN = math.nan


@pytest.fixture(scope="module")
def page_text(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    return written(folder, mission(folder))


def values_that_break_plots():
    return [
        [(t, 0, t % 2, value, limit) for t in range(10)]
        for value, limit in [
            (NAN, NAN),
            (math.inf, 1),
            (1e308, -1e308),
            (5e-324, 0),
            (1, 1),
            (1e6 + 0.1, 1e6),
        ]
    ]


# DBL_MAX is what a node often starts with ("no distance yet"). 98 values of 1 to 2 against a
# threshold of 3 must stay readable beside it: the axis does not reach 1e308.
def test_an_outlier_does_not_flatten_the_plot(tmp_path):
    rows = [(t / 10, 0, t % 2, 1 + t % 2, 3) for t in range(98)] + [(9.9, 0, 1, 1.7e308, 3)]
    recording = Recording("far", events(rows), (Mark(ns(10), "I"),), 0, ns(10))
    static = static_info(comparison(0, "x"))
    report = MissionReport("far", recording, static, rank_marks(recording, static))
    text = written(tmp_path, report)
    labels = re.findall("<text[^>]*>([^<]*)</text>", text)
    assert "compared values beyond this plot, up to 1.7e+308<" in text
    card = next(iter(numbers_of(text)["cards"].values()))
    assert card["edges"] == [[], [pytest.approx(9.9)]]
    assert {"1.2", "1.8", "2.4", "3.0"} <= set(labels)
    assert not any("e+" in label for label in labels)


# The first compared value is a time since the epoch. Of nine it is 11 %, more than the ends that
# are not looked at among many values; the others, 0.05 to 17.5, and the threshold of 3 are shown.
# The axis ends 0.08 of their range above them, and 0.16 for the mark's name: 17.5 + 0.24 * 17.45.
# The smallest change to draw is just below 0.05.
def test_one_of_a_few_values_does_not_flatten_the_plot(tmp_path):
    cmps = [1_795_763_972.0, 0.05, 10.75, 0.05, 3.05, 0.05, 17.5, 0.05, 2.0]
    rows = [(t, 0, cmp > 3, cmp, 3) for t, cmp in enumerate(cmps)]
    recording = Recording("epoch", events(rows), (Mark(ns(9), "I"),), 0, ns(9))
    static = static_info(comparison(0, "x", ">"))
    report = MissionReport("epoch", recording, static, rank_marks(recording, static))
    text = written(tmp_path, report)
    card = next(iter(numbers_of(text)["cards"].values()))
    assert (card["low"], card["high"]) == pytest.approx((0.05 - 0.08 * 17.45, 21.688), abs=0.001)
    assert card["edges"] == [[], [0.0]]
    assert "compared values beyond this plot, up to 1795763972<" in text


@pytest.mark.parametrize("rows", values_that_break_plots())
def test_odd_values_are_drawn_without_a_word(tmp_path, rows):
    recording = Recording("odd", events(rows), (Mark(ns(9), "I"),), 0, ns(9))
    static = static_info(comparison(0, "x" * 60))
    report = MissionReport("odd", recording, static, rank_marks(recording, static))
    assert Page(written(tmp_path, report)).tags["svg"] == 3


def numbers_of(text, mission="m1"):
    block = re.search(
        f'<script type="application/json" id="{mission}-numbers">(.*?)</script>', text
    )
    assert block is not None
    return json.loads(block[1])


def unpacked(text, kind):
    return np.frombuffer(base64.b64decode(text), dtype=kind)


# Mark 2 is at 35 s of 40: shown from 15 s to the end, the window from 23 s, and what would do is
# all below 0.5. Coverage t/60 stays at 0.5 from 30 s on; it is never above its limit of 0.6, which
# never changes, so that it is told once. The smallest change is to 0.499.
def test_the_numbers_of_the_moving_figures(page_text):
    numbers = numbers_of(page_text)
    assert numbers["seconds"] == 40
    assert numbers["marks"] == [
        {"t": 31, "type": "I"},
        {"t": 35, "type": "II"},
        {"t": 36, "type": ""},
    ]
    card = numbers["cards"]["m1-2-1"]
    assert (card["begin"], card["end"], card["mark"], card["window"]) == (15, 40, 35, 23)
    assert (card["feasible"], card["suggested"], card["culprit"]) == ([[None, 0.5]], 0.499, True)
    series = numbers["series"][card["series"]]
    assert series["of"] == 400
    times = unpacked(series["t"], "<f4")
    assert (times.size, times[0], times[-1]) == (400, 0, np.float32(39.9))
    values = unpacked(series["c"], "<f8")
    assert (values[60], values[300], values.max()) == (6 / 60, 0.5, 0.5)
    assert not unpacked(series["r"], "u1").any()
    assert unpacked(series["lt"], "<f8").tolist() == [0]
    assert unpacked(series["lv"], "<f8").tolist() == [0.6]


# Each of 6000 columns is 1/150 s: an evaluation each tenth of a second holds for 15 of them. faces
# is false up to 30 s and true from then on, the last evaluation at 39.9 s for its own column.
def test_the_lanes_of_the_moving_figure(page_text):
    timeline = numbers_of(page_text)["timeline"]
    assert timeline["labels"][0] == "coverage"
    assert timeline["labels"][timeline["accent"]] == "coverage"
    place = timeline["labels"].index("faces")
    states = unpacked(timeline["runs"][place], "<i4").reshape(-1, 3).tolist()
    assert states == [[FALSE, 0, 4500], [TRUE, 4500, 1486]]


# faces first flops at 30 s; from then on it has a score of type I: rank 1 of 4 parameters while
# 2 * (t - 30) is less than NASTY's. Before that it has none: rank 0.
def test_the_curves_of_the_moving_figure(page_text):
    timeline = numbers_of(page_text)["timeline"]
    curves = timeline["curves"]
    times = unpacked(curves["t"], "<f8")
    assert (times.size, times[1], times[-1]) == (401, 0.1, 40)
    ranks = unpacked(curves["I"][timeline["labels"].index("faces")], "<u2")
    assert (ranks[299], ranks[310]) == (0, 65535)


@pytest.mark.parametrize(
    ("name", "shown"),
    [
        ("</script><b>", "</script><b>"),
        ("<!--<script>", "<!--<script>"),
        # Bokeh would look for a formula, and for MathJax on the network.
        ("$$x$$", "$\N{WORD JOINER}$x$\N{WORD JOINER}$"),
        ("\\[x\\]", "\\\N{WORD JOINER}[x\\]"),
        # What nobody sees could make a name pass for another.
        ("a\u202eb\x00c\u2028", "a\ufffdb\ufffdc\ufffd"),
    ],
)
def test_names_stay_names_in_the_figures(tmp_path, name, shown):
    plain = mission(tmp_path)
    found = plain.static_info.comparisons[key(0)]
    static = static_info(replace(found, source=name), source_root=str(tmp_path))
    report = replace(plain, static_info=static, rankings=rank_marks(plain.recording, static))
    text = written(tmp_path, report)
    assert numbers_of(text)["timeline"]["labels"] == [shown]
    assert Page(text).tags["b"] == 0
    assert not set("\x00\u202e\u2028") & set(text)


# yaw_deg is turned into radians: the axis is in what is compared, the value to try in what is set.
def test_an_axis_has_its_unit(tmp_path):
    turned = Transform("affine", math.pi / 180, 0.0)
    static = static_info(
        comparison(0, "~yaw", name="limit_", transform=turned), comparison(1, "~range_m")
    )
    rows = [(t / 10, n, False, 0.1 + t / 1000, 0.5) for t in range(100) for n in (0, 1)]
    recording = Recording("units", events(rows), (Mark(ns(9), "II"),), 0, ns(10))
    report = MissionReport("units", recording, static, rank_marks(recording, static))
    text = written(tmp_path, report)
    cards = numbers_of(text)["cards"]
    assert {card["label"] for card in cards.values()} == {"value in rad", "value in m"}
    for label in ("value in rad", "value in m"):
        assert f">{label}</text>" in text
    shown = " ".join("".join(Page(text).text).split())
    # 0.19, at the mark, is the nearest to 0.5: below it, and below 10.886 degrees. 10.8 degrees are
    # 0.188496.
    assert "smallest change: 10.8 °, here 0.188496 rad " in shown
    assert "smallest change: 0.189 m " in shown


# Three summaries: all True, all False, and True last after a flop, so that both were there.
def test_the_strip_of_results_has_those_of_summaries():
    builder = SummaryBuilder()
    for begin, flops, result in ((1, 0, True), (2, 0, False), (3, 1, True)):
        counts = (ns(begin), ns(begin + 1), 9, flops, 9, 0)
        values = (2.4, 3.0, -1.0, -0.5, -0.7, 0.7, 2.0, 3.0)
        builder.add(Summary(key(0), "/node", *counts, result, result, *values))
    found = results_of(builder.build(), key(0), 0)
    assert found.tolist() == [[1, 2, 3], [2, 3, 4], [1, 0, 0], [1, 0, 1]]


# Under the policy edges a report is made of the first evaluation alone, where nothing flops; the
# summary from 20 to 30 s has 100 evaluations of 2 to 2.5 against 3, the one from 40 s on lies after
# the mark. 2.5 is the nearest. Nothing of the second comparison is in the events.
def test_summaries_are_drawn_as_spans(tmp_path):
    def kept(number, begin, end):
        return Summary(
            *(key(number), "/node", ns(begin), ns(end), 100, 0, 100, 0, False, False),
            *(2.4, 3.0, -1.0, -0.5, -0.7, 0.7, 2.0, 3.0),
        )

    builder = SummaryBuilder()
    for one in (kept(0, 20, 30), kept(0, 40, 50), kept(1, 20, 30)):
        builder.add(one)
    rows = [(1, 0, False, 2.0, 3.0)]
    recording = Recording(
        "edges",
        events(rows),
        (Mark(ns(31), "II"),),
        0,
        ns(60),
        summaries=builder.build(),
    )
    static = static_info(comparison(0, "a"), comparison(1, "b"))
    report = MissionReport("edges", recording, static, rank_marks(recording, static))
    text = written(tmp_path, report)
    numbers = numbers_of(text)
    cards = [numbers["cards"][f"m1-1-{place}"] for place in (1, 2)]
    assert [card["kept"] for card in cards] == [True, True]
    spans = [
        [unpacked(column, "<f8").tolist() for column in numbers["series"][card["series"]]["kept"]]
        for card in cards
    ]
    assert spans == [[[20, 40], [30, 50], [2, 2], [2.5, 2.5]], [[20], [30], [2], [2.5]]]
    # The strip below has their results: all False.
    strips = [
        [unpacked(one, "<f8").tolist() for one in numbers["series"][card["series"]]["results"]]
        for card in cards
    ]
    assert strips == [[[20, 40], [30, 50], [0, 0], [0, 0]], [[20], [30], [0], [0]]]
    # 6000 columns of a hundredth of a second; the first evaluation stands alone at 1 s.
    lanes = dict(zip(numbers["timeline"]["labels"], numbers["timeline"]["runs"], strict=True))
    assert unpacked(lanes["b"], "<i4").tolist() == [FALSE, 2000, 1001]
    assert unpacked(lanes["a"], "<i4").reshape(-1, 3).tolist() == [
        [FALSE, 100, 1],
        [FALSE, 2000, 1001],
        [FALSE, 4000, 1001],
    ]
    shown = " ".join("".join(Page(text).text).split())
    said = "In the 12 s before the mark it was false all 100 times; the compared value came"
    assert f"{said} closest at 2.5, against 3." in shown
    # The window of type II is painted first: it must not hide what lies in it.
    still = text[text.index('aria-label="a: compared value') :]
    assert 0 < still.index("var(--span)") < still.index("PolyCollection") < still.index("</svg>")
