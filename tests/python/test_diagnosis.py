from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from mission_samples import comparison, events, key, ns, static_info

from pytpc.diagnosis.ranking.known_good import (
    BETWEEN,
    DEFAULT,
    UNCHANGED,
    KnownGood,
    of_change,
    of_changes,
    of_defaults,
    of_others,
    of_references,
)
from pytpc.diagnosis.ranking.mark_evidence import (
    PATIENCE_LOG,
    PATIENCE_SIGMA,
    REACTION_LOG,
    REACTION_SIGMA,
    SHARE,
    STRAY,
    MarkEvidence,
    Wait,
    mark_evidence,
    marked,
    reaction,
)
from pytpc.diagnosis.ranking.other_values import diagnose_replayed
from pytpc.diagnosis.ranking.posterior import (
    MARKS_I,
    MARKS_II,
    REPEAT,
    Said,
    diagnose_log,
    mixture,
    ranked,
    softmax,
    type_odds,
)
from pytpc.diagnosis.ranking.result_streams import ResultStreams
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.recording.events import Events
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc_evaluation.study.fit import REASONED

STATIC = static_info(
    comparison(0, "~gate"),
    comparison(1, "~noisy"),
    comparison(2, "~safe"),
    comparison(3, "~never"),
    comparison(4, "~enable", "flag"),
)


def gate_case(switch=30.0, end=80.0):
    """gate turns once; noisy turns each second; safe never does; enable is a flag."""
    rows = []
    for tick in range(int(end * 2)):
        t = tick / 2
        rows.append((t, 0, t >= switch, t / end, switch / end))
        rows.append((t + 0.01, 1, int(t) % 2, 0.1 * (int(t) % 2), 0.05))
        rows.append((t + 0.02, 2, 0, 1 + 0.1 * math.sin(t), 9))
        rows.append((t + 0.03, 4, 1, 1, 1))
    return rows


def wait_case(begin=20.0, end=80.0):
    """From ``begin`` on gate is evaluated, stands near its threshold and does not turn."""
    rows = []
    for tick in range(int(end * 2)):
        t = tick / 2
        value = 5 - 0.2 * t if t < begin else 1.1 + 0.01 * (tick % 2)
        rows.append((t, 0, value < 1, value, 1))
        rows.append((t + 0.01, 1, int(t) % 2, 0.1 * (int(t) % 2), 0.05))
        rows.append((t + 0.02, 2, 0, 1 + 0.1 * math.sin(t), 9))
        rows.append((t + 0.03, 4, 1, 1, 1))
    return rows


def recording(rows, marks, table=None):
    found = events(rows) if table is None else table
    return Recording("mission", found, tuple(marks), 0, ns(80))


def marks(*seconds, kind=None, observer="user1"):
    return [Mark(ns(t), kind, observer) for t in seconds]


def first(found):
    return found.names[found.order[0]]


def test_the_change_before_the_mark_is_suspected():
    found = diagnose_log(recording(gate_case(), marks(33, kind="I")), STATIC)
    assert first(found) == "~gate"
    assert "~never" not in [found.names[n] for n in found.order]


def test_what_stands_near_its_threshold_in_the_wait_is_suspected():
    for kind in ("II", None):
        found = diagnose_log(recording(wait_case(), marks(30, 37, 44, 51, kind=kind)), STATIC)
        assert first(found) == "~gate", kind


def test_the_posterior_is_one_with_none_of_them():
    found = diagnose_log(recording(gate_case(), marks(33, kind="I")), STATIC)
    assert found.posterior.sum() + found.none == pytest.approx(1.0)
    assert found.posterior[found.names.index("~never")] == 0.0


# exp of the scores log 2, log 1 and none's log 1: 2/4, 1/4 and 1/4.
def test_the_posterior_of_two_by_hand():
    posterior, none = softmax(np.log([2.0, 1.0]), 0.0)
    assert posterior.tolist() == pytest.approx([0.5, 0.25])
    assert none == pytest.approx(0.25)
    posterior, none = softmax(np.array([-np.inf, -np.inf]), 2.0)
    assert (posterior.tolist(), none) == ([0.0, 0.0], 1.0)


