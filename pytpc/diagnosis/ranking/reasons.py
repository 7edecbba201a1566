"""Why a parameter is a suspect, in one sentence."""

from __future__ import annotations

import numpy as np

from pytpc.base.wording import many, show
from pytpc.diagnosis.results.suspects import Suspect
from pytpc.recording.events import Floats
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording


def why(recording: Recording, suspect: Suspect, mark: Mark, window_s: float) -> str:
    """What the suspect's comparison did before the mark; empty if it did nothing.

    Type I: its last flop. Type II: its results in the window of ``window_s`` seconds, and the
    evaluation that came nearest to the other outcome.
    """
    if suspect.type == "I":
        return _last_flop(recording, suspect, mark)
    return _window(recording, suspect, mark, window_s)


def _last_flop(recording: Recording, suspect: Suspect, mark: Mark) -> str:
    events = recording.events
    rows = events.rows_of(suspect.key)
    flops = rows[events.flop[rows] & (events.time_ns[rows] <= mark.time_ns)]
    if not flops.size:
        return ""
    row = int(flops[-1])
    age = (mark.time_ns - int(events.time_ns[row])) / 1e9
    truth = "true" if events.result[row] else "false"
    text = f"It became {truth} {age:.2f} s before the mark"
    if suspect.comparison.relation == "flag":
        return f"{text}."
    cmp, thresh = float(events.cmp[row]), float(events.thresh[row])
    return f"{text}, with {show(cmp)} against {show(thresh)}."


def _window(recording: Recording, suspect: Suspect, mark: Mark, window_s: float) -> str:
    begin = f"In the {window_s:g} s before the mark it was"
    begin_ns = mark.time_ns - round(window_s * 1e9)
    events = recording.events
    rows = events.rows_of(suspect.key)
    rows = rows[(events.time_ns[rows] >= begin_ns) & (events.time_ns[rows] <= mark.time_ns)]
    cmp, thresh = events.cmp[rows], events.thresh[rows]
    count, true = int(rows.size), int(events.result[rows].sum())
    one = true in (0, count)
    summaries = recording.summaries
    if suspect.key in summaries.keys:
        # They count the events, too.
        own = summaries.take(summaries.key == summaries.keys.index(suspect.key))
        own = own.take((own.begin_ns >= begin_ns) & (own.end_ns <= mark.time_ns))
        if len(own):
            count = int(own.count.sum())
            one = not own.flops.any() and bool(own.result.all() or not own.result.any())
            true = count if own.result.all() else 0
            cmp = np.concatenate([own.thresh + own.diff_min, own.thresh + own.diff_max])
            thresh = np.tile(own.thresh, 2)
            if not one:
                return f"{begin} evaluated {many(count, 'time')}{_near(cmp, thresh)}"
    if not count:
        return ""
    each = f"all {many(count, 'time')}" if count > 1 else "the one time it was evaluated"
    truth = f"{'true' if true else 'false'} {each}"
    counted = truth if one else f"true {true:,} of {many(count, 'time')}"
    flag = suspect.comparison.relation == "flag"
    return f"{begin} {counted}{'.' if flag else _near(cmp, thresh)}"


def _near(cmp: Floats, thresh: Floats) -> str:
    """The end of the sentence: the values that were nearest to one another."""
    with np.errstate(invalid="ignore", over="ignore"):
        away = np.abs(cmp - thresh)
    if not np.any(np.isfinite(away)):
        return "."
    nearest = int(np.nanargmin(away))
    values = show(float(cmp[nearest])), show(float(thresh[nearest]))
    return f"; the compared value came closest at {values[0]}, against {values[1]}."
