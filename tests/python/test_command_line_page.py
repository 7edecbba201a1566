"""The page of the command line has every command, and every field of the JSON documents."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest
from click.testing import CliRunner

from pytpc.cli.main import SUMMARIES, main

ROOT = Path(__file__).parents[2]
EXAMPLE = str(ROOT / "examples/recorded_mission")
STATIC = ("--static", f"{EXAMPLE}/static.json")
PAGE = (ROOT / "docs/reference/command-line.md").read_text()
WORDS = set(re.findall(r"`([\w-]+)`", PAGE))
RUNS = {
    "marks": (EXAMPLE,),
    "rank": (EXAMPLE, *STATIC, "--top", "1"),
    "suggest": (EXAMPLE, *STATIC, "--top", "1"),
    "stats": (EXAMPLE, *STATIC, "--table", "confusion"),
    "watch": (EXAMPLE, *STATIC, "--top", "1"),
}
# Objects whose fields stand elsewhere, or are names of columns.
ELSEWHERE = {"suggestion", "remedy", "what_if", "declared", "together", "rows", "summary"}


def fields(value: object) -> Iterator[str]:
    """The names of all fields, but for those within what is described elsewhere."""
    if isinstance(value, list):
        for one in value:
            yield from fields(one)
    if isinstance(value, dict):
        for name, one in value.items():
            yield name
            if name not in ELSEWHERE:
                yield from fields(one)


def test_every_command_is_on_the_page():
    assert set(SUMMARIES) <= WORDS


@pytest.mark.parametrize(("name", "words"), RUNS.items(), ids=list(RUNS))
def test_every_field_is_on_the_page(name: str, words: Sequence[str]):
    result = CliRunner().invoke(main, [name, *words, "--json"])
    assert result.exit_code == 0
    document = json.loads(result.stdout)
    assert document
    assert set(fields(document)) <= WORDS
