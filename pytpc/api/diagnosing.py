"""Which parameter is to blame: by all marks together, at each mark, and over the mission."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, TypedDict

from pytpc.api.comparing import RecordedRun, Run, beside
from pytpc.api.missions import (
    Source,
    about_mission,
    find_declared,
    load_static,
    question_of,
    read,
    read_marked,
    with_names_of,
)
from pytpc.api.wired_robot import with_wiring
from pytpc.base.closest import did_you_mean
from pytpc.base.errors import InputError
from pytpc.base.wording import listed, plain
from pytpc.diagnosis.diagnose import diagnose_mission
from pytpc.diagnosis.question import PLAIN, Question, Types
from pytpc.diagnosis.ranking.mark_ranking import rank_marks
from pytpc.diagnosis.results.advice import RankCurves
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.diagnosis.results.suspects import MarkRanking
from pytpc.diagnosis.scores.score_tables import STEP_S, Tpcs, rank_curves
from pytpc.present.answers import Diagnosed, NotebookTable, TableSequence
from pytpc.recording.declaration import Declared
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc.static.parameters import ByParameter, meant_by, parameter_name, same_parameter
from pytpc.static.static_info import StaticInfo
from pytpc.values.changes import changes_between
from pytpc.values.origins import PARAMS_FILE
from pytpc.values.recording import params_file

if TYPE_CHECKING:
    from typing_extensions import Unpack

_LISTED = 5


class DiagnoseSettings(TypedDict, total=False):
    """The settings of ``diagnose`` as keywords."""

    types: Types
    reference: Run | Sequence[Run] | None
    changes: Sequence[Change]
    top: int


def diagnose(
    mission: Recording | Source,
    static_info: StaticInfo | Source,
    question: Question | None = None,
    **settings: Unpack[DiagnoseSettings],
) -> Diagnosed:
    """How likely each parameter is to blame, by all marks of a mission, and which value to try.

    Args:
        mission: the mission with its marks.
        static_info: what the analysis found.
        question: all settings at once. Without it, declared ranges of parameters are read from the
            sources of the static information, and from the folder of a mission given by its path.
        **settings: in place of ``question``. ``types``: with ``ignore`` the types of the marks do
            not count. ``reference``: a good run of the same build, or several with the last one
            last; the folder of a run also tells its parameters. ``changes``: what was changed
            since the last good run, see `pytpc.values.changes.read_changes` and
            `pytpc.values.changes.changes_between`. ``top``: how many suspects get a value to try.

    Raises:
        InputError: the mission has no marks, or something cannot be read.
        TypeError: both ``question`` and other settings are given, or there is no such setting.
    """
    reference = settings.pop("reference", None)
    asked = question_of(question, settings, DiagnoseSettings.__annotations__)
    if question is not None and reference is not None:
        raise TypeError("give a question or single settings, not both")
    source = None if isinstance(mission, Recording) else Path(mission)
    run = RecordedRun(read_marked(mission), source)
    good = () if reference is None else reference
    return Diagnosed.of(AskedMission.of(run, load_static(static_info), asked, good).diagnosis)


def changes_since(before: Path, mission: Path) -> tuple[Change, ...]:
    """What differs between an earlier params.yaml and the one in a mission's folder.

    Raises:
        InputError: one of them does not exist or cannot be read.
    """
    after = params_file(mission)
    if after is None:
        raise InputError(f"has no {PARAMS_FILE} beside it to compare with --before", mission)
    return changes_between(before, after)


def is_compared(changes: Sequence[Change], static_info: StaticInfo) -> bool:
    """Whether one of the changed parameters is compared anywhere; otherwise changes say nothing."""
    names = ByParameter(Tpcs.of(static_info).names, str)
    return any(names.meant(one.parameter) for one in changes)


class RankSettings(TypedDict, total=False):
    """The settings of ``rank`` as keywords."""

    types: Types
    window_s: float


@dataclass(frozen=True, slots=True)
class Rankings(TableSequence[MarkRanking]):
    """The rankings of one mission, one for each mark, in the order of the marks.

    A sequence of `pytpc.diagnosis.results.suspects.MarkRanking`. ``recording`` and ``static_info``
    are what was ranked, with the settings of ``question``. ``source`` is the path of the mission if
    it was ranked by its path; a report shows the rest of its folder, too.
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
        named = with_names_of(recording, static_info, source)
        question = about_mission(question, static_info, named)
        recording = with_wiring(recording, source)
        found = rank_marks(recording, named, question)
        return cls(tuple(found), recording, named, source, question)

    @property
    def declared(self) -> Sequence[Declared]:
        """The declared ranges: those of the question, or else those in the sources."""
        given = self.question.declared
        return find_declared(self.static_info, self.source) if given is None else given

    def only(self, parameter: str) -> Rankings:
        """The rankings of one parameter, at its positions.

        Raises:
            InputError: no comparison with it is known.
        """
        name = self.named(parameter)
        return replace(self, rankings=tuple(one.only(name) for one in self.rankings))

    def named(self, parameter: str) -> str:
        """The parameter that a person means by its name, or by the end of its name in the source.

        Raises:
            InputError: no comparison with it is known, or several parameters end so.
        """
        names = sorted({parameter_name(found) for found in self.static_info.thresholds.values()})
        meant = meant_by(parameter, names)
        if not meant:
            hint = did_you_mean(parameter, names)
            raise InputError(f"no comparison with a parameter {plain(parameter)} is known{hint}")
        if len(meant) == 1:
            return meant[0]
        # The diagnosis takes this name for all of them.
        if any(same_parameter(parameter, name) for name in meant):
            return parameter
        which = plain(listed(meant, _LISTED))
        raise InputError(f"several end with {plain(parameter)}; give one of: {which}")

    @property
    def items(self) -> tuple[MarkRanking, ...]:
        """The ranking of each mark."""
        return self.rankings

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
        """The rows as a table; a mark without a ranking has a row that says why."""
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


