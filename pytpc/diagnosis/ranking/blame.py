"""Which parameter all marks of a mission blame together, in words for a user.

``blame`` is the entrance. It adds notes to the probabilities of
`pytpc.diagnosis.ranking.other_values` if the marks or the reports are not enough.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import groupby

from pytpc.base.wording import many
from pytpc.diagnosis.question import PLAIN, Question
from pytpc.diagnosis.ranking.grouped import suspect_groups
from pytpc.diagnosis.ranking.mark_ranking import outside
from pytpc.diagnosis.ranking.other_nodes import OtherNodes
from pytpc.diagnosis.ranking.other_values import diagnose_among, diagnose_beside, unheard
from pytpc.diagnosis.ranking.posterior import Decisive, Posterior
from pytpc.diagnosis.ranking.reach import place_notes
from pytpc.diagnosis.ranking.result_streams import ResultStreams
from pytpc.diagnosis.ranking.summarised import with_summarised
from pytpc.diagnosis.ranking.uncompared import by_size, with_uncompared
from pytpc.diagnosis.results.suspects import (
    Accused,
    Blame,
    Evaluation,
    Suspected,
)
from pytpc.diagnosis.scores.evaluations import KeyRows, LoggedEvaluations
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.diagnosis.turn_groups import groups_in
from pytpc.recording.events import Events
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo

_DIGITS = 9
"""Digits of the logarithms of probabilities after which suspects are tied."""


def blame(recording: Recording, static_info: StaticInfo, question: Question = PLAIN) -> Blame:
    """Judge the parameters by all marks of a mission.

    Args:
        recording: the mission with its marks.
        static_info: what the analysis found.
        question: its ``references``, ``changes`` and ``differences``, or ``others`` in their place.
            The ``types`` ``believe`` and ``doubt`` are the same here: types are never certain. A
            mark without a report in ``window_s`` before it does not count.
    """
    if question.types == "ignore":
        untyped = tuple(replace(mark, type=None) for mark in recording.marks)
        recording = replace(recording, marks=untyped)
    tpcs = Tpcs.of(static_info)
    log = LoggedEvaluations(recording.events.with_keys(tpcs.keys), recording.summaries)
    events = with_summarised(recording).with_keys(tpcs.keys)
    beyond = [outside(mark, log, question.window_s) for mark in recording.marks]
    notes = (*_notes(recording, beyond), *place_notes(recording, static_info))
    if not recording.marks or all(beyond) or not len(events):
        return Blame((), 1.0, len(tpcs.names), recording.marks, notes)
    found = _diagnosed(recording, static_info, question)
    streams = ResultStreams.of(with_summarised(recording), tpcs)
    others = OtherNodes.of(streams, tpcs, static_info, recording.wiring)
    compared = _compared(found, static_info, recording.marks, events)
    if others is not None:
        last_ns = max(mark.time_ns for mark in recording.marks)
        compared = _with_followed(compared, others, (last_ns - streams.begin_ns) / 1e9)
    differences = question.differences
    left, silent = with_uncompared(found, recording, streams, differences)
    compared = tuple(replace(one, probability=left * one.probability) for one in compared)
    no_word = {found.names[column] for column in unheard(recording, streams)}
    suspects = _in_order(by_size((*compared, *silent), differences, no_word))
    code = None if differences is None else differences.code
    turning = groups_in(streams, tpcs, recording)
    groups = suspect_groups(suspects, turning, streams, tpcs, recording.marks)
    none = left * found.none
    made = Blame(suspects, none, len(tpcs.names), recording.marks, notes, code, groups)
    if len(recording.marks) > 1 or made.accused is not None:
        return made
    return replace(
        made, notes=(*notes, "one mark says little: mark the error each time it happens")
    )


def _diagnosed(recording: Recording, static_info: StaticInfo, question: Question) -> Posterior:
    if question.others:
        return diagnose_among(recording, static_info, question.others)
    return diagnose_beside(
        recording,
        static_info,
        references=question.references,
        changes=question.changes,
        differences=question.differences,
    )


def _in_order(suspects: Iterable[Suspected]) -> tuple[Suspected, ...]:
    """The suspects with their positions, the likeliest first; equal ones as they are given."""
    made: list[Suspected] = []
    for _, equal in groupby(sorted(suspects, key=_unlikely), key=_unlikely):
        alike = list(equal)
        position, tied = len(made) + 1, len(alike) > 1
        made += [replace(one, position=position, tied=tied) for one in alike]
    return tuple(made)


def _unlikely(suspect: Suspected) -> float:
    return -round(math.log(max(suspect.probability, sys.float_info.min)), _DIGITS)


def _compared(
    found: Posterior, static_info: StaticInfo, marks: Sequence[Mark], events: Events
) -> tuple[Accused, ...]:
    """The compared parameters, without their positions."""
    last_ns = max(mark.time_ns for mark in marks)
    suspects: list[Accused] = []
    for column in found.order:
        by = found.decisive[column]
        assert by is not None, "what is in the order was compared"
        suspects.append(
            Accused(
                position=1,
                tied=False,
                parameter=found.names[column],
                probability=float(found.posterior[column]),
                type="I" if by.type1 > 1 / 2 else "II",
                key=by.key,
                comparison=static_info.comparisons[by.key],
                last=_last(events, by, last_ns),
            )
        )
    return tuple(suspects)


def _with_followed(
    suspects: tuple[Accused, ...], others: OtherNodes, until_s: float
) -> tuple[Accused, ...]:
    return tuple(
        replace(one, followed=others.followed(one.key, one.last.node, until_s)) for one in suspects
    )


def _last(events: Events, by: Decisive, time_ns: int) -> Evaluation:
    """The last evaluation of a comparison in a node up to a time, or its first."""
    rows = events.rows_in(by.key, by.node)
    return KeyRows(events, rows, events.time_ns[rows]).at(time_ns)


def _notes(recording: Recording, beyond: Sequence[str]) -> tuple[str, ...]:
    """What is wrong with the marks (those with the same reason together) and with the reports."""
    places: dict[str, list[str]] = {}
    for number, reason in enumerate(beyond, start=1):
        if reason:
            places.setdefault(reason, []).append(str(number))
    notes = [f"{_marks(numbers)}: {reason}" for reason, numbers in places.items()]
    if len(recording.summaries):
        count = int(recording.summaries.count.sum())
        notes.append(
            f"{many(count, 'evaluation')} came as summaries, of which only the extremes and the"
            " last are judged; TPC_POLICY=every reports them one by one"
        )
    return tuple(notes)


def _marks(numbers: Sequence[str]) -> str:
    return f"mark{'' if len(numbers) == 1 else 's'} {', '.join(numbers)}"
