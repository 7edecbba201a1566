"""``getattr`` and ``setattr``; an unknown name means all attributes that fit it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pytpc.python_analysis.ir.instructions import Instr
from pytpc.python_analysis.ir.names import NamePattern, attribute_named
from pytpc.python_analysis.points_to.call_table import Given
from pytpc.python_analysis.points_to.objects import ATTRIBUTES, UNNAMED, Obj

if TYPE_CHECKING:
    from pytpc.python_analysis.points_to.points_to import PointsTo


def by_name(flow: PointsTo, instr: Instr, path: str, given: list[Given]) -> None:
    """What ``instr``, a call of the builtin ``path``, reads or writes."""
    if len(given) < 2:
        return
    owner, known = given[0][1], attribute_named(given[1][1])
    if path == "builtins.getattr":
        flow.when(owner, lambda found: _read(flow, found, known, instr))
        if len(given) > 2:
            flow.copy(given[2][1], instr)
    elif len(given) > 2:
        value = given[2][1]
        flow.when(owner, lambda found: _write(flow, found, known, value, instr))


def _write(flow: PointsTo, owner: Obj, known: str | NamePattern, value: Instr, at: Instr) -> None:
    if isinstance(known, str):
        flow.store_attribute(owner, known, value, at)
    elif owner.kind == "instance":
        flow.write(owner, UNNAMED, value, at)


def _read(flow: PointsTo, owner: Obj, known: str | NamePattern, at: Instr) -> None:
    if isinstance(known, str):
        flow.load_attribute(owner, known, at)
    elif owner.kind == "instance" and not known.start and not known.end:
        flow.copy(flow.slot(owner, ATTRIBUTES), at)
    elif owner.kind == "instance":
        for name in flow.program.attributes:
            if known.takes(name):
                flow.load_attribute(owner, name, at)