@dataclass(frozen=True)
class AskedMission:
    """A mission that was read, and a question about it; each answer is worked out once.

    ``static_info`` has the names of this mission, and ``question`` what differs from the good runs.
    """

    run: RecordedRun
    static_info: StaticInfo
    question: Question

    @classmethod
    def of(
        cls,
        run: RecordedRun,
        static_info: StaticInfo,
        question: Question,
        good: Run | Sequence[Run] = (),
    ) -> AskedMission:
        """Put a question.

        Args:
            run: the mission.
            static_info: of its build.
            question: its ``declared`` is looked for if it is None.
            good: good runs, the last one last; may be empty.

        Raises:
            InputError: the values of a run cannot be read.
        """
        named = with_names_of(run.recording, static_info, run.source)
        if question.declared is None:
            question = replace(question, declared=find_declared(named, run.source))
        asked = beside(question, good, run, static_info, named)
        wired = replace(run, recording=with_wiring(run.recording, run.source))
        return cls(wired, named, asked)

    @cached_property
    def diagnosis(self) -> Diagnosis:
        """What all marks say together; without a mark, nobody is suspected."""
        return diagnose_mission(self.run.recording, self.static_info, self.question)

    @cached_property
    def rankings(self) -> Rankings:
        """The suspects at each mark."""
        recording, named = self.run.recording, self.static_info
        found = rank_marks(recording, named, self.question)
        return Rankings(tuple(found), recording, named, self.run.source, self.question)


def rank(
    mission: Recording | Source,
    static_info: StaticInfo | Source,
    question: Question | None = None,
    **settings: Unpack[RankSettings],
) -> Rankings:
    """The suspected parameters at each mark, most suspicious first.

    Args:
        mission: the mission with its marks.
        static_info: what the analysis found.
        question: all settings at once.
        **settings: in place of ``question``. ``types``: ``believe`` the observer's types, ``doubt``
            them (suspects of the other type still compete) or ``ignore`` them. ``window_s``: the
            window of type II, in seconds.

    Raises:
        InputError: the mission has no marks, or something cannot be read.
        TypeError: both ``question`` and other settings are given, or there is no such setting.
    """
    asked = question_of(question, settings, RankSettings.__annotations__)
    source = None if isinstance(mission, Recording) else Path(mission)
    return Rankings.of(read_marked(mission), load_static(static_info), asked, source)


def curves(
    mission: Recording | Source,
    static_info: StaticInfo | Source,
    question: Question | None = None,
    *,
    step_s: float = STEP_S,
    **settings: Unpack[RankSettings],
) -> RankCurves:
    """Scores and ranks of all parameters over the mission, every ``step_s`` seconds.

    The other arguments are those of ``rank``; ``types`` change nothing here.

    Raises:
        InputError: something cannot be read.
        TypeError: both ``question`` and other settings are given, or there is no such setting.
    """
    asked = question_of(question, settings, RankSettings.__annotations__)
    recording = read(mission)
    source = None if isinstance(mission, Recording) else Path(mission)
    named = with_names_of(recording, load_static(static_info), source)
    return rank_curves(recording, named, asked, step_s=step_s)
