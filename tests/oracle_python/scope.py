"""What a piece of a made program can use, and the lines that are written so far."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field


@dataclass
class Scope:
    """Expressions by their kind.

    ``numbers`` have a number as value, ``targets`` can be assigned one. ``calls`` are patterns with
    places for two numbers. ``truths`` are variables with outcomes, ``lists`` and ``tables`` hold
    numbers (tables at ``a`` and ``b``). ``can_return``: in a function; ``loops``: how many around.
    """

    numbers: list[str]
    targets: list[str] = field(default_factory=list)
    calls: list[str] = field(default_factory=list)
    truths: list[str] = field(default_factory=list)
    lists: list[str] = field(default_factory=list)
    tables: list[str] = field(default_factory=list)
    publishers: list[str] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)
    can_return: bool = False
    loops: int = 0
    can_yield: bool = False

    def inner(self) -> Scope:
        """The same for a block in it; what the block adds is not seen outside."""
        lists = {
            name: list(value) if isinstance(value, list) else value
            for name, value in vars(self).items()
        }
        return Scope(**lists)


class Lines:
    """Lines of a module, with their depth."""

    def __init__(self) -> None:
        """Nothing."""
        self.lines: list[str] = []
        self.depth = 0

    def add(self, text: str) -> None:
        """A line at the current depth."""
        self.lines.append("    " * self.depth + text)

    @contextmanager
    def block(self, head: str) -> Iterator[None]:
        """A compound statement; ``pass`` stands in it where nothing else does."""
        self.add(head)
        self.depth += 1
        before = len(self.lines)
        yield
        if len(self.lines) == before:
            self.add("pass")
        self.depth -= 1

    def text(self) -> str:
        """The module."""
        return "\n".join(self.lines) + "\n"
