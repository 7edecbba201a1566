"""What other viewers show of a mission: evaluations, values, marks and suspects over time.

`pytpc.api.exporting` works it out; the writers in `pytpc.present.viewers` write it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from pytpc.base.columns import Bools, Floats, Int32s, Int64s
from pytpc.diagnosis.results.advice import RankCurves
from pytpc.recording.marks import Mark

Progress = Callable[[int, int], None]

MARKS_TOPIC, SUSPECTS_TOPIC, LOG_TOPIC = "/tpc/marks", "/tpc/suspects", "/tpc/log"
FIXED_TOPICS = (MARKS_TOPIC, SUSPECTS_TOPIC, LOG_TOPIC)


@dataclass(frozen=True, slots=True)
class ComparisonSeries:
    """One comparison in one node.

    ``topic`` is its name in viewers, unique and legal; ``parameter`` is the name that suspects
    have, ``place`` is ``file:line``. The margin is in the unit of the parameter if
    ``is_in_parameters``, else in that of the compared values.
    """

    topic: str
    node: str
    parameter: str
    key: str
    place: str
    relation: str
    source_code: str
    is_in_parameters: bool

    @property
    def unit(self) -> str:
        """The unit of the margin, as tables call it."""
        if self.relation == "flag":
            return ""
        return "parameter" if self.is_in_parameters else "compared"


class ExportedRows(NamedTuple):
    """n evaluations in order of time.

    ``series`` are numbers of `MissionExport.series`. ``result`` is that of the whole condition,
    ``holds`` of this comparison, ``flop`` says that the result changed. A row of several
    ``evaluations`` is a summary: its time is the summary's end, its values are those of the last
    one, and ``flop`` says that there were changes among them that have no row. An evaluation that
    a summary counts has 0 ``evaluations``, so that each counts once.
    """

    time_ns: Int64s
    series: Int32s
    value: Floats
    threshold: Floats
    margin: Floats
    result: Bools
    holds: Bools
    flop: Bools
    evaluations: Int64s


class ExportedValue(NamedTuple):
    """From a time on a parameter has this value; ``number`` is NaN if it is no number."""

    time_ns: int
    topic: str
    node: str
    parameter: str
    number: float
    text: str


class ExportedSuspect(NamedTuple):
    """A suspect by the marks so far; ``series`` are the numbers of its comparison's series.

    ``to_try`` is the value to try as text, empty if there is none.
    """

    position: int
    parameter: str
    probability: float
    type: str
    place: str
    key: str
    to_try: str
    series: tuple[int, ...]


class ExportedSuspects(NamedTuple):
    """What all marks up to the one with this number (from 1) say together."""

    time_ns: int
    mark: int
    suspects: tuple[ExportedSuspect, ...]
    none: float
    text: str
    action: str


class ExportedLine(NamedTuple):
    """A line of the log: a mark, a verdict, or a comparison that turned.

    ``kind`` is ``mark``, ``verdict`` or ``turn``.
    """

    time_ns: int
    kind: str
    name: str
    text: str


@dataclass(frozen=True, eq=False)
class MissionExport:
    """A mission for other viewers.

    ``first`` are the numbers of the series that layouts show, the first suspect's first, and
    ``ranges`` their lowest and highest finite value or threshold. ``ranks``
    are the ranks that `watch` shows, with ``rank_topics`` for their parameters, and
    ``probability_topics`` are those of the suspects' probabilities. ``rows`` gives the
    evaluations in parts of about so many; there are ``count`` in all. ``unknown`` reports are of
    comparisons that the static information does not have; they are left out.
    """

    name: str
    start_ns: int
    end_ns: int
    series: tuple[ComparisonSeries, ...]
    values: tuple[ExportedValue, ...]
    marks: tuple[Mark, ...]
    suspects: tuple[ExportedSuspects, ...]
    ranks: RankCurves
    rank_topics: tuple[str, ...]
    probability_topics: Mapping[str, str]
    log: tuple[ExportedLine, ...]
    first: tuple[int, ...]
    ranges: tuple[tuple[float, float], ...]
    count: int
    unknown: int
    rows: Callable[[int], Iterator[ExportedRows]]

    def counting(self, on_progress: Progress | None) -> Callable[[int], None]:
        """Take how many evaluations and ranks were written more; tell how many there are by now.

        Args:
            on_progress: called with (written, all of both).
        """
        done = 0

        def tell(count: int) -> None:
            nonlocal done
            done += count
            if on_progress is not None:
                on_progress(done, self.count + self.ranks.combined.size)

        return tell
