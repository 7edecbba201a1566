"""Comparisons that turn together or in a fixed order are one group, others are none."""

from __future__ import annotations

import io
import itertools
from dataclasses import replace

import numpy as np
import pytest
from mission_samples import SummaryBuilder, comparison, events, key, ns, static_info
from rich.console import Console

import pytpc.diagnosis.turn_groups as turn_groups_module
from pytpc.diagnosis.diagnose import diagnose_mission
from pytpc.diagnosis.ranking.grouped import suspect_groups
from pytpc.diagnosis.ranking.live_groups import LiveGroups
from pytpc.diagnosis.ranking.result_streams import ResultStreams
from pytpc.diagnosis.ranking.summarised import with_summarised
from pytpc.diagnosis.results.advice import WhatIf
from pytpc.diagnosis.results.turn_groups import SuspectGroup, group_of
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.diagnosis.turn_groups import MOST, Turns, groups_in, part_of, turn_groups, turn_groups_of
from pytpc.present.answers import Diagnosed
from pytpc.present.as_json import diagnosis_json
from pytpc.present.margin_tables import group_text
from pytpc.present.ranking_tables import print_diagnosis
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summary

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


def test_a_parameter_is_named_once_for_each_node():
    a = (10, 50, 90)
    nodes = [turns("a", *a, node="/x"), turns("a", *a, node="/y")]
    (group,) = turn_groups(nodes, SECONDS)
    assert group_text(group) == "One group: a in /x, a in /y turned together, 3 times"
    lines = [replace(turns("a", *a), key=name) for name in ("one", "two")]
    (group,) = turn_groups([*lines, turns("b", *(t + 0.5 for t in a))], SECONDS)
    assert group_text(group) == (
        "One group: a (2 comparisons), b (0.5 s later) turned one after the other within 0.5 s,"
        " 3 times"
    )


def test_who_turns_very_often_takes_bounded_time():
    often = np.cumsum(np.tile([0.9, 1.7, 2.4], MOST))
    (group,) = turn_groups([turns("a", *often), turns("b", *(often + 0.02))], float(often[-1]))
    assert group.turns == MOST


def test_few_pairs_are_looked_at_closely(monkeypatch):
    # 300 comparisons that turn 20 times, at random: 44,850 pairs.
    rng = np.random.default_rng(1)
    every = [turns(f"x{n}", *np.sort(rng.uniform(0, 3600, 20))) for n in range(300)]
    looked_at = []
    belong = turn_groups_module._belong
    monkeypatch.setattr(
        turn_groups_module, "_belong", lambda *given: looked_at.append(given) or belong(*given)
    )
    assert turn_groups(every, 3600.0) == ()
    assert len(looked_at) < 100


