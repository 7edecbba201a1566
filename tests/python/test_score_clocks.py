"""Times of two clocks in one recording, each told in one sentence."""

from __future__ import annotations

from mission_samples import events, ns

from pytpc.recording.faults import two_clocks
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording

# 2026-09-21, in seconds since 1970.
WALL = 1_790_000_000


def told(rows, *marks):
    return list(two_clocks(Recording("m", events(rows), marks, 0, ns(10))))


def rows_of(node, begin, count):
    return [(begin + second, 0, 1, 1, 0, node) for second in range(count)]


# Most reports tell the usual clock, whichever is earlier.
def test_the_few_are_on_another_clock():
    assert told([*rows_of("/sim", 3, 5), *rows_of("/wall", WALL, 2)]) == [
        "2 of 7 reports, of /wall, are on another clock than the others"
        " (2026-09-21 and 3.0 s; /use_sim_time?)"
    ]
    assert told([*rows_of("/sim", 3, 2), *rows_of("/wall", WALL, 5)]) == [
        "2 of 7 reports, of /sim, are on another clock than the others"
        " (3.0 s and 2026-09-21; /use_sim_time?)"
    ]


# Before the first /clock a node that will be on simulated time may be on the wall's.
def test_one_node_on_two_clocks():
    (said,) = told([*rows_of("/a", WALL, 1), *rows_of("/a", 3, 5)])
    assert said.startswith("1 of 6 reports, of /a, ")


def test_many_nodes_are_not_all_named():
    rows = [*rows_of("/sim", 3, 9), *(row for n in range(5) for row in rows_of(f"/n{n}", WALL, 1))]
    (said,) = told(rows)
    assert said.startswith("5 of 14 reports, of /n0, /n1, /n2 and others, ")


# Within a day nothing is said: 86,400 s before the first report of 3 s, or after the last of 7 s.
def test_marks_on_another_clock():
    rows = rows_of("/a", 3, 5)
    assert told(rows, Mark(ns(3 - 86400), "I"), Mark(ns(7 + 86400), "I")) == []
    assert told(rows, Mark(ns(5), "I"), Mark(ns(WALL), "II")) == [
        "1 of 2 marks are on another clock than the reports (2026-09-21 and 3.0 s; /use_sim_time?)"
    ]


def test_nothing_to_tell():
    assert told([], Mark(5, "I")) == []
    assert told(rows_of("/a", 3, 5)) == []
