"""Names of attributes that are put together: what is known of them before anything is solved."""

from __future__ import annotations

from dataclasses import dataclass

from pytpc.pynodes.ir import Instr


@dataclass(frozen=True)
class NamePattern:
    """A name of which the beginning and the end are known; both empty where nothing is."""

    start: str = ""
    end: str = ""

    def takes(self, name: str) -> bool:
        """True where ``name`` may be meant."""
        fits = name.startswith(self.start) and name.endswith(self.end)
        return fits and len(name) >= len(self.start) + len(self.end)


def attribute_named(instr: Instr) -> str | NamePattern:
    """The name that a value is, or what is known of it: ``"max_" + axis``, ``f"{axis}_limit"``."""
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
