"""What a diagnosis advises for suspected parameters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from pytpc.base.columns import Floats, Int64s
from pytpc.base.wording import Number, show, shown_value
from pytpc.diagnosis.question import Source
from pytpc.diagnosis.results.suspects import Suspect, Suspected, Uncompared
from pytpc.diagnosis.thresholds.intervals import Intervals
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import Mark, MarkType

Direction = Literal["raise", "lower", "switch"]


@dataclass(frozen=True, slots=True)
class Suggestion:
    """What to do with one parameter.

    ``current`` and ``value`` are in the parameter's unit: a bool for a switch, an int for a
    whole-number parameter. ``boundary`` is where the values that would do begin; it is one of them
    if ``inclusive``. ``text`` is the sentence to show. If nothing can be suggested, ``direction``,
    ``value`` and ``boundary`` are None and ``reason`` says why.

    ``feasible`` are all values that would do, whether or not the parameter can take them (for
    equality and periodic arithmetic those near the present one). It may have values although none
    is suggested. ``limited_by`` says what kept ``value`` from the smallest change: a declared
    range, a step, a whole number, the sign.
    """

    parameter: str
    current: Number | None
    direction: Direction | None
    value: Number | None
    boundary: float | None
    inclusive: bool
    text: str
    reason: str | None
    feasible: Intervals = ()
    limited_by: str = ""


@dataclass(frozen=True, slots=True)
class KnownValue:
    """A value in the parameter's unit, and who says that it is good."""

    source: Source
    value: float


Basis = Literal[
    "reference", "default", "declared", "lasting", "growth", "between", "smallest", "before"
]


@dataclass(frozen=True, slots=True)
class Remedy:
    """What to try.

    ``current`` and ``value`` are in the parameter's unit, as in `Suggestion`. ``basis`` is the
    evidence that decided: a known value, a ``lasting`` one, a step because the ``growth`` of the
    values shows no bound, one ``between`` values that were tried, the ``smallest`` change, or the
    value from ``before`` a change. ``smallest`` is the smallest change that does at the most marks.
    ``kind`` is the type of error that it answers, by the comparison ``key``. ``known`` are all
    values that are known to be good. If nothing can be suggested, ``value``, ``direction`` and
    ``basis`` are None and ``reason`` says why. ``doubt`` is why a person would hesitate to try the
    value; empty of a usual one.
    """

    parameter: str
    current: Number | None
    direction: Direction | None
    value: Number | None
    basis: Basis | None
    text: str
    reason: str | None
    kind: MarkType | None
    key: str | None
    smallest: Suggestion | None
    known: tuple[KnownValue, ...] = ()
    doubt: str = ""


@dataclass(frozen=True, slots=True)
class WhatIf:
    """The recorded comparisons of one parameter, replayed with another value.

    The value answers ``answered`` of the ``marks`` that the question is about. Type I: the last
    flop before the mark would not have happened. Type II: an evaluation in the window would have
    gone the other way. ``evaluations`` of the parameter's TPCs were replayed. ``flipped_near`` of
    them have another outcome within a window before a mark, ``flipped_away`` elsewhere, where
    nobody complained. ``text`` is the sentence to show, ``caveats`` what the replay cannot know.

    ``unsure`` is how many more may have another outcome: only the extremes of summaries are known.
    ``stops`` says that the value answers marks of type I by stopping all that the parameter
    decides: every evaluation would go the same way, also those that nobody complained about.
    """

    parameter: str
    value: Number
    marks: int
    answered: int
    evaluations: int
    flipped_near: int
    flipped_away: int
    text: str
    caveats: tuple[str, ...]
    unsure: int = 0
    stops: bool = False


@dataclass(frozen=True, slots=True)
class Suggested:
    """A suspect with the smallest change that is suggested for it."""

    suspect: Suspect
    suggestion: Suggestion


@dataclass(frozen=True, slots=True)
class Advice:
    """A suspect with what to do.

    ``suggestion`` is the smallest change, and ``what_if`` what it would have changed; None if
    nothing is suggested. ``remedy`` is the value to try, and ``tried`` what that would have
    changed; `pytpc.diagnosis.suggestion.advise.with_remedies` fills them from all marks.
    """

    suspect: Suspect
    suggestion: Suggestion
    what_if: WhatIf | None
    declared: Declared | None
    remedy: Remedy | None = None
    tried: WhatIf | None = None

    @property
    def told(self) -> Suggestion | Remedy:
        """The value to try, or else the smallest change."""
        return self.suggestion if self.remedy is None or self.remedy.value is None else self.remedy


@dataclass(frozen=True, slots=True)
class BlamedAdvice:
    """A parameter that all marks suspect, with the value to try and what it would have changed."""

    accused: Suspected
    remedy: Remedy
    what_if: WhatIf | None

    @property
    def current(self) -> str:
        """The parameter's value in the mission, for people."""
        if isinstance(self.accused, Uncompared):
            return shown_value(self.accused.difference.bad.value)
        known = self.remedy.current
        return show(self.accused.last.thresh if known is None else known)

    @property
    def stops(self) -> bool:
        """Whether the value to try would only stop the robot, see `WhatIf`."""
        return self.what_if is not None and self.what_if.stops


@dataclass(frozen=True, slots=True)
class JoinedAdvice:
    """One parameter at the marks of a group, with the advice that does at the most of them.

    It is a suspect at ``named`` of the marks, and the suggested value would do at ``agreed``.
    ``remedy`` is the value to try, from all marks of the group together, and ``what_if`` what it
    would have changed.
    """

    advice: Advice
    named: int
    agreed: int
    remedy: Remedy
    what_if: WhatIf | None


@dataclass(frozen=True, slots=True)
class MarkGroup:
    """Marks of one type whose first suspect and the direction of its suggestion are the same.

    ``suspects`` are ordered by their mean position. ``reasons`` say why there is not enough
    evidence at a mark.
    """

    marks: tuple[Mark, ...]
    type: MarkType | None
    suspects: tuple[JoinedAdvice, ...]
    reasons: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class RankCurves:
    """Scores and ranks of p parameters at t times.

    ``times_ns`` int64[t]; ``parameters`` the p names, sorted; ``score1``, ``score2`` float64[t, p]
    (`pytpc.diagnosis.scores.scores.NONE` where none), ``rank1``, ``rank2`` and ``combined``
    float64[t, p] in [0, 1], 1 the most suspicious.
    """

    times_ns: Int64s
    parameters: tuple[str, ...]
    score1: Floats
    score2: Floats
    rank1: Floats
    rank2: Floats
    combined: Floats
