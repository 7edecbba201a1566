"""What other nodes did after a comparison turned, as evidence in the diagnosis."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from mission_samples import comparison, events, key, link_unit, ns

from pytpc.diagnosis.ranking.blame import blame
from pytpc.diagnosis.ranking.other_nodes import OtherNodes, Reached, effects
from pytpc.diagnosis.ranking.result_streams import ResultStreams
from pytpc.diagnosis.results.suspects import Followed
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.static.link_unit import Received
from pytpc.static.static_info import StaticInfo
from pytpc.static.wiring import Wiring

DONE = Received("/done", None, "value", "src/node.cpp", 20)


# limit (1) decides /done in /camera, retry (2) in /driver hears it; twin (3) in /camera is as
# limit, but decides a topic that nobody hears.
def static() -> StaticInfo:
    camera = [comparison(1, "~limit", topic="/done"), comparison(3, "~twin", topic="/nobody")]
    driver = [comparison(2, "~retry", topic="/cmd", received=(DONE,))]
    units = {"camera": camera, "driver": driver}
    return StaticInfo.of(replace(link_unit(found), link_unit=name) for name, found in units.items())


def mission(*, linked: bool = True) -> Recording:
    """limit and twin turn at 20 s, retry at 20.4 s; it is evaluated twice a second."""
    rows: list[tuple[object, ...]] = []
    for n in range(80):
        seconds = n / 2
        rows.append((seconds, 1, n >= 40, n >= 40, 0.5, "/camera"))
        rows.append((seconds, 3, n >= 40, n >= 40, 0.5, "/camera"))
        rows.append((seconds + 0.4, 2, n >= 40, n >= 40, 0.5, "/driver"))
    made = events(sorted(rows, key=lambda row: row[0]))  # type: ignore[arg-type,return-value]
    found = Recording("m", made, (Mark(ns(27), "I"), Mark(ns(29), "I")), ns(0), ns(40))
    return replace(found, wiring=Wiring(evaluated=found.nodes_of)) if linked else found


def test_the_evidence_names_the_path_to_what_turned() -> None:
    found = {one.parameter: one for one in blame(mission(), static()).suspects}

    path = "~limit (camera) -> /done -> driver: src/node.cpp:12 ~retry -> /cmd"
    (followed,) = found["~limit"].followed
    assert followed.text == path
    assert (round(followed.turned_s, 6), round(followed.after_s, 6)) == (20, 0.4)
    assert followed.sentence == f"turned at 20.0 s, and 0.4 s later: {path}"
    assert found["~twin"].followed == found["~retry"].followed == ()


def test_a_turn_that_others_followed_counts_for_more_than_its_twin() -> None:
    linked = {one.parameter: one.probability for one in blame(mission(), static()).suspects}
    alone = {
        one.parameter: one.probability for one in blame(mission(linked=False), static()).suspects
    }

    assert alone["~limit"] == alone["~twin"]
    assert linked["~limit"] > linked["~twin"]


def test_without_links_nothing_changes() -> None:
    units = [replace(unit, comparisons=tuple(replace(c, received=None) for c in unit.comparisons))
             for unit in static().units]  # fmt: skip
    unlinked = StaticInfo.of(units)
    assert blame(mission(), unlinked) == blame(mission(linked=False), unlinked)


def test_a_turn_before_is_no_effect() -> None:
    # The other one turned at 3 s (1.0 after the first turn at 2 s) and at 9 s (0.5 before 9.5 s,
    # and 3 s after the turn at 6 s). Within 1.5 s: +1, 0, -1.
    other = Reached(np.array([3.0, 9.0]), 1.5)
    assert effects(np.array([2.0, 6.0, 9.5]), [other]).tolist() == [1, 0, -1]
    # One that hears the same message is no further effect; one at 7 s is one of the turn at 6 s.
    alike, later = Reached(np.array([3.1]), 1.5), Reached(np.array([7.0]), 1.5)
    assert effects(np.array([2.0, 6.0, 9.5]), [other, alike, later]).tolist() == [1, 1, -1]


def test_a_later_turn_than_messages_take_is_no_evidence() -> None:
    # retry turns 3 s after limit.
    rows = [(n / 2, 1, n >= 20, n >= 20, 0.5, "/camera") for n in range(60)]
    rows += [(n / 2 + 0.1, 2, n >= 26, n >= 26, 0.5, "/driver") for n in range(60)]
    late = Recording("m", events(sorted(rows)), (Mark(ns(15), "I"),), ns(0), ns(30))
    late = replace(late, wiring=Wiring(evaluated=late.nodes_of))
    tpcs = Tpcs.of(static())
    others = OtherNodes.of(ResultStreams.of(late.events, tpcs), tpcs, static(), late.wiring)

    assert others is not None
    assert others.followed(key(1), "/camera", 15.0) == ()
    assert not isinstance(others.followed(key(1), "/nobody", 15.0), Followed)


Turns = dict[tuple[int, str], list[float]]


def turned(turns: Turns, found: StaticInfo) -> OtherNodes:
    """Each comparison (TPC, node) is evaluated at 0 s, and turns at its times."""
    rows = [
        (time, tpc, n % 2 == 1, n % 2 == 1, 0.5, node)
        for (tpc, node), times in turns.items()
        for n, time in enumerate([0.0, *times])
    ]
    made = events(sorted(rows))
    recording = Recording("m", made, (), ns(0), ns(40))
    tpcs = Tpcs.of(found)
    wiring = Wiring(evaluated=recording.nodes_of)
    others = OtherNodes.of(ResultStreams.of(made, tpcs), tpcs, found, wiring)
    assert others is not None
    return others


def seen(others: OtherNodes, node: str, until_s: float) -> list[tuple[float, float]]:
    found = others.followed(key(1), node, until_s)
    return [(round(one.turned_s, 6), round(one.after_s, 6)) for one in found]


def test_each_process_of_a_program_has_its_own_turns() -> None:
    # retry follows process 41 after 5.4 - 5 = 0.4 s; process 97 turns 14.6 s later.
    first = turned(
        {(1, "/camera.py 41"): [5.0], (1, "/camera.py 97"): [20.0], (2, "/driver"): [5.4]},
        static(),
    )
    assert seen(first, "/camera.py 41", 30) == [(5, 0.4)]
    assert seen(first, "/camera.py 97", 30) == []


def test_all_processes_that_hear_a_message_count() -> None:
    # Process 7 follows after 0.4 s, process 8 turns 10 s later.
    others = turned(
        {(1, "/camera"): [5.0], (2, "/driver.py 7"): [5.4], (2, "/driver.py 8"): [15.0]}, static()
    )
    assert seen(others, "/camera", 30) == [(5, 0.4)]
    reached = {tuple(one.turns.tolist()) for found in others.reached for one in found}
    assert reached == {(5.4,), (15.0,)}


def test_what_changes_all_the_time_is_no_evidence() -> None:
    # 21 turns, one a second from 0.4 s: more than DECISIVE (20). That at 5.4 s is 0.4 s after 5 s.
    flaps = [n + 0.4 for n in range(21)]
    assert (
        seen(turned({(1, "/camera"): [5.0], (2, "/driver"): flaps}, static()), "/camera", 30) == []
    )
    others = turned({(1, "/camera"): [5.0], (2, "/driver"): flaps[:20]}, static())
    assert seen(others, "/camera", 30) == [(5, 0.4)]


def test_any_turn_in_between_may_lead_on() -> None:
    # 10 -> 11.4 is 1.4 s, 11.4 -> 12.5 is 1.1 s. From the first in between, 10.1, it is 2.4 s.
    heard = Received("/cmd", None, "value", "src/node.cpp", 20)
    arm = replace(link_unit([comparison(4, "~arm", received=(heard,))]), link_unit="arm")
    turns: Turns = {(1, "/camera"): [10.0], (2, "/driver"): [10.1, 11.4], (4, "/arm"): [12.5]}
    others = turned(turns, StaticInfo.of([*static().units, arm]))
    assert seen(others, "/camera", 30) == [(10, 2.5)]


def test_turns_after_the_time_are_no_evidence() -> None:
    # retry turns at 5.4 s.
    others = turned({(1, "/camera"): [5.0], (2, "/driver"): [5.4]}, static())
    assert seen(others, "/camera", 5.3) == []
    assert seen(others, "/camera", 5.4) == [(5, 0.4)]
