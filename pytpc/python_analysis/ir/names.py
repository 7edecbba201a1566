"""Names of variables, and of attributes as far as they are known before points-to."""

from __future__ import annotations

from dataclasses import dataclass

from pytpc.python_analysis.ir.instructions import Instr, Variable


@dataclass(frozen=True)
class NamePattern:
    """A name with a known beginning and end; both are empty where nothing is known."""

    start: str = ""
    end: str = ""

    def takes(self, name: str) -> bool:
        """True where it may be ``name``."""
        fits = name.startswith(self.start) and name.endswith(self.end)
        return fits and len(name) >= len(self.start) + len(self.end)


def attribute_named(instr: Instr) -> str | NamePattern:
    """A value as a name, or what is known of it: ``"max_" + axis``, ``f"{axis}_limit"``."""
    if instr.op == "const" and isinstance(instr.data, str):
        return instr.data
    is_put_together = (instr.op, instr.data) in (("binary", "Add"), ("build", "text"))
    if not is_put_together or not instr.args:
        return NamePattern()
    first, last = attribute_named(instr.args[0]), attribute_named(instr.args[-1])
    if len(instr.args) == 1:
        return first
    return NamePattern(
        first if isinstance(first, str) else first.start,
        last if isinstance(last, str) else last.end,
    )


def named_variable(instr: Instr) -> str | None:
    """The variable or attribute that an instruction has the value of."""
    if instr.op == "load" and isinstance(instr.data, Variable):
        return None if instr.data.name.startswith("<") else instr.data.name
    if instr.op == "attr":
        owner = named_variable(instr.args[0])
        return f"{owner}.{instr.data}" if owner else str(instr.data)
    if instr.op in ("copy", "item") and instr.args:
        return named_variable(instr.args[0])
    return None
