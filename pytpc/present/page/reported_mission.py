"""What the report page is made from: one mission with its diagnosis."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from pytpc.diagnosis.results.mission_answer import MissionAnswer
from pytpc.diagnosis.results.suspects import MarkRanking
from pytpc.recording.mission import Recording
from pytpc.static.parameters import same_parameter
from pytpc.static.static_info import StaticInfo
from pytpc.values.origins import Origin


@dataclass(frozen=True)
class ReportedMission:
    """One mission for the page.

    ``treatment`` says what was done to the robot, and ``changed_parameter`` which parameter was
    changed; only a study knows that. ``origins`` are where the values came from, and may be empty.
    ``source`` is the path of the mission that commands on the page name; None if it has none.
    """

    name: str
    recording: Recording
    static_info: StaticInfo
    answer: MissionAnswer
    treatment: str = ""
    changed_parameter: str | None = None
    origins: Mapping[str, Origin] = field(default_factory=dict)
    source: Path | None = None

    @property
    def rankings(self) -> list[MarkRanking]:
        """The suspects at each mark."""
        return [mark.ranking for mark in self.answer.marks]

    @cached_property
    def _differing(self) -> frozenset[str]:
        """The keys of the comparisons whose parameter differs from the good runs."""
        found = self.answer.differences
        return frozenset() if found is None else frozenset(k for d in found.found for k in d.keys)

    def is_changed(self, parameter: str, key: str | None) -> bool:
        """Whether a parameter is known to have been changed.

        In a study it is the one that the study changed. Else it is one that differs from good runs.

        Args:
            parameter: as in the source.
            key: of one of its comparisons; objects and nodes may have values of their own. None for
                a parameter that is a suspect because it differs.
        """
        changed = self.changed_parameter
        if changed is not None:
            return same_parameter(changed, parameter)
        return key is None or key in self._differing

    def seconds(self, time_ns: int) -> float:
        """A time of the recording's clock as seconds since the recording began."""
        return (time_ns - self.recording.start_ns) / 1e9
