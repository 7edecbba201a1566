"""What ``pytpc watch`` knows and shows, without a terminal: the model, the lines, the messages."""

from __future__ import annotations

import math
import struct

import pytest
from mission_samples import comparison, events, key, link_unit, static_info
from rich.cells import cell_len
from rich.text import Text

from patience import wait_for
from pytpc.api.graph_feed import GraphFeed
from pytpc.api.live_mission import RecordedFeed
from pytpc.api.live_reports import Reports
from pytpc.diagnosis.ranking.watching import BINS, KeptRankings, Watching
from pytpc.diagnosis.results.live import Look, Seen
from pytpc.diagnosis.scores.live_scores import LiveRanking
from pytpc.present.watch_screen import LAYOUTS, Panel, Status, WatchOptions, table, watch_screen
from pytpc.recording.graph_places import Naming, Place
from pytpc.recording.marking_session import MarkChange, Session, View
from pytpc.recording.marks import Mark
from pytpc.recording.mission import ReadName, Recording
from pytpc.recording.summaries import Summary
from pytpc.ros.ros1.publisher import encode_string
from pytpc.ros.source import Source
from pytpc.static.link_unit import ParameterRead
from pytpc.static.static_info import StaticInfo

S = 10**9
STATIC = static_info(comparison(0, "~speed"), comparison(1, "~limit"), comparison(2, "~gain"))


def seen(seconds: float, number: int, cmp: float, thresh: float, node: str = "/a") -> Seen:
    """An evaluation of ``cmp > thresh``."""
    result = cmp > thresh
    return Seen(round(seconds * S), key(number), node, result, cmp, thresh, result)


def watching(*events: Seen) -> Watching:
    found = Watching(LiveRanking(STATIC), STATIC)
    for event in events:
        found.take(event)
    return found


# ~speed is 1 above 3 at 100 s, below it at 104 s (a flop) and stays so; ~limit comes near: 8, 4, 2
# below 10 within values from 2 to 10 (spread 8): distances 8/8, 4/8, 2/8.
# At 110 s, type I: only ~speed has flopped, (110 - 104) * (1 + 1) = 12.
# Type II, window from 98 s: ~speed: cmp 4, 2, 1 of 3: |.| 1, 1, 2; spread 4 - 1 = 3: mean 4/9,
# flops in the window 1: 4/9 = 0.444. ~limit: (8 + 4 + 2)/3/8 = 0.583.
EVENTS = (
    seen(100, 0, 4, 3),
    seen(101, 1, 2, 10),
    seen(104, 0, 2, 3),
    seen(105, 1, 6, 10),
    seen(108, 0, 1, 3),
    seen(109, 1, 8, 10),
)


def test_both_rankings_and_what_stands_beside_the_scores():
    look = watching(*EVENTS).look(110 * S, 5)
    (first,) = look.rows["I"]
    assert first.suspect.parameter == "~speed"
    assert first.suspect.score == pytest.approx(12)
    assert first.flop_s == 6
    assert first.last == EVENTS[4]
    second = look.rows["II"]
    assert [row.suspect.parameter for row in second] == ["~speed", "~limit"]
    assert [row.suspect.score for row in second] == pytest.approx([4 / 9, 14 / 3 / 8])
    assert second[1].flop_s is None
    assert look.parameters == 3


# The second object of a class flops at 102 s and 104 s; the first one, with other values, never
# does. Type I at 110 s: (110 - 104) * (1 + 2) = 18. Mixed, each evaluation would be a flop.
def test_objects_are_watched_apart():
    second = f"{key(0)}#2"
    given = static_info(comparison(0, "<dynamic>/speed"), comparison(1, "~limit"))
    found = Watching(LiveRanking(given), given)
    before = found.snapshot()
    for at, cmp in ((100, 4), (102, 2), (104, 4)):
        found.take(seen(at - 1, 0, 9, 3))
        found.take(seen(at, 0, cmp, 3)._replace(key=second))
        found.take(seen(at, 1, 0, 3))
    (row,) = found.look(110 * S, 5).rows["I"]
    assert row.suspect.key == second
    assert row.suspect.parameter == "<dynamic>/speed (object 2)"
    assert row.suspect.score == pytest.approx(18)
    assert not found.unknown
    # A copy from before knows nothing of it.
    assert second not in before.static_info.comparisons
    found.take(Seen(105 * S, "0badbad0-0000-5000-8000-000000000000#2", "/a", True, 1, 0, True))
    assert list(found.unknown.values()) == [1]