# Streams 0 and 1 are of parameter 0, 2 of parameter 1, nobody is of parameter 2. By acted, with the
# weight 1, parameter 0 has the mean of e^0 and e^2 and 1 has e^-1, none of them e^0; waited has the
# mean of e^1 and e^0, e^-1 and e^0. The
# baseline has 1/1 and 1/2, so 2/3 and 1/3 of what is not "none of them", by type I, and the other
# way round by the better of both.
def test_the_witnesses_are_mixed_by_hand():
    zero = np.zeros(3)
    found = MarkEvidence(
        acted=np.array([0.0, 2.0, -1.0]),
        waited=np.array([1.0, 0.0, -1.0]),
        since=zero,
        held=np.full(3, 1 - SHARE),
        near=zero,
        flat=zero,
    )
    ranks = np.log([[[1, 1 / 2, 1e-300]], [[1 / 2, 1, 1e-300]]])
    weights = replace(REASONED, acted=1, waited=1, ranked=1, none=0, latch=-50)

    def mixed(odds, **changes):
        said = Said(np.array([0, 0, 1]), ranks, np.array([odds]))
        return mixture(found, said, replace(weights, **changes))

    two = (1 + math.e**2) / 2
    did = np.array([two, 1 / math.e, 0, 1]) / (two + 1 / math.e + 1)
    some = 1 - did[3]
    did = (did + np.array([some * 2 / 3, some / 3, 0, did[3]])) / 2
    two = (1 + math.e) / 2
    waits = np.array([two, 1 / math.e, 0, 1]) / (two + 1 / math.e + 1)
    some = 1 - waits[3]
    waits = (waits + np.array([some / 3, some * 2 / 3, 0, waits[3]])) / 2
    assert mixed(-50.0).shares[0].tolist() == pytest.approx(did.tolist())
    assert mixed(50.0).shares[0].tolist() == pytest.approx(waits.tolist())
    both = mixed(0.0)
    assert both.shares[0].tolist() == pytest.approx(((did + waits) / 2).tolist())
    assert both.type1[0, 0] == pytest.approx(did[0] / (did[0] + waits[0]))
    # Surely of type II: half of that are latches, which are changes after all.
    latched = mixed(50.0, latch=0.0)
    assert latched.shares[0].tolist() == pytest.approx(((did + waits) / 2).tolist())
    assert latched.type1[0, 0] == pytest.approx(0.0, abs=1e-9)
    assert latched.turned[0, 0] == pytest.approx(did[0] / (did[0] + waits[0]))


# At 50 s by type I: gate (50-49)*2 = 2 before noisy (50-37)*2 = 26, then safe, which has no score.
# By type II in the window: safe 0.2/(2-1) before gate 1/(3-1). So by the better of both gate and
# safe share the places 1 and 2. The others were never compared.
def test_the_baseline_is_a_witness():
    rows = [(1, 0, 0, 1, 2), (49, 0, 1, 3, 2), (1, 1, 0, 1, 2), (37, 1, 1, 3, 2), (1, 2, 0, 1, 2)]
    rows += [(48, 2, 0, 1.8, 2)]
    tpcs = Tpcs.of(STATIC)
    found = ranked(recording(rows, []), tpcs, np.array([ns(50)]))
    nobody = {"~never": math.inf, "~enable": math.inf}
    first = dict(zip(tpcs.names, np.exp(-found[0, 0]), strict=True))
    assert first == pytest.approx({"~gate": 1.0, "~noisy": 2.0, "~safe": 3.0, **nobody})
    either = dict(zip(tpcs.names, np.exp(-found[1, 0]), strict=True))
    assert either == pytest.approx({"~gate": 1.5, "~noisy": 3.0, "~safe": 1.5, **nobody})


# At the median z = 0: 3/8 / (sigma t), of the 0.775 that are in time. Before the mark there is no
# reaction; 15 s later than the median are those that are late by as much, and the rest of the
# others.
def test_reactions_by_hand():
    median = math.exp(REACTION_LOG)
    density = reaction(np.array([median, -1.0, 0.0]))
    in_time = 0.775 * 0.375 / (REACTION_SIGMA * median)
    assert density.tolist() == pytest.approx([in_time, 0.0, 0.0])
    z = math.log((median + 15) / median) / REACTION_SIGMA
    rest = 0.775 * 0.375 * (1 + z * z / 4) ** -2.5 / (REACTION_SIGMA * (median + 15))
    late = 0.15 * 0.375 / (REACTION_SIGMA * median)
    assert reaction(np.array([median + 15]))[0] == pytest.approx(rest + late)
    # It is a density: its integral over log t from far left to far right is 1.
    logs = np.linspace(-40, 40, 80001)
    assert float(np.sum(reaction(np.exp(logs)) * np.exp(logs)) * 0.001) == pytest.approx(
        1, abs=0.01
    )


