"""The policy `edges`: each flop once, all evaluations in the summaries."""

from __future__ import annotations

import math
from collections import defaultdict
from itertools import pairwise

import log_file
import pytest
from test_file import key

TURNS = 3000


def value(turn: int) -> float:
    """What drive.cpp's ``edges`` compares with 100 in this turn."""
    return turn % 1000 / 8


# In each 1000 turns the value is above 100 from turn 801 to 999: over 3000 turns it changes at
# 801, 1000, 1801, 2000 and 2801, five flops, and the first evaluation is reported as well.
@pytest.mark.parametrize("sites", [1, 150])
def test_one_thread(drive, files, sites):
    settings = {"policy": "edges", "period": 0.01}
    assert drive("edges", 1, sites, TURNS * sites, 30, **settings).returncode == 0
    file = log_file.read(files()[0])
    assert file.policies == [(1, 10_000_000)]
    values = [value(turn) for turn in range(TURNS)]
    reports = defaultdict(list)
    for _steady, site, result, res, cmp, thresh, is_edge in file.all_reports:
        assert is_edge
        assert result == res == (cmp > thresh)
        reports[file.keys[site]].append((result, cmp))
    expected = [(turn % 1000 == 801, value(turn)) for turn in (0, 801, 1000, 1801, 2000, 2801)]
    assert reports == {key(n): expected for n in range(sites)}
    summaries = defaultdict(list)
    for summary in file.all_summaries:
        summaries[file.keys[summary["site"]]].append(summary)
    assert len(summaries) == sites
    for mine in summaries.values():
        assert sum(s["count"] for s in mine) == TURNS
        assert sum(s["flops"] for s in mine) == 5
        assert sum(s["far"] for s in mine) == sum(1 for v in values if v != 100)
        assert math.fsum(s["diff_sum"] for s in mine) == math.fsum(v - 100 for v in values)
        assert math.fsum(s["abs_sum"] for s in mine) == math.fsum(abs(v - 100) for v in values)
        assert min(s["low"] for s in mine) == 0
        assert max(s["high"] for s in mine) == max(values)
        assert min(s["diff_min"] for s in mine) == -100
        assert max(s["diff_max"] for s in mine) == max(values) - 100
        mine.sort(key=lambda s: s["period"])
        assert (mine[-1]["cmp"], mine[-1]["thresh"]) == (values[-1], 100)
        for before, after in pairwise(mine):
            assert before["begin"] < after["begin"]


def test_a_flop_lies_in_the_span_of_its_summary(drive, files):
    assert drive("edges", 1, 1, 5000, 0, policy="edges", period=0.005).returncode == 0
    file = log_file.read(files()[0])
    for steady, *_ in sorted(file.all_reports)[1:]:
        spans = [(s["begin"], s["end"]) for s in file.summaries if s["flops"]]
        assert any(begin <= steady <= end for begin, end in spans)


# Threads change the result of one site in turn: whoever does reports it, and in the order of time
# each report says something else than the one before.
@pytest.mark.parametrize("threads", [2, 16])
def test_threads_share_a_site(drive, files, threads):
    settings = {"policy": "edges", "period": 0.005}
    assert drive("edges", threads, 3, TURNS * 3, 20, **settings).returncode == 0
    file = log_file.read(files()[0])
    counts, flops = defaultdict(int), defaultdict(int)
    for summary in file.all_summaries:
        counts[summary["site"]] += summary["count"]
        flops[summary["site"]] += summary["flops"]
    assert list(counts.values()) == [TURNS * threads] * 3
    for site in counts:
        results = [r[2] for r in sorted(file.all_reports) if r[1] == site]
        assert all(a != b for a, b in pairwise(results))
        assert len(results) - 1 == flops[site]


# 1, nan, inf, -inf, 2, 1e308 against -1e308, 3; the others against 1. What is not finite (the
# difference of 1e308 and -1e308 neither) is counted as odd.
def test_odd_values(drive, files):
    assert drive("odd", policy="edges").returncode == 0
    file = log_file.read(files()[0])
    (summary,) = file.all_summaries
    assert (summary["count"], summary["odd"], summary["far"]) == (7, 4, 2)
    assert (summary["diff_min"], summary["diff_max"], summary["diff_sum"]) == (0, 2, 3)
    assert (summary["low"], summary["high"], summary["cmp"]) == (1, 3, 3)
    # False, False, True, False, True, True, True
    assert [r[2] for r in file.all_reports] == [False, True, False, True]
    assert summary["flops"] == 3


def test_caps_hold_for_flops_and_summaries_stay_whole(drive, files):
    settings = {"policy": "edges", "period": 0.01, "site_cap": 2}
    assert drive("edges", 1, 1, 10_000, 0, **settings).returncode == 0
    file = log_file.read(files()[0])
    dropped = sum(count for _why, _site, count, _flops in file.dropped)
    # 10,000 turns: the first evaluation and 19 flops.
    assert len(file.all_reports) + dropped == 20
    assert dropped > 0
    assert sum(s["flops"] for s in file.all_summaries) == 19
    assert sum(s["count"] for s in file.all_summaries) == 10_000


def test_a_thousand_threads_begin_at_once(drive, files):
    assert drive("together", 1000, 8, policy="edges", period=0.005).returncode == 0
    file = log_file.read(files()[0])
    counts = defaultdict(int)
    for summary in file.all_summaries:
        counts[file.keys[summary["site"]]] += summary["count"]
    assert counts == {key(n): 1000 for n in range(8)}
