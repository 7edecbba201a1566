"""What is declared of a parameter: its type, range and step (dynamic_reconfigure, descriptors)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from pytpc.parameters import same_parameter
from pytpc.scoring.ranking import Suspect
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


def declared_for(declared: Sequence[Declared], suspect: Suspect) -> Declared | None:
    """What is declared of the parameter of a suspect; None where nothing is, or not one thing.

    Where several declarations have its name, those of the suspect's package count.
    """
    same = [one for one in declared if same_parameter(one.parameter, suspect.parameter)]
    meanings = {replace(one, description="", place="") for one in same}
    return same[0] if len(meanings) == 1 else None
