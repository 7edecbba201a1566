"""Objects of the classes that ``collections.namedtuple`` makes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pytpc.python_analysis.ir.instructions import Instr
from pytpc.python_analysis.points_to.call_table import Given

if TYPE_CHECKING:
    from pytpc.python_analysis.points_to.points_to import PointsTo


def named_tuple(flow: PointsTo, instr: Instr, site: Instr, given: list[Given]) -> None:
    """An object of a class that ``collections.namedtuple`` made at ``site``."""
    names: list[object] = []
    if len(site.args) > 2:
        words = site.args[2]
        names = [part.data for part in words.args]
        if isinstance(words.data, str) and words.op == "const":
            names = list(words.data.replace(",", " ").split())
    made = flow.heap.made("collections.namedtuple.__call__", instr)
    flow.add(instr, [made])
    for place, (keyword, value) in enumerate(given):
        name = keyword or (names[place] if place < len(names) else None)
        if isinstance(name, str):
            flow.write(made, name, value, instr)
        if name in names:
            flow.write(made, f"[{names.index(name)}]", value, instr)
