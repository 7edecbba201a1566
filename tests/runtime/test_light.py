"""The policy `light`: flops up to the caps, counts of everything, summaries of a sample."""

from __future__ import annotations

from collections import Counter, defaultdict
from itertools import pairwise

import log_file
import pytest
from test_edges import TURNS, value
from test_file import key

LIGHT = {"policy": "light", "period": 0.02, "site_cap": 0, "process_cap": 0}


def totals(file: log_file.LogFile) -> dict[str, Counter[str]]:
    found: dict[str, Counter[str]] = defaultdict(Counter)
    for summary in file.all_summaries:
        for name in ("count", "flops", "seen"):
            found[file.keys[summary["site"]]][name] += summary[name]
    return found


# As in test_edges: five flops and a first evaluation in 3000 turns; all are seen although most
# evaluations are only counted.
@pytest.mark.parametrize("sites", [1, 150])
def test_every_flop_is_seen_and_every_evaluation_counted(drive, files, sites):
    assert drive("edges", 1, sites, TURNS * sites, 30, **LIGHT).returncode == 0
    file = log_file.read(files()[0])
    assert file.policies == [(2, 20_000_000)]
    reports = defaultdict(list)
    for _steady, site, result, _res, cmp, _thresh, is_edge in file.all_reports:
        assert is_edge
        reports[file.keys[site]].append((result, cmp))
    expected = [(turn % 1000 == 801, value(turn)) for turn in (0, 801, 1000, 1801, 2000, 2801)]
    assert reports == {key(n): expected for n in range(sites)}
    assert {name: (sums["count"], sums["flops"]) for name, sums in totals(file).items()} == {
        key(n): (TURNS, 5) for n in range(sites)
    }


# A million evaluations of one site: less than one in a hundred is inspected, and none is missing.
def test_a_hot_site_is_sampled(drive, files):
    assert drive("hot", 1_000_000, 0, 50, **LIGHT).returncode == 0
    file = log_file.read(files()[0])
    (sums,) = totals(file).values()
    assert sums["count"] == 1_000_000
    assert sums["flops"] == 0
    assert 128 <= sums["seen"] < 10_000
    assert all(s["about"] == 0 for s in file.all_summaries)
    # A thread that had to wait for the processor may have inspected none between two summaries.
    inspected = [summary for summary in file.all_summaries if summary["seen"]]
    assert inspected
    for summary in inspected:
        assert (summary["diff_min"], summary["diff_max"]) == (-1, -1)
        assert summary["diff_sum"] == pytest.approx(-summary["count"])
        assert summary["far"] == summary["count"]


# Each evaluation is a flop: ten of them are reported in a second, the others are estimated from
# pairs of evaluations, and said to be.
def test_a_site_that_always_changes_is_capped(drive, files):
    settings = {**LIGHT, "site_cap": 10}
    ran = drive("hot", 1_000_000, 1, 50, **settings)
    assert ran.returncode == 0
    (line,) = ran.stderr.splitlines()
    assert "changes more often than 10 times a second (TPC_SITE_CAP)" in line
    file = log_file.read(files()[0])
    (sums,) = totals(file).values()
    assert sums["count"] == 1_000_000
    assert 900_000 < sums["flops"] <= 1_000_000
    assert sums["seen"] < 20_000
    assert any(s["about"] for s in file.all_summaries)
    results = [r[2] for r in sorted(file.all_reports)]
    assert all(a != b for a, b in pairwise(results))
    dropped = sum(flops for *_, flops in file.dropped)
    assert dropped + len(results) - 1 == pytest.approx(sums["flops"], rel=0.01)


# Threads overwrite each other's counts, so these are said to be estimates.
def test_threads_share_a_site(drive, files):
    assert drive("edges", 8, 3, TURNS * 3, 20, **LIGHT).returncode == 0
    file = log_file.read(files()[0])
    for sums in totals(file).values():
        assert sums["count"] == pytest.approx(TURNS * 8, rel=0.5)
    assert any(s["about"] for s in file.all_summaries)
    for site in file.keys:
        results = [r[2] for r in sorted(file.all_reports) if r[1] == site]
        assert all(a != b for a, b in pairwise(results))


# All sites turn 20 times in two seconds, the same ones first. What the node may send in ten seconds
# is there at once: 500 flops; 50 more come in each second. The first evaluation of a site is no
# flop, and the outcome of the last turn is reported at the end in any case: they do not count here.
@pytest.mark.parametrize("sites", [200, 800])
def test_each_site_reports_a_flop_before_one_reports_many(drive, files, sites):
    settings = {**LIGHT, "period": 3600, "process_cap": 50}
    assert drive("turning", sites, 21, 100, **settings).returncode == 0
    file = log_file.read(files()[0])
    flops = Counter(dict.fromkeys(map(key, range(sites)), 0))
    flops.update(file.keys[site] for _, site, _, _, cmp, *_ in file.all_reports if 0 < cmp < 20)
    steady = [report[0] for report in file.all_reports]
    assert sum(flops.values()) <= 501 + 50 * (max(steady) - min(steady)) / 1e9
    if sites == 200:
        assert min(flops.values()) >= 1
        assert sum(flops.values()) > 250
    else:
        assert sum(count > 0 for count in flops.values()) >= 500
        assert min(flops.values()) == 1 or max(flops.values()) == 1


def test_odd_values(drive, files):
    assert drive("odd", **LIGHT).returncode == 0
    (summary,) = log_file.read(files()[0]).all_summaries
    assert (summary["count"], summary["odd"], summary["far"], summary["flops"]) == (7, 4, 2, 3)
    assert (summary["diff_min"], summary["diff_max"], summary["diff_sum"]) == (0, 2, 3)


def test_forked_processes_count_for_themselves(drive, files):
    assert drive("forked", 3000, **LIGHT).returncode == 0
    assert len(files()) == 3
    for path in files():
        file = log_file.read(path)
        assert file.state == 1
        counts = sum(sums["count"] for sums in totals(file).values())
        # The parent's other thread reports as well.
        assert counts == 3000 or counts > 5000


# Nobody asked for reports, and there is no ROS: nothing is printed and no file is written.
def test_without_a_sink_and_without_ros_nothing_is_said(drive, settings, files, tmp_path):
    del settings["TPC_SINK"]
    ran = drive("threads", 2, 3, 100_000)
    assert (ran.returncode, ran.stdout, ran.stderr) == (0, "", "")
    assert not list(tmp_path.rglob("*.tpc"))
