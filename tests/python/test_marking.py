"""A marking session by itself: keys and times in, marks and lines out."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from mission_samples import ns
from rich.cells import cell_len

from pytpc.recording.graph_places import Naming, Place, places_of
from pytpc.recording.marking_session import (
    MarkChange,
    Player,
    Session,
    View,
    clock_text,
    press,
    screen,
    with_places,
)
from pytpc.recording.marks import Mark
from pytpc.static.wiring import Connections, GraphTopic

PLACES = (Place("/cmd_vel", "geometry_msgs/Twist"), Place("/odom", "nav_msgs/Odometry"))


def pressed(keys: list[tuple[str, float | None]]) -> tuple[Session, list[MarkChange]]:
    """A session of ``ana`` after ``keys``, each at its second, and what it changed."""
    session, changes = Session("ana"), []
    for key, seconds in keys:
        now_ns = None if seconds is None else ns(seconds)
        session, change = press(session, key, now_ns, PLACES)
        changes += [] if change is None else [change]
    return session, changes


def at(seconds: float, kind, note: str = "") -> Mark:
    return Mark(ns(seconds), kind, "ana", note)


def test_one_key_each():
    session, changes = pressed([("1", 1), ("2", 2), ("3", 3)])
    assert session.marks == (at(1, "I"), at(2, "II"), at(3, None))
    assert changes == [MarkChange(None, mark) for mark in session.marks]
    assert (session.said, session.ended) == ("marked: wrong", False)


def test_undo_takes_back_the_last_one_made():
    session, changes = pressed([("1", 5), ("2", 3), ("u", 9), ("u", 9), ("u", 9)])
    assert session.marks == ()
    assert changes[2:] == [MarkChange(at(3, "II"), None), MarkChange(at(5, "I"), None)]
    assert session.said == "no mark yet"


# While a note is written the keys of marks are text: "1q" here.
def test_a_note_goes_to_the_last_mark():
    keys = ["1", "n", "1", "q", "ä", "left", "x", "backspace", " ", "enter", "n", "z", "escape"]
    session, changes = pressed([(key, 1) for key in keys])
    assert session.marks == (at(1, "I", "1qä"),)
    assert changes == [MarkChange(None, at(1, "I")), MarkChange(at(1, "I"), at(1, "I", "1qä"))]
    assert session.typing is None


def typed(*keys: str) -> tuple[Session, list[MarkChange]]:
    return pressed([(key, 1) for key in keys])


def test_the_last_mark_gets_a_place():
    session, changes = typed("1", "2", "w", "o", "d", "enter")
    assert session.marks == (at(1, "I"), at(1 + 1e-9, "II", "@/odom"))
    assert changes[2:] == [MarkChange(at(1 + 1e-9, "II"), at(1 + 1e-9, "II", "@/odom"))]
    assert (session.naming, session.said) == (None, "wrong at /odom")


def test_a_place_stands_before_the_note_and_a_new_one_in_its_stead():
    session, _ = typed("1", "n", "h", "i", "enter", "w", "1", "enter")
    assert session.marks == (at(1, "I", "@/cmd_vel hi"),)
    session, _ = press(session, "w", 0, PLACES)
    for key in ("2", "enter"):
        session, _ = press(session, key, 0, PLACES)
    assert session.marks == (at(1, "I", "@/odom hi"),)


def test_a_note_after_a_place_does_not_lengthen_it():
    session, _ = typed("1", "w", "1", "enter", "n", "h", "i", "enter")
    assert session.marks == (at(1, "I", "@/cmd_vel hi"),)
    session, _ = typed("1", "w", "1", "enter", "n", "enter")
    assert session.marks == (at(1, "I", "@/cmd_vel"),)


@pytest.mark.parametrize("leave", ["escape", "enter"])
def test_nothing_is_named_by_escape_nor_by_enter_alone(leave: str):
    keys = ["c", "escape"] if leave == "escape" else ["enter"]
    session, changes = typed("1", "w", *keys)
    assert (session.marks, session.naming, session.said) == ((at(1, "I"),), None, "")
    assert len(changes) == 1


# "q", "1" and "w" are text there; the message goes with the next key.
def test_what_is_no_name_is_said_and_can_be_mended():
    session, changes = typed("1", "w", "q", "#", "enter")
    assert session.said == "not a ROS name: q#"
    assert len(changes) == 1
    for key in ("left", "backspace"):
        session, _ = press(session, key, 0, PLACES)
    assert (session.naming, session.said) == (Naming(PLACES, "q"), "")
    session, _ = press(session, "enter", 0, PLACES)
    assert session.marks == (at(1, "I", "@q"),)


def test_places_that_become_known_can_be_chosen_and_others_keep_their_numbers():
    session, _ = press(Session("ana", (at(1, "I"),)), "w", 0, ())
    session = with_places(session, PLACES)
    assert session.naming == Naming(PLACES)
    assert with_places(session, PLACES[1:]) == session
    assert with_places(Session("ana"), PLACES) == Session("ana")


def test_without_a_mark_there_is_no_place():
    session, _ = typed("w")
    assert (session.naming, session.said) == (None, "no mark yet")


def test_the_last_mark_gets_the_time_at_which_it_began():
    session, changes = typed("1", "b", *"20x", "backspace", *"-5", "enter")
    assert session.marks == (at(1, "I", "@-20..-5"),)
    assert changes[1:] == [MarkChange(at(1, "I"), at(1, "I", "@-20..-5"))]
    assert (session.dating, session.said) == (None, "it began 20 to 5 s before the mark")
    session, _ = typed("1", "b", "7", "enter", "n", "h", "i", "enter")
    assert session.marks == (at(1, "I", "@-7 hi"),)


def test_what_is_no_time_is_said_and_can_be_mended():
    session, changes = typed("1", "b", "w", "enter")
    assert (session.said, len(changes)) == ("'w' is not like 20-5, or 12", 1)
    for key in ("left", "backspace", "8", "enter"):
        session, _ = press(session, key, 0)
    assert session.marks == (at(1, "I", "@-8"),)


@pytest.mark.parametrize("leave", ["escape", "enter", "end", "closed"])
def test_a_time_that_is_not_taken_is_not_said(leave: str):
    keys = [leave] if leave == "enter" else ["8", leave]
    session, changes = typed("1", "b", *keys)
    assert (session.marks, session.dating, len(changes)) == ((at(1, "I"),), None, 1)


def test_the_screen_asks_when_it_began():
    session = Session("ana", (at(101, "I"),), dating="20")
    prompt = "it began so many seconds before the mark (20-5, or 12): 20_"
    assert screen(session, VIEW, 80, 24)[-1] == prompt
    assert screen(replace(session, said="no"), VIEW, 80, 24)[-2:] == ["no", prompt]


# What Enter would have taken, nobody has said.
def test_a_place_that_is_interrupted_is_not_named():
    for key in ("end", "closed"):
        session, changes = typed("1", "w", "o", key)
        assert (session.marks, session.ended) == ((at(1, "I"),), True)
        assert len(changes) == 1


def test_a_note_is_kept_where_the_terminal_is_gone():
    session, changes = typed("1", "n", "o", "closed")
    assert (session.marks, session.ended) == ((at(1, "I", "o"),), True)
    assert changes[-1] == MarkChange(at(1, "I"), at(1, "I", "o"))


def test_the_end_is_q_or_control_c_and_within_a_note_control_c():
    assert pressed([("q", 1)])[0].ended
    session, _ = pressed([("1", 1), ("n", 1), ("q", 1)])
    assert (session.ended, session.typing) == (False, "q")
    assert press(session, "end", 0)[0].ended


def test_without_a_time_there_is_no_mark():
    session, changes = pressed([("1", None)])
    assert (session.marks, changes) == ((), [])
    assert "no /clock" in session.said


def test_marks_of_one_time_are_told_apart():
    session, _ = pressed([("1", 1), ("1", 1), ("2", 1)])
    assert [mark.time_ns - ns(1) for mark in session.marks] == [0, 1, 2]


# What was taken back is told by its time, so that this must not be marked again.
def test_a_time_that_was_taken_back_is_not_marked_again():
    session, changes = pressed([("1", 1), ("u", 1), ("1", 1)])
    assert session.marks == (Mark(ns(1) + 1, "I", "ana"),)
    assert changes[1] == MarkChange(at(1, "I"), None)


def test_other_keys_do_nothing():
    session, changes = pressed([(key, 1) for key in ("x", "left", "enter", "escape", "é")])
    assert (session, changes) == (Session("ana"), [])


@given(
    st.lists(st.sampled_from(["1", "2", "3", "n", "u", "w", "enter", "escape", "a", "backspace"]))
)
def test_the_changes_make_the_marks(keys: list[str]):
    session, changes = pressed([(key, 1) for key in keys])
    marks: tuple[Mark, ...] = ()
    for change in changes:
        marks = change.apply(marks)
    assert sorted(marks, key=Mark.order) == sorted(session.marks, key=Mark.order)


# From 100 to 160 s. At steady 10 s it begins to go, at 12 s it is at 102 s; twice as fast for 3 s
# makes 108 s; 5 s back is 103 s; it stands, and an hour later it still does.
def test_the_player_by_hand():
    player = Player.of(ns(100), ns(160))
    assert player.time_ns(ns(7)) == ns(100)
    for seconds, key in [(10, " "), (12, "+"), (15, "left"), (15, " ")]:
        player = player.press(key, ns(seconds))
        assert player is not None
    assert player.time_ns(ns(3600)) == ns(103)
    assert player.press("1", 0) is None


def test_the_player_stays_within_the_recording():
    player = Player.of(ns(100), ns(160))
    assert player.press("left", 0).time_ns(0) == ns(100)
    assert player.press("up", 0).time_ns(0) == ns(160)
    assert player.press(" ", 0).time_ns(ns(1000)) == ns(160)
    for _ in range(9):
        player = player.press("-", 0)
    assert player.speed == 0.125
    for _ in range(20):
        player = player.press("=", 0)
    assert player.speed == 16


@pytest.mark.parametrize(
    ("seconds", "text"),
    [(0, "0:00.0"), (59.99, "0:59.9"), (60, "1:00.0"), (3725.5, "1:02:05.5"), (-1.5, "-0:01.5")],
)
def test_clock_text(seconds: float, text: str):
    assert clock_text(ns(seconds)) == text


VIEW = View("mission.bag", ("0:01.0 of 1:00.0",), ns(100), ns(101), ("space go or stop",))


def test_the_screen():
    session = Session("ana", (at(101, "I"), at(103.25, None, "it \x1b[31mturned")), said="noted")
    assert screen(session, VIEW, 80, 24) == [
        "mission.bag",
        "0:01.0 of 1:00.0",
        "1 it did something it should not have",
        "2 it should be doing something",
        "3 something is wrong",
        "n note  w where  b when it began  u undo  q quit  space go or stop",
        "2 marks:",
        "   0:01.0  I",
        "   0:03.2  -   it \N{REPLACEMENT CHARACTER}[31mturned",
        "noted",
    ]


def test_the_screen_lists_the_places_to_choose_from():
    session = Session("ana", (at(101, "I"),), naming=Naming(PLACES, "od"))
    assert screen(session, VIEW, 80, 24)[6:] == [
        "1 mark:",
        "   0:01.0  I",
        ">  2 /odom (nav_msgs/Odometry)",
        "where (number, name or part): od_",
    ]


# Of 24 lines, six and "30 marks:" are above, ten list places and one asks: six marks have room.
def test_the_list_of_places_leaves_room_for_marks():
    places = tuple(Place(f"/t{number}", "x") for number in range(100))
    session = Session("ana", tuple(at(100 + n, "I") for n in range(30)), naming=Naming(places))
    lines = screen(session, VIEW, 80, 24)
    assert len(lines) == 24
    assert lines[6:] == [
        "30 marks:",
        *(f"   0:{second}.0  I" for second in range(24, 30)),
        *(f"   {number} /t{number - 1} (x)" for number in range(1, 10)),
        "     91 more: type a part of the name",
        "where (number, name or part): _",
    ]


# What a robot calls its topics must not steer the terminal, nor fill it.
def test_names_of_the_graph_cannot_steer_the_terminal():
    bad = "/\x1b[2J" + "a" * 10_000
    topics = {
        bad: GraphTopic("x", frozenset({"/a"}), frozenset()),
        "/b": GraphTopic("\x1b]0;x\x07\n" + "t" * 10_000, frozenset({bad}), frozenset({"/c"})),
    }
    places = places_of(Connections(topics, {bad: frozenset({bad})}))
    session = Session("", (at(101, "I"),), naming=Naming((*places, Place(bad, bad))))
    lines = screen(session, VIEW, 80, 24)
    assert [line[:7] for line in lines[8:11]] == ["   1 /b", "   2 /a", "   3 /c"]
    assert "\N{REPLACEMENT CHARACTER}]0;x" in lines[8]
    assert len(lines) == 13
    assert all(line.isprintable() for line in lines)
    assert all(cell_len(line) <= 80 for line in lines)


# 24 lines hold 16 marks besides the other eight.
def test_the_newest_marks_are_shown():
    session = Session("ana", tuple(at(100 + n, "I") for n in range(30)))
    lines = screen(session, VIEW, 80, 24)
    assert len(lines) == 24
    assert lines[7:-1] == [f"   0:{n:02d}.0  I" for n in range(14, 30)]


# "1 mark:" has seven columns; a joiner (U+200D) takes the width of what is put behind it.
@example(6, 28, "", "")
@example(5, 28, "a\N{ZERO WIDTH JOINER}\N{ARABIC NUMBER SIGN}" * 4, "note")
@given(
    st.integers(1, 60),
    st.integers(1, 30),
    st.text(max_size=40),
    st.sampled_from(["", "note", "where"]),
)
def test_the_screen_fits(width: int, height: int, text: str, typing: str):
    session = Session("ana", (at(101, "II", text),), said=text)
    if typing == "note":
        session = replace(session, typing=text)
    elif typing:
        session = replace(session, naming=Naming((Place(text, text), *PLACES), text))
    lines = screen(session, VIEW._replace(title=text), width, height)
    assert len(lines) <= height
    assert all(character.isprintable() for line in lines for character in line)
    assert all(cell_len(line) <= width for line in lines)
