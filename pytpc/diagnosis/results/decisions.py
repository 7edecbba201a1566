"""How the comparisons of two runs came out."""

from __future__ import annotations

from dataclasses import dataclass, replace

from pytpc.diagnosis.results.differences import SetValue


@dataclass(frozen=True, slots=True)
class Decided:
    """How one comparison came out in one run.

    ``true`` is the share of the ``evaluations`` that came out true, 0 to 1; in a summary with flops
    it is that of the time. ``flops`` counts all turns, ``turned_s`` is when the first one was, in
    seconds from the start of the run; None without one. ``low``, ``middle`` and ``high`` are the
    smallest, the median and the largest margin: the compared value minus the threshold; None if no
    value is finite. The median takes the mean of a summary for each evaluation in it.
    ``thresholds`` are the different ones, sorted, at most ``MOST``; ``more`` counts the others.
    ``value`` is that of the parameter on the robot, and where it was set.
    """

    evaluations: int
    true: float
    flops: int
    turned_s: float | None
    low: float | None
    middle: float | None
    high: float | None
    thresholds: tuple[float, ...]
    more: int
    value: SetValue

    @property
    def outcomes(self) -> tuple[bool, ...]:
        """The outcomes that it had: only true, only false, or both."""
        if self.flops:
            return (False, True)
        return tuple(way for way, some in ((False, self.true < 1), (True, self.true > 0)) if some)


MOST = 4
"""So many different thresholds of a comparison are told apart."""


@dataclass(frozen=True, slots=True)
class DecisionChange:
    """One comparison in two runs; ``old`` or ``new`` is None if that run did not evaluate it.

    ``key`` is that of the newer run's build, ``parameter`` the name of its parameter there.
    """

    key: str
    parameter: str
    place: str
    source_code: str
    relation: str
    old: Decided | None
    new: Decided | None

    @property
    def is_alike(self) -> bool:
        """Whether both runs had the same thresholds, and either no flop or all the same numbers."""
        old, new = self.old, self.new
        if old is None or new is None or self.has_other_threshold:
            return False
        if not (old.flops or new.flops):
            return old.outcomes == new.outcomes
        return replace(old, value=new.value) == new

    @property
    def has_other_threshold(self) -> bool:
        """Whether both runs have thresholds, and these differ."""
        old, new = self.old, self.new
        return old is not None and new is not None and old.thresholds != new.thresholds

    @property
    def share(self) -> float:
        """How much larger the share of true outcomes is in the newer run; 0 if one is missing."""
        return 0.0 if self.old is None or self.new is None else self.new.true - self.old.true

    @property
    def earlier_s(self) -> float | None:
        """How much earlier it first turned in the newer run, in seconds; None if not in both."""
        if self.old is None or self.new is None:
            return None
        first, second = self.old.turned_s, self.new.turned_s
        return None if first is None or second is None else first - second

    @property
    def what(self) -> str:
        """The main difference, in a phrase."""
        if self.old is None or self.new is None:
            return f"evaluated only in {'NEW' if self.old is None else 'OLD'}"
        return "decided alike" if self.is_alike else self._difference(self.old, self.new)

    def _difference(self, old: Decided, new: Decided) -> str:
        if bool(old.flops) != bool(new.flops):
            return f"turned only in {'NEW' if new.flops else 'OLD'}"
        if old.outcomes != new.outcomes:
            return f"always {_way(old)} in OLD, always {_way(new)} in NEW"
        if not old.flops:
            return "the same outcome with another threshold"
        if not self.earlier_s:
            return "turned in both, first at the same time"
        order = "earlier" if self.earlier_s > 0 else "later"
        return f"turned in both, first {abs(self.earlier_s):.1f} s {order} in NEW"

    def order(self) -> tuple[int, float, float, str, str]:
        """Sorts the largest difference first.

        First what came out in a way in one run only, then other shares and times, then what only
        one run evaluated.
        """
        if self.old is None or self.new is None:
            return (2, 0.0, 0.0, self.parameter, self.key)
        place = 1 if self.old.outcomes == self.new.outcomes else 0
        return (place, -abs(self.share), -abs(self.earlier_s or 0.0), self.parameter, self.key)


def _way(one: Decided) -> str:
    return "true" if one.true > 0 else "false"


@dataclass(frozen=True, slots=True)
class RunDecisions:
    """The comparisons that two runs evaluated, the largest difference first.

    ``old`` and ``new`` name the runs, ``seconds`` are how long each was. ``unknown`` counts the
    comparisons of each whose build the static information does not have.
    """

    old: str
    new: str
    seconds: tuple[float, float]
    found: tuple[DecisionChange, ...]
    unknown: tuple[int, int]

    @property
    def differing(self) -> tuple[DecisionChange, ...]:
        """Those that did not decide alike."""
        return tuple(one for one in self.found if not one.is_alike)
