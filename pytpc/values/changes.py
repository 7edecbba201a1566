"""Changes made on a robot, from a history or from an earlier dump of the parameters."""

from __future__ import annotations

import math
from pathlib import Path

from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError
from pytpc.recording.parameter_change import Change
from pytpc.values.recording import read_parameters


def read_changes(path: Path) -> tuple[Change, ...]:
    """A history of changes, newest last: a JSON list of ``{parameter, node, old, new}``.

    Raises:
        InputError: it cannot be read, or is no such list.
    """
    document = parse_json(path)
    if not isinstance(document, list):
        raise InputError("not a history of changes: expected a list", path)
    return tuple(_change(one, path) for one in document)


def _change(one: object, path: Path) -> Change:
    if not isinstance(one, dict):
        raise InputError(f"not a history of changes: {one!r} is no object", path)
    parameter, node = one.get("parameter"), one.get("node", "")
    if not isinstance(parameter, str) or not isinstance(node, str):
        raise InputError("not a history of changes: parameter and node are texts", path)
    return Change(parameter, node, _number(one, "old", path), _number(one, "new", path))


def _number(one: dict[str, object], name: str, path: Path) -> float:
    value = one.get(name)
    found = _float(value)
    if math.isnan(found):
        raise InputError(f"not a history of changes: {name} is no number", path)
    return found


def changes_between(before: Path, after: Path) -> tuple[Change, ...]:
    """The differences between two dumps of the parameters (params.yaml), by full names, sorted.

    Where a value is no number, or is in one of them only, it is nan.

    Raises:
        InputError: one cannot be read, or they have no parameter in common.
    """
    old, new = read_parameters(before), read_parameters(after)
    if not old.keys() & new.keys():
        raise InputError(f"has no parameter in common with {after}", before)
    return tuple(
        Change(name, "", _float(old.get(name)), _float(new.get(name)))
        for name in sorted({*old, *new})
        if repr(old.get(name)) != repr(new.get(name))
    )


def _float(value: object) -> float:
    try:
        return float(value) if isinstance(value, int | float) else math.nan
    except OverflowError:
        return math.nan
