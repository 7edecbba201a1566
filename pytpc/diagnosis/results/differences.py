"""The parameters whose values differ between a good run and a mission."""

from __future__ import annotations

from dataclasses import dataclass

from pytpc.base.closest import did_you_mean
from pytpc.base.wording import listed, many, shown_value
from pytpc.static.coverage import State
from pytpc.static.parameters import DYNAMIC

_NAMED = 3


@dataclass(frozen=True, slots=True)
class SetValue:
    """A parameter's value in a run, and where it was set.

    ``value`` is what the parameter server held, or what the comparisons reported; None if it was
    not set. ``place`` is ``config/params.yaml:12``, ``default in the code`` and so on; empty if it
    is not known.
    """

    value: object
    place: str = ""

    @property
    def number(self) -> float | None:
        """The value as a double; None if it is no number, or larger than any double."""
        try:
            return float(self.value) if isinstance(self.value, bool | int | float) else None
        except OverflowError:
            return None


@dataclass(frozen=True, slots=True)
class ReplayedComparison:
    """A comparison of the mission, evaluated again with the good run's value.

    Of its ``evaluations``, ``turned`` would have come out otherwise, ``turned_near`` of them in a
    window before a mark; the first of them was ``first_s`` seconds into the mission. ``unsure`` is
    how many more may have turned: of summaries only the extremes are known.
    """

    key: str
    place: str
    source_code: str
    evaluations: int
    turned: int
    turned_near: int
    first_s: float | None
    unsure: int = 0


@dataclass(frozen=True, slots=True)
class Difference:
    """A parameter whose value differs.

    ``parameter`` is its full name on the robot, or the name in the source if only reports have its
    value. ``state`` is what became of it in the analysed nodes; None if none of them reads it.
    ``reads`` and ``compared_at`` are the places in the source. ``keys`` are its comparisons that
    the mission evaluated, ``replayed`` those of them that can be replayed. ``source`` is its name
    in the source, as suspects have it; empty if that means other parameters of the robot, too.
    ``alike`` are names that nodes read and nobody set, if none of them reads this one. ``apart`` is
    how far its value is from the nearest one of the good runs, in powers of e, 0 between two of
    them, infinite if the sign differs; None of what is no number, as a flag or a text.
    """

    parameter: str
    good: SetValue
    bad: SetValue
    state: State | None
    reads: tuple[str, ...]
    compared_at: tuple[str, ...]
    keys: tuple[str, ...]
    replayed: tuple[ReplayedComparison, ...] = ()
    source: str = ""
    alike: tuple[str, ...] = ()
    apart: float | None = None

    @property
    def name(self) -> str:
        """What an answer calls it: as a suspect is called, or else its full name.

        The full name, too, if no comparison reports it and part of its name in the source is not
        known.
        """
        if self.is_silent and DYNAMIC in self.source and self.parameter.startswith("/"):
            return self.parameter
        return self.source or self.parameter

    @property
    def change(self) -> str:
        """``~faces 5 -> 12``."""
        return f"{self.name} {shown_value(self.good.value)} -> {shown_value(self.bad.value)}"

    @property
    def evaluations(self) -> int:
        """How often its comparisons were evaluated in the mission."""
        return sum(one.evaluations for one in self.replayed)

    @property
    def turned(self) -> int:
        """How many of these decisions would have come out otherwise with the good run's value."""
        return sum(one.turned for one in self.replayed)

    @property
    def turned_near(self) -> int:
        """Those of ``turned`` that were shortly before a mark."""
        return sum(one.turned_near for one in self.replayed)

    @property
    def is_silent(self) -> bool:
        """Whether no report of the mission says anything about it."""
        return not self.keys

    @property
    def effect(self) -> str:
        """What the other value means for the mission, in one phrase."""
        if self.compared_at:
            return f"compared at {listed(self.compared_at, _NAMED)}: {self._replay}"
        if self.state is None:
            return f"read by no analysed node{did_you_mean(self.parameter, self.alike)}"
        where = f"read at {listed(self.reads, _NAMED)}"
        if self.state == "hidden":
            return f"{where}, compared only where nothing exposed depends on it"
        if self.state == "lost":
            return f"{where}; the analysis loses it on the way"
        return f"{where}, compared nowhere"

    @property
    def _replay(self) -> str:
        if self.is_silent:
            return "not evaluated in this mission"
        if self.replayed:
            unsure = sum(one.unsure for one in self.replayed)
            perhaps = f", perhaps {unsure:,} more," if unsure else ""
            of = f"{self.turned:,} of {many(self.evaluations, 'decision')}{perhaps}"
            return f"{of} would have come out otherwise"
        if self.good.value is None:
            why = "the good run's value is not known"
        elif not isinstance(self.good.value, bool | int | float):
            why = "the good run's value is no number"
        else:
            why = "the threshold that it gives is not known"
        return f"not replayed, as {why}"

    def order(self) -> tuple[int, int, int, str]:
        """Sorts those first that changed what the robot decided, and those that nobody reads last.

        A parameter of which nothing can be replayed comes before one whose decisions stay the same.
        """
        if self.turned or any(one.unsure for one in self.replayed):
            place = 0
        elif self.state is None:
            place = 3
        else:
            place = 2 if self.replayed else 1
        return (place, -self.turned_near, -self.turned, self.parameter)


