"""The tables of a study against those of the thesis: what its own rows give by its definitions.

The rows are those printed in the thesis (6.5.2 to 6.5.5). They are rounded, so that what follows
from them may differ from what is printed by half of the last digit, of a sum by that for each row.
"""

from __future__ import annotations

import pytest

from pytpc.diagnosis.scores.scores import NONE
from pytpc.recording.marks import MarkType
from pytpc_evaluation.stats.delays import DelaysOfTrial, delays_table
from pytpc_evaluation.stats.found import FoundAtMark, FoundInTrial, found_table
from pytpc_evaluation.stats.marked import MarksOfTrial, confusion_table, marks_table
from pytpc_evaluation.stats.runtime import RuntimeRow, RuntimeStatistics, runtime_table
from pytpc_evaluation.tables import Table, shown

# Table 6.12: locations, comparisons, frequency, runtime %, flops, true %, false %.
RUNTIME = """
collapse deadband 1 17833 28.37 95 0 100 0
enable baro ctrl mode 2 35633 56.69 95 0 100 0
enable derv fir filter 1 17439 27.74 95 0 100 0
enable pitch ctrl 1 17831 28.37 95 0 0 100
enable roll ctrl 2 17835 28.37 96 0 0 100
enable thrust ctrl 1 17833 28.37 95 0 0 100
enable thrust iir filter 1 17833 28.37 95 0 100 0
enable yaw ctrl 2 17836 28.38 96 0 0 100
face detection threshold 2 6700 10.66 59 23 58.55 41.45
gps enable mode 1 17833 28.37 95 0 0 100
max coverage limit 8 7188 11.44 29 0 66.44 33.56
max pkt size 1 64884 103.22 99 12 99.99 0.01
max selfie count 4 16554 26.34 72 673 81.71 18.29
min coverage limit 4 4707 7.49 29 57 47.27 52.73
min displacement 1 6183 9.84 99 81 63.72 36.28
min land height 1 132 0.21 2 5 96.21 3.79
min z displacement 1 2243 3.57 41 8 7.09 92.91
selfie control rate 1 5 0.01 0 0 100 0
waypose idle timeout 1 617 0.98 98 18 90.28 9.72
"""


def cells(table: Table, name: str) -> tuple:
    """The cells of a row, or of one of the last rows."""
    return dict((*table.rows, *table.summary))[name]


def runtime_rows() -> tuple[RuntimeRow, ...]:
    rows = []
    for line in RUNTIME.strip().splitlines():
        *name, locations, comparisons, frequency, runtime, flops, true, false = line.split()
        rows.append(
            RuntimeRow(
                " ".join(name),
                int(locations),
                int(comparisons),
                float(frequency),
                float(runtime),
                int(flops),
                float(true),
                float(false),
            )
        )
    return tuple(rows)


# As printed: mean, median, deviation of a sample, minimum, maximum, sum. Of 19 rounded rows a sum
# may be 19 * 0.005 off, and what is printed half of the last digit.
@pytest.mark.parametrize(
    ("name", "printed"),
    [
        ("mean", (1.89, 15111.53, 24.04, 72.89, 46.16, 58.49, 41.51)),
        ("median", (1, 17439, 27.74, 95, 0, 66.44, 33.56)),
        ("std", (1.76, 15106.26, 24.03, 34.87, 153.36, 43, 43)),
        ("minimum", (1, 5, 0.01, 0, 0, 0, 0)),
        ("maximum", (8, 64884, 103.22, 99, 673, 100, 100)),
        ("sum", (36, 287119, 456.78, 1385, 877, 1111.27, 788.73)),
    ],
)
def test_the_last_rows_of_table_6_12_follow_from_its_rows(name, printed):
    rows = runtime_rows()
    table = runtime_table(RuntimeStatistics(rows, 6, 628.6, 61, 36, 41))
    slack = 19 * 0.005 if name == "sum" else 0.01
    assert cells(table, name) == pytest.approx(printed, abs=slack)


# 287119 / 628.6 = 456.76 a second; 877 / 287119 = 0.305 %; 36 / 61 = 59.0 %.
def test_what_the_text_says_of_table_6_12():
    table = runtime_table(RuntimeStatistics(runtime_rows(), 6, 628.6, 61, 36, 41))
    first, second = table.notes
    assert first.startswith("36 of 61 locations (59.0 %)")
    assert second == "287,119 comparisons, 456.8 a second; 0.31 % of them are flops."


# Table 6.15: treatment, then marks of type I and type II of the users 1 to 4.
MARKS = [
    ("type1", (0, 3, 0, 1, 0, 2, 0, 2)),
    ("type1", (0, 3, 0, 2, 0, 0, 2, 2)),
    ("type2", (6, 1, 3, 1, 0, 0, 10, 1)),
    ("type2", (2, 7, 3, 3, 0, 0, 2, 12)),
    ("fault", (3, 5, 1, 3, 0, 0, 2, 11)),
    ("fault", (0, 6, 0, 2, 0, 0, 0, 9)),
    ("clean", (0, 0, 0, 0, 0, 0, 0, 0)),
    ("clean", (2, 1, 1, 1, 0, 0, 2, 0)),
]
USERS = ["User 1", "User 2", "User 3", "User 4"]


