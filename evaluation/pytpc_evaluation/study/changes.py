"""What was changed on a robot before a mission, newest last; the harmless changes among it.

Every mission has decoys: other parameters that were changed by as much as the treatments' are, and
do no harm. So neither "what was changed last", nor "what was changed most", nor "what differs from
the good run" is a trivial answer.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Iterable, Mapping
from dataclasses import asdict
from hashlib import sha256
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError
from pytpc.recording.parameter_change import Change
from pytpc.values.recording import read_parameters
from pytpc_evaluation.demo.demo_examples import Example
from pytpc_evaluation.treatment import Treatment

CHANGES_FILE = "changes.json"
DECOYS = 8
_LIST = "decoys"
_FIELDS = ("parameter", "node", "new")


def harmless_changes(example: Example) -> dict[Change, frozenset[str]]:
    """The changes that may be decoys, and with which treatments they may not: ``study.json``.

    In the example's file ``decoys`` is a list; an entry has ``parameter`` (``~name``), ``node`` and
    ``new``, a number; the old value is that of the robot's own file. None is the simulator's, which
    is the world. ``not_with`` may name treatments whose error was not seen together with it: what
    does no harm may still hide another's. Without a file there is none.

    Raises:
        InputError: the file is no such list, or an entry changes no number of this robot's nodes.
    """
    path = example.study
    if not path.exists():
        return {}
    document = parse_json(path)
    entries = document.get(_LIST, []) if isinstance(document, dict) else None
    if not isinstance(entries, list):
        raise InputError(f"{_LIST} is not a list", path)
    own = read_parameters(example.parameters)
    treatments = {one.name for one in example.all_treatments()}
    found: dict[Change, frozenset[str]] = {}
    names: set[tuple[str, str]] = set()
    for number, entry in enumerate(entries, 1):
        try:
            change, not_with = _harmless(entry, own)
            if (change.node, change.parameter) in names:
                raise ValueError(f"{change.parameter} is there twice")
            if change.node == example.simulator:
                raise ValueError(f"{change.node} is the world")
            if not_with - treatments:
                raise ValueError(f"there is no treatment {min(not_with - treatments)}")
        except ValueError as error:
            raise InputError(f"{_LIST}, entry {number}: {error}", path) from error
        names.add((change.node, change.parameter))
        found[change] = not_with
    return found


def _harmless(entry: object, own: Mapping[str, object]) -> tuple[Change, frozenset[str]]:
    if not isinstance(entry, dict) or sorted({*entry} - {"not_with"}) != sorted(_FIELDS):
        raise ValueError(f"an object with {', '.join(_FIELDS)} is expected")
    parameter, node = entry["parameter"], entry["node"]
    if not isinstance(parameter, str) or not parameter.startswith("~") or not isinstance(node, str):
        raise ValueError("parameter is ~name, and node a text")
    full = f"{node}/{parameter[1:]}"
    old, new = _number(own.get(full)), _number(entry["new"])
    if old is None or new is None or old == new:
        what = "changes no number of this robot"
        raise ValueError(f"{full} {own.get(full)!r} -> {entry['new']!r} {what}")
    not_with = entry.get("not_with", [])
    if not isinstance(not_with, list) or not all(isinstance(name, str) for name in not_with):
        raise ValueError("not_with is no list of treatments")
    return Change(parameter, node, old, new), frozenset(not_with)


def _number(value: object) -> float | None:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value)


def drawn_changes(
    system: str, treatment: Treatment, seed: int, among: Mapping[Change, Collection[str]]
) -> tuple[Change, ...]:
    """The changes of a mission in a drawn order, newest last: decoys, and the treatment's own.

    Everything is drawn by SHA-256 of ``SYSTEM/TREATMENT/SEED`` and the parameter, so that it is the
    same everywhere and at any time. No decoy is called like the changed parameter.

    Args:
        system: the robot's name.
        treatment: its changed parameter is none of the decoys, and is among the changes.
        seed: of the mission.
        among: see ``harmless_changes``.
    """
    drawn = f"{system}/{treatment.name}/{seed}"
    own = (treatment.parameter or "").lstrip("~/")
    others = [
        one
        for one, not_with in among.items()
        if one.parameter.lstrip("~") != own and treatment.name not in not_with
    ]
    changes = sorted(others, key=lambda c: _hash(f"{drawn}{c.node}{c.parameter}"))[:DECOYS]
    if treatment.parameter is not None and treatment.old is not None and treatment.new is not None:
        node = treatment.node or ""
        changes.append(Change(treatment.parameter, node, treatment.old, treatment.new))
    return tuple(sorted(changes, key=lambda c: _hash(f"{drawn}/order{c.node}{c.parameter}")))


def _hash(text: str) -> str:
    return sha256(text.encode()).hexdigest()


def save_changes(changes: Iterable[Change], folder: Path) -> None:
    """Write ``changes.json`` into a mission's folder.

    Raises:
        TpcError: it cannot be written.
    """
    text = json.dumps([asdict(change) for change in changes], indent=1)
    write_atomic(folder / CHANGES_FILE, text.encode() + b"\n")
