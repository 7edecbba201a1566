"""The short lines of a batch (policy light): what they leave out follows from what they have."""

from __future__ import annotations

import math

import pytest
from mission_samples import BagFile, key

from pytpc.ingest.reading import read
from pytpc.ingest.rosout_line import Malformed
from pytpc.ingest.short_summary import ShortSummary, Span, parse_short, parse_span

SPAN = Span(10_000_000_000, 11_000_000_000)
KEY = key(1)


def short(rest: str) -> ShortSummary:
    found = parse_short(f"~{KEY},{rest}", SPAN, "/n")
    assert isinstance(found, ShortSummary)
    return found


def test_span():
    assert parse_span("@10.0000000;11.5") == Span(10_000_000_000, 11_500_000_000)
    # The clock was set back.
    assert parse_span("@11.5;10.0") == Span(10_000_000_000, 10_000_000_000)
    assert isinstance(parse_span("@10.5"), Malformed)
    assert isinstance(parse_span("@9999999999.0;9999999999.0"), Malformed)


# 3 and 2.5 in all 50 evaluations, both outcomes true: the difference is 0.5 in all of them.
def test_equal_evaluations():
    found = short("3,3,2.5,50")
    summary = found.summary
    assert (found.seen, found.about) == (50, False)
    assert (summary.key, summary.node, summary.begin_ns, summary.end_ns) == (KEY, "/n", *SPAN)
    assert (summary.result, summary.res) == (True, True)
    assert (summary.count, summary.flops, summary.far, summary.odd) == (50, 0, 50, 0)
    assert (summary.cmp, summary.thresh, summary.low, summary.high) == (3, 2.5, 2.5, 3)
    assert (summary.diff_min, summary.diff_max, summary.diff_mean, summary.abs_mean) == (0.5,) * 4


def test_equal_values_are_not_far():
    assert short("1,2.5,2.5,50").summary.far == 0


# Values from 1 to 4 against 2, mean difference 0.5 of either sign: the mean size must be told.
def test_values_against_one_threshold():
    found = short("2,4,2,1000,f:7,c:1;4,m:0.5;0.75,w:990,s:128,e")
    summary = found.summary
    assert (found.seen, found.about) == (128, True)
    assert (summary.result, summary.res) == (False, True)
    assert (summary.count, summary.flops, summary.far) == (1000, 7, 990)
    assert (summary.diff_min, summary.diff_max) == (-1, 2)
    assert (summary.low, summary.high) == (1, 4)
    assert (summary.diff_mean, summary.abs_mean) == (0.5, 0.75)


# All below: the mean size is the mean with the other sign.
def test_mean_size_follows_if_all_are_on_one_side():
    summary = short("0,1,4,10,c:1;3,m:-2").summary
    assert (summary.abs_mean, summary.far, summary.low, summary.high) == (2, 10, 1, 4)


def test_threshold_that_moved():
    summary = short("1,5,4,10,d:-1;2;0.5;6,m:0.5;1").summary
    assert (summary.diff_min, summary.diff_max, summary.low, summary.high) == (-1, 2, 0.5, 6)


def test_nothing_is_finite():
    summary = short("1,nan,4,10,o:10").summary
    assert (summary.odd, summary.far) == (10, 0)
    assert math.isnan(summary.abs_mean)


@pytest.mark.parametrize(
    "rest",
    ["4,1,2,3", "1,1,2,0", "1,1,2,3,f:4", "1,1,2,3,s:4", "1,1,2,3,o:4", "1,1,2", "1,1,2,3,x"],
)
def test_contradictions(rest):
    assert isinstance(parse_short(f"~{KEY},{rest}", SPAN, "/n"), Malformed)


def test_a_summary_without_a_span():
    assert isinstance(parse_short(f"~{KEY},3,3,2.5,50", None, "/n"), Malformed)


BATCH = (
    "threshold_batch:#seq:0,count:2,dropped:5,pid:7,steady:1.000000000\n"
    f"10.1000000,{KEY},0,cmp:1,thresh:2,res:0\n"
    f"10.2000000,{KEY},1,cmp:3,thresh:2,res:1\n"
    "@10.0000000;11.0000000\n"
    f"~{KEY},3,3,2,1000,f:1,c:1;3,m:0.5;1,s:128\n"
    f"~{key(2)},3,1,0,10,e\n"
    f"11.0000000,threshold_dropped:{KEY},count:5,flops:5,why:site"
)


def test_batches_in_the_log_of_a_bag(tmp_path):
    with BagFile(tmp_path / "mission.bag") as bag:
        bag.log(11.2, "/n", BATCH)
        bag.log(11.3, "/n", BATCH.replace("#seq:0", "#seq:4").replace("@10.0", "@10.5"))
    recording = read([tmp_path / "mission.bag"])
    assert recording.malformed == 0
    assert len(recording.events) == 4
    assert recording.events.nodes == ("/n",)
    assert sorted(recording.summaries.count.tolist()) == [10, 10, 1000, 1000]
    assert sum(dropped.count for dropped in recording.dropped) == 10
    # The second batch begins with report 4, the first ended with 1.
    assert recording.lost == {"/n": 2}
    assert any("1,744 evaluations of 1 comparison in hot loops" in n for n in recording.notes)
    assert any("flops of 1 comparison are" in note for note in recording.notes)


def test_batches_in_the_file_of_the_rosout_node(tmp_path):
    log = tmp_path / "rosout.log"
    log.write_text(f"1.5 INFO /n [:0()] [topics: ] {BATCH}\n1.7 INFO /n [:0()] [topics: ] Bye\n")
    recording = read([log])
    assert recording.malformed == 0
    assert len(recording.events) == 2
    assert recording.summaries.count.tolist() == [1000, 10]
    assert recording.events.nodes == ("/n",)
