"""What is declared of a parameter: its type, range and step (dynamic_reconfigure, descriptors)."""

from __future__ import annotations

from dataclasses import dataclass

from pytpc.words import Number


@dataclass(frozen=True, slots=True)
class Declared:
    """One declaration.

    ``type`` is ``bool``, ``int``, ``double`` or ``str``; ``choices`` are the values of an
    enumeration with their names. ``place`` is ``file:line``, or the topic that said so.
    """

    parameter: str
    type: str
    low: Number | None
    high: Number | None
    step: Number | None
    default: Number | str | None
    choices: tuple[tuple[str, Number | str], ...]
    description: str
    place: str