def marks_of_trials() -> list[MarksOfTrial]:
    kinds: tuple[MarkType, MarkType] = ("I", "II")
    return [
        MarksOfTrial(
            f"Trial {number}",
            kind,
            {
                user: dict(zip(kinds, row[2 * n : 2 * n + 2], strict=True))
                for n, user in enumerate(USERS)
            },
        )
        for number, (kind, row) in enumerate(MARKS, start=1)
    ]


# Of the first trial 3 + 1 + 2 + 2 of type II, of the second 0 + 0 + 0 + 2 and 3 + 2 + 0 + 2, as
# printed in the last two columns.
def test_the_totals_of_table_6_15():
    table = marks_table(marks_of_trials(), USERS)
    totals = [row[-2:] for _, row in table.rows]
    assert totals == [(0, 8), (2, 7), (19, 3), (7, 22), (6, 19), (0, 17), (0, 0), (5, 2)]
    assert [column.key for column in table.columns][-3:] == [
        "user 4 type ii",
        "total type i",
        "total type ii",
    ]


# As printed, two digits each; half digits (1.625) are printed cut off or rounded to even.
@pytest.mark.parametrize(
    ("name", "printed"),
    [
        ("mean", (1.62, 3.25, 1, 1.62, 0, 0.25, 2.25, 4.62, 4.88, 9.75)),
        ("median", (1, 3, 0.50, 1.50, 0, 0, 2, 2, 3.50, 7.50)),
        ("std", (2.13, 2.55, 1.31, 1.06, 0, 0.71, 3.28, 5.13, 6.38, 8.45)),
        ("minimum", (0, 0, 0, 0, 0, 0, 0, 0, 0, 0)),
        ("maximum", (6, 7, 3, 3, 0, 2, 10, 12, 19, 22)),
        ("sum", (13, 26, 8, 13, 0, 2, 18, 37, 39, 78)),
    ],
)
def test_the_last_rows_of_table_6_15_follow_from_its_rows(name, printed):
    table = marks_table(marks_of_trials(), USERS)
    assert cells(table, name) == pytest.approx(printed, abs=0.006)


def test_table_6_13_follows_from_table_6_15():
    table = confusion_table(marks_of_trials())
    assert table.rows == (("Treatment Type I", (2, 15)), ("Treatment Type II", (26, 25)))
    # 15 + 26 of 2 + 15 + 26 + 25; the others are 6 + 19 + 17, and 5 + 2.
    assert table.notes == (
        "41 of 68 marks are of the wrong type.",
        "42 marks in 2 trials with a fault in the source.",
        "7 marks in 2 trials with nothing changed.",
    )


# Table 6.14. The last two means are printed 10.47 and 7.19: 31.43 / 3 = 10.477, 21.59 / 3 = 7.197.
def test_the_means_of_table_6_14_follow_from_its_rows():
    trials = [
        DelaysOfTrial("1.1", 0.0, dict(zip(USERS, (11.69, 25.07, 11.45, 21.63), strict=True))),
        DelaysOfTrial("1.2", 0.0, {"User 1": 3.12, "User 2": 3.78, "User 4": 0.96}),
        DelaysOfTrial("2.1", 0.0, {"User 1": 6.99, "User 2": 12.37, "User 4": 12.07}),
        DelaysOfTrial("2.2", 0.0, {"User 1": 1.71, "User 2": 9.97, "User 4": 9.91}),
    ]
    table = delays_table(trials, USERS)
    means = [row[-1] for _, row in table.rows]
    assert means == pytest.approx([17.46, 2.62, 10.47, 7.19], abs=0.01)
    assert shown(table, table.rows[1][1]) == ["0.00", "3.12", "3.78", "-", "0.96", "2.62"]


# Table 6.16 says rank 0.15 and score 8181.87 of the 22 marks of type II in treatment 2, trial 2.
# 18 without a score and four of 0.735: (18 * 9999.9 + 4 * 0.735) / 22 = 180001.14 / 22 = 8181.87;
# four of rank 0.825: 3.3 / 22 = 0.15. None of its 7 marks of type I had a score: 0.00 and 9999.90.
# Over all 29 marks no score between 0 and 1 would give that mean: 24 * 9999.9 / 29 = 8275.8.
def test_table_6_16_is_over_the_marks_of_each_type():
    marks = [FoundAtMark("II", 0.0, NONE)] * 18 + [FoundAtMark("II", 0.825, 0.735)] * 4
    marks += [FoundAtMark("I", 0.0, NONE)] * 7
    table = found_table([FoundInTrial("Treatment 2 Trial 2", tuple(marks))])
    assert shown(table, table.rows[0][1]) == ["7", "0.00", "9999.90", "22", "0.15", "8181.87"]


# Treatment 1, trial 1 has no mark of type I; what is printed for it is no mean of anything.
def test_without_marks_of_a_type_there_is_no_mean():
    table = found_table([FoundInTrial("Treatment 1 Trial 1", (FoundAtMark("II", 0.8, 0.74),) * 8)])
    assert shown(table, table.rows[0][1]) == ["0", "-", "-", "8", "0.80", "0.74"]