# 300 objects, which report by turns before anyone looks; each flops once, at 101 s.
def test_many_objects_are_learned_at_once(monkeypatch):
    given = static_info(comparison(0, "<dynamic>/speed"))
    engine = LiveRanking(given)
    learned = []
    learn = engine.learn
    monkeypatch.setattr(engine, "learn", lambda static: (learned.append(static), learn(static)))
    found = Watching(engine, given)
    for at, cmp in ((100, 4), (101, 2)):
        for number in range(2, 302):
            found.take(Seen(at * S, f"{key(0)}#{number}", "/a", cmp > 3, cmp, 3, cmp > 3))
    rows = found.look(110 * S, 1000).rows["I"]
    assert (len(learned), found.evaluations, found.unknown) == (1, 600, {})
    assert len(rows) == 300
    assert {row.flop_s for row in rows} == {9}


# Nodes of Python tell no names; the node that reports completes them, also if it comes late.
def test_a_parameter_of_ros2_has_the_name_of_its_node():
    read = ParameterRead(
        "speed", "rclpy.node.Node.declare_parameter", "double", None, "src/node.cpp", 3, 5, "main",
        None,
    )  # fmt: skip
    given = StaticInfo.of([link_unit([comparison(0, "speed")], [read])])
    found = Watching(LiveRanking(given), given)
    before = found.snapshot()
    for at, cmp in ((100, 4), (102, 2)):
        found.take(seen(at, 0, cmp, 3, "/robot1/guard"))
    (row,) = found.look(110 * S, 5).rows["I"]
    assert row.suspect.parameter == "/robot1/guard/speed"
    found.take(seen(103, 0, 2, 3, "/robot2/guard"))
    (row,) = found.look(110 * S, 5).rows["I"]
    assert row.suspect.parameter == "~speed"
    before.take(seen(103, 0, 2, 3, "/robot2/guard"))
    before.look(110 * S, 5)
    assert [one.source for one in before.static_info.comparisons.values()] == [
        "/robot2/guard/speed"
    ]


def test_names_that_nodes_tell_are_watched():
    read = ParameterRead(
        "<dynamic>/speed", "ros::NodeHandle::param", "double", None, "src/node.cpp", 3, 5, "main",
        key(90),
    )  # fmt: skip
    unit = link_unit([comparison(0, "<dynamic>/speed"), comparison(1, "~limit")], [read])
    given = StaticInfo.of([unit])
    table = events([(100, 0, 0, 1, 3), (104, 0, 1, 4, 3), (105, 1, 0, 1, 3)])
    told = Recording(
        "m", table, (), 0, 200 * S, names=(ReadName(key(90), "/node", "/node/arm/speed"),)
    )
    taken, items = RecordedFeed(told, Watching(LiveRanking(given), given)).take(200 * S)
    for item in items:
        taken.take(item)
    (row,) = taken.look(110 * S, 5).rows["I"]
    assert row.suspect.parameter == "/node/arm/speed"


# A part is 12 s / 8 = 1.5 s. At 110 s the newest is [109.5, 111) and the oldest [99, 100.5).
# ~limit: 101 s in the second, 105 s in the fifth ([105, 106.5)), 109 s in the seventh.
def test_the_parts_of_the_window():
    row = watching(*EVENTS).look(110 * S, 5).rows["II"][1]
    assert len(row.parts) == BINS
    known = {n: part.distance for n, part in enumerate(row.parts) if part.distance == part.distance}
    assert known == {1: 1.0, 4: 0.5, 6: 0.25}
    first = watching(*EVENTS).look(110 * S, 5).rows["I"][0]
    assert [n for n, part in enumerate(first.parts) if part.flopped] == [3]


# Two nodes run the same comparison: one is always above, the other always below. No flop, however
# they take turns. The same from one node alone is three flops.
def test_a_flop_is_one_node_s():
    values = [(100, 4), (101, 2), (102, 4), (103, 2)]
    two = [seen(t, 0, cmp, 3, "/a" if cmp > 3 else "/b") for t, cmp in values]
    assert watching(*two).look(105 * S, 5).rows["I"] == ()
    (row,) = watching(*[seen(t, 0, cmp, 3) for t, cmp in values]).look(105 * S, 5).rows["I"]
    assert row.flop_s == 2


