"""Summaries that a node told twice: in the file of its ring, and, rounded, over the graph."""

from __future__ import annotations

import numpy as np

from pytpc.ingest.duplicates import summaries_twice
from pytpc.ingest.gathering import SUMMARY_ROW, Channel

T = 1_700_000_000_123_456_789
MS = 10**6


def twice(channels: list[Channel], *rows: tuple[int, int, int, int]) -> list[bool]:
    """Rows are (channel, begin, end, count); times in ns after T."""
    table = np.zeros(len(rows), SUMMARY_ROW)
    for place, (channel, begin, end, count) in enumerate(rows):
        table[place]["channel"] = channel
        table[place]["begin_ns"], table[place]["end_ns"] = T + begin, T + end
        table[place]["count"] = count
    return summaries_twice(table, channels, MS).tolist()


BAG = Channel(0, "mission.bag", "log", "/rosout")
FILE = Channel(1, "one.tpc", "file", "", process="a")
OTHER = Channel(2, "two.tpc", "file", "", process="b")
ALL = [BAG, FILE, OTHER]


def test_what_a_file_has_is_kept():
    """The batch has its times in steps of 100 ns: 89 ns less. Whichever comes first."""
    assert twice(ALL, (0, -89, 911, 5), (1, 0, 1000, 5)) == [True, False]
    assert twice(ALL, (1, 0, 1000, 5), (0, 11, 911, 5)) == [False, True]


def test_what_differs_stays():
    """Another count, another beginning or another end, by more than the tolerance of 1 ms."""
    assert twice(ALL, (0, 0, 10, 5), (1, 0, 10, 6)) == [False, False]
    assert twice(ALL, (0, 0, 9 * MS, 5), (1, 2 * MS, 9 * MS, 5)) == [False, False]
    assert twice(ALL, (0, 0, 5 * MS, 5), (1, 0, 7 * MS, 5)) == [False, False]


def test_threads_of_one_process():
    """Two threads evaluated it as often: two in each channel, and two are left."""
    rows = [(1, 0, 10, 5), (1, 0, 10, 5), (0, -9, 10, 5), (0, -9, 10, 5)]
    assert twice(ALL, *rows) == [False, False, True, True]
    assert twice(ALL, *rows[:2]) == [False, False]


def test_two_processes():
    """Both files are kept; the bag has one of them."""
    assert twice(ALL, (1, 0, 10, 5), (2, 0, 10, 5)) == [False, False]
    assert twice(ALL, (0, 0, 10, 5), (1, 0, 10, 5), (2, 0, 10, 5)) == [True, False, False]
