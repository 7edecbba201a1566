"""Marks on topics and in CSV."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mission_samples import BagFile, line, ns

from pytpc.base.errors import InputError
from pytpc.ingest.reading import read
from pytpc.recording.marks import (
    LONGEST_NOTE,
    MARK_TYPES,
    Mark,
    MarkMessages,
    joined,
    marks_beside,
    marks_text,
    note_text,
    parse_began,
    parse_note,
    read_marks,
    topic_for,
    topic_of_marks,
    with_began,
    with_where,
    write_marks,
)
from pytpc.recording.mission import load_recording, save_recording

MARKS = st.builds(
    Mark,
    st.integers(0, 2**63 - 1),
    st.sampled_from([*MARK_TYPES, None]),
    st.sampled_from(["", "marks0", "lab/ben"]),
    st.text(st.characters(exclude_categories=["Cs", "Cc"])),
)


@pytest.mark.parametrize(
    ("topic", "mark"),
    [
        ("/mark_wrong", (None, "")),
        ("/lab/ben/mark_wrong", (None, "lab/ben")),
        ("/mark_action", ("I", "")),
        ("/marks0/mark_no_action", ("II", "marks0")),
        ("/mark_undo", None),
        ("/mark_note", None),
    ],
)
def test_topics(topic: str, mark: tuple[str | None, str] | None):
    assert topic_of_marks(topic) == mark
    if mark is not None:
        assert topic_for(Mark(1, *mark)) == topic


# ana marks at 1, 2 and 3 s and takes back that of 2 s; ben's of the same time stays. The messages
# of different topics come in any order.
def test_what_was_taken_back_is_no_mark():
    found = MarkMessages()
    found.add_time("/ana/mark_undo", ns(2))
    found.add_text("/ana/mark_note", "3.000000000,too fast, again")
    for topic, seconds in [
        ("/ana/mark_action", 3),
        ("/ana/mark_action", 1),
        ("/ana/mark_wrong", 2),
        ("/ben/mark_no_action", 2),
    ]:
        found.add_time(topic, ns(seconds))
    assert found.marks() == (
        Mark(ns(1), "I", "ana"),
        Mark(ns(2), "II", "ben"),
        Mark(ns(3), "I", "ana", "too fast, again"),
    )
    assert found.count == 3


# Two bags of one mission have the same mark, and only one has what took it back.
def test_what_was_recorded_twice_is_taken_back_once():
    found = MarkMessages()
    for _ in range(2):
        found.add_time("/mark_action", ns(1))
    assert found.count == 1
    for _ in range(2):
        found.add_time("/mark_undo", ns(1))
    assert (found.marks(), found.count) == ((), 0)


def test_marks_of_several_sources_are_each_once():
    marks = [Mark(2, "I"), Mark(1, None, "ana"), Mark(2, "I", "", "late"), Mark(2, "I")]
    assert joined(marks) == (Mark(1, None, "ana"), Mark(2, "I", "", "late"))


def where(note: str) -> tuple[str, ...]:
    return Mark(1, "I", "", note).where


@pytest.mark.parametrize(
    ("note", "places"),
    [
        ("@/cmd_vel too fast", ("/cmd_vel",)),
        ("at @move_base, then @~state; (@/a) @/b.) @/c:", ("move_base", "~state", "/b", "/c")),
        ("@/a @/b @/a", ("/a", "/b")),
        # An address, what begins with no name, and what is no name to its end.
        ("ana@lab.org @ @2 @/a-b @/a//b @/a/ @@/a @/ä", ()),
        ("@/" + "a" * 255, ()),
        (" ".join(f"@/t{number}" for number in range(20)), tuple(f"/t{n}" for n in range(8))),
    ],
)
def test_the_places_of_a_note(note: str, places: tuple[str, ...]):
    assert where(note) == places


def test_new_places_replace_those_before_the_text():
    assert with_where("@/a @/b: it turned", ["/c", "/c", "~d"]) == "@/c @~d it turned"
    assert with_where("", ["/c"]) == "@/c"
    assert with_where("@/a", []) == ""


def test_a_place_within_the_text_stays_as_a_name():
    assert with_where("it left @/map, twice", ["/c"]) == "@/c it left /map, twice"


# "@/c " takes 4 of 500 characters, so of 600 there are 493 and the dots.
def test_a_long_text_loses_its_end_and_not_its_place():
    assert with_where("x" * 600, ["/c"]) == "@/c " + "x" * 493 + "..."
    # Two names of 248 characters fill 500 with a sign and a space each; nothing else has room.
    names = ["/" + letter * 247 for letter in "abc"]
    assert with_where("text", names) == f"@{names[0]} @{names[1]}"


NAMES = st.from_regex(r"\A(/[a-z]\w{0,300}|~[a-z]|[a-z]\w?)\Z")


@given(st.text(st.sampled_from("@/a~ .-\n")) | st.text(), st.lists(NAMES, max_size=3))
def test_a_note_with_places_has_these(note: str, names: list[str]):
    names = [name for name in names if len(name) < 100 and name.isascii()]
    made = with_where(note, names)
    assert where(made) == tuple(dict.fromkeys(names))
    assert len(made) <= LONGEST_NOTE
    assert with_where(made, names) == made


@pytest.mark.parametrize(
    ("note", "began"),
    [
        ("@-20..-5 too fast", (20.0, 5.0)),
        ("@/cmd_vel @-12.5 slow", (12.5, 12.5)),
        ("from @-3..-8", (8.0, 3.0)),
        # As people type it.
        ("@-5, too fast", (5.0, 5.0)),
        ("@-20-5 @-20..5: late.", (20.0, 5.0)),
        # Not a word of its own, and no number of seconds.
        ("x@-20 @-1..-2..-3 @-1e3 @-٣ @20", None),
        ("@-1234567", None),
    ],
)
def test_when_an_error_began(note: str, began: tuple[float, float] | None):
    assert Mark(1, "I", "", note).began == began


@pytest.mark.parametrize(
    ("text", "began"),
    [("20-5", (20, 5)), ("5..20", (20, 5)), (" 12 s ", (12, 12)), ("3.5 to 4 s", (4, 3.5))],
)
def test_what_is_typed_for_it(text: str, began: tuple[float, float]):
    assert parse_began(text) == began


@pytest.mark.parametrize("text", ["", "soon", "-5", "1-2-3", "1e3", "20-"])
def test_what_is_no_time_is_refused(text: str):
    with pytest.raises(ValueError, match="is not like 20-5, or 12"):
        parse_began(text)


def test_place_and_time_do_not_replace_one_another():
    note = with_began("@/odom drifts", 20, 5)
    assert note == "@-20..-5 @/odom drifts"
    assert with_where(note, ["/tf"]) == "@-20..-5 @/tf drifts"
    assert with_began(note, 12, 12) == "@-12 @/odom drifts"
    assert Mark(1, "I", "", note).remark == "drifts"
    assert len(with_began("x" * 600, 20, 5)) == LONGEST_NOTE
    assert Mark(1, "I", "", with_began("", 1e9, 0)).began == (999_999.0, 0.0)
    assert with_where("@-5, too fast", ["/tf"]) == "@-5 @/tf too fast"


# The bag has the note of before, and the file beside it that with the place.
def test_of_two_notes_the_one_that_says_where_is_kept():
    said, placed = Mark(1, "I", "", "too fast"), Mark(1, "I", "", "@/cmd_vel too fast")
    assert said.note > placed.note
    assert joined([said, placed]) == joined([placed, said]) == (placed,)


def test_types_of_messages():
    topics = ["/mark_action", "/a/mark_wrong", "/a/mark_undo", "/mark_note", "/mark", "/rosout"]
    assert [MarkMessages.message_type(topic) for topic in topics] == [
        *["Time"] * 3,
        "String",
        None,
        None,
    ]


@pytest.mark.parametrize(
    "text", ["", "1.5,x", "1,x", "1.000000000", "-1.000000000,x", "1.00000000x,"]
)
def test_no_note(text: str):
    assert parse_note(text) is None
    with pytest.raises(ValueError, match="not a note"):
        MarkMessages().add_text("/mark_note", text)


@given(st.integers(0, 2**62), st.text())
def test_notes_come_back(time_ns: int, note: str):
    assert parse_note(note_text(time_ns, note)) == (time_ns, note)


def test_the_file_by_hand():
    marks = [Mark(ns(2), None, "ana", 'a "b", c'), Mark(ns(1), "II")]
    assert marks_text(marks) == (
        'time_ns,type,observer,note\n1000000000,II,,\n2000000000,,ana,"a ""b"", c"\n'
    )


@given(st.lists(MARKS, max_size=8))
def test_files_come_back(tmp_path_factory: pytest.TempPathFactory, marks: list[Mark]):
    path = tmp_path_factory.mktemp("marks") / "a.csv"
    write_marks(marks, path)
    assert read_marks(path) == tuple(sorted(marks, key=Mark.order))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", ":1: the first line is not time_ns,type,observer,note"),
        ("time,type\n", ":1: the first line is not"),
        ("time_ns,type,observer,note\n1,I,,\nx,I,,\n", ":3: 'x' is not a time in nanoseconds"),
        ("time_ns,type,observer,note\n9223372036854775808,I,,\n", ":2: '92233720368547758"),
        (
            "time_ns,type,observer,note\n1,III,,\n",
            ":2: 'III' is not a type of mark (I, II or nothing)",
        ),
        ("time_ns,type,observer,note\n1,I,,,more\n", ":2: 5 columns, not 4"),
    ],
)
def test_no_file_of_marks(tmp_path: Path, text: str, message: str):
    path = tmp_path / "a.csv"
    path.write_text(text)
    with pytest.raises(InputError) as caught:
        read_marks(path)
    assert str(caught.value).startswith(f"{path}{message}")


def test_a_file_by_hand_may_leave_out_what_is_empty(tmp_path: Path):
    path = tmp_path / "a.csv"
    path.write_bytes("\ufefftime_ns,type,observer,note\r\n5,I\r\n\r\n3\r\n".encode())
    assert read_marks(path) == (Mark(3, None), Mark(5, "I"))


def test_a_file_that_is_not_text(tmp_path: Path):
    path = tmp_path / "a.csv"
    path.write_bytes(b"time_ns\xff")
    with pytest.raises(InputError, match="byte 7 is not UTF-8"):
        read_marks(path)
    with pytest.raises(InputError, match="cannot be read"):
        read_marks(tmp_path / "none.csv")


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    """From 100 to 160 s; ana marked at 110 s and 120 s, and took back what was at 110 s."""
    path = tmp_path / "mission.bag"
    with BagFile(path) as writer:
        for seconds in (100, 160):
            writer.log(seconds, "/node", line(0, 0, 1, 2))
        writer.mark(110, "/ana/mark_action")
        writer.mark(111, "/ana/mark_undo", 110)
        writer.mark(120, "/ana/mark_wrong")
        writer.text(121, "/ana/mark_note", "/m", "120.000000000,it stands, still")
        writer.text(122, "/ana/mark_note", "/m", "what?")
    return path


IN_BAG = Mark(ns(120), None, "ana", "it stands, still")


def test_a_bag_with_notes_and_what_was_taken_back(bag: Path):
    recording = read(bag)
    assert recording.marks == (IN_BAG,)
    assert [(one.topic, one.what) for one in recording.malformed_first] == [
        ("/ana/mark_note", "not a note: expected SECONDS.NANOSECONDS,NOTE")
    ]


def test_marks_beside_a_bag_are_read_with_it(bag: Path, tmp_path: Path):
    late = Mark(ns(130), "II", "ben")
    write_marks([late, Mark(ns(120), None, "ana")], marks_beside(bag))
    for source in (bag, tmp_path, [bag, marks_beside(bag)]):
        assert read(source).marks == (IN_BAG, late)
    assert read(bag).marks == (IN_BAG, late)


def test_marks_beside_a_folder_of_recordings(bag: Path, tmp_path: Path):
    # What `pytpc record -o FOLDER` leaves, and `pytpc marks FOLDER --add` then marks.
    folder = tmp_path / "mission"
    folder.mkdir()
    bag.rename(folder / bag.name)
    added = Mark(ns(130), "II", "ben")
    write_marks([added], marks_beside(folder))
    assert read(folder).marks == (IN_BAG, added)
    assert read([folder, folder]).marks == read(folder).marks


def test_marks_beside_an_ingested_folder(bag: Path, tmp_path: Path):
    folder = tmp_path / "out"
    save_recording(read(bag), folder)
    assert load_recording(folder).marks == (IN_BAG,)
    write_marks([Mark(ns(130), "II", "ben")], marks_beside(folder))
    assert read(folder).marks == (IN_BAG, Mark(ns(130), "II", "ben"))


def test_a_broken_file_beside_a_bag_is_said(bag: Path):
    marks_beside(bag).write_text("time_ns,type,observer,note\n1,VI\n")
    with pytest.raises(
        InputError,
        match=r"mission\.bag\.marks\.csv:2: 'VI' is not a type of mark \(I, II or nothing\)$",
    ):
        read(bag)