def test_keys_of_another_build_are_counted():
    found = watching(seen(100, 7, 1, 2), seen(101, 7, 1, 2), seen(101, 0, 1, 2))
    assert found.unknown == {key(7): 2}
    assert found.evaluations == 3


def test_a_copy_goes_its_own_way():
    one = watching(*EVENTS[:2])
    other = one.snapshot()
    other.take(EVENTS[2])
    assert (one.evaluations, other.evaluations) == (2, 3)
    assert one.look(110 * S, 5).rows["I"] == ()
    assert len(other.look(110 * S, 5).rows["I"]) == 1
    assert other.static_info is STATIC


# Ten evaluations in one summary, as far from 10 as 2 to 6, mean 4; values 4 to 10, spread 6.
def test_a_summary_is_many_evaluations():
    numbers = {"diff_min": -6.0, "diff_max": -2.0, "diff_mean": -4.0, "abs_mean": 4.0}
    summary = Summary(
        key(1), "/a", 101 * S, 104 * S, 10, 0, 10, 0, False, False, 8.0, 10.0,
        **numbers, low=4.0, high=10.0,
    )  # fmt: skip
    found = watching()
    found.take_summary(summary)
    assert found.evaluations == 10
    (row,) = found.look(105 * S, 5).rows["II"]
    assert row.suspect.score == pytest.approx(4 / 6)
    assert row.last is not None
    assert (row.last.cmp, row.last.time_ns) == (8.0, 104 * S)


def test_rankings_are_kept_at_marks_noted_and_taken_back():
    kept, found = KeptRankings(5), watching(*EVENTS)
    mark, other = Mark(110 * S, "II"), Mark(111 * S, "I")
    kept.follow(MarkChange(None, mark), found)
    kept.follow(MarkChange(None, other), found)
    assert len(kept) == 2
    assert [row.suspect.parameter for row in kept[0].look.rows["II"]] == ["~speed", "~limit"]
    noted = Mark(110 * S, "II", note="stuck")
    kept.follow(MarkChange(mark, noted), found)
    kept.follow(MarkChange(other, None), found)
    assert len(kept) == 1
    assert [one.mark for one in kept] == [noted]


def test_a_mark_whose_type_is_not_believed_is_ranked_by_both():
    kept = KeptRankings(5)
    kept.follow(MarkChange(None, Mark(110 * S, "I")), watching(*EVENTS), believe=False)
    parameters = {suspect.parameter for suspect in kept[0].ranking.suspects}
    assert parameters == {"~speed", "~limit"}


def panel(look: Look, options: WatchOptions, kept: KeptRankings | None = None) -> Panel:
    return Panel(look, tuple(kept or ()), Status(6, 2.0, 1), options)


def shown(
    width: int, height: int, options: WatchOptions | None = None, session: Session | None = None
) -> list[Text]:
    options = options or WatchOptions()
    look = watching(*EVENTS).look(110 * S, 5)
    view = View("watching on http://robot:11311", ("connected",), 100 * S, 110 * S)
    return watch_screen(session or Session(""), view, panel(look, options), width, height)


def texts(lines: list[Text]) -> list[str]:
    return [line.plain.rstrip() for line in lines]


def test_side_by_side_on_a_wide_screen():
    lines = texts(shown(120, 30))
    (titles,) = [line for line in lines if line.startswith("Type I:")]
    assert "Type II: what is near its threshold" in titles
    heads = lines[lines.index(titles) + 1]
    # Columns stand below their headings on both sides.
    for row in lines[lines.index(titles) + 2 : lines.index(titles) + 3]:
        assert row.index("~speed") == heads.index("Parameter")
        assert row.rindex("~speed") == heads.rindex("Parameter")
    assert "6 evaluations of 1 node, 2/s" in lines
    assert lines[-1].startswith("1 should not have  2 should be doing  3 wrong")


def test_below_one_another_on_a_narrow_one():
    lines = texts(shown(70, 24))
    places = [n for n, line in enumerate(lines) if line.startswith("Type ")]
    assert len(places) == 2
    assert places[1] > places[0] + 2


@pytest.mark.parametrize("layout", LAYOUTS)
def test_no_line_is_too_wide_and_none_too_many(layout):
    session = Session("", (Mark(105 * S, "I", note="ü" * 90), Mark(110 * S, None)))
    for width in (1, 2, 7, 20, 39, 40, 60, 80, 99, 120, 300):
        for height in (1, 2, 5, 9, 24, 60):
            lines = shown(width, height, WatchOptions(layout=layout), session)
            assert len(lines) <= height
            assert all(cell_len(line.plain) <= width for line in lines), (width, height)