# One user, n marks of no type: REPEAT times log of (1/m2 (1-1/m2)^(n-1)) / (1/m1 (1-1/m1)^(n-1)).
def test_many_marks_speak_for_the_second_type():
    one = type_odds(marks(1))
    assert one == pytest.approx(REPEAT * math.log(MARKS_I / MARKS_II))
    ratio = (1 - 1 / MARKS_II) / (1 - 1 / MARKS_I)
    assert type_odds(marks(1, 2, 3)) == pytest.approx(one + REPEAT * 2 * math.log(ratio))


# The observers tell the types apart (0.5), with slips of 0.05, or say I with 28/68 (0.5).
# One mark of type I: (0.05 + 28/68) / (0.95 + 28/68).
def test_a_said_type_is_believed_in_part():
    plain = type_odds(marks(1))
    said = type_odds(marks(1, kind="I")) - plain
    assert said == pytest.approx(math.log((0.05 + 28 / 68) / (0.95 + 28 / 68)))
    assert type_odds(marks(1, kind="II")) > plain


def test_agreement_is_believed_more_and_disagreement_not_at_all():
    def said(kinds):
        own = [Mark(ns(5), kind, f"user{n}") for n, kind in enumerate(kinds)]
        return type_odds(own) - type_odds([replace(mark, type=None) for mark in own])

    assert said(["I"] * 4) < said(["I"]) < 0
    assert abs(said(["I", "II", "I", "II"])) < abs(said(["I"]))


# I, II and II by one count 1, 1/2 and 1/4: so 1 against 3/4, whatever the order in the list.
def test_what_an_observer_says_first_counts_most():
    own = [*marks(9, 12, kind="II"), *marks(5, kind="I")]
    vague = 0.5 * (28 / 68) * (40 / 68) ** 0.75
    one = 0.5 * 0.95 * 0.05**0.75 + vague
    two = 0.5 * 0.95**0.75 * 0.05 + vague
    plain = type_odds([replace(mark, type=None) for mark in own])
    assert type_odds(own) - plain == pytest.approx(math.log(two / one))
    assert two < one


# gate has one turn at 30 s, the first evaluation is a start at 0 s. The mark is at 33 s.
# At 30 s nothing else changed in the 1.5 s before but noisy, which changes too often; nothing
# begins after it: u = 0.3. At 0 s u = 0.05 * 0.3: what begins with the log is no shift. The first
# part is log (0.3 f(3) + 0.015 f(33)) / (0.315 + 0.3), f(d) = 0.1 + 0.9 * 79.53 p(d).
# The mean of f over causes from 0 to 33 s is 0.1 + 0.9 * 79.53 / 33 times the share F of reactions
# below 33 s, where z = (log 33 - 1.946) / 1.17 = 1.3252 and, of t with four degrees of freedom,
# F = 1/2 + 3/8 z/sqrt(1 + z^2/4) (1 - z^2/(12 + 3 z^2)) = 0.8721; below 18 s (late by 15 s) it is
# 0.7676, below 3 s (late by 30 s) 0.2545: 0.775 F + 0.15 * 0.7676 + 0.075 * 0.2545 = 0.8101.
def test_acted_by_hand():
    streams = ResultStreams.of(events(gate_case()), Tpcs.of(STATIC))
    found = mark_evidence(streams, marked([Mark(ns(33), None)], streams))
    f = STRAY + (1 - STRAY) * 79.53 * reaction(np.array([3.0, 33.0]))
    chance = STRAY + (1 - STRAY) * 79.53 / 33 * 0.8101
    expected = math.log((0.3 * f[0] + 0.015 * f[1]) / 0.615) - math.log(chance)
    assert streams.seconds == pytest.approx(79.53)
    assert found.acted[0] == pytest.approx(expected, abs=0.01)
    assert int(np.argmax(found.acted)) == 0


