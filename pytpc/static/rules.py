"""The user's own rules: a JSON file with more functions that read or expose."""

from __future__ import annotations

from pathlib import Path

from pytpc.base.checked_json import RULES_SCHEMA, check_schema, parse_json


def check_rules(path: Path) -> None:
    """Check a file of rules against ``schema/rules.schema.json``.

    The plugin checks it again where it links: there a fault is a warning, because a build must not
    break, and the link unit is left as it was.

    Raises:
        InputError: the file cannot be read, is no JSON or breaks the schema, with the place.
    """
    check_schema(parse_json(path), path, RULES_SCHEMA)
