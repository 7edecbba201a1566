"""The evaluations from which a suggestion is computed: the two of a flop, or those of a window."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pytpc.base.columns import Floats, Int64s
from pytpc.recording.events import Events
from pytpc.recording.marks import MarkType
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summaries


class NoneBecauseError(Exception):
    """Why there is no suggestion."""


@dataclass(frozen=True, slots=True)
class SuggestionEvidence:
    """Evaluations of one comparison up to a mark, those that count for a type of error.

    ``cmp`` and ``thresh`` are float64[n]: type I the two of the last flop, the earlier first; type
    II those of the window. ``threshold`` is the last one up to the mark, ``seen`` float64[m] are
    all up to it. ``summed`` says that summaries are among them, which have the ends alone.
    """

    cmp: Floats
    thresh: Floats
    threshold: float
    seen: Floats
    summed: bool


@dataclass(frozen=True, slots=True)
class _KeptEnds:
    """What summaries say of the evaluations in a window: those at the ends of what each encloses.

    The outermost values are all that type II asks for. ``threshold`` is the last one up to the
    mark, in the summary that ends at ``last_ns``. A summary that straddles an end of the window is
    taken where none lies within it, for its evaluations need not.
    """

    cmp: Floats
    thresh: Floats
    threshold: float
    last_ns: int

    @classmethod
    def of(
        cls, summaries: Summaries | None, key: str, mark_ns: int, window_s: float
    ) -> _KeptEnds | None:
        """None where there are none of ``key`` before the mark."""
        if summaries is None or key not in summaries.keys:
            return None
        begins = mark_ns - round(window_s * 1e9)
        own = summaries.take(summaries.key == summaries.keys.index(key))
        own = own.take(own.begin_ns <= mark_ns)
        if not len(own):
            return None
        last = int(np.argmax(own.end_ns))
        threshold, last_ns = float(own.thresh[last]), int(own.end_ns[last])
        within = own.take((own.begin_ns >= begins) & (own.end_ns <= mark_ns))
        if not len(within):
            within = own.take(own.end_ns >= begins)
        ends = [within.thresh + within.diff_min, within.thresh + within.diff_max]
        return cls(
            np.concatenate([*ends, within.cmp]), np.tile(within.thresh, 3), threshold, last_ns
        )


def evidence_of(
    recording: Recording, key: str, mark_ns: int, kind: MarkType, window_s: float
) -> SuggestionEvidence:
    """What the log has of ``key`` up to a mark.

    Raises:
        NoneBecauseError: there is nothing.
    """
    events = recording.events
    kept = _KeptEnds.of(recording.summaries, key, mark_ns, window_s)
    rows = _rows_up_to(events, key, mark_ns)
    if kept is None and not rows.size:
        raise NoneBecauseError("it was not evaluated before the mark")
    seen = events.thresh[rows]
    if kept is not None and (not rows.size or kept.last_ns >= events.time_ns[rows[-1]]):
        threshold = kept.threshold
        seen = np.append(seen, threshold)
    else:
        threshold = float(seen[-1])
    if kind == "I":
        pair = last_flop(events, rows)
        return SuggestionEvidence(events.cmp[pair], events.thresh[pair], threshold, seen, False)
    begin = mark_ns - round(window_s * 1e9)
    window = rows[int(np.searchsorted(events.time_ns[rows], begin, side="left")) :]
    cmp, thresh = events.cmp[window], events.thresh[window]
    if kept is not None:
        cmp, thresh = np.append(kept.cmp, cmp), np.append(kept.thresh, thresh)
    if not cmp.size:
        raise NoneBecauseError("it was not evaluated in the window before the mark")
    return SuggestionEvidence(cmp, thresh, threshold, seen, kept is not None)


def _rows_up_to(events: Events, key: str, mark_ns: int) -> Int64s:
    rows = events.rows_of(key)
    return rows[: int(np.searchsorted(events.time_ns[rows], mark_ns, side="right"))]


def last_flop(events: Events, rows: Int64s) -> Int64s:
    """The rows of the two evaluations of the last flop among ``rows``, the earlier first.

    Raises:
        NoneBecauseError: there is none.
    """
    flops = rows[events.flop[rows]]
    if not flops.size:
        raise NoneBecauseError("its result did not change before the mark")
    return np.array([events.previous[flops[-1]], flops[-1]], dtype=np.int64)
