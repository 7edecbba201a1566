"""The study's page: its numbers against those worked out by hand, and its pictures."""

from __future__ import annotations

import csv
import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import matplotlib.image
import pyarrow.parquet as pq
import pytest
from study_pages import row_of, rows_of

from pytpc_evaluation.study.report.conclusion import conclusion
from pytpc_evaluation.study.report.confidence import Accusations, calibration, false_accusations
from pytpc_evaluation.study.report.drawings import draw_results
from pytpc_evaluation.study.report.making import ReportOptions, make_report
from pytpc_evaluation.study.report.page import wrapped
from pytpc_evaluation.study.report.parts import Part
from pytpc_evaluation.study.report.positions import Position, read_positions
from pytpc_evaluation.study.report.systems import nearness
from pytpc_evaluation.tables import Column, Table
from pytpc_evaluation.treatment import load_treatment

ROOT = Path(__file__).parents[2]
STUDY = ROOT / "docs/study"
OPEN = "interval holds the target"
HALVES = ("tuning", "held-back")


def surest(treatment, seed, confidence, *, kind="type1", labels="confused", **changes):
    """A verdict of a mission; the changed parameter is ~low."""
    right = changes.get("top", "~low") == "~low"
    values = {
        "system": "alpha", "treatment": treatment, "type": kind, "half": "tuning", "seed": seed,
        "labels": labels, "who": "all", "method": "tpc", "position": 1.0 if right else 2.0,
        "parameters": 4, "top": "~low", "confidence": confidence, "marks": 1, **changes,
    }  # fmt: skip
    return Position(**values)


CLEAN = [
    *(surest("clean", 1, 0.85, kind="clean", labels=labels) for labels in ("typed", "untyped")),
    surest("clean", 1, 0.1, kind="clean"),
    surest("clean", 2, 0.1, kind="clean"),
    surest("clean", 3, None, kind="clean", marks=0),
]


# Of two treatments held back: type2_high has its parameter at 1 and 4, so top 1 is 1/2 and top 3 is
# 1/2; the other system's is at 2: 0 and 1. Means 25 % and 75 %; position (2.5 + 2) / 2. Ranks of
# the first: 1 and 1 - 3/4, mean 0.625; of the second: 1 - 1/41. Untyped: 1 and 1.5 (of two, so that
# each is first with 1/2), and 3: top 1 is 3/8, positions (1.25 + 3) / 2. Confused: 3 and no mark at
# all, and 20. No mark is a miss at place (4 + 1) / 2: positions (2.75 + 20) / 2. Drawing two of
# two gives either, both, or the other. Where both are 1 or 0 the other end is 0.16 or 0.84.
def test_the_main_table(study_text):
    heading = "The held-back half"
    assert row_of(study_text, heading, "tpc", "typed") == [
        "2", "25 [0, 50]", "75 [50, 100]", "2.2", "22", "0.80", ">= 90", f"miss, {OPEN}"
    ]  # fmt: skip
    assert row_of(study_text, heading, "tpc", "untyped") == [
        "2", "38 [0, 75]", "100 [16, 100]", "2.1", "22", "0.94", ">= 80", f"hit, {OPEN}"
    ]  # fmt: skip
    assert row_of(study_text, heading, "tpc", "confused")[:4] == [
        "2",
        "0 [0, 84]",
        "25 [0, 50]",
        "11.4",
    ]
    # 3.5, which two share, and 2, and 30.
    assert row_of(study_text, heading, "thesis", "typed")[:4] == [
        "2",
        "0 [0, 84]",
        "38 [0, 75]",
        "16.4",
    ]
    # At 1, and a mission without a mark.
    assert row_of(study_text, "The tuning half", "tpc", "typed")[:3] == [
        "1",
        "50 [50, 50]",
        "50 [50, 50]",
    ]


