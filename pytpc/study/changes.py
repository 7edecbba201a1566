"""What was changed on a robot before a mission, newest last; the harmless changes among it.

Every mission has decoys: parameters that are a little off, so that neither "what was changed last"
nor "what differs from the clean run" is a trivial answer.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from hashlib import sha256
from pathlib import Path

from pytpc.atomic import write_atomic
from pytpc.changes import Change
from pytpc.demo_examples import Example
from pytpc.errors import InputError
from pytpc.parameters import same_parameter
from pytpc.static_info import StaticInfo
from pytpc.static_json import parse_json
from pytpc.treatment import Treatment
from pytpc.values.recording import read_parameters

CHANGES_FILE = "changes.json"
DECOYS = 5
_PART = 0.03
_EXCEPTIONS_FILE = "study.json"
_EXCEPTIONS = "never_decoys"


@dataclass(frozen=True, slots=True, order=True)
class Candidate:
    """A parameter that may be a decoy: whose it is, its name below that node, its value."""

    node: str
    name: str
    value: float

    @property
    def full(self) -> str:
        """The name on the parameter server."""
        return f"{self.node}/{self.name}"


def candidates(example: Example, static: StaticInfo) -> tuple[Candidate, ...]:
    """The parameters of a robot that a decoy may change, sorted.

    They are numbers with a fraction that are not 0 and are compared somewhere. The simulator's are
    none: it is the world. Those of the example's own list are none: to change them does harm.

    Raises:
        InputError: the robot's file of parameters, or its list, cannot be read.
    """
    compared = {found.source for found in static.thresholds.values() if found.source is not None}
    never = never_decoys(example)
    found = set()
    for full, value in read_parameters(example.parameters).items():
        _, node, name = full.split("/", 2) if full.count("/") > 1 else ("", "", full)
        one_of_a_node = node and f"/{node}" != example.simulator
        if not one_of_a_node or not isinstance(value, float) or value == 0.0:
            continue
        if full not in never and any(same_parameter(full, source) for source in compared):
            found.add(Candidate(f"/{node}", name, value))
    return tuple(sorted(found))


def never_decoys(example: Example) -> frozenset[str]:
    """The full names of the parameters that no decoy may change: ``study.json`` of the example.

    There they stand as ``~name``, ``name`` or ``/node/name``.

    Raises:
        InputError: the file is no such list, or a name in it is that of no parameter.
    """
    path = example.folder / _EXCEPTIONS_FILE
    if not path.exists():
        return frozenset()
    document = parse_json(path)
    names = document.get(_EXCEPTIONS, []) if isinstance(document, dict) else None
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise InputError(f"{_EXCEPTIONS} is not a list of texts", path)
    known = read_parameters(example.parameters)
    found: set[str] = set()
    for name in names:
        meant = {full for full in known if _means(name, full)}
        if not meant:
            raise InputError(f"{_EXCEPTIONS}: {name} is no parameter of this robot", path)
        found |= meant
    return frozenset(found)


def _means(name: str, full: str) -> bool:
    return full == name if name.startswith("/") else full.split("/", 2)[-1] == name.lstrip("~")


def drawn_changes(
    system: str, treatment: Treatment, seed: int, among: Sequence[Candidate]
) -> tuple[Change, ...]:
    """The changes of a mission in a drawn order, newest last: decoys, and the treatment's own.

    Everything is drawn by SHA-256 of ``SYSTEM/TREATMENT/SEED`` and the parameter, so that it is the
    same everywhere and at any time. No decoy is called like the changed parameter.

    Args:
        system: the robot's name.
        treatment: its changed parameter is none of the decoys, and is among the changes.
        seed: of the mission.
        among: see ``candidates``.
    """
    drawn = f"{system}/{treatment.name}/{seed}"
    others = [one for one in among if one.name != (treatment.parameter or "").lstrip("~/")]
    chosen = sorted(others, key=lambda one: _hash(f"{drawn}{one.full}"))[:DECOYS]
    changes = [_decoy(one, drawn) for one in chosen]
    if treatment.parameter is not None and treatment.old is not None and treatment.new is not None:
        node = treatment.node or ""
        changes.append(Change(treatment.parameter, node, treatment.old, treatment.new))
    return tuple(sorted(changes, key=lambda c: _hash(f"{drawn}/order{c.node}{c.parameter}")))


def _decoy(one: Candidate, drawn: str) -> Change:
    sign = 1 if int(_hash(f"{drawn}/sign{one.full}"), 16) % 2 else -1
    # Nine digits: nobody sees where the third of a percent ended.
    return Change(
        f"~{one.name}", one.node, one.value, float(f"{one.value * (1 + sign * _PART):.9g}")
    )


def _hash(text: str) -> str:
    return sha256(text.encode()).hexdigest()


def save_changes(changes: Iterable[Change], folder: Path) -> None:
    """Write ``changes.json`` into a mission's folder.

    Raises:
        TpcError: it cannot be written.
    """
    text = json.dumps([asdict(change) for change in changes], indent=1)
    write_atomic(folder / CHANGES_FILE, text.encode() + b"\n")
