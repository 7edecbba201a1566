"""The policy ``light`` of Python nodes: all evaluations are counted, a sample is inspected."""

from __future__ import annotations

import pytest

from pytpc.ingest.short_summary import ShortSummary, Span, parse_short
from pytpc.python_runtime.config import Config
from pytpc.python_runtime.light import Light, LightSummary, short_line
from pytpc.python_runtime.policies import Caps
from pytpc.python_runtime.sinks import PeriodSummary, Sink
from pytpc.python_runtime.sites import Reported

KEY = "00000001-0000-5000-8000-000000000000"
SPAN = Span(0, 10**9)


class Kept(Sink):
    """A sink that keeps all it gets."""

    def __init__(self) -> None:
        super().__init__()
        self.reports: list[tuple[bool, float]] = []
        self.lines: list[str] = []
        self.over = 0

    def take(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        self.reports.append((result, cmp))

    def summary(self, summary: PeriodSummary) -> None:
        assert isinstance(summary, LightSummary)
        self.lines.append(short_line(summary))

    def dropped(self, one: Reported, count: int, flops: int, why: str) -> None:
        self.over += flops

    def read(self) -> list[ShortSummary]:
        found = [parse_short(f"~{line}", SPAN, "/n") for line in self.lines]
        assert all(isinstance(one, ShortSummary) for one in found)
        return [one for one in found if isinstance(one, ShortSummary)]


@pytest.fixture
def sink() -> Kept:
    return Kept()


def policy(sink: Kept, **settings: int) -> Light:
    config = Config(**settings).filled_in()
    return Light(config, sink, Caps(config, sink))


def test_the_default_is_light_and_a_named_sink_gets_every_evaluation():
    assert Config().filled_in()[:5] == ("auto", "light", 10**9, 10, 50)
    assert Config(sink="rosout").filled_in()[:5] == ("rosout", "every", 10**8, 0, 0)
    assert Config(site_cap=0).filled_in().site_cap == 0


# 100,000 evaluations below, one above, 100,000 below: the flops lie in the middle of strides.
def test_every_flop_is_seen_in_a_hot_loop(sink):
    taken, one = policy(sink), Reported(KEY, 1, False)
    for number in range(200_001):
        taken.take(one, number == 100_000, 3.0 if number == 100_000 else 1.0, 2.0, False)
    taken.flush(all_of_them=True)
    assert sink.reports == [(False, 1.0), (True, 3.0), (False, 1.0)]
    (found,) = sink.read()
    assert (found.summary.count, found.summary.flops) == (200_001, 2)
    assert (found.summary.diff_min, found.summary.diff_max) == (-1.0, 1.0)
    assert 128 < found.seen < 1000
    assert not found.about


# The second period is sampled from its beginning, with the stride of the first one's rate.
def test_a_period_begins_with_what_is_known_of_the_last(sink):
    taken, one = policy(sink), Reported(KEY, 1, False)
    for _ in range(2):
        for number in range(100_000):
            taken.take(one, False, float(number % 10), 20.0, False)
        taken.flush(all_of_them=True)
    first, second = sink.read()
    assert (first.summary.count, second.summary.count) == (100_000, 100_000)
    assert second.seen < first.seen
    assert second.summary.abs_mean == pytest.approx(15.5, rel=0.1)


# The process ends a few evaluations after a period began, all of them between two samples.
def test_what_has_no_sample_when_the_process_ends_is_counted(sink):
    taken, one = policy(sink), Reported(KEY, 1, False)
    for number in range(100_003):
        taken.take(one, False, 1.0, 20.0, False)
        if number == 99_999:
            taken.flush(all_of_them=True)
    taken.flush(all_of_them=True)
    first, last = sink.read()
    assert (first.summary.count, last.summary.count) == (100_000, 3)
    assert (last.seen, last.summary.flops, last.summary.odd) == (0, 0, 3)
    assert (last.summary.cmp, last.summary.thresh, last.summary.result) == (1.0, 20.0, False)


def test_flops_beyond_the_cap_are_counted(sink):
    taken, one = policy(sink, site_cap=3), Reported(KEY, 1, False)
    for number in range(100):
        taken.take(one, number % 2 == 1, float(number % 2), 0.5, False)
    taken.flush(all_of_them=True)
    # The first one, and three flops; if the second changed meanwhile, up to three more, and the
    # last outcome at the end of the period.
    assert 4 <= len(sink.reports) <= 8
    results = [result for result, _ in sink.reports]
    assert results == [number % 2 == 1 for number in range(len(results))]
    (found,) = sink.read()
    assert (found.summary.count, found.summary.flops) == (100, 99)
    assert sink.over + len(sink.reports) - 1 in (99, 100)