@pytest.mark.parametrize("begin", [0.0, 1.7e9])
def test_a_first_look_misses_no_group(monkeypatch, begin):
    # Pairs at all distances, with as many misses as are forgiven, at the begin of the mission.
    rng = np.random.default_rng(2)
    every = []
    for n, count in enumerate((2, 3, 9, 10, 20, 60, 150)):
        for distance in (0.0, 0.1, 0.5, 1.4):
            times = begin + np.cumsum(rng.uniform(6, 10, count))
            later = times + distance + rng.uniform(-0.1, 0.1, count)
            later[: count // 10] += 3
            every += [turns(f"a{n} {distance}", *times), turns(f"b{n} {distance}", *later)]
    found = turn_groups(every, 1500.0)
    assert {"a6 0.0", "b6 0.0"} in [{*one.parameters} for one in found]
    monkeypatch.setattr(
        turn_groups_module,
        "_likely",
        lambda turned, ends: ((a, b) for a in range(len(turned)) for b in range(a + 1, ends[a])),
    )
    assert turn_groups(every, 1500.0) == found


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
    (group,) = groups_in(
        ResultStreams.of(events(rows), tpcs), tpcs, Recording("m", events(rows), (), 0, 0)
    )
    assert [(one.key, one.parameter, one.turns) for one in group.members] == [
        (key(0), "~a", 3),
        (key(1), "~b", 3),
    ]


def test_turns_that_only_summaries_tell_have_no_time():
    # Of both, each period of 10 s is one summary. In 60 to 70 s and in 130 to 140 s both turned.
    told = SummaryBuilder()
    for number, period in itertools.product((0, 1), range(30)):
        on, turned = 6 <= period < 13, period in (6, 13)
        end = 10 * period + 10
        row = Summary(
            key(number), "/node", ns(end - 10), ns(end), 100, int(turned), 0, 0, on, on,
            2.0 * on, 1.0, -1.0, 1.0, 0.0, 1.0, 0.0, 2.0,
        )  # fmt: skip
        told.add(row)
    static = static_info(comparison(0, "~a"), comparison(1, "~b"))
    silent = Recording("m", events([]), (), 0, ns(300), summaries=told.build())
    streams = ResultStreams.of(with_summarised(silent), Tpcs.of(static))
    assert [one.changes.size for one in streams.streams] == [2, 2]
    assert turn_groups_of(silent, static) == ()
    # The same with the reports of the turns.
    rows = [(t + 0.1 * n, n, on, 2 * on, 1) for t, on in ((66, 1), (135, 0)) for n in (0, 1)]
    reported = replace(silent, events=events(rows))
    assert [one.parameters for one in turn_groups_of(reported, static)] == [("~a", "~b")]


def test_the_sentence_about_suspects():
    (turning,) = turn_groups([turns("a", 10, 50, 90), turns("b", 10, 50, 90)], SECONDS)
    group = SuspectGroup(("b", "a"), 0.62, turning)
    assert group.sentence == ("b, a: 62 % that it is one of them; they turned together, 3 times")
    assert group_of([group], "a") is group
    assert group_of([group], "c") is None


def told_mission():
    """A mission in which ~a and ~b turn at the same times, 3 s before each mark; ~c is noise."""
    rows = []
    for tick in range(1600):
        t = tick / 20
        on = 20 <= t < 40 or t >= 60
        rows += [(t, 0, on, 1 + on, 1.5), (t + 0.01, 1, not on, 2 - on, 1.5)]
        rows.append((t + 0.02, 2, 0, 0.1 * (tick % 3), 9))
    marks = tuple(Mark(ns(t), "I", "one") for t in (23, 63))
    static = static_info(comparison(0, "~a"), comparison(1, "~b"), comparison(2, "~c"))
    return Recording("m", events(rows), marks, 0, ns(80)), static


def told():
    return diagnose_mission(*told_mission())


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


def switched(*turns_of, marks, seconds=800):
    """The groups of a mission whose comparisons turn at these times."""
    rows = [
        (tick / 4 + n / 100, n, on, 1 + on, 1.5)
        for tick in range(4 * seconds)
        for n, times in enumerate(turns_of)
        for on in [sum(t <= tick / 4 for t in times) % 2]
    ]
    static = static_info(
        *(comparison(n, f"~{name}") for n, name in enumerate("abc"[: len(turns_of)]))
    )
    recording = Recording("m", events(rows), tuple(Mark(ns(t), "I", "one") for t in marks), 0, 0)
    return [one.parameters for one in diagnose_mission(recording, static).blame.groups]


def test_who_did_not_turn_before_the_mark_is_told_apart():
    # ~a and ~b turn together ten times. Before the mark at 604 s, only ~a does.
    often = [50 * n for n in range(1, 11)]
    assert switched([*often, 600], often, marks=[604]) == []
    assert [{*one} for one in switched([*often, 600], [*often, 600], marks=[604])] == [{"~a", "~b"}]


def test_turns_long_before_the_marks_make_no_group_of_suspects():
    assert switched([2, 5, 9], [2, 5, 9], marks=[600, 700]) == []
    assert len(switched([2, 5, 9], [2, 5, 9], marks=[20, 30])) == 1


def test_who_is_unlikely_is_not_named():
    found = told().blame
    a, b, *_ = found.suspects
    recording, static = told_mission()
    tpcs = Tpcs.of(static)
    streams = ResultStreams.of(recording.events, tpcs)
    likely = replace(a, probability=0.81), replace(b, probability=0.009)
    given = groups_in(streams, tpcs, recording), streams, tpcs, recording.marks
    assert suspect_groups(likely, *given) == ()
    likely = replace(a, probability=0.7), replace(b, probability=0.1)
    assert suspect_groups(likely, *given)[0].probability == pytest.approx(0.8)


def test_a_blamed_group_is_tried_although_each_member_is_less_likely_than_none():
    found = told()
    group = replace(found.blame.groups[0], probability=0.82)
    suspects = tuple(replace(one, probability=0.1) for one in found.blame.suspects)
    blame = replace(found.blame, suspects=suspects, none=0.18, groups=(group,))
    assert blame.text.startswith("blame one of ")
    assert not replace(found, blame=blame).is_none_likeliest
    assert replace(found, blame=replace(blame, groups=())).is_none_likeliest


def test_a_group_of_which_all_would_only_be_stopped_is_not_blamed():
    found = told()
    blame = replace(found.blame, groups=(replace(found.blame.groups[0], probability=0.85),))
    low = tuple(replace(one, probability=0.4) for one in blame.suspects)
    ends = WhatIf("~a", 2, 2, 2, 9, 2, 7, "", (), stops=True)
    advice = tuple(replace(one, what_if=ends) for one in found.advice)
    asked = replace(found, blame=replace(blame, suspects=low), advice=advice)
    a, b = blame.groups[0].parameters
    assert asked.headline == (
        f"not sure: {a}, {b} are likeliest (85 % together), but the log only shows that another"
        " value would stop all that they decide"
    )
    some = (advice[0], *(replace(one, what_if=None) for one in advice[1:]))
    assert replace(asked, advice=some).headline.startswith("blame one of ")


def test_the_part_of_a_group_begins_with_its_own_first_member():
    a = np.arange(10.0, 110.0, 20.0)
    (whole,) = turn_groups(
        [turns("a", *a), turns("b", *(a + 1.2)), turns("c", *(a + 1.25))], SECONDS
    )
    assert whole.kind == "in order"
    part = part_of(whole, {(f"key of {name}", "/node") for name in "bc"})
    assert part.kind == "together"
    assert [one.after_s for one in part.members] == pytest.approx([0, 0.05])


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
