"""How the suite's nodes are fed and compared, without a graph."""

import io
import math
from pathlib import Path

import genpy
from std_msgs.msg import Header

from suite.both_ways import Published, differences, input_of, timeless


def package(folder: Path) -> Path:
    """A package with one node, which knows the word "fast" and takes NaN."""
    (folder / "nodes").mkdir()
    (folder / "nodes/a.json").write_text('{"expect": [], "nan": true}', encoding="utf-8")
    (folder / "nodes/a.cpp").write_text('if (mode == "fast") {}', encoding="utf-8")
    return folder


def test_the_same_seed_feeds_the_same(tmp_path: Path) -> None:
    place = package(tmp_path)
    once, again = input_of("a", 1, place), input_of("a", 1, place)
    assert repr(once) == repr(again) != repr(input_of("a", 2, place))
    assert all(-10 <= number <= 10 for number in once["aux"] if not math.isnan(number))
    assert any(math.isnan(number) for number in once["input"])
    assert "fast" in once["text"]


def test_equal_messages_are_no_difference() -> None:
    results = {name: Published({"output": [b"1", b"2"]}, 0, 0) for name in ("plain", "tpc")}
    assert list(differences("a", results)) == []


def test_says_where_messages_differ() -> None:
    results = {"plain": Published({"o": [b"1", b"2"]}), "tpc": Published({"o": [b"1", b"3"]})}
    assert list(differences("a", results)) == [
        "a: o: plain published 2 messages, tpc 2; the first difference is at 1"
    ]


def test_a_message_less_and_another_status_are_differences() -> None:
    results = {"plain": Published({"o": [b"1"]}, 0, 0), "tpc": Published({}, 0, -11)}
    assert list(differences("a", results)) == [
        "a: o: plain published 1 messages, tpc 0; the first difference is at 0",
        "a: plain ended with 0, tpc -11",
    ]


def test_takes_times_and_numbers_out_and_nothing_else() -> None:
    def written(number: int, seconds: int) -> bytes:
        out = io.BytesIO()
        Header(seq=number, stamp=genpy.Time(seconds), frame_id="map").serialize(out)
        return out.getvalue()

    definition = Header._full_text
    assert timeless("std_msgs/Header", definition, written(4, 7)) == written(0, 0)
