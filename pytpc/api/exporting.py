"""A mission for other viewers: what is exported is worked out once, for all of their formats."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from pytpc.api.diagnosing import AskedMission
from pytpc.api.export_series import ExportSeries, rows_of
from pytpc.api.export_values import values_over_time
from pytpc.base.columns import Int64s
from pytpc.base.legal_names import LegalNames
from pytpc.base.wording import show
from pytpc.diagnosis.results.advice import RankCurves
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.diagnosis.results.exported import (
    FIXED_TOPICS,
    ExportedLine,
    ExportedSuspect,
    ExportedSuspects,
    MissionExport,
    Progress,
)
from pytpc.diagnosis.scores.score_tables import rank_curves
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording

PERIOD_S = 1.0
"""How often the ranks of all parameters are exported, in seconds."""

_FIRST = 3
_MOST_JUDGED = 50
_MOST_TURNS = 5000


def export_of(
    asked: AskedMission,
    *,
    period_s: float = PERIOD_S,
    on_progress: Progress | None = None,
) -> MissionExport:
    """Work out what is exported of a mission.

    The marks are judged once for each: what all marks up to it say together. Of more than 50 marks,
    50 that are evenly spread are judged, and the last one.

    Args:
        asked: the mission and the question about it.
        period_s: how often the ranks of all parameters are exported, in seconds.
        on_progress: called with (marks judged, marks to judge).

    Raises:
        TpcError: the mission has too many periods.
    """
    recording, static_info = asked.run.recording, asked.static_info
    names = LegalNames()
    for topic in FIXED_TOPICS:
        names.take(topic)
    found = ExportSeries.of(recording, static_info, names)
    ranks = _ranked(rank_curves(recording, static_info, asked.question, step_s=period_s))
    suspects = tuple(_judged(asked, found, on_progress))
    first = _first_series(recording, found, suspects, ranks)
    log = sorted(
        [
            *map(mark_line, recording.marks),
            *map(verdict_line, suspects),
            *_turns(recording, found, first),
        ]
    )
    return MissionExport(
        name=recording.name,
        start_ns=recording.start_ns,
        end_ns=recording.end_ns,
        series=found.series,
        values=tuple(values_over_time(recording, static_info, found, names)),
        marks=recording.marks,
        suspects=suspects,
        ranks=ranks,
        rank_topics=tuple(names.take("tpc", "ranks", name) for name in ranks.parameters),
        probability_topics={
            name: names.take("tpc", "probabilities", name)
            for name in sorted({one.parameter for at in suspects for one in at.suspects})
        },
        log=tuple(log),
        first=first,
        ranges=tuple(_range_of(recording, found.series[number].key) for number in first),
        count=found.count,
        unknown=len(recording.events) + len(recording.summaries) - found.count,
        rows=partial(rows_of, recording, found),
    )


def _ranked(curves: RankCurves) -> RankCurves:
    """Only the parameters that are suspected at any time."""
    ever = np.flatnonzero((curves.combined > 0).any(axis=0))
    return RankCurves(
        curves.times_ns,
        tuple(curves.parameters[number] for number in ever),
        *(
            one[:, ever]
            for one in (curves.score1, curves.score2, curves.rank1, curves.rank2, curves.combined)
        ),
    )


def _judged(
    asked: AskedMission, found: ExportSeries, on_progress: Progress | None
) -> Iterator[ExportedSuspects]:
    """What the marks up to each one say."""
    recording = asked.run.recording
    total = len(recording.marks)
    chosen = sorted(set(np.linspace(1, total, min(total, _MOST_JUDGED)).round().astype(int)))
    for done, count in enumerate(chosen, start=1):
        past = recording.marks[:count]
        run = replace(asked.run, recording=replace(recording, marks=past))
        so_far = replace(asked, run=run) if count < total else asked
        yield suspects_at(past[-1], int(count), so_far.diagnosis, found.of_key)
        if on_progress is not None:
            on_progress(done, len(chosen))


def suspects_at(
    mark: Mark,
    number: int,
    diagnosis: Diagnosis,
    of_key: Callable[[str | None], tuple[int, ...]],
) -> ExportedSuspects:
    """What is shown of a diagnosis.

    Args:
        mark: the last one that counts.
        number: of that mark, from 1.
        diagnosis: by all marks up to it.
        of_key: the numbers of a comparison's series.
    """
    to_try = {
        one.accused.parameter: show(one.remedy.value)
        for one in diagnosis.advice
        if one.remedy.value is not None
    }
    suspects = tuple(
        ExportedSuspect(
            one.position,
            one.parameter,
            one.probability,
            one.type or "",
            one.place,
            one.key or "",
            to_try.get(one.parameter, ""),
            of_key(one.key),
        )
        for one in diagnosis.blame.suspects
    )
    return ExportedSuspects(
        mark.time_ns,
        number,
        suspects,
        diagnosis.blame.none,
        diagnosis.headline,
        diagnosis.action,
    )


def _first_series(
    recording: Recording,
    found: ExportSeries,
    suspects: Sequence[ExportedSuspects],
    ranks: RankCurves,
) -> tuple[int, ...]:
    """The series of the first suspects; without marks, of those that rank highest at the end.

    Of several series of one suspect, such as those of two nodes, the one that turned most often.
    """
    if suspects:
        several: list[Sequence[int]] = [one.series for one in suspects[-1].suspects]
    else:
        last = ranks.combined[-1] if ranks.times_ns.size else np.zeros(len(ranks.parameters))
        by_name: defaultdict[str, list[int]] = defaultdict(list)
        for number, one in enumerate(found.series):
            by_name[one.parameter].append(number)
        order = np.argsort(-last, kind="stable")
        several = [by_name.get(ranks.parameters[number], ()) for number in order]
    turns = _turns_of(recording, found)
    chosen = [max(numbers, key=lambda one: turns[one]) for numbers in several if numbers]
    return tuple(dict.fromkeys(chosen))[:_FIRST]


def _turns_of(recording: Recording, found: ExportSeries) -> Int64s:
    """int64[series]: how often each one turned."""
    turns = np.zeros(len(found.series), np.int64)
    events, summaries = recording.events, recording.summaries
    series = found.of_events[events.key, events.node]
    own = (series >= 0) & events.flop
    np.add.at(turns, series[own], 1)
    series = found.of_summaries[summaries.key, summaries.node]
    own = (series >= 0) & found.has_untold
    np.add.at(turns, series[own], summaries.flops[own])
    return turns


def _range_of(recording: Recording, key: str) -> tuple[float, float]:
    """The lowest and the highest number of a comparison; 0 and 1 where there is none."""
    parts = []
    for table in (recording.events, recording.summaries):
        rows = table.rows_of(key)
        parts += [table.cmp[rows], table.thresh[rows]]
    numbers = np.concatenate(parts)
    finite = numbers[np.isfinite(numbers)]
    return (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)


def mark_line(mark: Mark) -> ExportedLine:
    """A mark as a line of the log."""
    kind = f"type {mark.type}" if mark.type else "without a type"
    note = f": {mark.note}" if mark.note else ""
    return ExportedLine(mark.time_ns, "mark", mark.observer or "observer", f"mark {kind}{note}")


def verdict_line(found: ExportedSuspects) -> ExportedLine:
    """A verdict as a line of the log."""
    action = f"; {found.action}" if found.action else ""
    return ExportedLine(found.time_ns, "verdict", "suspects", f"{found.text}{action}")


def _turns(
    recording: Recording, found: ExportSeries, first: Sequence[int]
) -> Iterator[ExportedLine]:
    """The changes of the first suspects' results; of very many, the last ones."""
    events = recording.events
    turned = np.flatnonzero(events.flop)
    series = found.of_events[events.key[turned], events.node[turned]]
    for row in turned[np.isin(series, first)][-_MOST_TURNS:].tolist():
        one = found.series[int(found.of_events[events.key[row], events.node[row]])]
        came = "true" if events.result[row] else "false"
        cmp, thresh = show(float(events.cmp[row])), show(float(events.thresh[row]))
        relation = "against" if one.relation == "flag" else one.relation
        yield ExportedLine(
            int(events.time_ns[row]),
            "turn",
            one.parameter,
            f"{one.place} turned {came}: {cmp} {relation} {thresh}",
        )