@dataclass(frozen=True, slots=True)
class CodeComparison:
    """Whether a mission ran the code of a good run, so that a fault in it would have shown there.

    ``run`` names the good run. The programs are ``package/program``: ``changed`` are those that
    were built from other sources, ``unseen`` those that reported in the mission and not in the good
    run.
    """

    run: str
    changed: tuple[str, ...] = ()
    unseen: tuple[str, ...] = ()

    @property
    def is_same(self) -> bool:
        """Whether all programs of the mission were at work in the good run, from one build."""
        return not self.changed and not self.unseen

    @property
    def line(self) -> str:
        """``the code is not that of the good run monday: nav/planner changed``."""
        of = f"that of the good run {self.run}"
        if self.is_same:
            return f"the code is {of}"
        unseen = f"{listed(self.unseen, _NAMED)} reported only now" if self.unseen else ""
        if not self.changed:
            return f"the code is {of}, but {unseen}"
        said = [f"{listed(self.changed, _NAMED)} changed", *([unseen] if unseen else [])]
        return f"the code is not {of}: {', '.join(said)}"


@dataclass(frozen=True, slots=True)
class RunDifferences:
    """What differs between good runs and a mission.

    ``good`` and ``bad`` name the runs. ``found`` are the differences, the most telling first: a
    parameter differs if no good run had its value. ``is_complete`` says whether the values of all
    parameters were recorded in both; else only compared ones are known. ``notes`` say what could
    not be compared, and how the code differs. ``code`` is about the good run whose code is nearest
    to the mission's; None if the builds are not known.
    """

    good: tuple[str, ...]
    bad: str
    found: tuple[Difference, ...]
    is_complete: bool
    notes: tuple[str, ...] = ()
    code: CodeComparison | None = None

    @property
    def unreported(self) -> tuple[Difference, ...]:
        """Those that analysed nodes read, and that no comparison reported: the log is silent."""
        return tuple(one for one in self.found if one.state is not None and one.is_silent)

    @property
    def line(self) -> str:
        """``differs from the good run monday: /uav/faces 5 -> 12 and 3 more``, or empty."""
        if not self.found:
            return ""
        told = [one.change for one in self.found]
        return f"differs from the good run {listed(self.good, 1)}: {listed(told, _NAMED)}"

    @property
    def title(self) -> str:
        """``1 parameter differs from the good run yesterday; the code is the same``."""
        run = "the good run" if len(self.good) == 1 else "the good runs"
        which = f"{run} {listed(self.good, _NAMED)}"
        code = "; the code is the same" if self.code is not None and self.code.is_same else ""
        if not self.found:
            what = "No parameter" if self.is_complete else "No compared parameter"
            return f"{what} differs from {which}{code}"
        verb = "differs" if len(self.found) == 1 else "differ"
        return f"{many(len(self.found), 'parameter')} {verb} from {which}{code}"