# That it begins and is left alone within 1.2 s are two effects: 0.3 + 2/(2 + 2) = 0.8. Evaluated at
# 30 s alone, the start weighs 0.4 * 0.8 = 0.32; where it goes on for a second, 0.05 * 0.8 = 0.04.
def test_what_is_evaluated_once_may_have_passed_at_once():
    rows = [(t / 2, 2, 0, 1, 9) for t in range(160)]
    f = STRAY + (1 - STRAY) * 79.5 * reaction(np.array([3.0]))[0]
    weighed = []
    for length in (0.1, 1.0):
        own = [(30 + t * length / 5, 0, 1, 1, 2) for t in range(6)]
        streams = ResultStreams.of(events(rows + own), Tpcs.of(STATIC))
        found = mark_evidence(streams, marked([Mark(ns(33), None)], streams))
        weighed.append(math.exp(found.acted[0]))
    assert weighed[0] / weighed[1] == pytest.approx((0.32 / 0.62) / (0.04 / 0.34))
    chance = STRAY + (1 - STRAY) * 79.5 / 33 * 0.8101
    assert weighed[0] == pytest.approx(0.32 * f / 0.62 / chance, rel=0.01)


def test_a_comparison_that_changes_all_the_time_is_as_good_as_chance():
    rows = [(t / 2, 0, t % 4 < 2, t % 4, 2) for t in range(160)]
    streams = ResultStreams.of(events(rows), Tpcs.of(STATIC))
    own = marked(
        [Mark(ns(at), None, who) for at, who in ((40, "a"), (42, "b"), (45, "c"))], streams
    )
    assert abs(mark_evidence(streams, own).acted[0]) < 0.3


# The wait is [22, 30]: gate stands at 1.1 and 1.11 with a threshold of 1, false, for 8.5 s of 8.
# 17 evaluations: 9 of 1.1 and 8 of 1.11; the value falls from 5, so the range is 4. As near is up
# to 0.11 + 0.05 * 4 = 0.31: elsewhere from 18.5 s, where the value is 1.3, to 21.5 s, and from 30.5
# to 79.5 s: 7 + 99 evaluations of half a second.
def test_waited_by_hand():
    streams = ResultStreams.of(events(wait_case()), Tpcs.of(STATIC))
    found = mark_evidence(streams, marked([Mark(ns(30), None)], streams))
    elsewhere = 106 * 0.5 / (79.53 - 8)
    assert found.held[0] == 1.0
    assert found.waited[0] == pytest.approx(math.log((1 + SHARE) / (elsewhere + SHARE)), abs=1e-3)
    assert found.near[0] == pytest.approx(math.log((9 * 0.1 + 8 * 0.11) / 17 / 4 + 0.01))
    # It has been so for 11.5 s at the mark.
    fit = 79.53 * reaction(np.array([11.5]), PATIENCE_LOG, PATIENCE_SIGMA)[0]
    assert found.since[0] == pytest.approx(math.log(STRAY + (1 - STRAY) * fit))
    # The flag has one value.
    assert found.flat.tolist() == [0.0, 0.0, 0.0, 1.0]


# At 50 s it has been so for 1 s, since its break of 3 s; before the break for 46 s, which ended
# more than 2 s before the mark at 49.5 s.
def test_a_break_ends_a_wait_and_a_short_one_does_not():
    rows = [(t / 10, 0, 0, 1, 2) for t in range(460)] + [
        (t / 10, 0, 0, 1, 2) for t in range(490, 800)
    ]
    streams = ResultStreams.of(events(rows), Tpcs.of(STATIC))
    found = [
        mark_evidence(streams, marked([Mark(ns(m), None)], streams)).since[0]
        for m in (50, 48.5, 47)
    ]
    fits = 79.9 * reaction(np.array([1.0, 47.0]), PATIENCE_LOG, PATIENCE_SIGMA)
    assert found[0] == pytest.approx(math.log(STRAY + (1 - STRAY) * fits[0]))
    assert found[1] == pytest.approx(math.log(STRAY))
    assert found[2] == pytest.approx(math.log(STRAY + (1 - STRAY) * fits[1]))


