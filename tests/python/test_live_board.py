"""What `pytpc live` shows: which comparisons are near to turning, held results, turns, marks."""

from __future__ import annotations

import json
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from live_samples import board_of, mission
from mission_samples import comparison, events, key, ns, static_info

from patience import wait_for
from pytpc.api.live_board import LiveBoard
from pytpc.api.live_mission import fresh_watching
from pytpc.api.live_observers import MOST_OBSERVERS, ObserverMissions
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.turning import Turning, margin_of, share_of, steady_order
from pytpc.diagnosis.results.live import Seen
from pytpc.recording.graph_places import Place
from pytpc.recording.marking_session import MarkChange, View
from pytpc.recording.marks import Mark, read_marks
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summary
from pytpc.serve.board_changes import changes, is_news
from pytpc.static.link_unit import Transform


@pytest.fixture
def board(tmp_path: Path) -> LiveBoard:
    return board_of(tmp_path, *mission(), places=(Place("/cmd_vel", "geometry_msgs/Twist"),))


def at(board: LiveBoard, seconds: float) -> dict:
    board.play("seek", seconds)
    board.tick()
    return board.board()


def names(rows) -> list[str]:
    return [row["parameter"] for row in rows]


# At 36 s. ~near: |9.5 - 10| of the range 0 to 10 is 0.05. ~far: 6 of 10. ~turns: |30 - 25| of 20
# to 30 is 0.5. ~on is a flag: no margin.
def test_the_nearest_comes_first(board: LiveBoard):
    near = at(board, 36)["near"]
    assert [(row["parameter"], row["share"], row["margin"]) for row in near] == [
        ("~near", 0.05, "0.5"),
        ("~turns", 0.5, "5"),
        ("~far", 0.6, "6"),
    ]
    assert near[0]["value"] == "9.5"
    assert near[0]["threshold"] == "10"
    assert near[0]["relation"] == ">"
    assert near[0]["in_unit"] is True
    assert near[0]["topic"] == "/near"
    assert near[0]["res"] is False
    assert near[0]["members"] == []


# Two nodes run one program: /a is 0.5 below the limit of 10, /b 6; the range is 0 to 10.
def test_nodes_of_one_comparison_have_rows_and_lines_of_their_own(tmp_path: Path):
    rows = [
        row
        for t in range(10)
        for row in [
            (t, 0, False, 9.5 if t else 0, 10, "/a"),
            (t + 0.5, 0, False, 4, 10, "/b"),
        ]
    ]
    both = Recording("two", events(rows), (), 0, ns(10))
    board = board_of(tmp_path, static_info(comparison(0, "~limit")), both)
    near = at(board, 10)["near"]
    assert [(row["node"], row["share"], row["value"]) for row in near] == [
        ("/a", 0.05, "9.5"),
        ("/b", 0.6, "4"),
    ]
    assert all(row["shared"] for row in near)
    assert len({row["id"] for row in near}) == 2
    assert set(board.line(key(0), "/b")["value"]) == {4.0}
    assert board.line(key(0), "/nobody") == board.line(key(0), "/b")


# A jump is read in parts: the page can be told how much is left, and keeps its board meanwhile.
def test_a_jump_that_takes_long_is_told(tmp_path: Path):
    board = board_of(tmp_path, *mission(seconds=100))
    before = at(board, 1)
    board.play("seek", 100.0)
    board.tick(0.0)
    shown = board.board()
    assert shown["state"]["behind"] == 69.0
    assert shown["clock"]["now"] == 100.0
    assert shown["near"] == before["near"]
    for _ in range(3):
        board.tick(0.0)
    assert board.board()["state"]["behind"] == 0
    assert board.board()["near"][0]["value"] == "9.5"


# At 36 s, ~turns has had its result for 1 s; the others since the first report, at 0.
def test_what_has_not_turned_for_a_window_is_held(board: LiveBoard):
    shown = at(board, 36)
    assert [(row["parameter"], row["since"]) for row in shown["held"]] == [
        ("~near", 0.0),
        ("~far", 0.0),
        ("~on", 0.0),
    ]
    assert next(row["since"] for row in shown["near"] if row["parameter"] == "~turns") == 35.0
    # Before a window has passed, nothing is.
    assert at(board, 11)["held"] == []


# ~turns turns at 5, 10, ... 35 s.
def test_the_last_turns_come_first(board: LiveBoard):
    turns = at(board, 36)["turns"]
    assert [row["at"] for row in turns] == [35.0, 30.0, 25.0, 20.0, 15.0, 10.0, 5.0]
    assert [row["result"] for row in turns[:2]] == [False, True]
    assert set(names(turns)) == {"~turns"}
    assert turns[0]["code"] == "if (value < ~turns_) {"
    assert turns[0]["place"] == "src/node.cpp:12"
    assert len({row["id"] for row in turns}) == 7