# With typed marks: the missions of type2_high are 1 against 3.5 (third with 1/2) and 4 against 2:
# better by 1/2, and worse by 1; positions -2.5 and 2, mean -0.25; the other system's is 2 against
# 30. The thesis's
# ranking has no row with other marks.
def test_against_the_baseline(study_text):
    rows = rows_of(study_text, "Better than the thesis's ranking? The held-back half")
    assert rows[1:] == [["tpc", "typed", "38 [-25, 100]", "-14.1"]]


def test_the_groups(study_text):
    by = "Top 3 by {}, the held-back half"
    assert row_of(study_text, by.format("system"), "alpha", "typed")[:2] == ["1", "50 [50, 50]"]
    # From 10 to 30 with the tipping point at 26: 4 beyond, after a way of 16.
    assert row_of(study_text, by.format("tipping point"), "near", "typed")[:2] == [
        "1",
        "50 [50, 50]",
    ]
    assert row_of(study_text, by.format("tipping point"), "unknown", "typed")[:2] == [
        "1", "100 [2, 100]"
    ]  # fmt: skip
    assert row_of(study_text, by.format("language"), "C++", "untyped")[:2] == [
        "2",
        "100 [16, 100]",
    ]
    # Users 1 and 2 alone: 1 and 4 with the first seed; none with the second, and none in the other
    # system: 1/4 and 0.
    assert row_of(study_text, by.format("number of users"), "1 user", "typed")[0] == "12 [0, 25]"
    every = "Positions in every mission, untyped marks"
    assert row_of(study_text, every, "alpha", "type2_high", "held-back", "1") == ["3", "4", "1.0"]
    assert row_of(study_text, every, "alpha", "type2_high", "held-back", "2") == ["3", "4", "1.5"]


def test_confidence(study_text, made_study):
    # Held back, confused marks: 0.1 and 0.2 of two treatments, both wrong: 0.15 in the mean, 0.1 or
    # 0.2 where one alone is drawn. Of the other half there are only typed ones.
    tables = made_study.numbers["tables"]
    found = {
        half: [
            (row["verdicts"], row["treatments"], row["mean confidence"], row["share right"])
            for row in tables[f"reliability-tpc-{half}"]["rows"]
        ]
        for half in ("held-back", "tuning")
    }
    assert found == {"held-back": [(1, 1, 0.1, 0.0), (1, 1, 0.2, 0.0)], "tuning": []}
    said = "Calibration error 0.15 [0.10, 0.20]. Bins of fewer than 5 treatments are not drawn."
    assert said in study_text.replace("\\", "")
    heading = "Confident verdicts"
    assert row_of(study_text, heading, "changed parameter", "tpc", "held-back", "typed") == [
        "3",
        "3",
        "2",
        "1",
    ]
    assert row_of(study_text, heading, "changed parameter", "tpc", "tuning", "typed") == [
        "2",
        "1",
        "1",
        "1",
    ]
    clean = {half: row_of(study_text, heading, "clean", "tpc", half, "typed") for half in HALVES}
    assert clean == {"tuning": ["1", "1", "0", "0"], "held-back": ["1", "0", "0", "0"]}
    assert row_of(study_text, "Clean missions and faults", "alpha", "fault_wires")[-2:] == [
        "0.85",
        "yes",
    ]


# Three parameters are compared in C++, one in Python (by the analysis, not by the file's name).
def test_the_systems(study_text):
    assert row_of(study_text, "What was done", "alpha") == [
        "1", "-", "4", "4", "3", "3", "1", "4", "7"
    ]  # fmt: skip


# 8 -> 5: at 7 two beyond after a way of one; at 6 one after two, half of it; at 5.5 0.5 after 2.5.
@pytest.mark.parametrize(("tipping", "word"), [(7, "far"), (6, "far"), (5.5, "near"), (None, None)])
def test_near_and_far(study, tmp_path, tipping, word):
    folder = Path(shutil.copytree(study / "missions/alpha/type1_low/seed-1", tmp_path / "m"))
    document = json.loads((folder / "treatment.json").read_text())
    (folder / "treatment.json").write_text(json.dumps({**document, "tipping": tipping}))
    assert nearness(load_treatment(folder)) == word


