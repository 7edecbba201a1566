"""TPC as a library: what the command line does, for a notebook or a program of one's own.

Every function takes what another one gave, or the path of it: ``rank("mission.bag", "my_ws")`` is
``rank(read("mission.bag"), load_static("my_ws"))``. What they give prints as a table, is one in a
notebook (all texts from the robot escaped), and holds typed objects of the parts it came from.
docs/tutorial/diagnose-a-mission.md shows each at work, and is run by the tests.

Errors are `pytpc.base.errors.TpcError`: one line that names the file.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import overload

from pytpc.api.report import CARDS, MissionReport
from pytpc.api.report import write_report as write_page
from pytpc.base.errors import InputError
from pytpc.base.wording import Number
from pytpc.diagnosis.question import PLAIN, WINDOW_S, Question, Types
from pytpc.diagnosis.ranking.blame import blame
from pytpc.diagnosis.ranking.ranking import rank_marks
from pytpc.diagnosis.results.advice import WhatIf
from pytpc.diagnosis.results.mission import RankCurves
from pytpc.diagnosis.results.suspects import MarkRanking
from pytpc.diagnosis.scores.curves import STEP_S, rank_curves
from pytpc.diagnosis.suggestion.advise import advise
from pytpc.diagnosis.suggestion.blamed import advise_blamed
from pytpc.diagnosis.suggestion.joining import with_remedies
from pytpc.diagnosis.suggestion.what_if import what_if as replay
from pytpc.ingest import Recording
from pytpc.ingest import read as read_recording
from pytpc.present.answers import Advices, Diagnosed
from pytpc.present.notebook import Table
from pytpc.recording.declaration import Declared
from pytpc.recording.known_change import read_known_change
from pytpc.recording.marks import Mark, MarkType
from pytpc.static.static_info import StaticInfo, read_static
from pytpc.values.changes import Change
from pytpc.values.declared_files import declared_in
from pytpc.values.origins import read_origins

__all__ = ["Advices", "Change", "Diagnosed", "Rankings", "curves", "diagnose", "load_static"]
__all__ += ["rank", "read", "suggest", "what_if", "write_report"]

Source = str | os.PathLike[str]

_SHOWN = 5


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

    def rows(self, top: int = _SHOWN) -> list[dict[str, object]]:
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

    def table(self, top: int = _SHOWN) -> Table:
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
        return Table(headings, tuple(rows), frozenset({0, 1, 3, 5, 6}))

    def __str__(self) -> str:
        """The table as text."""
        return str(self.table())

    def _repr_html_(self) -> str:
        """The table for a notebook, escaped."""
        return self.table()._repr_html_()


def load_static(source: StaticInfo | Source) -> StaticInfo:
    """The static information of a workspace that ``pytpc build`` built, or of a static.json.

    Raises:
        InputError: there is none, or it is broken.
    """
    return source if isinstance(source, StaticInfo) else read_static(Path(source))


def read(source: Recording | Source) -> Recording:
    """A recorded mission: a bag of ROS 1 or 2, a file or folder of any kind that ``convert`` takes.

    Its ``events`` are columns of numpy (`pytpc.recording.events.Events`);
    ``events.to_arrow().to_pandas()`` makes a data frame of them.

    Raises:
        InputError: it cannot be read.
    """
    return source if isinstance(source, Recording) else read_recording(Path(source))


def rank(
    mission: Recording | Source,
    static_info: StaticInfo | Source,
    *,
    types: Types = "believe",
    window_s: float = WINDOW_S,
) -> Rankings:
    """The suspected parameters at each mark, most suspicious first.

    Args:
        mission: the mission with its marks.
        static_info: what the analysis found.
        types: ``believe`` the observer's types, ``doubt`` them (the other type's suspects stay
            rivals) or ``ignore`` them.
        window_s: the window of type II, in seconds.

    Raises:
        InputError: the mission has no marks, or something cannot be read.
    """
    recording, static = _marked(mission), load_static(static_info)
    question = Question(types=types, window_s=window_s)
    found = rank_marks(recording, static, question)
    source = None if isinstance(mission, Recording) else Path(mission)
    return Rankings(tuple(found), recording, static, source, question)


def diagnose(
    mission: Recording | Source,
    static_info: StaticInfo | Source,
    *,
    types: Types = "believe",
    reference: Recording | Source | None = None,
    changes: Sequence[Change] = (),
    top: int = _SHOWN,
) -> Diagnosed:
    """How likely it is each parameter, by all marks of a mission together, and what to do.

    Args:
        mission: the mission with its marks.
        static_info: what the analysis found.
        types: with ``ignore`` what the marks say of the type does not count.
        reference: a mission of the same build that went right.
        changes: what was changed since it went right, empty where that is not known; see
            `pytpc.values.changes.read_changes` and `pytpc.values.changes.changes_between`.
        top: for how many suspects there is a value to try.

    Raises:
        InputError: the mission has no marks, or something cannot be read.
    """
    recording, static = _marked(mission), load_static(static_info)
    clean = None if reference is None else read(reference)
    known = [(one.parameter, one.old, one.new) for one in changes]
    places = [] if isinstance(mission, Recording) else [Path(mission)]
    question = Question(
        types=types,
        top=top,
        reference=clean,
        changes=known,
        declared=declared_in(static, places),
    )
    found = blame(recording, static, question)
    advice = advise_blamed(found, recording, static, question)
    return Diagnosed(found, tuple(advice))


def curves(
    mission: Recording | Source,
    static_info: StaticInfo | Source,
    *,
    step_s: float = STEP_S,
    window_s: float = WINDOW_S,
) -> RankCurves:
    """Scores and ranks of all parameters over the mission, every ``step_s`` seconds.

    Raises:
        InputError: something cannot be read.
    """
    static = load_static(static_info)
    return rank_curves(read(mission), static, Question(window_s=window_s), step_s=step_s)


def suggest(
    rankings: Rankings,
    mark: int = 1,
    *,
    top: int = _SHOWN,
    declared: Sequence[Declared] | None = None,
) -> Advices:
    """What to do with suspects at a mark, and what it would have changed in the recorded run.

    Of each it has ``remedy``, the value to try by all marks that say the same (as `pytpc suggest`),
    and ``suggestion``, the smallest change at this mark.

    Args:
        rankings: what ``rank`` gave.
        mark: which of them, counted from 1.
        top: how many suspects.
        declared: the declared ranges of parameters; None: they are looked for in the sources of the
            static information, and in the mission where it was ranked by its path.

    Raises:
        IndexError: there is no such mark.
    """
    if not 1 <= mark <= len(rankings):
        raise IndexError(f"mark {mark} of {len(rankings)}")
    recording, static = rankings.recording, rankings.static_info
    if declared is None:
        declared = _declared(rankings)
    question = replace(rankings.question, top=top, declared=declared)
    lists = [advise(recording, static, ranking, question) for ranking in rankings]
    found = with_remedies(recording, static, list(rankings), lists, question)
    return Advices(tuple(found[mark - 1]), rankings[mark - 1])


def what_if(
    mission: Recording | Source,
    static_info: StaticInfo | Source,
    parameter: str,
    value: Number,
    *,
    kind: MarkType | None = None,
    marks: Sequence[Mark] | None = None,
    window_s: float = WINDOW_S,
) -> WhatIf:
    """What another value of a parameter would have changed in a recorded run.

    Args:
        mission: the run.
        static_info: what the analysis found.
        parameter: its name as in the source, or as a user gives it.
        value: in the parameter's own unit.
        kind: the type of error that the question is about; None: of each mark its own.
        marks: those to answer; None: the mission's, of that type or without one.
        window_s: how long before a mark counts as near to it, in seconds.

    Raises:
        InputError: no comparison is with that parameter, or something cannot be read.
    """
    recording, static = read(mission), load_static(static_info)
    question = Question(kind=kind, marks=marks, window_s=window_s)
    return replay(recording, static, parameter, value, question)


def write_report(path: Source, *rankings: Rankings, title: str = "Suspected parameters") -> Path:
    """Write the report page of one or several missions: one HTML file that opens offline.

    A mission that was ranked by its path is shown with what else is in its folder: where values
    came from (origins.json), and what had been done to the robot (treatment.json).

    Returns:
        Its path.

    Raises:
        TpcError: it cannot be written.
    """
    write_page(Path(path), [_for_report(one) for one in rankings], title=title)
    return Path(path)


def _marked(mission: Recording | Source) -> Recording:
    """The mission, which has to have marks."""
    recording = read(mission)
    if not recording.marks:
        raise InputError("no marks; `pytpc mark` makes some beside it", recording.name)
    return recording


def _declared(rankings: Rankings) -> list[Declared]:
    """The ranges that sources declare, and the mission where it was ranked by its path."""
    return declared_in(rankings.static_info, [rankings.source] if rankings.source else [])


def _for_report(rankings: Rankings) -> MissionReport:
    """A mission with what its folder says of it: where values came from, what had been changed."""
    source, recording = rankings.source, rankings.recording
    given = MissionReport(
        recording.name,
        recording,
        rankings.static_info,
        list(rankings.rankings),
        question=replace(rankings.question, top=CARDS, declared=_declared(rankings)),
    )
    if source is None:
        return given
    # As on the command line: bags of all missions may have one name, their folders have not.
    name = source.absolute().name if source.is_dir() else recording.name
    done = read_known_change(source)
    return replace(
        given,
        origins=read_origins(source),
        name=name,
        treatment=done.effect,
        changed_parameter=done.parameter,
    )