def test_only_the_first_mark_of_an_observer_tells_when_it_began():
    streams = ResultStreams.of(events(gate_case()), Tpcs.of(STATIC))
    found = marked(
        [Mark(ns(at), None, who) for at, who in ((40, "a"), (33, "a"), (50, "b"))], streams
    )
    assert found.times.tolist() == [40, 33, 50]
    assert found.firsts.tolist() == [33, 50]


# It began 20 to 10 s before the mark at 60 s: from 40 to 50. The density is 0.9 / (10 + 3 + 0.5)
# there, falls by e for each 3 s before 40 and each 0.5 s after 50, and a tenth of it is ordinary.
def test_when_it_began_is_nearer_to_its_cause_than_the_mark():
    streams = ResultStreams.of(events(gate_case()), Tpcs.of(STATIC))
    marks = marked([Mark(ns(60), None, "a", "@-20..-10"), Mark(ns(61), None, "b")], streams)
    assert marks.begins[0].tolist() == [40, 50]
    causes = np.array([45.0, 37.0, 51.0])
    found = marks.fits(causes[:, None], 1.946, 1.17)
    told = 0.9 / 13.5 * np.exp([0.0, -1.0, -2.0])
    assert found[:, 0] == pytest.approx(told + 0.1 * reaction(60 - causes))
    assert found[:, 1] == pytest.approx(reaction(61 - causes))


# The wait of a mark that says so begins in the middle of it, and ends with the mark at the latest.
def test_the_wait_is_where_the_error_began():
    streams = ResultStreams.of(events(gate_case()), Tpcs.of(STATIC))
    late = [Mark(ns(60), "II", "a", "@-20..-10"), Mark(ns(50), "II", "a", "@-3..-1")]
    wait = Wait.before(marked(late, streams), streams.seconds)
    assert wait.begins.tolist() == pytest.approx([45])
    assert wait.ends.tolist() == pytest.approx([53])
    one = Wait.before(marked(late[1:], streams), streams.seconds)
    assert (one.begins.tolist(), one.ends.tolist()) == ([48], [50])


def test_what_is_as_it_was_is_hardly_to_blame():
    assert (of_change(1.0, 2.0), of_change(2.0, 2.0)) == (0.0, UNCHANGED)
    changes = [
        Change("/node/b", "", 1.0, 2.0),
        Change("~b", "", 1.0, 1.0),
        Change("~c", "", 3, 3),
    ]
    prior = of_changes(("~a", "~b", "~c"), changes)
    assert prior.tolist() == [UNCHANGED, 0.0, UNCHANGED]


def test_a_good_run_tells_which_threshold_is_another():
    tpcs = Tpcs.of(STATIC)
    here = events([(1, 0, 0, 1, 4), (1, 1, 0, 1, 4), (1, 2, 0, 1, 4), (2, 2, 0, 1, 5)])
    there = events([(1, 0, 0, 1, 2), (1, 1, 0, 1, 4), (1, 2, 0, 1, 4)])
    found = of_references(STATIC, tpcs, here, [there])
    prior = dict(zip(tpcs.names, found.prior, strict=True))
    assert prior["~gate"] == 0.0
    assert prior["~noisy"] == UNCHANGED
    # Nothing is known of what changed in a run, or was not compared.
    assert np.isnan([prior["~safe"], prior["~never"]]).all()
    assert found.others == {key(0): 2.0}
    # It kept its value if one of the runs had it.
    runs = [there, events([(1, 0, 0, 1, 4)]), there]
    gate = of_references(STATIC, tpcs, here, runs).prior[tpcs.names.index("~gate")]
    assert gate == UNCHANGED


# Nobody watched these runs: what one of them had may be wrong, too. 2 is the nearest other value.
def test_runs_of_which_nobody_knows_more_are_replayed_only():
    tpcs = Tpcs.of(STATIC)
    here = events([(1, 0, 0, 1, 4), (1, 1, 0, 1, 4)])
    runs = [events([(1, 0, 0, 1, value), (1, 1, 0, 1, 4)]) for value in (4, 9, 2)]
    found = of_others(STATIC, tpcs, here, runs)
    assert found.prior.tolist() == [0.0] * len(tpcs.names)
    assert (found.others, found.same) == ({key(0): 2.0}, {key(1)})