# Of the second round is the other system's treatment alone.
def test_the_result(study_text, made_study):
    tables = made_study.numbers["tables"]
    names = ("marks", "among the first", "target", "thesis", "tpc", "verdict on tpc")

    def rows(part):
        found = tables[f"result-{part}"]["rows"]
        return [tuple(row[name] for name in names) for row in found]

    assert rows("held-back")[:2] == [
        ("typed", 1, None, "0 [0, 84]", "25 [0, 50]", None),
        ("typed", 3, ">= 90", "38 [0, 75]", "75 [50, 100]", f"miss, {OPEN}"),
    ]
    assert rows("second-round") == [
        ("typed", 1, None, "0 [0, 98]", "0 [0, 98]", None),
        ("typed", 3, ">= 90", "0 [0, 98]", "100 [2, 100]", f"hit, {OPEN}"),
        ("untyped", 1, None, "-", "0 [0, 98]", None),
        ("untyped", 3, ">= 80", "-", "100 [2, 100]", f"hit, {OPEN}"),
        ("confused", 1, None, "-", "0 [0, 98]", None),
        ("confused", 3, ">= 80", "-", "0 [0, 98]", f"miss, {OPEN}"),
    ]
    assert {row["tpc+reference"] for row in tables["result-held-back"]["rows"]} == {"-"}
    assert row_of(study_text, "The second round alone", "tpc", "untyped")[:4] == [
        "1", "0 [0, 98]", "100 [2, 100]", "3.0"
    ]  # fmt: skip


def test_without_a_second_round_there_is_no_part_of_it(own_study, tmp_path):
    path = own_study / "missions/image_capture/type2_min_coverage_limit/seed-1/treatment.json"
    treatment = json.loads(path.read_text())
    del treatment["round"]
    path.write_text(json.dumps(treatment))
    made = make_report(own_study, tmp_path / "study.md", ReportOptions(draw=False))
    assert "second round alone" not in made.page.read_text()
    assert not any("second-round" in one["name"] for one in made.numbers["figures"])


# Rows of the table that were written before there were rounds are of the first one, ties are those
# of their places: 1.5 is shared by two.
def test_a_table_of_the_first_round_is_read(own_study):
    path = own_study / "results/positions.parquet"
    table = pq.read_table(path)
    pq.write_table(table.drop_columns(["tied", "round"]), path)
    rows = read_positions(path)
    assert {row.round for row in rows} == {1}
    assert [row.within(1) for row in rows if row.position == 1.5] == [0.5]


def test_the_headlines(made_study):
    found = {one["name"]: (one["value"], one["hit"]) for one in made_study.numbers["figures"]}
    assert found == {
        "top3-typed-held-back": (75.0, False),
        "top3-typed-thesis-held-back": (37.5, False),
        "top3-untyped-held-back": (100.0, True),
        "top3-confused-held-back": (25.0, False),
        "suggestions-gone-held-back": (25.0, False),
        "suggestions-gone-none-new-held-back": (25.0, False),
        "suggestions-gone-smallest-held-back": (100.0, True),
        "suggestions-gone-none-new-smallest-held-back": (0.0, False),
        "top3-typed-second-round": (100.0, True),
        "top3-typed-thesis-second-round": (0.0, False),
        "top3-untyped-second-round": (100.0, True),
        "top3-confused-second-round": (0.0, False),
        "suggestions-gone-second-round": (0.0, False),
        "suggestions-gone-none-new-second-round": (0.0, False),
        "top3-typed-tuning": (50.0, False),
        "suggestions-gone-tuning": (0.0, False),
        "suggestions-gone-none-new-tuning": (0.0, False),
        "accusations-clean-tuning": (0, True),
        "accusations-fault-tuning": (1, False),
    }


