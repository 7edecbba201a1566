"""What the report page is made from: one mission with its diagnosis."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from pytpc.diagnosis.results.advice import MissionAnswer
from pytpc.diagnosis.results.suspects import MarkRanking
from pytpc.recording.mission import Recording
from pytpc.static.parameters import same_parameter
from pytpc.static.static_info import StaticInfo
from pytpc.values.origins import Origin


@dataclass(frozen=True)
class ReportedMission:
    """One mission for the page.

    ``treatment`` says what was done to the robot, and ``changed_parameter`` which parameter was
    changed, where that is known (in a study); it is shown in red. ``origins`` are where the values
    came from, and may be empty.
    """

    name: str
    recording: Recording
    static_info: StaticInfo
    answer: MissionAnswer
    treatment: str = ""
    changed_parameter: str | None = None
    origins: Mapping[str, Origin] = field(default_factory=dict)

    @property
    def rankings(self) -> list[MarkRanking]:
        """The suspects at each mark."""
        return [mark.ranking for mark in self.answer.marks]

    def is_changed(self, parameter: str) -> bool:
        """True where ``parameter``, as in the source, is the one that was changed."""
        changed = self.changed_parameter
        return changed is not None and same_parameter(changed, parameter)

    def seconds(self, time_ns: int) -> float:
        """A time of the recording's clock as seconds since the recording began."""
        return (time_ns - self.recording.start_ns) / 1e9
