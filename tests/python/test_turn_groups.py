"""Comparisons that turn together or in a fixed order are one group, others are none."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from mission_samples import comparison, events, key, ns, static_info
from rich.console import Console

from pytpc.diagnosis.diagnose import diagnose_mission
from pytpc.diagnosis.ranking.live_groups import LiveGroups
from pytpc.diagnosis.ranking.result_streams import ResultStreams
from pytpc.diagnosis.results.turn_groups import SuspectGroup, group_of
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.diagnosis.turn_groups import MOST, Turns, groups_in, turn_groups
from pytpc.present.answers import Diagnosed
from pytpc.present.as_json import diagnosis_json
from pytpc.present.ranking_tables import print_diagnosis
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording

SECONDS = 300.0


def turns(name, *times, node="/node"):
    return Turns(f"key of {name}", node, name, np.array(times, np.float64))


def grouped(*every, seconds=SECONDS):
    return [one.parameters for one in turn_groups(every, seconds)]


def test_two_that_turn_at_the_same_times_are_a_group():
    found = turn_groups([turns("a", 10, 50, 90), turns("b", 10.05, 50.1, 89.95)], SECONDS)
    (group,) = found
    assert group.kind == "together"
    assert group.parameters == ("a", "b")
    assert group.turns == 3
    assert group.text == "turned together, 3 times"


def test_one_that_always_follows_the_other_is_a_group_in_order():
    # The median distance is 0.8 s; a quarter of that may be more or less.
    (group,) = turn_groups([turns("b", 10.8, 50.7, 90.95), turns("a", 10, 50, 90)], SECONDS)
    assert group.kind == "in order"
    assert [one.parameter for one in group.members] == ["a", "b"]
    assert [one.after_s for one in group.members] == pytest.approx([0, 0.8])
    assert group.text == "turned one after the other within 0.8 s, 3 times"


def test_an_order_that_varies_is_no_group():
    assert grouped(turns("a", 10, 50, 90), turns("b", 10.2, 51.4, 90.7)) == []


def test_what_follows_later_is_no_consequence():
    assert grouped(turns("a", 10, 50, 90), turns("b", 12, 52, 92)) == []


def test_one_turn_says_nothing():
    assert grouped(turns("a", 10), turns("b", 10)) == []


def test_another_number_of_turns_is_no_group():
    many = np.arange(1.0, 300.0, 10.0)
    assert grouped(turns("a", *many), turns("b", *many[::2])) == []


def test_one_miss_in_ten_is_forgiven_and_two_are_not():
    times = np.arange(10.0, 210.0, 20.0)
    one, two = times.copy(), times.copy()
    one[3] += 7
    two[[3, 6]] += 7
    assert grouped(turns("a", *times), turns("b", *one)) == [("a", "b")]
    assert grouped(turns("a", *times), turns("b", *two)) == []


def test_two_that_turn_all_the_time_meet_by_chance():
    # Each time is within 0.15 s of a turn of the one that turns every 0.25 s.
    often = np.arange(0, 25, 0.25)
    assert grouped(turns("a", *often), turns("b", *(often + 0.1)), seconds=25) == []
    assert grouped(turns("a", *often), turns("b", *(often + 0.1)), seconds=300) == [("a", "b")]


def test_chance_counts_all_pairs():
    # Two pairs of turns within 0.15 s in 300 s: p = (2 * 0.15 * 2 / 300)^2 = 4e-6 for a pair. Among
    # 100 comparisons that turn twice there are 4,950 pairs, so that one such pair is no wonder.
    alone = [turns("a", 10, 50), turns("b", 10.1, 50.1)]
    others = [turns(f"x{n:03}", 60 + 2.3 * n, 61.7 + 2.3 * n + n % 7) for n in range(98)]
    assert grouped(*alone) == [("a", "b")]
    assert ("a", "b") not in grouped(*alone, *others)


def test_groups_are_joined_over_a_common_member():
    a = np.arange(10.0, 110.0, 20.0)
    found = grouped(turns("a", *a), turns("b", *(a + 1.2)), turns("c", *(a + 2.4)))
    assert found == [("a", "b", "c")]


def test_the_order_of_the_input_changes_nothing():
    a = np.arange(10.0, 110.0, 20.0)
    every = [turns("a", *a), turns("b", *(a + 0.01)), turns("c", *(a + 5)), turns("d", *(a + 5.01))]
    assert grouped(*every) == grouped(*reversed(every)) == [("a", "b"), ("c", "d")]


def test_nodes_of_one_comparison_are_told_apart():
    found = turn_groups([turns("a", 10, 50, node="/x"), turns("a", 10, 50, node="/y")], SECONDS)
    assert [(one.node, one.parameter) for one in found[0].members] == [("/x", "a"), ("/y", "a")]
    assert found[0].parameters == ("a",)


def test_who_turns_very_often_takes_bounded_time():
    often = np.cumsum(np.tile([0.9, 1.7, 2.4], MOST))
    (group,) = turn_groups([turns("a", *often), turns("b", *(often + 0.02))], float(often[-1]))
    assert group.turns == MOST


def test_the_groups_of_a_recording():
    # a and b turn at 5, 20 and 33 s, c at other times; noise within 0.5 s is one turn.
    rows = []
    for tick in range(400):
        t = tick / 10
        high = t >= 5 and not 20 <= t < 33
        rows += [(t, 0, high, 2 * high, 1), (t + 0.04, 1, not high, 2 * (not high), 1)]
        rows.append((t + 0.05, 2, int(t) // 9 % 2, int(t) // 9 % 2, 0.5))
    static = static_info(comparison(0, "~a"), comparison(1, "~b"), comparison(2, "~c"))
    tpcs = Tpcs.of(static)
    (group,) = groups_in(ResultStreams.of(events(rows), tpcs), tpcs)
    assert [(one.key, one.parameter, one.turns) for one in group.members] == [
        (key(0), "~a", 3),
        (key(1), "~b", 3),
    ]


def test_the_sentence_about_suspects():
    (turning,) = turn_groups([turns("a", 10, 50, 90), turns("b", 10, 50, 90)], SECONDS)
    group = SuspectGroup(("b", "a"), 0.62, turning)
    assert group.sentence == ("b, a: 62 % that it is one of them; they turned together, 3 times")
    assert group_of([group], "a") is group
    assert group_of([group], "c") is None


def told():
    """A mission in which ~a and ~b turn at the same times, 3 s before each mark; ~c is noise."""
    rows = []
    for tick in range(1600):
        t = tick / 20
        on = 20 <= t < 40 or t >= 60
        rows += [(t, 0, on, 1 + on, 1.5), (t + 0.01, 1, not on, 2 - on, 1.5)]
        rows.append((t + 0.02, 2, 0, 0.1 * (tick % 3), 9))
    marks = tuple(Mark(ns(t), "I", "one") for t in (23, 63))
    static = static_info(comparison(0, "~a"), comparison(1, "~b"), comparison(2, "~c"))
    return diagnose_mission(Recording("m", events(rows), marks, 0, ns(80)), static)


def test_suspects_that_turn_together_are_one():
    found = told()
    (group,) = found.blame.groups
    a, b = found.blame.suspects[:2]
    assert group.parameters == (a.parameter, b.parameter)
    assert {*group.parameters} == {"~a", "~b"}
    assert group.probability == pytest.approx(a.probability + b.probability)
    assert group.turning.turns == 3
    assert len(found.by_group[0]) == 2


def test_a_group_is_blamed_that_is_sure_together():
    found = told().blame
    a, b = (
        replace(one, probability=p) for one, p in zip(found.suspects[:2], (0.5, 0.35), strict=True)
    )
    group = replace(found.groups[0], probability=0.85)
    sure = replace(found, suspects=(a, b), none=0.15, groups=(group,))
    assert sure.accused is None, "neither of them is sure"
    assert sure.text == (
        f"blame one of {a.parameter}, {b.parameter}: 85 %, as they turned together, 3 times; none"
        " of the parameters: 15 %"
    )
    unsure = replace(sure, groups=(replace(group, probability=0.79),))
    assert unsure.text.startswith("not sure: ")


def test_the_answers_show_the_group():
    found = told()
    out = Console(width=200, record=True, file=io.StringIO())
    print_diagnosis(out, found)
    text = out.export_text()
    a, b = (one.parameter for one in found.blame.suspects[:2])
    assert f"with {b} " in text
    assert f"{a}, {b}: " in text
    document = diagnosis_json(found)["groups"][0]
    assert document["parameters"] == [a, b]
    assert (document["kind"], document["turns"]) == ("together", 3)
    assert [one["parameter"] for one in document["members"]] == ["~a", "~b"]
    assert f"{a}, {b}: " in str(Diagnosed.of(found))


def live(pairs, now_s):
    groups = LiveGroups()
    for key_, t in sorted(pairs, key=lambda one: one[1]):
        groups.turned(key_, "/node", ns(t))
    return groups, groups.groups(ns(now_s), lambda one: f"~{one}" if one != "hidden" else None)


def test_the_groups_of_a_running_mission():
    pairs = [(name, t + 0.05 * n) for n, name in enumerate(("a", "b", "hidden")) for t in (5, 90)]
    groups, (found,) = live(pairs, 100)
    assert found.parameters == ("~a", "~b")
    # Nothing new: the same answer; old turns are forgotten.
    assert groups.groups(ns(120), str) == (found,)
    groups.turned("a", "/node", ns(900))
    assert groups.groups(ns(901), str) == ()


# Of 1,000 comparisons that turn alike (half a million pairs), those that turned last are compared.
def test_only_so_many_are_compared_while_it_runs():
    pairs = [(f"{n}", t + 0.001 * n) for n in range(1000) for t in range(5, 200, 20)]
    _, (found,) = live(pairs, 200)
    assert {one.key for one in found.members} == {f"{n}" for n in range(900, 1000)}


def test_noise_at_a_threshold_is_one_turn_while_it_runs():
    noisy = [(name, 5 + 0.2 * n) for n in range(50) for name in ("a", "b")]
    # From 5 to 14.8 s they turn each 0.2 s: one turn, and one says nothing.
    assert live(noisy, 100)[1] == ()