# 4 is between 2 and 7, and nearer to 2.
def test_between_two_good_values_is_nearly_as_good():
    tpcs = Tpcs.of(STATIC)
    here = events([(1, 0, 0, 1, 4)])
    runs = [events([(1, 0, 0, 1, value)]) for value in (7, 2)]
    found = of_references(STATIC, tpcs, here, runs)
    assert found.prior[tpcs.names.index("~gate")] == BETWEEN
    assert found.others == {key(0): 2.0}


# Modes 1 and 3 were good; 2 is another one, and no less likely to be wrong.
def test_nothing_lies_between_two_values_that_must_be_equal():
    static = static_info(comparison(0, "~mode", "=="))
    tpcs = Tpcs.of(static)
    runs = [events([(1, 0, 0, 1, value)]) for value in (1, 3)]
    found = of_references(static, tpcs, events([(1, 0, 0, 1, 2)]), runs)
    assert found.prior.tolist() == [0.0]


# Of a good run with 5 and one with 7, the nearer one is replayed: 4 is below both.
def test_the_nearest_good_value_is_replayed():
    here, tpcs = events([(1, 0, 0, 1, 4)]), Tpcs.of(STATIC)
    for order in ((5, 7), (7, 5)):
        runs = [events([(1, 0, 0, 1, value)]) for value in order]
        assert of_references(STATIC, tpcs, here, runs).others == {key(0): 5.0}


def with_defaults(*defaults):
    """gate, noisy and so on with these defaults; STATIC has none."""
    known = [*STATIC.comparisons.values()]
    changed = [replace(one, default=value) for one, value in zip(known, defaults, strict=False)]
    return static_info(*changed, *known[len(changed) :])


def test_a_default_in_the_code_is_known_to_be_good():
    static = with_defaults(4, 9, None)
    tpcs = Tpcs.of(static)
    here = events([(1, 0, 0, 1, 4), (1, 1, 0, 1, 4), (1, 2, 0, 1, 4)])
    found = of_defaults(static, tpcs, here)
    names = [static.comparisons[key(number)].source for number in range(3)]
    prior = dict(zip(tpcs.names, found.prior, strict=True))
    assert [prior[name] for name in names[:2]] == [DEFAULT, 0.0]
    assert np.isnan(prior[names[2]])
    assert found.others == {key(1): 9.0}


# The node keeps 0.1 in a float, and reports it as 0.100000001490116.
def test_a_default_that_is_kept_in_a_float_is_the_same():
    static = with_defaults(0.1)
    here = events([(1, 0, 0, 1, 0.10000000149011612)])
    assert of_defaults(static, Tpcs.of(static), here).others == {}


def test_a_prior_moves_the_order():
    names = Tpcs.of(STATIC).names
    prior = np.where([name == "~safe" for name in names], 20.0, 0.0)
    found = diagnose_replayed(recording(gate_case(), marks(33)), STATIC, KnownGood(prior, {}))
    assert first(found) == "~safe"


CASES = [(gate_case, marks(33, 35)), (wait_case, marks(30, 37, 44))]


@pytest.mark.parametrize(("rows", "own"), CASES)
def test_the_clock_does_not_matter(rows, own):
    plain = diagnose_log(recording(rows(), own), STATIC)
    late = [(row[0] + 2**20, *row[1:]) for row in rows()]
    moved = [replace(mark, time_ns=mark.time_ns + ns(2**20)) for mark in own]
    found = diagnose_log(recording(late, moved), STATIC)
    assert found.scores == pytest.approx(plain.scores, rel=1e-9)


@pytest.mark.parametrize(("rows", "own"), CASES)
def test_the_order_of_recording_does_not_matter(rows, own):
    plain = diagnose_log(recording(rows(), own), STATIC)
    shuffled = [rows()[n] for n in np.random.default_rng(1).permutation(len(rows()))]
    turned = diagnose_log(recording(shuffled, own[::-1]), STATIC)
    assert turned.scores.tolist() == plain.scores.tolist()