# A mission is accused once, by whichever labels; those without marks could not be. (1 - p)^1 is
# 0.025 for p = 0.975.
def test_accusations_are_told_of_missions_that_have_marks(study_text):
    assert false_accusations(CLEAN, "tuning", "clean", "tpc") == Accusations(1, 2, 3)
    assert Accusations(1, 2, 3).said == (
        "1 of 2 missions with marks (of 3); up to 99 % cannot be ruled out"
    )
    told = study_text.replace("\\", "")
    assert (
        "| Confident accusations on clean missions, tuning half |"
        " 0 of 1 mission with marks (of 1); up to 98 % cannot be ruled out | 0 | hit |" in told
    )


# Five treatments make a bar, of two verdicts each; in the bin of four there is none. 0.9 is 0.1 too
# little of 10, 0.5 is 0.5 too much of 4: 3 of 14.
def test_sparse_bins_are_not_drawn(tmp_path):
    rows = [surest(f"a{n}", seed, 0.9) for n in range(5) for seed in (1, 2)]
    few = [surest(f"b{n}", 1, 0.5, top="~high") for n in range(4)]
    found = calibration([*rows, *few], "tuning", "tpc")
    assert [(one.verdicts, one.treatments) for one in found.bins] == [(4, 4), (10, 5)]
    assert [one.verdicts for one in found.drawn] == [10]
    assert found.error.value == pytest.approx(3 / 14)
    part = Part("tuning", "tuning half", "tuning")
    names = {one.file for one in draw_results([*rows, *few], tmp_path, [part])}
    assert names == {"top3-tuning.png", "confidence-tuning-tpc.png"}
    assert {one.file for one in draw_results(few, tmp_path, [part])} == {"top3-tuning.png"}


def test_links_and_pictures_are_there_and_small(made_study):
    for page in (made_study.page, made_study.page.parent / "study/tables.md"):
        links = re.findall(r"\]\(([^):#]+)\)", page.read_text())
        assert len(links) > 5
        for link in links:
            committed = ROOT / "docs" / page.parent.relative_to(made_study.page.parent) / link
            assert (page.parent / link).exists() or committed.resolve().exists(), link
    for path in made_study.files:
        if path.suffix == ".png":
            assert path.stat().st_size < 150_000
            assert matplotlib.image.imread(path).shape[1] >= 400


def test_lines_of_prose_are_short(made_study):
    for page in (made_study.page, made_study.page.parent / "study/tables.md"):
        lines = page.read_text().splitlines()
        assert all(len(line) <= 120 or line.startswith(("|", "!")) for line in lines)
    # The second line of a point stands below its text; a link is not broken.
    point = "1. " + "word " * 23 + "a-very-long-word [link](which/nobody/breaks)"
    first, second = wrapped(point).splitlines()
    assert first == "1. " + "word " * 22 + "word"
    assert second == "   a-very-long-word [link](which/nobody/breaks)"
    assert wrapped("| " + "x " * 100) == "| " + "x " * 100