def test_the_clock_can_go_back(board: LiveBoard):
    at(board, 39)
    back = at(board, 7)
    assert [row["at"] for row in back["turns"]] == [5.0]
    assert back["clock"]["now"] == 7.0
    assert back["clock"]["playing"] is False


# The ranking is worked out anew only after a while; that of before the jump must not stay.
def test_the_suspects_follow_a_jump_of_a_clock_that_stands(board: LiveBoard):
    at(board, 7)
    at(board, 36)

    def flop() -> float:
        rows = board.board()["suspects"][0]["rows"]
        return next(row["flop"] for row in rows if row["parameter"] == "~turns")

    wait_for(lambda: flop() == 35.0)


def test_play_speed_and_the_end(board: LiveBoard):
    assert at(board, 10)["clock"]["rate"] == 0.0
    board.play("speed", 4.0)
    board.play("play", 0)
    board.play("play", 0)
    clock = board.board()["clock"]
    assert (clock["playing"], clock["speed"], clock["rate"], clock["end"]) == (True, 4.0, 4.0, 40.0)
    board.play("seek", 1e9)
    assert board.board()["clock"]["playing"] is False
    assert board.board()["clock"]["now"] == 40.0
    # At its end, it starts again.
    board.play("play", 0)
    assert board.board()["clock"]["now"] < 39.0
    board.play("pause", 0)
    board.play("seek", 20)
    board.play("step", -30)
    assert board.board()["clock"]["now"] == 0.0


def test_a_board_is_json_of_printable_texts(tmp_path: Path):
    hostile = ("~\x1b[31mred", "~\u202egnp", "~<img src=x>", "~a\nb")
    shown = at(board_of(tmp_path, *mission(hostile)), 36)
    text = json.dumps(shown, allow_nan=False, ensure_ascii=False)
    assert "~<img src=x>" in text
    assert all(character.isprintable() for character in text)


def test_the_detail_has_the_line_and_the_source(board: LiveBoard):
    at(board, 2)
    detail = board.detail(key(0))
    # Each 0.25 s at most, of reports each 0.1 s: those at 0, 0.3, 0.6 ... 1.8 s.
    assert detail["line"]["t"] == [0.0, 0.3, 0.6, 0.9, 1.2, 1.5, 1.8]
    assert detail["line"]["value"] == [0.0, *[9.5] * 6]
    assert set(detail["line"]["threshold"]) == {10.0}
    assert detail["source"] == [{"number": 10, "text": "if (value > ~near_) {", "here": True}]
    assert detail["note"] == "the source file is not on this machine"
    assert board.detail("no such key") is None


def test_observers_have_sessions_of_their_own(board: LiveBoard, tmp_path: Path):
    at(board, 20)
    people = board.observers
    assert people.join("ana").ok
    assert people.join("bo").ok
    assert people.do("ana", "1").said.startswith("marked: type I: 1 ~")
    assert people.do("bo", "2").ok
    assert people.do("ana", "where", "/cmd_vel").said == "wrong at /cmd_vel"
    assert people.do("ana", "began", "20-5").ok
    # A note leaves the place and the time alone, also the second one.
    assert people.do("ana", "note", "too slow").ok
    assert people.do("ana", "note", "too fast").ok
    twenty = ns(20)
    assert read_marks(tmp_path / "marks.csv") == (
        Mark(twenty, "I", "ana", "@-20..-5 @/cmd_vel too fast"),
        Mark(twenty, "II", "bo"),
    )
    shown = board.board()["marks"]
    assert [(row["observer"], row["remark"]) for row in shown] == [("ana", "too fast"), ("bo", "")]
    assert shown[0]["suspects"].startswith("1 ~")
    assert people.do("bo", "undo").said == "taken back: type II"
    assert people.do("bo", "undo") == (False, "no mark yet")
    assert [mark.observer for mark in read_marks(tmp_path / "marks.csv")] == ["ana"]


@pytest.mark.parametrize(
    ("what", "text", "said"),
    [
        ("where", "too fast", "not a ROS name: too fast"),
        ("where", "", "not a ROS name: "),
        ("began", "soon", "not"),
        ("nothing", "", "nothing is called 'nothing'"),
    ],
)
def test_what_cannot_be_said_changes_nothing(board: LiveBoard, what: str, text: str, said: str):
    at(board, 20)
    people = board.observers
    people.join("ana")
    people.do("ana", "3")
    answer = people.do("ana", what, text)
    assert not answer.ok
    assert said in answer.said
    assert [mark.note for mark in people.marks] == [""]
    # Nothing is being typed any more.
    assert people.do("ana", "undo").ok


