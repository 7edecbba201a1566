"""Tables of the study's page, read back."""

from __future__ import annotations

import re


def rows_of(text: str, heading: str) -> list[list[str]]:
    """The cells of the last table below a heading of the page, without the line of dashes."""
    below = text.split(f"# {heading}\n")[1].split("\n#", maxsplit=1)[0]
    tables = re.findall(r"(?:^\|.*\n?)+", below, re.MULTILINE)
    lines = tables[-1].replace("\\|", "/").replace("\\", "").strip().splitlines()
    return [
        [cell.strip() for cell in line.strip("|").split("|")] for line in (lines[0], *lines[2:])
    ]


def row_of(text: str, heading: str, *beginning: str) -> list[str]:
    """The cells after ``beginning`` of the only row with it."""
    found = [r for r in rows_of(text, heading) if r[: len(beginning)] == list(beginning)]
    assert len(found) == 1, (heading, beginning, rows_of(text, heading))
    return found[0][len(beginning) :]
