"""Rounds of suggestions for a study of one mission: what is asked for, taken in and written."""

from __future__ import annotations

import json
from dataclasses import replace

import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner
from mission_samples import comparison, events, ns, static_info
from study_flights import made

from pytpc.base.errors import InputError
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording, save_recording
from pytpc_evaluation.commands.study_suggestions import suggestions_command
from pytpc_evaluation.study.case import Verdict
from pytpc_evaluation.study.dataset import save_done
from pytpc_evaluation.study.plan import Setting
from pytpc_evaluation.study.suggested import FAILED_FILE, TRIED_FILE
from pytpc_evaluation.study.suggestion_chains import FIX_RUNS, VARIANTS, Chain, Try, shares
from pytpc_evaluation.study.suggestions import HEADLINE_FILE, Asked, next_round

MISSION = "robot/type1_limit/seed-1"
TOLD = Asked(variants=[name for name in VARIANTS if name not in FIX_RUNS])
OTHER = "~other"
USER_MARK = ("time_ns", "observer", "cause", "right", "said")


def log(threshold, cmps=None):
    """A counter that the program acts on at the threshold, and a flag that stays as it is."""
    cmps = range(threshold + 1) if cmps is None else cmps
    rows = [(90 + n, 0, cmp >= threshold, cmp, threshold) for n, cmp in enumerate(cmps)]
    rows += [(90 + n, 1, False, 0, 0, "/pump") for n in range(5)]
    end = 90 + len(cmps)
    return Recording("m", events(rows, "/brain"), (Mark(ns(end), "I"),), 0, ns(end))


@pytest.fixture
def out(tmp_path):
    """A counter with a threshold of 3 for 25: the log 0, 1, 2, 3."""
    mission = {"system": "robot", "treatment": "type1_limit", "type": "type1", "half": "tuning"}
    values = {"parameter": "~limit", "node": "/brain", "old": 25, "new": 3}
    rows = [{**mission, **values, "seed": 1}, {**mission, **values, "seed": 2}]
    (tmp_path / "study.json").write_text(json.dumps({"missions": rows}))
    static = tmp_path / "systems" / "robot"
    static.mkdir(parents=True)
    flag = comparison(1, OTHER, "flag", default=False)
    static_info(comparison(0, "~limit", ">=", default=25), flag).save(static / "static.json")
    save(tmp_path / "missions" / MISSION, log(3))
    (tmp_path / "missions" / MISSION / "treatment.json").write_text(
        json.dumps({**values, "type": "type1"})
    )
    save(tmp_path / "reference" / "robot", log(25, range(10)))
    people_say(tmp_path, (94, "II"))
    return tmp_path


def people_say(out, *said):
    """The marks of one user at so many seconds, with the type that was said; I is right."""
    table = [
        {"time_ns": ns(time), "observer": "user1", "cause": 0, "right": "I", "said": kind}
        for time, kind in said
    ]
    columns = {name: [one[name] for one in table] for name in USER_MARK}
    pq.write_table(pa.table(columns), out / "missions" / MISSION / "marks.parquet")


def save(folder, recording):
    folder.mkdir(parents=True, exist_ok=True)
    save_recording(recording, folder)
    (folder / "done.json").write_text("{}")


def fly(out, value, *, gone, new=False, parameter="~limit", node="/brain"):
    """What `pytpc study suggested` leaves."""
    folder = out / "suggested" / MISSION / Setting(parameter, node, float(value)).label
    save(folder, log(value))
    errors = [] if gone and not new else ["I: too early"]
    said = {"parameter": parameter, "value": value, "gone": gone, "new": new, "errors": errors}
    (folder / "suggestion.json").write_text(json.dumps(said))


def wanted(out):
    return json.loads((out / "results" / "suggestions-wanted.json").read_text())


