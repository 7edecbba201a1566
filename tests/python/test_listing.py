"""Rows for a terminal of any width: names and paths stay whole."""

from __future__ import annotations

import io

import pytest
from rich.console import Console
from rich.text import Text

from pytpc.cli.console import console
from pytpc.present.listing import Heading, Listing, broken

HEADINGS = (Heading("#", right=True, in_line=True), Heading("Parameter", in_line=True),
            Heading("Value", right=True), Heading("Compared at"))  # fmt: skip
ROWS = (
    (Text("1"), Text("~min_coverage_limit"), Text("0.058"), Text("src/logic.cpp:21\nif (a > b)")),
    (Text("2="), Text("~rate"), Text("3"), Text("")),
)


def shown(width, *, one_line=False):
    out = io.StringIO()
    Console(file=out, width=width, force_terminal=True, color_system=None).print(
        Listing(HEADINGS, ROWS, one_line=one_line)
    )
    return [line.rstrip() for line in out.getvalue().splitlines()]


# The longest words have 2, 19, 5 and 16 columns, and 2 stand behind each: 42 + 8 = 50.
def test_a_table_has_room_for_its_longest_words():
    assert shown(50) == [
        " #  Parameter            Value  Compared at",
        " 1  ~min_coverage_limit  0.058  src/logic.cpp:21",
        "                                if (a > b)",
        "2=  ~rate                    3",
    ]


def test_in_a_narrow_terminal_each_row_is_a_block():
    assert shown(49) == [
        "1  ~min_coverage_limit",
        "   Value: 0.058",
        "   Compared at: src/logic.cpp:21",
        "     if (a > b)",
        "2=  ~rate",
        "   Value: 3",
    ]


def test_piped_each_row_is_a_line():
    _, first, second = shown(200, one_line=True)
    assert first == " 1  ~min_coverage_limit  0.058  src/logic.cpp:21  if (a > b)"
    assert second == "2=  ~rate                    3"


@pytest.mark.parametrize(
    ("text", "width", "lines"),
    [
        ("src/a/long/path.cpp:7", 12, ["src/a/long/", "path.cpp:7"]),
        ("at src/a/long/path.cpp:7", 21, ["at src/a/long/path.cpp:7"]),
        ("abcdefgh", 3, ["abc", "def", "gh"]),
        ("/a", 1, ["/", "a"]),
        ("", 5, [""]),
    ],
)
def test_a_word_that_is_longer_than_the_terminal_is_broken_behind_a_slash(text, width, lines):
    assert broken(Text(text), width).plain.split("\n") == lines


def test_piped_output_has_no_width_and_no_filling(capsys):
    word = "x" * 5000
    out = console()
    out.print(Listing(HEADINGS[:2], [(Text("1"), Text(word)), (Text("2"), Text("y"))]))
    assert capsys.readouterr().out.splitlines() == [
        "#  Parameter", f"1  {word}", "2  y",
    ]  # fmt: skip