def test_what_is_being_written_is_shown_however_small_the_screen_is():
    for height in (1, 3, 10):
        session = Session("", (Mark(105 * S, "I"),), typing="stuck")
        assert texts(shown(40, height, session=session))[-1] == "note: stuck_"


def test_the_places_to_choose_from_are_above_the_question():
    naming = Naming(tuple(Place(f"/t{number}", "x") for number in range(100)), "t9")
    session = Session("", (Mark(105 * S, "I"),), naming=naming)
    lines = texts(shown(80, 24, session=session))
    assert lines[-1] == "where (number, name or part): t9_"
    first = lines.index("> 10 /t9 (x)")
    assert lines[first + 1] == "  91 /t90 (x)"
    for height in (1, 2, 5, 12, 24, 60):
        lines = texts(shown(40, height, session=session))
        assert len(lines) <= height
        assert lines[-1].endswith("t9_")


def test_without_utf8_all_is_ascii():
    session = Session("", (Mark(105 * S, "I", note="dröhnt"),))
    lines = texts(shown(100, 30, WatchOptions(utf8=False), session))
    assert all(line.isascii() for line in lines)
    assert any("dr?hnt" in line for line in lines)


# What a robot calls its parameter must not steer the terminal, nor its source text.
def test_names_from_the_robot_cannot_steer_the_terminal():
    bad = comparison(0, "~a\x1b[2J\n漢字", source_code="if (a\x07\x1b]0;x\x07)")
    static = static_info(bad)
    found = Watching(LiveRanking(static), static)
    for event in (EVENTS[0], EVENTS[2], EVENTS[4]):
        found.take(event)
    look = found.look(110 * S, 5)
    lines = watch_screen(Session(""), View("t", (), 0, 0), panel(look, WatchOptions()), 120, 40)
    assert any("漢字" in line.plain for line in lines)
    for line in lines:
        assert line.plain.isprintable()
        assert cell_len(line.plain) <= 120


def test_why_there_is_nothing_to_show():
    look = watching().look(110 * S, 5)
    view = View("t", (), 0, 0)
    lines = texts(watch_screen(Session(""), view, panel(look, WatchOptions()), 120, 20))
    assert any(look.reasons["I"][:20] in line for line in lines)
    assert look.reasons["I"]


LINE = f"{key(0)},1,cmp:4,thresh:3,res:1"


def log(text: str, seconds: int = 100, number: int = 1, node: bytes = b"/a") -> bytes:
    """A rosgraph_msgs/Log: header, level, name, text, and no more that is read."""
    data = text.encode()
    name = struct.pack("<I", len(node)) + node
    head = struct.pack("<IIIIB", number, seconds, 0, 0, 2)
    return head + name + struct.pack("<I", len(data)) + data


ROSOUT = Source("/rosout", "/a", "rosgraph_msgs/Log", "", "")
REPORT = Seen(100 * S, key(0), "/a", True, 4.0, 3.0, True)


def topic(node: str) -> Source:
    return Source("/threshold_information", node, "std_msgs/String", "", "")


def test_what_a_relay_passes_on_is_the_same_report():
    reports = Reports()
    line = encode_string(f"100.0000000,{LINE}")
    # The copy comes before the log message, and another one after.
    assert reports.read(topic("/tpc_relay"), line, 0.0) == []
    assert reports.read(ROSOUT, log(f"threshold_information:{LINE}"), 0.1) == [REPORT]
    assert reports.read(ROSOUT, log(f"threshold_information:{LINE}", number=2), 0.1) == [REPORT]
    assert reports.read(topic("/tpc_relay"), line, 0.2) == []
    assert reports.due(10.0) == []


def test_a_python_node_s_line_is_a_report_of_its_own():
    reports = Reports()
    assert reports.read(topic("/p"), encode_string(f"100.0000000,{LINE}"), 0.0) == []
    assert reports.due(0.4) == []
    assert reports.due(0.6) == [REPORT._replace(node="/p")]


