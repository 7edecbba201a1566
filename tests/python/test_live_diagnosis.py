"""The suspects of a running mission beside good runs: what differs first, and one verdict."""

from __future__ import annotations

import threading
import time
from dataclasses import replace

import pytest
from mission_samples import comparison, equal_tables, key, ns, static_info
from test_same_code import FASTEST, FOUR, STATIC, flight, marks_at

from pytpc.api import live_diagnosis
from pytpc.api.comparing import RecordedRun
from pytpc.api.live_diagnosis import LiveDiagnosis, asked_of_graph
from pytpc.api.live_mission import RecordedFeed, WatchedMission, fresh_watching
from pytpc.base.errors import RunError
from pytpc.diagnosis.question import PLAIN
from pytpc.diagnosis.results.live import Seen
from pytpc.diagnosis.results.suspects import Evaluation, MarkRanking, Suspect
from pytpc.present.marking_terminal import RecordedMission
from pytpc.present.watch_screen import WatchOptions
from pytpc.recording.growing import GrowingRecording
from pytpc.recording.marking_session import MarkChange
from pytpc.recording.marks import Mark
from pytpc.recording.mission import ReadName
from pytpc.recording.summaries import Summary

GOOD = flight(5.0)
BAD = flight(12.0)
SERVER = {"/node/fastest": 12.0, "/node/nearest": 5.0}


def items_of(recording):
    """The evaluations as a graph brings them."""
    table = recording.events
    columns = (table.time_ns, table.result, table.cmp, table.thresh, table.res)
    return [
        Seen(time, table.keys[code], table.nodes[node], result, cmp, thresh, res)
        for code, node, time, result, cmp, thresh, res in zip(
            table.key.tolist(), table.node.tolist(), *(c.tolist() for c in columns), strict=True
        )
    ]


def waited_for(condition, patience_s=60.0):
    until = time.monotonic() + patience_s
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.02)


SUMMARY = Summary(key(3), "/two", ns(4), ns(5), 9, 1, 9, 0, True, True, *[1.0] * 8)


def test_a_growing_recording_is_that_of_its_reports():
    log = GrowingRecording()
    marks = marks_at((9, 4), "I")
    empty = log.recording(marks)
    assert (len(empty.events), len(empty.summaries), empty.seconds) == (0, 0, 0.0)
    name = ReadName(key(1), "/node", "/node/limit")
    for item in (*reversed(items_of(BAD)), SUMMARY, name, name):
        log.add(item)
    found = log.recording(marks)
    assert equal_tables(found.events.with_keys(BAD.events.keys), BAD.events)
    assert [one.time_ns for one in found.marks] == [ns(4), ns(9)]
    assert (found.start_ns, found.end_ns) == (0, int(BAD.events.time_ns[-1]))
    assert found.summaries.flops.tolist() == [1]
    assert found.names == (name,)
    log.clear()
    assert len(log.recording(()).events) == 0


# The fourth report is one too many.
def test_a_growing_recording_has_an_end():
    log = GrowingRecording(most=3)
    for item in items_of(BAD)[:3]:
        log.add(item)
    assert not log.is_full
    log.add(items_of(BAD)[3])
    assert log.is_full
    assert len(log.recording(()).events) == 3


def suspect(position, name, *, tied=False):
    found = comparison(position, name)
    last = Evaluation(0, True, 1.0, 2.0, True, "/node")
    return Suspect(position, name, found.key, found, "I", 1.0, 1.0, (found.key,), last, tied)


# ~a and ~b share position 1, and ~c and ~d position 3. Of ~b and ~d, which come first, none is tied
# any more; nor is ~a or ~c.
def test_what_differs_comes_first_and_positions_are_counted_anew():
    names = [(1, "~a"), (1, "~b"), (3, "~c"), (3, "~d"), (5, "~e")]
    ranking = MarkRanking(Mark(0, "I"), tuple(suspect(*one, tied=True) for one in names), 5)
    found = ranking.with_first({"/node/d", "/node/b", "/node/unknown"}).suspects
    assert [(one.parameter, one.position, one.tied) for one in found] == [
        ("~b", 1, False), ("~d", 2, False), ("~a", 3, False), ("~c", 4, False), ("~e", 5, False),
    ]  # fmt: skip
    both = ranking.with_first({"~c", "~d"}).suspects
    assert [(one.parameter, one.position, one.tied) for one in both] == [
        ("~c", 1, True), ("~d", 1, True), ("~a", 3, True), ("~b", 3, True), ("~e", 5, False),
    ]  # fmt: skip


