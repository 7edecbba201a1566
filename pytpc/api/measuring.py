"""How near each comparison came to turning, over a mission and over missions."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import cast

from pytpc.api.missions import Source, load_static, read_named, with_names_of
from pytpc.diagnosis.behaviour import behaviours, over_missions
from pytpc.diagnosis.results.behaviour import Behaviour, OverMissions
from pytpc.diagnosis.results.turn_groups import TurnGroup
from pytpc.diagnosis.turn_groups import turn_groups_of
from pytpc.present.answers import NotebookTable, TableSequence
from pytpc.present.margin_tables import BehaviourTexts, median_text, short
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo

_MISSIONS = 6


@dataclass(frozen=True)
class MissionMargins(TableSequence[Behaviour]):
    """The comparisons of one mission, by parameter, and the groups that turn as one."""

    name: str
    seconds: float
    behaviours: tuple[Behaviour, ...]
    groups: tuple[TurnGroup, ...]

    @classmethod
    def of(
        cls, recording: Recording, static_info: StaticInfo, source: Path | None
    ) -> MissionMargins:
        """Those of a recording that was read before."""
        named = with_names_of(recording, static_info, source)
        found = behaviours(recording, named)
        return cls(recording.name, recording.seconds, found, turn_groups_of(recording, named))

    @property
    def items(self) -> tuple[Behaviour, ...]:
        """What each comparison did."""
        return self.behaviours

    def table(self) -> NotebookTable:
        """A row for each comparison."""
        rows = tuple(
            (
                texts.parameter,
                one.node,
                texts.nearest,
                *(map(short, one.margins) if one.margins is not None else [""] * 4),
                *texts[4:],
            )
            for one, texts in ((one, BehaviourTexts.of(one)) for one in self.behaviours)
        )
        headings = (
            "parameter", "node", "nearest", "least", "5 %", "median", "95 %", "true", "turns",
            "near misses", "undecided", "drift", "compared at",
        )  # fmt: skip
        return NotebookTable(headings, rows, frozenset(range(2, 11)))


@dataclass(frozen=True)
class Margins(TableSequence[MissionMargins]):
    """The missions in their order, and each comparison over all of them."""

    missions: tuple[MissionMargins, ...]

    @property
    def items(self) -> tuple[MissionMargins, ...]:
        """What the comparisons of each mission did."""
        return self.missions

    @cached_property
    def over(self) -> tuple[OverMissions, ...]:
        """Each comparison over the missions, by parameter."""
        return over_missions([one.behaviours for one in self.missions])

    def table(self) -> NotebookTable:
        """That of the one mission; of several, the median margins of the last ones."""
        if len(self.missions) == 1:
            return self.missions[0].table()
        last = self.missions[-_MISSIONS:]
        rows = tuple(
            (
                one.parameter,
                one.node,
                *(median_text(each) for each in one.behaviours[-_MISSIONS:]),
                "" if one.trend is None else short(one.trend),
                one.place,
            )
            for one in self.over
        )
        names = [one.name for one in last]
        headings = ("parameter", "node", *names, "trend", "compared at")
        return NotebookTable(headings, rows, frozenset(range(2, 3 + len(names))))


def margins(
    missions: Recording | Source | Sequence[Recording | Source],
    static_info: StaticInfo | Source,
) -> Margins:
    """How near each comparison came to turning in missions; marks are not needed.

    Args:
        missions: one, or several in the order in which they were.
        static_info: what the analysis found.

    Raises:
        InputError: something cannot be read.
    """
    static = load_static(static_info)
    single = isinstance(missions, Recording | str | os.PathLike)
    given = cast("Sequence[Recording | Source]", [missions] if single else missions)
    found = []
    for one in given:
        source = None if isinstance(one, Recording) else Path(one)
        recording = one if isinstance(one, Recording) else read_named(Path(one))
        found.append(MissionMargins.of(recording, static, source))
    return Margins(tuple(found))
