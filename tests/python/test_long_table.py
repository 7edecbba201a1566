"""Long tables are printed by our own code, which must print what rich prints."""

from __future__ import annotations

import io
from unittest import mock

from hypothesis import given, settings
from hypothesis import strategies as st
from rich.console import Console

from pytpc.cli import long_table
from pytpc.cli.console import table_of
from pytpc.cli.long_table import LONG, print_table

HEADINGS = ("Parameter", "Distance", "Place", "Source line")
RIGHT = ("Distance",)
WORD = st.text("ab_/.:<", min_size=1, max_size=30) | st.sampled_from(["größe", "速度", "x" * 90])
TEXT = st.lists(WORD, max_size=6).map(" ".join) | st.text("ab  \t\x1b", max_size=12)


def printed(rows: list[tuple[str, ...]], width: int) -> tuple[str, str]:
    """What we print, and what rich prints."""
    texts = []
    for ours in (True, False):
        out = Console(width=width, file=io.StringIO(), force_terminal=False)
        if ours:
            print_table(out, HEADINGS, rows, RIGHT)
        else:
            out.print(table_of(HEADINGS, rows, RIGHT), highlight=False)
        assert isinstance(out.file, io.StringIO)
        texts.append(out.file.getvalue())
    return texts[0], texts[1]


@settings(max_examples=100, deadline=None)
@given(
    st.lists(st.tuples(TEXT, st.integers(0, 9999).map(str), TEXT, TEXT), min_size=1),
    st.sampled_from([80, 120, 160]),
)
def test_a_long_table_is_that_of_rich(rows: list[tuple[str, ...]], width: int) -> None:
    # How a row is printed does not depend on how many there are.
    with mock.patch.object(long_table, "LONG", 1):
        ours, theirs = printed(rows, width)
    assert ours == theirs


def test_a_long_table_folds_a_place_that_is_too_long() -> None:
    rows = [("~p", "3", "package/src/" + "f" * 200 + ".cpp:7", "if (a > b)")] * LONG
    ours, theirs = printed(rows, 80)
    assert ours == theirs
    assert all(len(line) == 80 for line in ours.splitlines())
