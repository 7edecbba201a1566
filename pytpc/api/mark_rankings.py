"""Which parameters are suspected at each mark, and over the mission."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import overload

from pytpc.api.missions import Source, find_declared, load_static, read, read_marked
from pytpc.base.errors import InputError
from pytpc.base.wording import plain
from pytpc.diagnosis.question import PLAIN, WINDOW_S, Question, Types
from pytpc.diagnosis.ranking.mark_ranking import rank_marks
from pytpc.diagnosis.results.mission_answer import RankCurves
from pytpc.diagnosis.results.suspects import MarkRanking
from pytpc.diagnosis.scores.rank_curves import STEP_S, rank_curves
from pytpc.present.notebook import NotebookTable
from pytpc.recording.declaration import Declared
from pytpc.recording.mission import Recording
from pytpc.static.parameters import parameter_name, same_parameter
from pytpc.static.static_info import StaticInfo


@dataclass(frozen=True, slots=True)
class Rankings(Sequence[MarkRanking]):
    """The rankings of one mission, one for each mark, in the order of the marks.

    A sequence of `pytpc.diagnosis.results.suspects.MarkRanking`; ``recording`` and ``static_info``
    are what was ranked, ``source`` where the mission was read from, if it was ranked by its path:
    what else is in its folder is in the report then. ``question`` is what it was ranked with, and
    what is made of it uses it, too. ``table`` has the first suspects of each
    mark.
    """

    rankings: tuple[MarkRanking, ...]
    recording: Recording
    static_info: StaticInfo
    source: Path | None = None
    question: Question = PLAIN

    @classmethod
    def of(
        cls,
        recording: Recording,
        static_info: StaticInfo,
        question: Question = PLAIN,
        source: Path | None = None,
    ) -> Rankings:
        """Rank the parameters at each mark of a recording that was read before."""
        found = rank_marks(recording, static_info, question)
        return cls(tuple(found), recording, static_info, source, question)

    @property
    def types(self) -> Types:
        """How far the types of the marks were believed."""
        return self.question.types

    @property
    def window_s(self) -> float:
        """The window of type II, in seconds."""
        return self.question.window_s

    @property
    def declared(self) -> Sequence[Declared]:
        """The declared ranges: those of the question, else those that are found in the sources."""
        if self.question.declared:
            return self.question.declared
        return find_declared(self.static_info, self.source)

    def only(self, parameter: str) -> Rankings:
        """The same with the one parameter, at the position that it has.

        Raises:
            InputError: no comparison with it is known.
        """
        names = {parameter_name(found) for found in self.static_info.thresholds.values()}
        if not any(parameter == name or same_parameter(parameter, name) for name in names):
            raise InputError(f"no comparison with a parameter {plain(parameter)} is known")
        only = []
        for ranking in self.rankings:
            exact = [one for one in ranking.suspects if one.parameter == parameter]
            same = [one for one in ranking.suspects if same_parameter(parameter, one.parameter)]
            only.append(replace(ranking, suspects=tuple(exact or same)))
        return replace(self, rankings=tuple(only))

    def __len__(self) -> int:
        """The number of marks."""
        return len(self.rankings)

    @overload
    def __getitem__(self, index: int) -> MarkRanking: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[MarkRanking, ...]: ...

    def __getitem__(self, index: int | slice) -> MarkRanking | tuple[MarkRanking, ...]:
        """The ranking of a mark."""
        return self.rankings[index]

    def __iter__(self) -> Iterator[MarkRanking]:
        """The rankings in the order of the marks."""
        return iter(self.rankings)

    def rows(self, top: int = PLAIN.top) -> list[dict[str, object]]:
        """The first ``top`` suspects of each mark, flat; ``pandas.DataFrame(rankings.rows())``.

        Each has ``mark`` (from 1), ``seconds`` into the mission, ``type``, ``position``,
        ``parameter``, ``rank``, ``score``, ``score_type``, ``place`` (``file:line``) and ``key``.
        """
        return [
            {
                "mark": number,
                "seconds": (ranking.mark.time_ns - self.recording.start_ns) / 1e9,
                "type": ranking.mark.type,
                "position": suspect.position,
                "parameter": suspect.parameter,
                "rank": suspect.rank,
                "score": suspect.score,
                "score_type": suspect.type,
                "place": f"{suspect.comparison.file}:{suspect.comparison.lineno}",
                "key": suspect.key,
            }
            for number, ranking in enumerate(self.rankings, start=1)
            for suspect in ranking.suspects[:top]
        ]

    def table(self, top: int = PLAIN.top) -> NotebookTable:
        """The same to look at; a mark at which nothing could be ranked has a row that says so."""
        rows = []
        for number, ranking in enumerate(self.rankings, start=1):
            seconds = (ranking.mark.time_ns - self.recording.start_ns) / 1e9
            mark = (str(number), f"{seconds:.1f} s", ranking.mark.type or "-")
            if not ranking.suspects:
                why = ranking.reason or "no parameter has a score here"
                rows.append((*mark, "", why, "", "", ""))
            rows += [
                (
                    *mark,
                    f"{suspect.position}{'=' if suspect.tied else ''}",
                    suspect.parameter,
                    f"{suspect.rank:.2f}",
                    f"{suspect.score:.3g}",
                    f"{suspect.comparison.file}:{suspect.comparison.lineno}",
                )
                for suspect in ranking.suspects[:top]
            ]
        headings = ("mark", "at", "type", "#", "parameter", "rank", "score", "compared at")
        return NotebookTable(headings, tuple(rows), frozenset({0, 1, 3, 5, 6}))

    def __str__(self) -> str:
        """The table as text."""
        return str(self.table())

    def _repr_html_(self) -> str:
        """The table for a notebook, escaped."""
        return self.table()._repr_html_()


def rank(
    mission: Recording | Source,
    static_info: StaticInfo | Source,
    *,
    types: Types = "believe",
    window_s: float = WINDOW_S,
    question: Question | None = None,
) -> Rankings:
    """The suspected parameters at each mark, most suspicious first.

    Args:
        mission: the mission with its marks.
        static_info: what the analysis found.
        types: ``believe`` the observer's types, ``doubt`` them (the other type's suspects stay
            rivals) or ``ignore`` them.
        window_s: the window of type II, in seconds.
        question: all settings at once, in place of ``types`` and ``window_s``.

    Raises:
        InputError: the mission has no marks, or something cannot be read.
    """
    asked = question or Question(types=types, window_s=window_s)
    source = None if isinstance(mission, Recording) else Path(mission)
    return Rankings.of(read_marked(mission), load_static(static_info), asked, source)


def curves(
    mission: Recording | Source,
    static_info: StaticInfo | Source,
    *,
    step_s: float = STEP_S,
    window_s: float = WINDOW_S,
    question: Question | None = None,
) -> RankCurves:
    """Scores and ranks of all parameters over the mission, every ``step_s`` seconds.

    Raises:
        InputError: something cannot be read.
    """
    asked = question or Question(window_s=window_s)
    return rank_curves(read(mission), load_static(static_info), asked, step_s=step_s)
