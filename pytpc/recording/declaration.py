"""Declarations of parameters, as dynamic_reconfigure makes them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from pytpc.base.wording import Number

_INT_ENDS = (-(2**31), 2**31 - 1)


@dataclass(frozen=True, slots=True)
class Declared:
    """One declaration.

    ``type`` is ``bool``, ``int``, ``double`` or ``str``; ``choices`` are the values of an
    enumeration with their names. ``place`` is ``file:line`` or a topic. ``package`` is the folder
    of the package whose file declares the parameter; empty if a node published it.
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
    package: str = ""


class RawValues(NamedTuple):
    """The values of a declaration as they were read, of any type."""

    low: object
    high: object
    default: object
    description: object


def make_declared(
    name: str, type_: str, said: RawValues, *, constants: object, place: str
) -> Declared:
    """A declaration of dynamic_reconfigure; values that make no sense become None.

    ``constants`` are those of the enumeration, each with a ``name`` and a ``value``.
    """
    numbers = type_ in {"int", "double"}
    choices = [
        (str(one["name"]), one["value"])
        for one in (constants if isinstance(constants, list) else [])
        if isinstance(one, dict)
        and "name" in one
        and isinstance(one.get("value"), int | float | str)
    ]
    low, high, default, description = said
    known = default if isinstance(default, int | float | str) else None
    return Declared(
        name,
        type_,
        _end(low, type_) if numbers else None,
        _end(high, type_) if numbers else None,
        None,
        known,
        tuple(choices),
        description if isinstance(description, str) else "",
        place,
    )


def _end(value: object, type_: str) -> Number | None:
    """The end of a range; None if it is only the limit of the type."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return None
    return None if type_ == "int" and value in _INT_ENDS else value