# The smallest change is to 4. Three times the way is 9, so it lasts from 10 on; from that log five
# times the way, 50: 51. The default and the good run have 25. Seed 2 has not been flown. Who is
# told nothing suspects the counter, too: what was flown for the others is not flown again.
def test_rounds(out):
    next_round(out, TOLD)
    first = {"system": "robot", "treatment": "type1_limit", "seed": 1}
    first |= {"parameter": "~limit", "node": "/brain"}
    assert wanted(out) == [{**first, "value": value} for value in (4, 10, 25)]
    fly(out, 4, gone=False)
    fly(out, 10, gone=False)
    next_round(out, TOLD)
    assert wanted(out) == [{**first, "value": value} for value in (51, 25)]
    # Asked again before it was flown, it stays so.
    next_round(out, TOLD)
    assert wanted(out) == [{**first, "value": value} for value in (51, 25)]
    fly(out, 51, gone=True)
    fly(out, 25, gone=True, new=True)
    chains = next_round(out, TOLD)
    assert wanted(out) == []
    assert all(chain.is_over for chain in chains)
    rows = pq.read_table(out / "results" / "suggestion-tries.parquet").to_pylist()
    told = [(row["variant"], row["tries"], row["value"], row["gone"]) for row in rows]
    assert told == [
        ("smallest", 1, 4, False),
        ("lasting", 1, 10, False),
        ("lasting", 2, 51, True),
        ("with-default", 1, 25, True),
        ("with-reference", 1, 25, True),
        ("ranked", 1, 10, False),
        ("ranked-reference", 1, 25, True),
    ]
    assert [row["basis"] for row in rows[3:]] == ["default", "reference", "growth", "reference"]
    assert [row["new_error"] for row in rows] == [False, False, False, True, True, False, True]
    assert rows[0]["reason"] == "I: too early"
    (headline,) = pq.read_table(out / "results" / "suggestions.parquet").to_pylist()
    assert (headline["value"], headline["gone"], headline["new"]) == (10, False, False)


# Of the first nothing is known. The second is a flag that never changed, so that no mark of type
# I is about it; the third is the counter. Its value is that of the chain `lasting`: one flight.
def test_suspects_are_tried_in_turn(out):
    method = lambda _: Verdict(("<dynamic> at a.cpp:1", OTHER, "~limit"))  # noqa: E731
    asked = replace(TOLD, method=method)
    chains = next_round(out, asked)
    tries = next(chain.tries for chain in chains if chain.variant == "suspects")
    assert [one.reason for one in tries] == [
        "only the running node knows its name",
        "its result did not change before the mark",
        "",
    ]
    assert (tries[2].parameter, tries[2].node, tries[2].value) == ("~limit", "/brain", 10)
    fly(out, 10, gone=True)
    chains = next_round(out, asked)
    assert [one.variant for one in chains if one.is_over] == ["lasting", "ranked", "suspects"]


# A mission in which only the flag was asked, and it never changed; the mark is of what was said.
# Beside a good run in which all is the same it is none of the parameters.
def test_the_ranking_may_say_that_it_is_none_of_them(out):
    quiet = Recording("m", log(25, range(10)).events, (), 0, ns(100))
    save(out / "missions" / MISSION, quiet)
    (chain,) = next_round(out, Asked(variants=["ranked"]))
    (only,) = chain.tries
    assert (only.parameter, only.value) == ("", None)
    assert only.reason.startswith("none of the parameters comes first: ")
    assert wanted(out) == []
    # The error counts as still there.
    assert shares([chain])[0].gone == 0


# Neither the treatment nor the right type is known: what is said of them changes nothing.
def test_who_is_told_nothing(out):
    path = out / "missions" / MISSION / "treatment.json"
    told = {**json.loads(path.read_text()), "parameter": OTHER, "node": "/pump", "type": "type2"}
    path.write_text(json.dumps(told))
    chains = next_round(out, Asked(variants=["ranked", "ranked-reference"]))
    found = [(one.tries[0].parameter, one.tries[0].node, one.tries[0].value) for one in chains]
    assert found == [("~limit", "/brain", 10), ("~limit", "/brain", 25)]
    assert wanted(out)[0]["value"] == 10


# 10 was flown for the other chain, 51 after it. The values are still those; nothing is flown.
def test_asked_anew(out):
    next_round(out, Asked(variants=["lasting", "ranked"]))
    fly(out, 10, gone=False)
    next_round(out)
    fly(out, 51, gone=True)
    chains = next_round(out, Asked(variants=["ranked"], again=True))
    ranked = next(chain for chain in chains if chain.variant == "ranked")
    assert [(one.value, one.gone) for one in ranked.tries] == [(10, False)]


def failed(out, times):
    """What `pytpc study suggested` leaves where the flight of 10 fails."""
    one = {"mission": MISSION, "digest": "", "parameter": "~limit", "node": "/brain", "value": 10.0}
    text = json.dumps([{**one, "times": times, "failure": "the brain died"}])
    (out / FAILED_FILE).write_text(text)


def test_a_flight_that_always_fails_is_given_up(out):
    next_round(out, Asked(variants=["lasting", "ranked"]))
    failed(out, 1)
    chains = next_round(out, Asked(variants=["lasting", "ranked"]))
    assert not any(chain.is_over for chain in chains)
    failed(out, 2)
    chains = next_round(out, Asked(variants=["lasting", "ranked"]))
    assert all(chain.is_over for chain in chains)
    assert wanted(out) == []
    told = {(one.gone, one.new_error, one.failed, one.reason) for c in chains for one in c.tries}
    assert told == {(False, None, True, "the flight failed 2 times: the brain died")}
    # The error counts as still there; the page says why.
    assert [(one.treatments, one.gone, one.open) for one in shares(chains)] == [(1, 0, 0)] * 4
    (row,) = pq.read_table(out / HEADLINE_FILE).to_pylist()
    assert (row["gone"], row["new"]) == (False, None)
    assert row["failure"] == "the flight failed 2 times: the brain died"
    said = CliRunner().invoke(suggestions_command, ["--out", str(out), "--variant", "lasting"])
    assert "type1_limit/seed-1, ranked: the flight failed 2 times" in said.stderr


