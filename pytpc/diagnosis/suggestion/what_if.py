"""Replays a recorded run with another value of a parameter, before the robot is touched."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from pytpc.base.columns import Bools, Int64s
from pytpc.base.wording import Number, exact, listed, many
from pytpc.diagnosis.question import PLAIN, Question
from pytpc.diagnosis.results.advice import WhatIf
from pytpc.diagnosis.thresholds.replay import Track, tracks_of
from pytpc.recording.marks import Mark, MarkType
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo

CLOSED_LOOP = (
    "the robot would have gone on differently from the first decision that changes; what came after"
    " it is replayed as it was logged"
)

_NAMED = 2


def what_if(
    recording: Recording,
    static_info: StaticInfo,
    parameter: str,
    value: Number,
    question: Question = PLAIN,
) -> WhatIf:
    """Replay all comparisons of a parameter with another value of it.

    Args:
        recording: the mission.
        static_info: what the analysis found.
        parameter: its name in the source, or what `same_parameter` takes for it.
        value: in the parameter's unit.
        question: its ``kind``, ``marks`` and ``window_s``. Without a ``kind``, either definition
            answers a mark that has no type.

    Raises:
        InputError: there is no such parameter, or several.
    """
    kind, window_s = question.kind, question.window_s
    name, tracks, without = tracks_of(recording.events, recording.summaries, static_info, parameter)
    asked = _asked(recording, question)
    near = spans_before([mark.time_ns for mark in (*recording.marks, *asked)], window_s)
    answered = sum(_answers(tracks, value, mark, kind or mark.type, window_s) for mark in asked)
    counted = [count_turned(track, value, near) for track in tracks]
    flipped_near = sum(one.near for one in counted)
    result = WhatIf(
        parameter=name,
        value=value,
        marks=len(asked),
        answered=answered,
        evaluations=sum(one.evaluations for one in counted),
        flipped_near=flipped_near,
        flipped_away=sum(one.turned for one in counted) - flipped_near,
        text="",
        caveats=(
            *_caveats(tracks, without, recording),
            *_long_before(tracks, asked, kind, window_s),
        ),
        unsure=sum(one.unsure for one in counted),
        stops=kind == "I" and stops_all(tracks, value, near),
    )
    mixed = any(mark.type != kind for mark in asked)
    places = sorted({f"{track.comparison.file}:{track.comparison.lineno}" for track in tracks})
    return replace(result, text=_sentence(result, kind, places, mixed=mixed))


class Turned(NamedTuple):
    """How many evaluations of a track would turn, how many near to marks, and perhaps ``unsure``
    more."""

    evaluations: int
    turned: int
    near: int
    unsure: int


def count_turned(track: Track, value: Number, spans: Int64s) -> Turned:
    """What another value would turn; ``spans`` int64[s, 2] are the windows before the marks."""
    threshold = track.threshold(value)
    turned = track.turned(threshold) & track.own
    inside = within(track.time_ns, track.time_ns, spans)
    beside = within(track.kept.begin_ns, track.kept.end_ns, spans)
    least, most = track.turned_kept(np.ones_like(beside), threshold)
    return Turned(
        int(track.own.sum() + track.kept.count.sum()),
        int(turned.sum()) + least,
        int((turned & inside).sum()) + track.turned_kept(beside, threshold)[0],
        most - least,
    )


def _asked(recording: Recording, question: Question) -> tuple[Mark, ...]:
    kind = question.kind
    if question.marks is not None:
        return tuple(question.marks)
    return tuple(m for m in recording.marks if kind is None or m.type in {kind, None})


def _answers(
    tracks: Sequence[Track], value: Number, mark: Mark, kind: MarkType | None, window_s: float
) -> bool:
    """Whether the value answers a mark; without a type either definition will do."""
    if kind == "I":
        return _stays(tracks, value, mark.time_ns)
    turns = _turns(tracks, value, mark.time_ns, window_s)
    return turns or (kind is None and _stays(tracks, value, mark.time_ns))


def _stays(tracks: Sequence[Track], value: Number, mark_ns: int) -> bool:
    """Whether the parameter's last flop up to the mark would not have happened.

    Both of its evaluations must have the earlier outcome. A flop that another comparison of the
    predicate caused is not answered.
    """
    last = _last_flop(tracks, mark_ns)
    if last is None:
        return False
    track, pair = last
    before, after = track.turned(track.threshold(value), pair).tolist()
    return after and not before and bool(track.res[pair[0]] != track.res[pair[1]])


def _last_flop(tracks: Sequence[Track], mark_ns: int) -> tuple[Track, Int64s] | None:
    """The parameter's last flop up to a mark: which track's, and its two places; None for none."""
    last: tuple[int, Track, Int64s] | None = None
    for track in tracks:
        pair = track.flop_before(mark_ns)
        if pair is None:
            continue
        time_ns = int(track.time_ns[pair[1]])
        if last is None or time_ns > last[0]:
            last = (time_ns, track, pair)
    return None if last is None else last[1:]


def _turns(tracks: Sequence[Track], value: Number, mark_ns: int, window_s: float) -> bool:
    """Whether an evaluation of the window would have gone the other way."""
    begin_ns = mark_ns - round(window_s * 1e9)
    for track in tracks:
        threshold = track.threshold(value)
        kept = (track.kept.begin_ns >= begin_ns) & (track.kept.end_ns <= mark_ns)
        if track.turned(threshold, track.rows_between(begin_ns, mark_ns)).any():
            return True
        if kept.any() and track.turned_kept(kept, threshold)[0] > 0:
            return True
    return False


def spans_before(marks_ns: Sequence[int], window_s: float) -> Int64s:
    """int64[s, 2]: the windows before the marks, joined, in ascending order."""
    spans: list[list[int]] = []
    for time_ns in sorted(marks_ns):
        begin = time_ns - round(window_s * 1e9)
        if spans and begin <= spans[-1][1]:
            spans[-1][1] = time_ns
        else:
            spans.append([begin, time_ns])
    return np.array(spans, dtype=np.int64).reshape(-1, 2)


def stops_all(tracks: Sequence[Track], value: Number, near: Int64s) -> bool:
    """Whether with a value all evaluations would go the same way, also where nobody complained.

    ``near`` are the windows before the marks. If all that turns is in them, only what was wrong
    goes away.
    """
    ways = [track.ways(track.threshold(value)) for track in tracks]
    if not any(before > 1 for before, _ in ways) or any(after > 1 for _, after in ways):
        return False
    return any(
        (track.turned(threshold) & ~within(track.time_ns, track.time_ns, near)).any()
        or track.turned_kept(~within(track.kept.begin_ns, track.kept.end_ns, near), threshold)[0]
        for track, threshold in ((track, track.threshold(value)) for track in tracks)
    )


def within(begins: Int64s, ends: Int64s, spans: Int64s) -> Bools:
    """bool[n]: which of them touch one of the spans."""
    if not spans.size:
        return np.zeros(begins.size, dtype=np.bool_)
    place = np.searchsorted(spans[:, 0], ends, side="right") - 1
    return np.asarray((place >= 0) & (spans[place, 1] >= begins), dtype=np.bool_)


def _caveats(
    tracks: Sequence[Track], without: Sequence[str], recording: Recording
) -> tuple[str, ...]:
    if not tracks:
        return ("none of its comparisons was evaluated", *without)
    said = [CLOSED_LOOP]
    joined = [track for track in tracks if track.comparison.other_thresholds]
    if joined:
        said.append(
            f"other comparisons share a condition with {len(joined)} of its comparisons and may"
            " decide the outcome"
        )
    nodes = {int(node) for track in tracks for node in np.flatnonzero(np.bincount(track.node))}
    if len(nodes) > 1:
        names = ", ".join(sorted(recording.events.nodes[node] for node in nodes))
        said.append(f"several nodes read it, and all are replayed with the value: {names}")
    if any(np.ptp(track.thresh[np.isfinite(track.thresh)]) > 0 for track in tracks if _some(track)):
        said.append("it was changed during the mission; the value is replayed from begin to end")
    if any(len(track.kept) for track in tracks):
        said.append("only the extreme values of each summary are known")
    if any(track.comparison.relation == "flag" and _is_switch(track) for track in tracks):
        said.append("it selects a case of a switch; the log does not have all of its values")
    return (*said, *without)


def _long_before(
    tracks: Sequence[Track], asked: Sequence[Mark], kind: MarkType | None, window_s: float
) -> Iterator[str]:
    """A caveat if a mark of type I asks about a flop before its window."""
    ages = []
    for mark in asked:
        last = None if (kind or mark.type) == "II" else _last_flop(tracks, mark.time_ns)
        if last is not None:
            ages.append((mark.time_ns - int(last[0].time_ns[last[1][1]])) / 1e9)
    if max(ages, default=0.0) > window_s:
        yield (
            f"the last change was up to {max(ages):.3g} s before the mark; what turns more than"
            f" {window_s:g} s before it counts as away from marks"
        )


def _some(track: Track) -> bool:
    return track.comparison.relation != "flag" and bool(np.isfinite(track.thresh).any())


def _is_switch(track: Track) -> bool:
    kept = track.kept
    return bool(np.any(track.res != (track.thresh != 0)) or np.any(kept.res != (kept.thresh != 0)))


def _sentence(found: WhatIf, kind: MarkType | None, places: Sequence[str], *, mixed: bool) -> str:
    """What to show: ``0.0527 answers 4 of 4 marks of type II; away from marks it turns ...``.

    ``mixed`` marks are not all of ``kind``, so the sentence does not name the type.
    """
    if not found.evaluations:
        return "it was not evaluated, so nothing is known of other values"
    of = "" if kind is None or mixed else f" of type {kind}"
    away = f"{found.flipped_away:,} of {many(found.evaluations, 'decision')}"
    share = found.flipped_away / found.evaluations
    percent = f" ({100 * share:.2g} %)" if found.flipped_away and math.isfinite(share) else ""
    marks = f"answers {found.answered} of {many(found.marks, 'mark')}{of}"
    if not found.marks:
        marks = f"is replayed without a mark{of}"
    more = f", perhaps {found.unsure:,} more" if found.unsure else ""
    said = f"{exact(found.value)} {marks}; away from marks it turns {away}{percent}{more}"
    if found.stops:
        said += (
            f"; it would stop what {listed(places, _NAMED)} decides altogether: all"
            f" {many(found.evaluations, 'evaluation')} would go the same way"
        )
    return said
