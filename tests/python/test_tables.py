"""The one writer of tables: groups, notes, what is not known, characters that mean something."""

from __future__ import annotations

import csv
import io
import json

import pytest
from rich.console import Console

from pytpc_evaluation.tables import (
    Column,
    Table,
    as_csv,
    as_json,
    as_latex,
    as_markdown,
    as_rich,
    statistics,
)

TABLE = Table(
    "marks",
    "Marks & more",
    (
        Column("Type I", 0, group="User_1"),
        Column("Type II", 0, group="User_1"),
        Column("Share", 2, name="share %"),
    ),
    (("a_1|b", (1, 2, 0.125)), ("c", (None, 3, float("nan")))),
    (("mean", (1.0, 2.5, 0.125)),),
    first="Trial",
    statistic_digits=2,
    notes=("50 % of them.",),
)


def printed(table: Table, width: int) -> str:
    out = Console(file=io.StringIO(), width=width, color_system=None)
    for part in as_rich(table, width):
        out.print(part)
    return out.file.getvalue()  # type: ignore[attr-defined]


def test_csv():
    rows = list(csv.reader(io.StringIO(as_csv(TABLE))))
    assert rows == [
        ["trial", "user_1 type i", "user_1 type ii", "share %"],
        ["a_1|b", "1", "2", "0.125"],
        ["c", "", "3", "nan"],
        ["mean", "1", "2.5", "0.125"],
    ]


def test_json_has_no_nan():
    found = json.loads(json.dumps(as_json(TABLE), allow_nan=False))
    assert found["rows"][0] == {
        "trial": "a_1|b",
        "user_1 type i": 1,
        "user_1 type ii": 2,
        "share %": 0.125,
    }
    assert found["rows"][1] == {
        "trial": "c",
        "user_1 type i": None,
        "user_1 type ii": 3,
        "share %": None,
    }
    assert (found["label"], found["title"], found["notes"]) == (
        "marks",
        "Marks & more",
        ["50 % of them."],
    )
    assert found["summary"][0]["user_1 type ii"] == 2.5


# A user may be called as a column of ours is, or differ from another in capitals alone.
def test_no_column_takes_the_place_of_another():
    users = [Column("Type I", 0, group=user) for user in ("Ann", "ann", "total", "Total")]
    table = Table("marks", "Marks", tuple(users), (("a", (1, 2, 3, 6)),), (), first="Trial")
    named = {"trial": "a", "ann type i 2": 1, "ann type i": 2, "total type i 2": 3}
    assert as_json(table)["rows"] == [{**named, "total type i": 6}]
    heading, _ = csv.reader(io.StringIO(as_csv(table)))
    assert heading == [*named, "total type i"]


def test_markdown():
    assert as_markdown(TABLE).splitlines() == [
        r"| Trial | User\_1 Type I | User\_1 Type II | Share |",
        "| --- | --: | --: | --: |",
        r"| a\_1\|b | 1 | 2 | 0.12 |",
        "| c | - | 3 | nan |",
        "| *mean* | 1 | 2.50 | 0.12 |",
        "",
        "50 % of them.",
    ]


def test_markdown_texts_begin_at_the_left_and_numbers_do_not():
    columns = (Column("Word", 0), Column("Number", 0), Column("Nothing", 0))
    table = Table("t", "T", columns, (("a", ("x", 1, None)), ("b", (None, 2, None))), ())
    assert as_markdown(table).splitlines()[1] == "| --- | --- | --: | --: |"


def test_latex_has_the_groups_above_their_columns():
    lines = as_latex(TABLE).splitlines()
    place = lines.index(r" & \multicolumn{2}{c}{User\_1} & \multicolumn{1}{c}{} \\")
    assert lines[place + 1] == r"\cmidrule(lr){2-3}"
    assert lines[place + 2] == (
        r"Trial & \shortstack[r]{Type\\I} & \shortstack[r]{Type\\II} & Share \\"
    )
    assert r"\caption{Marks \& more}\label{tab:marks}\\" in lines
    assert r"a\_1|b & 1 & 2 & 0.12 \\" in lines
    assert lines[-2:] == [r"\noindent 50 \% of them.\par", "}"]
    assert r"\midrule" not in as_latex(Table("t", "T", (), (), ())).split(r"\endlastfoot")[1]


def test_a_wide_table_is_split_and_nothing_is_left_out():
    columns = tuple(Column(f"H{n}", 0, group=f"a long group {n}") for n in range(20))
    table = Table("t", "T", columns, (("the name of a row", tuple(range(100, 120))),), ())
    for width in (40, 80, 200):
        text = printed(table, width)
        assert all(len(line) <= width for line in text.splitlines())
        words = text.split()
        assert [word for word in words if word[0] == "H"] == [f"H{n}" for n in range(20)]
        assert [word for word in words if word[0] == "1" and len(word) == 3] == [
            str(n) for n in range(100, 120)
        ]
        assert text.count("the name of a row") == len(as_rich(table, width))
    assert len(as_rich(TABLE, 80)) == 1


def test_a_terminal_sees_no_control_characters_and_no_markup():
    evil = Table(
        "t", "T", (Column("[red]h", 0, group="\x1b[2J"),), (("\x1b]0;x\x07[b]", ("\r",)),), ()
    )
    text = printed(evil, 80)
    assert "\x1b" not in text
    assert "\x07" not in text
    assert "[red]h" in text
    assert "[b]" in text


# 2, 4 and 9: mean 5, median 4, deviations -3, -1, 4: sqrt(26 / 2) = 3.6056; without a number none.
def test_statistics():
    found = statistics([2, None, 4.0, "text", 9])
    assert found["std"] == pytest.approx(3.6056, abs=1e-4)
    assert [found[name] for name in ("mean", "median", "min", "max", "sum")] == [5, 4, 2, 9, 15]
    assert set(statistics([None]).values()) == {None}
    assert statistics([7])["std"] is None