@pytest.fixture
def graph(monkeypatch):
    """Asks about a graph whose master answers with what is in the list; once it has no answer."""
    answers = [SERVER]

    def values(master):
        assert master == "http://robot:11311"
        # The test may empty the list meanwhile.
        for given in answers:
            return {**given, "/rosdistro": "noetic"}
        raise RunError("the master does not answer")

    monkeypatch.setattr(live_diagnosis, "values_at", values)
    monkeypatch.setattr(live_diagnosis, "_AGAIN_S", 0.05)
    given = {"/node/fastest": 5.0, "/node/nearest": 5.0}
    good = RecordedRun(replace(GOOD, name="monday"), server=given)
    return answers, asked_of_graph("http://robot:11311", STATIC, None, PLAIN, [good])


def test_the_verdict_of_a_running_robot_is_that_of_its_recording(graph):
    answers, ask = graph
    judged = LiveDiagnosis(ask)
    judged.take(items_of(BAD))
    waited_for(lambda: judged.differing == {"/node/fastest"})
    said = "differs from the good run monday: ~fastest 5 -> 12"
    assert judged.lines == [said]
    marks = marks_at(FOUR, "II")
    for mark in marks:
        judged.mark(MarkChange(None, mark).apply)
    recorded = ask(replace(BAD, marks=marks)).diagnosis
    wanted = f"{recorded.blame.title}: {recorded.headline}"
    assert wanted.startswith("All 4 marks together: 4 of type II: ")
    waited_for(lambda: judged.lines == [said, wanted])
    # The master is gone, and a mark is taken back: the last answer stands.
    answers.clear()
    judged.mark(MarkChange(marks[0], None).apply)
    assert judged.lines == [said, wanted]
    answers.append(SERVER)
    waited_for(lambda: judged.lines[1].startswith("All 3 marks together"))
    judged.restart()
    waited_for(lambda: len(judged.lines) == 1)
    judged.close()
    waited_for(lambda: not any(one.name == "diagnosis" for one in threading.enumerate()))


# At 90 s the others have changed their results, and the speed never has: by its score it has no
# place for type I, and is not the first for type II.
def test_the_table_has_what_differs_first(graph):
    _, ask = graph
    feed = RecordedFeed(BAD, fresh_watching(STATIC, PLAIN))
    judged = LiveDiagnosis(ask, BAD)
    mission = RecordedMission("tuesday", ns(90), ns(100))
    watched = WatchedMission(mission, feed, WatchOptions(layout=("II",)), judged=judged)
    before = fresh_watching(STATIC, PLAIN)
    for item in items_of(BAD):
        before.take(item)
    rows = before.look(ns(90), 9, ("II",)).rows["II"]
    assert rows[0].suspect.parameter != "~fastest"
    assert key(FASTEST) in {row.suspect.key for row in rows}
    waited_for(lambda: judged.found is not None)
    watched.take()
    rows = watched.panel(ns(90), utf8=True).look.rows["II"]
    assert (rows[0].suspect.parameter, rows[0].suspect.position) == ("~fastest", 1)
    assert [row.suspect.position for row in rows] == sorted(row.suspect.position for row in rows)
    said = watched.send(MarkChange(None, Mark(ns(90), "II")))
    assert said.startswith("1 ~fastest")
    assert "differs from the good run monday: ~fastest 5 -> 12" in watched.view().status
    waited_for(lambda: any(line.startswith("The one mark") for line in judged.lines))
    watched.close()


def test_without_a_difference_the_order_stays():
    static = static_info(comparison(0, "~a"), comparison(1, "~b"))
    watching = fresh_watching(static, PLAIN)
    for t in range(4):
        watching.take(Seen(ns(t), key(0), "/n", t > 1, t, 1.5, t > 1))
        watching.take(Seen(ns(t), key(1), "/n", t > 2, t, 2.5, t > 2))
    assert [row.suspect.parameter for row in watching.look(ns(4), 5, ("I",)).rows["I"]] == [
        "~b", "~a",
    ]  # fmt: skip
    watching.differing = frozenset({"/n/a"})
    assert [row.suspect.parameter for row in watching.look(ns(4), 5, ("I",)).rows["I"]] == [
        "~a", "~b",
    ]  # fmt: skip


def test_a_fault_of_ours_is_told_and_the_next_judgement_is_tried():
    faults = [ZeroDivisionError("of\nours")]

    def ask(_recording):
        if faults:
            raise faults[0]
        raise RunError("the graph is gone")

    judged = LiveDiagnosis(ask)
    try:
        waited_for(lambda: judged.lines)
        told = "no verdict now (ZeroDivisionError: of ours); ask `rank` after the mission"
        assert judged.lines == [told]
        judged.mark(lambda _: marks_at((9, 4), "I"))
        assert judged._thread.is_alive()
    finally:
        judged.close()
    judged._thread.join(10)
    assert not judged._thread.is_alive()
