"""What the name of a parameter says of its values: weak evidence, kept as a table.

A row counts if the name has one of the words ``any``, one of ``also`` (where there are some) and
none of ``but``. Words are what stands between ``/``, ``_`` and changes of case.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

_WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")


@dataclass(frozen=True, slots=True)
class NamedKind:
    """Values from ``low`` to ``high`` are usual; ``firm`` says that others make no sense at all.

    ``what`` ends the sentence "a value beyond 1, which is unusual for ...".
    """

    any: frozenset[str]
    low: float
    high: float
    what: str
    also: frozenset[str] = frozenset()
    but: frozenset[str] = frozenset()
    firm: bool = False

    def is_meant(self, words: frozenset[str]) -> bool:
        """Whether a name with these words is of this kind."""
        also = not self.also or bool(self.also & words)
        return bool(self.any & words) and also and not self.but & words


def _words(text: str) -> frozenset[str]:
    return frozenset(text.split())


_ANGLES = _words("yaw heading angle angular rotation orientation theta bearing pitch roll")
_DEGREES = _words("deg degree degrees")
_RADIANS = _words("rad radian radians")
_LIMITS = _words("tolerance tol error deviation")
_CHANGES = _words("rate speed vel velocity acc accel acceleration gain weight scale factor cost s")

_NEVER = "what cannot be negative"

NAMED_KINDS: tuple[NamedKind, ...] = (
    NamedKind(
        _DEGREES, 0.0, 180.0, "a tolerance of an angle in degrees",
        also=_LIMITS, but=_CHANGES, firm=True,
    ),
    NamedKind(
        _ANGLES | _RADIANS, 0.0, math.pi, "a tolerance of an angle",
        also=_LIMITS, but=_CHANGES | _DEGREES, firm=True,
    ),
    NamedKind(_ANGLES | _RADIANS, -2 * math.pi, 2 * math.pi, "an angle", but=_CHANGES | _DEGREES),
    NamedKind(_DEGREES, -360.0, 360.0, "an angle in degrees", but=_CHANGES),
    NamedKind(_words("percent percentage pct"), 0.0, 100.0, "a percentage"),
    NamedKind(
        _words("probability prob confidence ratio fraction"), 0.0, 1.0, "a ratio or a probability"
    ),
    NamedKind(
        _words("vel velocity speed acc accel acceleration"), 0.0, math.inf, _NEVER,
        also=_words("max limit tolerance tol"), firm=True,
    ),
    NamedKind(
        _words(
            "rate hz freq frequency timeout duration period delay patience secs seconds sec ms"
            " count num size radius tolerance tol"
        ),
        0.0, math.inf, _NEVER, but=_words("turn rotation"), firm=True,
    ),
)  # fmt: skip
"""The kinds; several may be meant by one name."""

_CHECKS = _words("check checks verify validate safety safe guard protect watchdog")


def is_check(parameter: str) -> bool:
    """Whether the name says that a flag switches a check on."""
    return bool(_CHECKS & _words_of(parameter))


def _words_of(parameter: str) -> frozenset[str]:
    return frozenset(word.lower() for word in _WORD.findall(parameter.rpartition("/")[2]))


def kinds_by_name(parameter: str) -> tuple[NamedKind, ...]:
    """The kinds that a parameter's name says.

    >>> [kind.what for kind in kinds_by_name("~planner/yawTolerance")]
    ['a tolerance of an angle', 'an angle', 'what cannot be negative']
    """
    words = _words_of(parameter)
    return tuple(kind for kind in NAMED_KINDS if kind.is_meant(words))
