"""Whether an entry of a list of Python nodes stands on its place in the source."""

from __future__ import annotations

from pathlib import Path

from suite.expectations import Entry
from suite.places import comparisons, values

_MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}


def wrong_with(entry: Entry, package: Path) -> str | None:
    """What is wrong with an entry's place, text or relation."""
    source = (package / entry.file).read_text("utf-8")
    assert entry.column is not None
    place = (entry.line, entry.column)
    here = [
        operator for at, text, operator in comparisons(source) if (at, text) == (place, entry.text)
    ]
    if not here:
        if (place, entry.text) not in values(source):
            return "no expression of this text begins here"
        # min and max compare inside; a value pattern and the end of a range do, too.
        inside = {None, "flag", "<", "<=", ">", ">=", "==", "!="}
        return None if entry.relation in inside else "not such a relation"
    if entry.relation not in (None, here[0], _MIRRORED.get(here[0], here[0])):
        return f"the operator is {here[0]}"
    return None