def test_a_numbered_batch_needs_no_waiting_and_shows_what_is_lost():
    reports = Reports()

    def batch(number: int) -> bytes:
        head = f"#seq:{number},count:2,dropped:0,pid:7,steady:1.0"
        return encode_string(f"{head}\n100.0000000,{LINE}\n101.0000000,{LINE}\n")

    found = reports.read(topic("/a"), batch(0), 0.0)
    assert found == [REPORT, REPORT._replace(time_ns=101 * S)]
    assert reports.lost == 0
    # 2 and 3, and 4 and 5, never came.
    reports.read(topic("/a"), batch(6), 0.0)
    assert reports.lost == 4


def test_other_log_messages_and_broken_ones():
    reports = Reports()
    assert reports.read(ROSOUT, log("motor started"), 0.0) == []
    assert reports.malformed == 0
    assert reports.read(ROSOUT, log("threshold_information:nonsense", number=2), 0.0) == []
    assert reports.read(ROSOUT, b"\x00", 0.0) == []
    assert reports.read(topic("/a"), encode_string("nonsense"), 0.0) == []
    assert reports.malformed == 3


# Copies are kept every half a minute, so 100 s is gone to from nothing and 40 s from one of 30 s.
def test_going_back_in_a_recording_is_never_having_been_further():
    rows = [(t, t % 2, t % 3 == 0, t % 7, 3) for t in range(120)]
    recording = Recording("m", events(rows), (), 0, 120 * S)

    def look_after(*stops: int) -> str:
        feed = RecordedFeed(recording, watching())
        for seconds in stops:
            found, items = feed.take(seconds * S)
            for item in items:
                assert isinstance(item, Seen)
                found.take(item)
        return str(found.look(stops[-1] * S, 5)) + str(found.evaluations)

    there = [look_after(stop) for stop in (40, 0, 119)]
    assert len(set(there)) == 3
    assert look_after(1, 20, 31, 62, 100, 40) == there[0]
    assert look_after(35, 80, 0) == there[1]
    assert look_after(35, 80, 0, 70, 30, 119) == there[2]


# 6,000 s: after a jump to the end, one step back reads a stretch between two copies again.
def test_a_jump_leaves_copies_on_its_way():
    recording = Recording("m", events([(t, 0, False, 1, 3) for t in range(6000)]), (), 0, 6000 * S)
    feed = RecordedFeed(recording, watching())
    while (stop := feed.stop(6000 * S)) != 6000 * S:
        feed.take(stop)
    assert len(feed.take(6000 * S)[1]) <= 31
    assert 1 < len(feed._copies) <= 64
    # 64 copies of each half a minute are full at 1,920 s: twice as far apart they reach 3,840 s.
    assert len(feed.take(5990 * S)[1]) <= 121


# However many reports have one time, the way goes on.
def test_many_reports_of_one_instant_are_taken_at_once():
    rows = [(t, 0, False, 1, 3) for t in (1, 2) for _ in range(25_000)]
    feed = RecordedFeed(Recording("m", events(rows), (), 0, 3 * S), watching())
    counts = []
    while True:
        stop = feed.stop(3 * S)
        counts.append(len(feed.take(stop)[1]))
        if stop == 3 * S:
            break
    assert counts[:2] == [25_000, 25_000]
    assert sum(counts) == 50_000


# The lines of two minutes and more of 2,000 comparisons are not kept 64 times.
def test_copies_share_the_lines():
    found = watching(*(seen(t, 0, 1, 3) for t in range(100)))
    times, *_ = found.line_of(key(0), "/a")
    other = found.snapshot()
    assert other.line_of(key(0), "/a")[0] == times == list(range(100))
    line, copied = (one._tracks[key(0)].lines["/a"] for one in (found, other))
    assert len(line.full) == 1
    assert line.full[0] is copied.full[0]
    found.take(seen(100, 0, 1, 3))
    assert other.line_of(key(0), "/a")[0] == times


class Feeding(GraphFeed):
    """A feed of a graph that is not there; what came is put into it."""

    def put(self, *items: Seen | ReadName) -> None:
        self._items.extend(items)


