"""The static information of a script whose comparisons are known, for the Python hook."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

Position = tuple[str, int, int]
"""File, line and column, from one."""


def key(number: int) -> str:
    """That of a comparison, by its number."""
    return f"{number:08x}-0000-5000-8000-000000000001"


def static_of(script: Path, text: str, line: str, others: Iterable[Position] = ()) -> str:
    """The comparison in ``line`` of the script's text, whose threshold is on the right.

    Args:
        script: where the script is.
        text: what is in it.
        line: has the compared value first, behind white space and a keyword.
        others: comparisons of other files, which come behind it.
    """
    code = line.strip()
    column = len(line) - len(code) + code.index(" ") + 2
    here = (script.name, text.splitlines().index(line) + 1, column)
    comparisons = [
        {
            "key": key(number),
            "relation": ">",
            "file": file,
            "lineno": lineno,
            "column": at,
            "name": "limit",
            "operand": "right",
            "source_code": code,
        }
        for number, (file, lineno, at) in enumerate([here, *others], 1)
    ]
    unit = {
        "link_unit": script.stem,
        "source_root": str(script.parent),
        "comparisons": comparisons,
    }
    return json.dumps({"schema": 1, "units": [unit]})