def test_marks_of_an_earlier_session_are_shown_and_can_be_taken_back(tmp_path: Path):
    first = board_of(tmp_path, *mission())
    at(first, 10)
    first.observers.join("ana")
    first.observers.do("ana", "1")
    assert first.close() == ""
    second = board_of(tmp_path, *mission())
    assert [row["suspects"] for row in second.board()["marks"]] == [""]
    second.observers.join("ana")
    assert second.observers.do("ana", "undo").ok
    assert second.board()["marks"] == []


def test_there_are_not_too_many_observers(board: LiveBoard):
    for number in range(MOST_OBSERVERS):
        assert board.observers.join(f"observer{number}").ok
    assert not board.observers.join("one_more").ok
    assert board.observers.join("observer3").ok


# A mark that waited for the connection has its own time, if that is in the mission.
def test_a_late_mark_has_its_own_time(board: LiveBoard):
    at(board, 20)
    assert board.mark_time(None) is None
    assert board.mark_time(12.5) == ns(12.5)
    # The page's clock is a little ahead.
    assert board.mark_time(20.4) == ns(20)
    for outside in (30.0, -5.0):
        with pytest.raises(ValueError, match="not in this mission"):
            board.mark_time(outside)


class Sent:
    """A mission that keeps what it is told."""

    def __init__(self) -> None:
        self.changes: list[MarkChange] = []

    def now_ns(self) -> int:
        return 5

    def press(self, key: str) -> bool:
        return False

    def view(self) -> View:
        return View("title", ("connected",), 0, 5)

    def send(self, change: MarkChange) -> str:
        self.changes.append(change)
        return ""

    def tick(self) -> None:
        pass

    def close(self) -> None:
        pass

    def unheard(self) -> int:
        return 0


def test_marks_go_to_the_topics_of_their_observer_in_order():
    base, opened = Sent(), {}

    def open_one(name: str) -> Sent:
        opened[name] = Sent()
        return opened[name]

    missions = ObserverMissions(base, open_one)
    made = [MarkChange(None, Mark(n, "I", name)) for n, name in enumerate(["ana", "", "ana", "bo"])]
    for change in made:
        missions.send(change)
    # It waits for those that are being opened.
    missions.close()
    assert base.changes == [made[1]]
    assert {name: one.changes for name, one in opened.items()} == {
        "ana": [made[0], made[2]],
        "bo": [made[3]],
    }
    assert missions.unheard() == 0


# 0.45 is more than 0.8 of 0.5, so it stays behind; 0.39 is less, so it moves before.
def test_rows_move_only_past_what_is_clearly_farther():
    assert steady_order(["a", "b"], {"a": 0.5, "b": 0.45}) == ["a", "b"]
    assert steady_order(["a", "b"], {"a": 0.5, "b": 0.39}) == ["b", "a"]
    assert steady_order([], {"a": 0.5, "b": 0.45, "c": 0.5}) == ["b", "a", "c"]
    assert steady_order(["a", "gone"], {"a": 0.5}) == ["a"]


@given(st.lists(st.dictionaries(st.sampled_from("abcdef"), st.floats(0, 1)), max_size=6))
def test_no_row_stands_behind_one_that_is_clearly_farther(steps):
    order: list[str] = []
    for values in steps:
        order = steady_order(order, values)
        assert sorted(order) == sorted(values)
        for n, one in enumerate(order):
            for later in order[n + 1 :]:
                assert values[later] >= values[one] * 0.8 - 0.001


# Degrees compared as radians: 0.1 rad away is 5.7296 degrees.
def test_a_margin_is_in_the_parameters_unit():
    radians = Transform("affine", scale=math.pi / 180, offset=0.0, text="x * pi / 180")
    unknown = Transform("expression", text="x + start")
    static = static_info(comparison(0, "~deg", transform=radians, type="derived"))
    unit = static.unit_of(key(0))
    margin, in_unit = margin_of(static.comparisons[key(0)], unit, 0.5, 0.4)
    assert margin == pytest.approx(5.7296, abs=1e-4)
    assert in_unit
    other = comparison(1, "~x", transform=unknown, type="derived")
    assert margin_of(other, unit, 0.75, 0.5) == (0.25, False)