@pytest.mark.parametrize(("rows", "own"), CASES)
def test_units_do_not_matter(rows, own):
    plain = diagnose_log(recording(rows(), own), STATIC)
    larger = [(t, n, r, cmp * 1024, thresh * 1024) for t, n, r, cmp, thresh in rows()]
    assert diagnose_log(recording(larger, own), STATIC).scores.tolist() == plain.scores.tolist()


@pytest.mark.parametrize(("rows", "own"), CASES)
def test_names_do_not_matter(rows, own):
    plain = diagnose_log(recording(rows(), own), STATIC)
    other = static_info(*(comparison(n, f"~z{9 - n}") for n in range(5)))
    found = diagnose_log(recording(rows(), own), other)
    by_name = dict(zip(found.names, found.scores, strict=True))
    names = ["~gate", "~noisy", "~safe", "~never", "~enable"]
    for number, name in enumerate(names):
        score = plain.scores[plain.names.index(name)]
        assert by_name[f"~z{9 - number}"] == pytest.approx(score, rel=1e-12)


@pytest.mark.parametrize(("rows", "own"), CASES)
def test_what_is_never_evaluated_changes_nothing(rows, own):
    plain = diagnose_log(recording(rows(), own), STATIC)
    more = static_info(*STATIC.comparisons.values(), comparison(7, "~more"))
    found = diagnose_log(recording(rows(), own), more)
    kept = [found.names.index(name) for name in plain.names]
    assert found.posterior[kept].tolist() == plain.posterior.tolist()
    assert found.posterior[found.names.index("~more")] == 0.0


def test_no_marks_and_no_log_are_nobodys_fault():
    for one in (recording(gate_case(), []), recording([], marks(3))):
        found = diagnose_log(one, STATIC)
        assert (found.order, found.none) == ([], 1.0)


def test_marks_outside_of_the_log_are_borne():
    for own in (marks(-500), marks(10_000), [Mark(2**62, "I"), Mark(-(2**62), "II")]):
        found = diagnose_log(recording(gate_case(), own), STATIC)
        assert np.isfinite(found.posterior).all()
        assert found.posterior.sum() + found.none == pytest.approx(1.0)


@pytest.mark.parametrize("odd", [math.nan, math.inf, -math.inf, 1.7e308])
def test_values_that_are_no_numbers_are_borne(odd):
    rows = wait_case() + [(t + 0.1, 3, t % 2, odd, -odd) for t in range(80)]
    rows += [(t + 0.2, 2, 0, odd, 9) for t in range(80)]
    found = diagnose_log(recording(rows, marks(30, 37, 44)), STATIC)
    assert np.isfinite(found.posterior).all()
    assert first(found) == "~gate"


def test_one_evaluation_and_equal_times_are_borne():
    rows = [(5, 0, 1, 1, 2)] + [(6, 1, n % 2, n, 2) for n in range(5)]
    found = diagnose_log(recording(rows, marks(7)), STATIC)
    assert {found.names[n] for n in found.order} == {"~gate", "~noisy"}
    assert np.isfinite(found.scores[found.order]).all()


def test_the_same_code_in_two_nodes_is_two_streams():
    rows = [(t, 0, 0, 1, 2, "/one") for t in range(80)] + [
        (t, 0, 1, 3, 2, "/two") for t in range(80)
    ]
    streams = ResultStreams.of(events(rows), Tpcs.of(STATIC))
    assert len(streams.streams) == 2
    assert [stream.changes.size for stream in streams.streams] == [0, 0]


def test_bursts_are_one_change():
    rows = [(t, 0, 0, 1, 2) for t in range(10)]
    rows += [(10.1, 0, 1, 3, 2), (10.2, 0, 0, 1, 2), (10.3, 0, 1, 3, 2), (15, 0, 0, 1, 2)]
    streams = ResultStreams.of(events(rows), Tpcs.of(STATIC))
    (stream,) = streams.streams
    assert stream.changes.tolist() == pytest.approx([10.1, 15.0])


def test_streams_are_worked_out_once_for_a_table():
    table: Events = events(gate_case())
    tpcs = Tpcs.of(STATIC)
    assert ResultStreams.of(table, tpcs) is ResultStreams.of(table, Tpcs.of(STATIC))
    fewer = Tpcs.of(static_info(comparison(0, "~gate")))
    assert len(ResultStreams.of(table, fewer).streams) == 1