# The next suspect needs no log of a flight.
def test_the_next_suspect_is_tried_where_a_flight_fails(out):
    method = lambda _: Verdict(("~limit", OTHER))  # noqa: E731
    next_round(out, Asked(method=method, variants=["suspects"]))
    failed(out, 2)
    (chain,) = next_round(out, Asked(method=method, variants=["suspects"]))
    assert [one.parameter for one in chain.tries] == ["~limit", OTHER, ""]


def test_a_half_that_is_not_asked_about_is_not_looked_at(out):
    assert next_round(out, Asked(["held-back"])) == []
    assert wanted(out) == []


# Without the smallest change the first flight is that of the value to try.
def test_one_variant(out):
    (chain,) = next_round(out, Asked(variants=["lasting"]))
    assert (chain.variant, wanted(out)[0]["value"]) == ("lasting", 10)


def test_nobody_marked(out):
    recording = log(3)
    save(out / "missions" / MISSION, Recording("m", recording.events, (), 0, recording.end_ns))
    people_say(out)
    chains = next_round(out)
    assert [chain.tries[0].reason for chain in chains] == ["nobody set a mark"] * 8
    assert wanted(out) == []
    # The error is still there.
    assert [share.gone for share in shares(chains)][:2] == [0, 0]


def chain(treatment, seed, *gone):
    tries = [Try("p", None, 1.0, None, one, False) for one in gone]
    return Chain("robot", treatment, "type1", "tuning", seed, "lasting", 1.0, 2.0, (), tries)


# Treatment a: of its two seeds one at once and one by the second try; b by neither of three.
def test_shares():
    found = shares(
        [chain("a", 1, True), chain("a", 2, False, True), chain("b", 1, False, False, False)]
    )
    assert [(one.tries, one.treatments, one.gone) for one in found] == [
        (1, 2, 0.25),
        (2, 2, 0.5),
        (3, 2, 0.5),
    ]


# One that waits for its second flight counts for the first try alone.
def test_shares_while_flights_are_left():
    waits = chain("a", 1, False)
    waits.tries.append(Try("p", None, 1.0, None))
    found = shares([waits])
    assert [(one.tries, one.treatments, one.open) for one in found] == [
        (1, 1, 0), (2, 0, 1), (3, 0, 1),
    ]  # fmt: skip
    assert found[1].gone is None


def test_the_command(out):
    result = CliRunner().invoke(suggestions_command, ["--out", str(out), "--variant", "smallest"])
    assert result.exit_code == 0, result.output
    assert "1 mission to fly" in result.output
    shown = CliRunner().invoke(suggestions_command, ["--out", str(out), "--json"])
    assert json.loads(shown.stdout)[0] == {
        "variant": "smallest", "tries": 1, "treatments": 0, "gone": None, "new_error": None,
        "open": 1,
    }  # fmt: skip


# What `study suggested` leaves is of its last flights, of any variant: the headline's table is
# another file, and a value that was not flown yet stands in it.
def test_the_headline_is_written_by_nobody_else(out):
    assert TRIED_FILE != HEADLINE_FILE
    next_round(out, TOLD)
    (row,) = pq.read_table(out / HEADLINE_FILE).to_pylist()
    assert (row["value"], row["gone"], row["new"]) == (10, None, None)


def test_a_mission_that_was_marked_anew_is_asked_about_anew(out):
    asked = Asked(variants=["smallest"])
    save_done(made(marked="people 1"), out / "missions" / MISSION)
    next_round(out, asked)
    fly(out, 4, gone=True)
    assert all(chain.is_over for chain in next_round(out, asked))
    save_done(made(marked="people 2"), out / "missions" / MISSION)
    # What was flown of a mission with other marks says nothing.
    path = out / "suggested" / MISSION / "brain.limit=4.0/suggestion.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), "mission": "1-people 1"}))
    (chain,) = next_round(out, asked)
    assert [one.is_open for one in chain.tries] == [True]
    path.write_text(json.dumps({**json.loads(path.read_text()), "mission": "1-people 2"}))
    (chain,) = next_round(out, asked)
    assert chain.is_over


def test_files_that_are_broken(out):
    (out / "study.json").write_text("{}")
    with pytest.raises(InputError, match="not a study's file"):
        next_round(out)