# A text is logged as its outcome on both sides, which would always be on the threshold.
def test_texts_and_what_has_no_range_have_no_margin():
    static = static_info(comparison(0, "~mode", "==", default="auto"), comparison(1, "~still"))
    watching = fresh_watching(static, Question())
    for t in range(3):
        watching.take(Seen(ns(t), key(0), "/n", t == 1, float(t == 1), float(t == 1), t == 1))
        watching.take(Seen(ns(t), key(1), "/n", False, 2.0, 2.0, False))
    for one in watching.compared(ns(2), 20.0):
        assert share_of(one, static.unit_of(one.last.key)) is None
    assert Turning().look(watching, ns(2), 10).near == []


# Not reported for 20 s: it is not shown. A result that is too young by 1 ns is not held.
def test_what_was_not_reported_lately_is_not_shown():
    static = static_info(comparison(0, "~x"))
    watching = fresh_watching(static, Question())
    watching.take(Seen(ns(1), key(0), "/n", False, 1.0, 2.0, False))
    watching.take(Seen(ns(5), key(0), "/n", False, 0.0, 2.0, False))
    turning = Turning(12.0)
    assert len(turning.look(watching, ns(13), 10).held) == 1
    assert len(turning.look(watching, ns(13) - 1, 10).held) == 0
    assert len(turning.look(watching, ns(25), 10).near) == 1
    assert len(turning.look(watching, ns(25) + 1, 10).near) == 0


def summary(begin: float, end: float, *, flops: int = 0, result: bool = False) -> Summary:
    numbers = (0.0, 0.0, 1.0, 2.0, -1.0, -1.0, -1.0, 1.0, 1.0, 2.0)
    _, _, cmp, thresh, *rest = numbers
    counts = (10, flops, 10, 0)
    return Summary(key(0), "/n", ns(begin), ns(end), *counts, result, result, cmp, thresh, *rest)


# Flops beyond the caps are in the count of a summary alone; a result that differs from the last one
# has changed, too.
@pytest.mark.parametrize(
    ("summaries", "since"),
    [
        ([summary(0, 1), summary(1, 2)], 0),
        ([summary(0, 1), summary(1, 2, flops=2)], 2),
        ([summary(0, 1), summary(1, 2, result=True), summary(2, 3, result=True)], 2),
    ],
)
def test_a_result_is_held_since_no_flop_is_known(summaries, since):
    watching = fresh_watching(static_info(comparison(0, "~x")), Question())
    for one in summaries:
        watching.take_summary(one)
    (found,) = watching.compared(ns(3), 20.0)
    assert found.since_ns == ns(since)


def test_changes_rebuild_the_board(board: LiveBoard):
    def applied(before, found):
        after = dict(before)
        for name, part in found.items():
            if "is" in part:
                after[name] = part["is"]
                continue
            rows = {row["id"]: row for row in [*before.get(name, ()), *part["rows"]]}
            order = part.get("order", [row["id"] for row in before.get(name, ())])
            after[name] = [rows[ident] for ident in order]
        return after

    shown: dict = {}
    last = None
    for seconds in (5, 5.1, 20, 3, 39):
        now = at(board, seconds)
        shown = applied(shown, changes(last, now))
        last = now
        assert shown == now
    assert changes(last, now) == {}
    assert not is_news({"clock": {"is": 1}})
    assert is_news({"near": {"rows": []}})


# ~a and ~b turn together at 5, 15 and 25 s, ~c alone at 8 and 18 s.
def test_what_turns_as_one_is_one_suspect(tmp_path: Path):
    static = static_info(*(comparison(n, name) for n, name in enumerate(("~a", "~b", "~c"))))
    rows = []
    for step in range(300):
        t = step / 10
        on, other = (t - 5) // 10 % 2 == 0, (t - 8) // 10 % 2 == 0
        rows += [(t, 0, on, on, 0.5), (t + 0.01, 1, not on, not on, 0.5)]
        rows.append((t + 0.02, 2, other, other, 0.5))
    recording = Recording("flight", events(rows, node="/robot"), (), 0, ns(30))
    shown = at(board_of(tmp_path, static, recording), 29)
    for ranking in shown["suspects"]:
        members = {row["parameter"]: (row["members"], row["turning"]) for row in ranking["rows"]}
        assert members.pop("~c") == ([], "")
        ((first, (others, turning)),) = members.items()
        assert {first, *others} == {"~a", "~b"}
        assert turning == "turned together, 3 times"
    # Of comparisons, each keeps its row.
    near = {row["parameter"]: row["members"] for row in shown["near"]}
    assert near == {"~a": ["~b"], "~b": ["~a"], "~c": []}
