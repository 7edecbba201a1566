"""What came of suggestions, on the study's page."""

from __future__ import annotations

import json

import pytest
from study_pages import row_of, rows_of
from study_samples import suggestions, write_rows

from pytpc_evaluation.study.report.folder import load_study
from pytpc_evaluation.study.report.making import ReportOptions, make_report
from pytpc_evaluation.study.report.parts import Part
from pytpc_evaluation.study.report.repairs import gone, read_repairs

OPEN = "interval holds the target"
HELD_BACK = Part("held-back", "held-back half", "held-back")


# type2_high: gone in one of two; of the other system nothing was suggested, which counts: 1/4. A
# new error in one of the two that were flown.
def test_suggestions(study_text):
    heading = "Suggestions, flown"
    alone = "Missions flown again"
    every = study_text.split(f"## {heading}")[1].replace("\\", "")
    assert "| all | held-back | 2 | 25 [0, 50] | 50 [50, 50] | >= 80 | miss |" in every
    assert row_of(study_text, alone, "alpha", "type2_high", "held-back", "2") == [
        "~high", "10", "26", "30", "~high", "12", "still there", "yes"
    ]  # fmt: skip
    assert (
        row_of(study_text, alone, "alpha", "type1_low", "tuning", "1")[-2]
        == "nothing was suggested"
    )
    assert "The headline is the variant `lasting` with one try" in every


# Of type2_high, which is of type II, the first error of the second seed is of type I, that of the
# first one is not; one that came later says nothing. There the error was not gone: 0 of 1.
def test_where_the_first_error_is_another_one_it_is_told_apart(own_study, tmp_path):
    other = {"kind": "I", "start": 12.0, "end": 12.0, "reason": "it jumps"}
    right = {"kind": "II", "start": 11.0, "end": 20.0, "reason": "it stands"}
    for seed, causes in ((1, [other, right]), (2, [other])):
        path = own_study / f"missions/alpha/type2_high/seed-{seed}/causes.json"
        path.write_text(json.dumps(causes))
    made = make_report(own_study, tmp_path / "study.md", ReportOptions(draw=False))
    rows = [row for row in made.numbers["tables"]["repairs"]["rows"] if row["part"] == "held-back"]
    assert [(row["treatments of"], row["treatments"], row["error gone %"]) for row in rows] == [
        ("all", 2, "25 [0, 50]"),
        ("type II", 2, "25 [0, 50]"),
        ("first error of another type", 1, "0 [0, 98]"),
    ]


# Of the two seeds of type2_high one is helped by the first try, the other by the second; its first
# flight had a new error. The smallest change took the error away and made another one. The flight
# after the first of type1_low is still to come: it counts for one try alone.
def test_suggestions_by_variant(study_text):
    heading = "All ways to suggest"
    assert rows_of(study_text, heading)[0][:4] == ["Variant", "Part", "Tries", "Treatments"]
    assert row_of(study_text, heading, "lasting (headline)", "held-back", "1") == [
        "1", "50 [50, 50]", "50 [50, 50]", "50 [50, 50]", "0", ">= 80", "miss"
    ]  # fmt: skip
    assert row_of(study_text, heading, "lasting", "held-back", "2") == [
        "1", "100 [2, 100]", "0 [0, 98]", "100 [2, 100]", "0", ">= 80", f"hit, {OPEN}"
    ]  # fmt: skip
    assert row_of(study_text, heading, "smallest", "held-back", "1") == [
        "1", "100 [2, 100]", "100 [2, 100]", "0 [0, 98]", "0", ">= 80", f"hit, {OPEN}"
    ]  # fmt: skip
    assert row_of(study_text, heading, "lasting (headline)", "tuning", "1")[:2] == [
        "1",
        "0 [0, 98]",
    ]
    assert row_of(study_text, heading, "lasting", "tuning", "2") == [
        "0", "-", "-", "-", "1", ">= 80", "-"
    ]  # fmt: skip


def test_suggestions_by_variant_of_one_half(study, tmp_path):
    made = make_report(study, tmp_path / "study.md", ReportOptions(["tuning"], draw=False))
    assert {row["part"] for row in made.numbers["tables"]["tries"]["rows"]} == {"tuning"}


# A chain of the ranking's first parameter, which was flown in vain, beside the other variants.
def test_what_is_ranked_first_is_told_apart(own_study, tmp_path):
    path = own_study / "results/suggestion-chains.json"
    chains = json.loads(path.read_text())
    (first,) = [one for one in chains if one["variant"] == "smallest"]
    ranked = {**first["tries"][0], "gone": False, "new_error": False}
    chains += [{**first, "variant": "ranked", "tries": [ranked]}, {**first, "variant": "another"}]
    path.write_text(json.dumps(chains))
    made = make_report(own_study, tmp_path / "study.md", ReportOptions(draw=False))
    rows = [r for r in made.numbers["tables"]["tries"]["rows"] if r["part"] == "held-back"]
    assert [(r["variant"], r["tries"], r["error gone %"]) for r in rows] == [
        ("smallest", 1, "100 [2, 100]"),
        ("lasting (headline)", 1, "50 [50, 50]"),
        ("lasting", 2, "100 [2, 100]"),
        ("lasting", 3, "100 [2, 100]"),
        ("ranked", 1, "0 [0, 98]"),
        ("another", 1, "100 [2, 100]"),
    ]
    found = {one["name"]: one["value"] for one in made.numbers["figures"]}
    assert found["suggestions-gone-smallest-held-back"] == 100.0
    assert found["suggestions-gone-none-new-smallest-held-back"] == 0.0
    assert found["suggestions-gone-ranked-held-back"] == 0.0
    assert "suggestions-gone-ranked-reference-held-back" not in found


def test_broken_chains_are_said(own_study, tmp_path):
    (own_study / "results/suggestion-chains.json").write_text('[{"tries": 1}]')
    made = make_report(own_study, tmp_path / "study.md", ReportOptions(draw=False))
    assert any("suggestion-chains.json is left out" in trouble for trouble in made.troubles)


# With the second seed the error is gone. With the first none was seen before, so that the treatment
# has 1 (and the other system's 0, mean 1/2); or the flight failed or was not flown, so that it has
# 1/2 (mean 1/4).
@pytest.mark.parametrize(
    ("failure", "said", "mean"),
    [
        ("", "none was seen before", 0.5),
        ("it died", "the flight failed", 0.25),
        ("", "still to be flown", 0.25),
    ],
)
def test_suggestions_that_cannot_be_judged(study, tmp_path, failure, said, mean):
    flights = [flight for system in load_study(study).systems for flight in system.flights]
    first, second = suggestions()
    new = False if said == "none was seen before" else None
    first |= {"gone": None, "new": new, "failure": failure}
    write_rows(tmp_path / "results/s.parquet", [first, second | {"gone": True}])
    rows = read_repairs(tmp_path / "results/s.parquet", flights)
    told = {(row.flight.treatment.name, row.flight.seed): row.said for row in rows}
    assert told == {
        ("type1_low", 1): "nothing was suggested",
        ("type1_low", 2): "nothing was suggested",
        ("type2_high", 1): said,
        ("type2_high", 2): "gone",
        ("type2_min_coverage_limit", 1): "nothing was suggested",
    }
    assert gone(rows, HELD_BACK).value == mean