# Now is 110 s. A report without a stamp is of now; one of 10^9 s is of another clock.
def test_the_clock_of_a_graph():
    feed = Feeding("http://127.0.0.1:9", watching())
    try:
        feed.put(EVENTS[0])
        assert feed.take(None)[1] == ()
        feed.put(EVENTS[1]._replace(time_ns=0), EVENTS[2]._replace(time_ns=10**18))
        found, items = feed.take(110 * S)
        assert items == [EVENTS[0], EVENTS[1]._replace(time_ns=110 * S)]
        assert "1 left out (another clock)" in feed.fault()
        for item in items:
            assert isinstance(item, Seen)
            found.take(item)
        # 101 s is out of order, 50 s is another run: what was before is no part of it.
        assert feed.take(101 * S)[0] is found
        again, _ = feed.take(50 * S)
        assert (again.evaluations, found.evaluations) == (0, 2)
        assert "the clock was set back, so the ranking started again" in feed.fault()
        wait_for(lambda: feed.is_settled)
        assert "http://127.0.0.1:9 does not answer" in feed.fault()
    finally:
        feed.close()


# A node tells its names before the clock is set back; the ranking that begins again knows them.
def test_names_outlive_the_clock_of_a_graph():
    read = ParameterRead(
        "<dynamic>/speed", "ros::NodeHandle::param", "double", None, "src/node.cpp", 3, 5, "main",
        key(90),
    )  # fmt: skip
    given = StaticInfo.of([link_unit([comparison(0, "<dynamic>/speed")], [read])])
    feed = Feeding("http://127.0.0.1:9", Watching(LiveRanking(given), given))
    try:
        feed.put(ReadName(key(90), "/a", "/a/arm/speed"), EVENTS[0])
        found, items = feed.take(110 * S)
        assert len(items) == 2
        found.take(EVENTS[0])
        again, _ = feed.take(50 * S)
        assert again is not found
        again.take(seen(40, 0, 4, 3))
        again.take(seen(41, 0, 2, 3))
        (row,) = again.look(50 * S, 5).rows["I"]
        assert row.suspect.parameter == "/a/arm/speed"
    finally:
        feed.close()


# The number takes 4 columns, the names 6. Score, Now ("8 > 10") and Flop take 6 + 2, Trend 8 + 2.
# So all need 4 + 6 + 8 + 8 + 10 + 8 = 44, and of 45 the names get 7; without Flop 36, without Trend
# 26, without Now 18. At 12 the names get all that is left, which is 8.
@pytest.mark.parametrize(
    ("width", "headings"),
    [
        (45, ["#", "Parame~", "Score", "Now", "Trend", "Flop"]),
        (43, ["#", "Parameter", "Score", "Now", "Trend"]),
        (30, ["#", "Parameter", "Score", "Now"]),
        (21, ["#", "Parameter", "Score"]),
        (12, ["#", "Paramet~"]),
    ],
)
def test_columns_go_one_by_one_as_room_goes(width: int, headings: list[str]):
    look = watching(*EVENTS).look(110 * S, 5)
    lines = texts(table(look, "II", width, 5, utf8=True))
    assert lines[1].split() == headings
    assert lines[2].split()[1] == "~speed"


@pytest.mark.parametrize(("width", "first"), [(45, "Trend of the"), (30, "Bold: the")])
def test_only_columns_that_are_shown_are_explained(width: int, first: str):
    lines = texts(shown(width, 40, WatchOptions(layout=("II",))))
    legend = [line for line in lines if line.startswith(("Trend of", "Bold:"))]
    assert [line[: len(first)] for line in legend] == [first]


# 0.3 is 0.30000001192092896 as a 32-bit float: eight digits are the first that show it.
@pytest.mark.parametrize(
    ("cmp", "thresh", "text"),
    [
        (0.30000001192092896, 0.3, "0.30000001 > 0.3"),
        (0.3, 0.3, "0.3 > 0.3"),
        (0.123456, 0.5, "0.123 > 0.5"),
        (math.nan, math.nan, "nan > nan"),
    ],
)
def test_the_last_comparison_has_no_more_digits_than_tell_its_numbers_apart(cmp, thresh, text):
    look = watching(*EVENTS, seen(110, 0, cmp, thresh)).look(110 * S, 5)
    (row,) = [row for row in look.rows["I"] if row.suspect.parameter == "~speed"]
    assert text in table(look, "I", 100, 5, utf8=True)[2].plain, row


# Both changed at 102 s: (103 - 102) * (1 + 1) = 2 for either.
def test_ties_are_named_as_ties():
    events = [seen(at, number, cmp, 1) for at, cmp in ((101, 0), (102, 2)) for number in (0, 1)]
    kept = KeptRankings(5)
    kept.follow(MarkChange(None, Mark(103 * S, "I")), watching(*events))
    assert sorted(kept[0].words().split(", ")) == ["1= ~limit", "1= ~speed"]
