"""The figures of a study: what is in them, read from matplotlib and from the SVG files."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.colors import to_hex
from mission_samples import comparison, events, ns, static_info

from pytpc.diagnosis.scores.score_tables import rank_curves
from pytpc.recording.events import Events
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc_evaluation.stats.bars import runtime_bars
from pytpc_evaluation.stats.curves import NAMED, mission_figure
from pytpc_evaluation.stats.drawing import COLOURS, CULPRIT, save, style
from pytpc_evaluation.stats.figure_choice import Figures
from pytpc_evaluation.stats.figures import draw_study
from pytpc_evaluation.stats.missions import StudyMission
from pytpc_evaluation.stats.runtime import RuntimeRow, RuntimeStatistics
from pytpc_evaluation.stats.states import Phases, RobotState, Series
from pytpc_evaluation.treatment import Treatment

STATIC = static_info(*(comparison(n, f"~p{n}") for n in range(12)))


def recording(marks=(), seconds: float = 20.0) -> Recording:
    """Parameter n flops at 1 + n seconds, to true; p11 never does, and has one evaluation only."""
    rows = [(0.5, n, 0, 1, 2) for n in range(11)]
    rows += [(1 + n, n, 1, 3, 2) for n in range(11)]
    rows.append((3, 11, 1, 5, 2))
    return Recording("m", events(rows), tuple(marks), 0, ns(seconds))


def treatment(parameter: str = "~p3") -> Treatment:
    return Treatment("low", "type1", parameter, "/node", 2.0, 1.0, {}, "", Path("p.yaml"))


MARKS = [Mark(ns(5), "I"), Mark(ns(6), "II"), Mark(ns(7), None), Mark(ns(25), "I")]
STATE = RobotState(
    (Series("x", np.array([0.0, 20.0]), np.array([1.0, np.nan])),),
    (Phases("/state.name", np.array([0.0, 8.0]), ("go <here>", "done")),),
)


def axes_of(figure):
    return {axes.get_ylabel(): axes for axes in figure.axes}


def lines_of(axes):
    """The curves, without the signs of marks, by label."""
    lines = [line for line in axes.lines if line.get_drawstyle() == "steps-post"]
    return {line.get_label(): line for line in lines}


# Rank by type I at 5 s: p0 to p4 have flopped at 1 to 5 s, once: (5 - t) * 2, so p4 is first: p3
# 1 - 1/12. Before 4 s p3 has no score and no line. p11 never has one.
def test_the_changed_parameter_is_red_thick_and_in_front():
    with style():
        given = recording(MARKS)
        curves = rank_curves(given, STATIC, step_s=1.0)
        figure = mission_figure("low trial 1", given, curves, STATE, "p3")
    for name in ("rank by type I", "rank by type II"):
        lines = lines_of(axes_of(figure)[name])
        culprit = lines["~p3\n(changed)"]
        others = [line for label, line in lines.items() if label != "~p3\n(changed)"]
        assert to_hex(culprit.get_color()) == CULPRIT
        assert all(to_hex(line.get_color()) != CULPRIT for line in others)
        assert all(line.get_linewidth() < culprit.get_linewidth() for line in others)
        assert all(line.get_zorder() < culprit.get_zorder() for line in others)
        named = [line for label, line in lines.items() if label.startswith("~p")]
        assert len(named) == NAMED + 1
        # No two named ones have both colour and dash in common.
        looks = {(line.get_color(), str(line._dash_pattern)) for line in named}
        assert len(looks) == len(named)
    first = lines_of(axes_of(figure)["rank by type I"])["~p3\n(changed)"]
    assert np.isnan(first.get_ydata()[:4]).all()
    assert first.get_ydata()[5] == pytest.approx(1 - 1 / 12)


def test_marks_stand_in_every_panel_and_differ_in_line_and_sign():
    with style():
        given = recording(MARKS)
        figure = mission_figure("t", given, rank_curves(given, STATIC, step_s=1.0), STATE)
    for axes in figure.axes:
        signs = {
            float(line.get_xdata()[0]): line.get_marker()
            for line in axes.lines
            if line.get_marker() not in {"None", ""}
        }
        assert signs == {5.0: "v", 6.0: "s", 7.0: "o"}
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        "mark of type I",
        "mark of type II",
        "mark without a type",
        "(1 mark before or after the mission)",
    ]


def test_the_robot_stands_above():
    with style():
        given = recording()
        curves = rank_curves(given, STATIC, step_s=1.0)
        figure = mission_figure("t", given, curves, STATE)
    lanes, robot = figure.axes[:2]
    assert [tick.get_text() for tick in lanes.get_yticklabels()] == ["go <here>", "done"]
    spans = [(bar.get_x(), bar.get_width()) for bar in lanes.patches]
    assert spans == [(0.0, 8.0), (8.0, 12.0)]
    assert robot.get_ylabel() == "robot"
    assert len({axes.get_xlim() for axes in figure.axes}) == 1


# Without a state: marks in stretches of 5 s. 5, 6 and 7 s are in the second.
def test_without_a_state_the_density_of_the_marks_is_drawn():
    with style():
        given = recording(MARKS)
        curves = rank_curves(given, STATIC, step_s=1.0)
        figure = mission_figure("t", given, curves, RobotState())
    (stairs,) = figure.axes[0].patches
    assert stairs.get_data().values.tolist()[:4] == [0, 3, 0, 0]


def test_bars_are_sorted_and_the_changed_one_is_hatched():
    rows = tuple(
        RuntimeRow(name, 1, 10, 1.0, share, 0, 0.0, 100.0)
        for name, share in (("~a", 5.0), ("~b", 100.0), ("~c", 50.0))
    )
    with style():
        figure = runtime_bars(RuntimeStatistics(rows, 2, 60.0, 3, 3, 3), ["c"])
    (axes,) = figure.axes
    assert [label.get_text() for label in axes.get_yticklabels()] == ["~b", "~c", "~a"]
    assert [bar.get_width() for bar in axes.patches] == [100.0, 50.0, 5.0]
    assert [bar.get_hatch() for bar in axes.patches] == [None, "////", None]
    assert axes.get_title("left") == "3 parameters in 2 missions of 60 s together"


def luminance(colour: str) -> float:
    red, green, blue = (int(colour[n : n + 2], 16) / 255 for n in (1, 3, 5))
    return 0.299 * red + 0.587 * green + 0.114 * blue


# There are four dashes, so that the fifth colour has the first dash again.
def test_lines_of_one_dash_differ_in_grey():
    for one, two in zip(COLOURS[:4], COLOURS[4:], strict=True):
        assert abs(luminance(one) - luminance(two)) > 0.09


def test_all_files_of_a_study(tmp_path):
    missions = [
        StudyMission("a", recording(MARKS), treatment()),
        StudyMission("../b $x^2$ <i>", recording()),
        StudyMission("runtime", Recording("e", Events.empty(), (), 7, 7)),
        StudyMission("-", replace(recording(), marks=tuple(MARKS))),
    ]
    drawn = draw_study(missions, STATIC, Figures(tmp_path, ("svg", "png", "pdf")))
    assert sorted(path.relative_to(tmp_path).name for path in drawn) == sorted(
        f"{name}.{form}"
        for name in ("runtime", "low-trial-1", "b-x-2-i", "runtime-2", "mission")
        for form in ("svg", "png", "pdf")
    )
    assert all(path.parent == tmp_path for path in drawn)
    begins = {"png": b"\x89PNG", "pdf": b"%PDF", "svg": b"<?xml"}
    for path in drawn:
        assert path.read_bytes().startswith(begins[path.suffix[1:]])
    text = (tmp_path / "low-trial-1.svg").read_text()
    assert re.search(r">low trial 1: ~p3 2 -&gt; 1<", text)
    assert "../b $x^2$ &lt;i&gt;" in (tmp_path / "b-x-2-i.svg").read_text()


def test_the_same_study_gives_the_same_bytes(tmp_path):
    missions = [StudyMission("a", recording(MARKS), treatment())]
    first = draw_study(missions, STATIC, Figures(tmp_path / "1", ("svg", "png", "pdf")))
    second = draw_study(missions, STATIC, Figures(tmp_path / "2", ("svg", "png", "pdf")))
    assert {path.suffix for path in first} == {".svg", ".png", ".pdf"}
    for one, two in zip(first, second, strict=True):
        assert one.read_bytes() == two.read_bytes()


# A user's own matplotlibrc changes nothing, and ours is not left behind.
def test_settings_are_ours_alone(tmp_path):
    missions = [StudyMission("a", recording(MARKS), treatment())]
    (one, _) = draw_study(missions, STATIC, Figures(tmp_path / "1"))
    with mpl.rc_context({"lines.linewidth": 9.0, "axes.facecolor": "black"}):
        (two, _) = draw_study(missions, STATIC, Figures(tmp_path / "2"))
        assert mpl.rcParams["axes.facecolor"] == "black"
    assert one.read_bytes() == two.read_bytes()


def test_characters_that_the_font_lacks(tmp_path):
    rows = (RuntimeRow("~\u6f22\x00\u202e", 1, 10, 1.0, 5.0, 0, 0.0, 100.0),)
    with style():
        save(runtime_bars(RuntimeStatistics(rows, 1, 1.0, 1, 1, 1)), tmp_path / "f.png", "png")
    assert (tmp_path / "f.png").stat().st_size > 1000


def test_troubles_are_told_and_the_ranks_are_drawn_all_the_same(tmp_path):
    missions = [
        StudyMission("a", recording(), treatment(), bag=tmp_path / "none.bag"),
        StudyMission("b", recording()),
    ]
    told: list[str] = []
    steps: list[tuple[int, int]] = []
    drawn = draw_study(
        missions,
        STATIC,
        Figures(tmp_path, states=["/odom.x"]),
        on_progress=lambda done, total: steps.append((done, total)),
        on_trouble=told.append,
    )
    assert len(drawn) == 3
    assert [text.split(":")[0] for text in told] == ["low trial 1", "b"]
    assert steps == [(1, 3), (2, 3)]