# The shares are those of confused marks, without their intervals.
def test_the_conclusion():
    methods = ("tpc", "random", "differs-at-random", "turned-decisions")
    columns = tuple(Column(heading, 0) for heading in ("Labels", *methods))
    four = ("confused", *(f"{share} [0, 99]" for share in (34, 4, 39, 71)))
    rows = (("1 user", four), ("all users", four))
    tables = {"users-held-back": Table("", "", columns, rows, (), "Marks of")}

    def observer(*shares):
        methods = ("tpc", "tpc+2-runs", "tpc+reference", "thesis", "tpc-log")
        rows = [(m, ("1 [0, 2]", f"{one} [0, 99]")) for m, one in zip(methods, shares, strict=True)]
        columns = Column("Top 1 %", 0), Column("Top 3 %", 0)
        return Table("", "", columns, tuple(rows), (), "Method")

    tables["observer-held-back"] = observer(20, 69, 70, 16, 11)
    tables["observer-second-round"] = observer(21, 66, 67, 17, 12)
    said = conclusion(tables).splitlines()
    assert len(said) == 4
    assert all(line.endswith(".") for line in said)
    assert "that they mark, from the log of that mission alone" in said[0]
    assert "in 20 % of the held-back treatments" in said[0]
    assert "in 69 % with two good runs of other settings, and in 70 %" in said[0]
    assert "ranking has 16 %; without the defaults in the code it is 11 %" in said[1]
    assert "it is 34 % from the log alone; chance finds 4 %" in said[2]
    assert "decisions 71 %" in said[2]
    assert "second round alone, which nobody" in said[3]
    assert "21 % from the log alone and 66 % with two good runs" in said[3]
    tables["observer-third-round"] = observer(22, 65, 66, 18, 13)
    assert "third round alone, which nobody" in conclusion(tables).splitlines()[3]
    assert conclusion({"users-held-back": tables["users-held-back"]}) == ""
    # Nothing is known of a method: percent() gives a dash.
    silent = observer(22, 65, 66, 18, 13)
    rows = tuple((name, (row[0], "-")) for name, row in silent.rows)
    assert conclusion({**tables, "observer-held-back": replace(silent, rows=rows)}) == ""


def test_twice_the_same(study, made_study, tmp_path):
    again = make_report(study, tmp_path / "study.md")
    assert again.page.read_bytes() == made_study.page.read_bytes()
    assert [path.name for path in again.files] == [path.name for path in made_study.files]
    for one, other in zip(again.files, made_study.files, strict=True):
        assert one.read_bytes() == other.read_bytes(), one.name


def test_one_half_alone(study, tmp_path):
    made = make_report(study, tmp_path / "study.md", ReportOptions(["tuning"]))
    text = made.page.read_text()
    assert "Only the tuning half of the results is shown." in text
    assert "The held-back half" not in text
    assert "type2" not in json.dumps(made.numbers["tables"]["alpha-found-compared"])
    assert not any("type2" in path.name for path in made.files)
    assert "type2_high" not in (tmp_path / "study/alpha-found.csv").read_text()
    assert all(one["name"].endswith("-tuning") for one in made.numbers["figures"])


# What the repository keeps of the study: the page, its figures, the positions, the judgings.
def test_the_committed_study_agrees_with_itself():
    text = (ROOT / "docs/study.md").read_text().replace("\\", "")
    flat = " ".join(text.split())
    figures = {one["name"]: one for one in json.loads((STUDY / "figures.json").read_text())}
    for name, one in figures.items():
        assert one["shown"] in flat, name
    said = flat.split("Result")[0]
    for name in ("", "-chance", "-chance-of-different"):
        share = figures[f"top3-confused{name}-held-back"]["shown"].split(" ")[0]
        assert f" {share} %" in said, name
    # Places that are shared count by halves and thirds, so the share of whole places is near it.
    with (STUDY / "positions-confused.csv").open() as stream:
        rows = [row for row in csv.DictReader(stream) if row["half"] == "held-back"]
    found = [row["tpc+reference"] in {"1", "2", "3"} for row in rows]
    share = figures["top3-confused-with-clean-run-held-back"]["value"]
    assert 100 * sum(found) / len(found) == pytest.approx(share, abs=3)
    judged = json.loads((STUDY / "judged.json").read_text())
    times = f"from {judged[0]['time']} to {judged[-1]['time']}"
    states = len({one["digest"] for one in judged})
    said = f"was judged {len(judged)} times, {times}, by {states} states of the methods."
    assert said in flat
    # A treatment's two seeds; faults and clean missions are in no table of positions.
    assert (len(rows), max(one["missions"] for one in judged)) == (124, 124 + 6 + 3)
