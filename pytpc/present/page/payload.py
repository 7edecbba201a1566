"""The numbers of a mission from which the page's script draws, as JSON inside the page.

Columns of numbers are little-endian arrays in base64, which a browser reads at once and without
loss (JSON has no NaN and no infinities). The evaluations of a TPC are in the page once for each
mission, however many cards show them.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt
from markupsafe import Markup

from pytpc.base.columns import Floats
from pytpc.diagnosis.results.advice import RankCurves
from pytpc.present.page.environment import seen
from pytpc.present.page.series import gap_after, kept_of, lane, results_of, runs, thin
from pytpc.recording.marks import MarkType
from pytpc.recording.mission import Recording

KEPT = 200_000
"""The most evaluations of one TPC in the page; of more, the extremes are kept."""

FINE = 6000
"""The number of columns of a lane that can be zoomed into."""

_RANKS = 65_535


def embedded(document: object) -> Markup:
    """JSON that may stand in a script element: nothing in it can end the element."""
    text = json.dumps(document, ensure_ascii=True, allow_nan=False, separators=(",", ":"))
    for sign in "<>&":
        text = text.replace(sign, f"\\u{ord(sign):04x}")
    return Markup(text)


def base64_of(values: npt.NDArray[np.generic]) -> str:
    """The bytes of an array, little-endian, in base64."""
    return base64.b64encode(
        np.ascontiguousarray(values, values.dtype.newbyteorder("<")).tobytes()
    ).decode("ascii")


def series_of(recording: Recording, key: str) -> dict[str, object]:
    """The evaluations of one TPC.

    Returns:
        ``t`` float32 seconds since the recording began, ``c`` float64 compared values, ``r`` uint8
        results, ``lt`` and ``lv`` float64 when the threshold became what it is, ``gap`` seconds
        after which a line is not drawn on, ``of`` how many evaluations there were, ``kept`` the
        four columns of `kept_of`, ``results`` those of `results_of`.
    """
    events, start_ns = recording.events, recording.start_ns
    rows = events.rows_of(key)
    spans = kept_of(recording.summaries, key, start_ns)
    seconds = (events.time_ns[rows] - start_ns) / 1e9
    kept = rows[thin(seconds, events.cmp[rows], KEPT)]
    limit = events.thresh[rows]
    same = (limit[1:] == limit[:-1]) | (np.isnan(limit[1:]) & np.isnan(limit[:-1]))
    change = np.flatnonzero(np.concatenate([[True], ~same])[: limit.size])
    change = change[thin(seconds[change], limit[change], KEPT)]
    return {
        "t": base64_of(((events.time_ns[kept] - start_ns) / 1e9).astype(np.float32)),
        "c": base64_of(events.cmp[kept]),
        "r": base64_of(events.result[kept].astype(np.uint8)),
        "lt": base64_of(seconds[change]),
        "lv": base64_of(limit[change]),
        "gap": gap_after(seconds),
        "of": int(rows.size),
        "kept": [base64_of(column) for column in spans],
        "results": [base64_of(column) for column in results_of(recording.summaries, key, start_ns)],
    }


def lanes_of(recording: Recording, lanes: Sequence[tuple[str, str]]) -> dict[str, object]:
    """The lanes of the timeline, from pairs of (label, key)."""
    found = [lane(recording, key, FINE) for _, key in lanes]
    return {
        "labels": [calm(label) for label, _ in lanes],
        "columns": FINE,
        "runs": [base64_of(np.array(runs(states), dtype=np.int32).reshape(-1)) for states in found],
    }


def curves_of(curves: RankCurves, names: Sequence[str], start_ns: int) -> dict[str, object]:
    """Both rank curves of ``names``: uint16 of 65,535ths, by type, and the times."""
    places = [curves.parameters.index(name) for name in names]
    return {
        "t": base64_of(((curves.times_ns - start_ns) / 1e9).astype(np.float64)),
        "I": [_ranks(curves.rank1[:, place]) for place in places],
        "II": [_ranks(curves.rank2[:, place]) for place in places],
    }


def marks_json(marks: Sequence[tuple[float, MarkType | None]]) -> list[Mapping[str, object]]:
    """Marks as (seconds, type) in the order of the page."""
    return [{"t": time, "type": kind or ""} for time, kind in marks]


def calm(text: str) -> str:
    """``text`` without what Bokeh takes for a formula, for which it would load MathJax."""
    text = seen(text)
    for start in ("$$", "\\[", "\\("):
        text = text.replace(start, f"{start[0]}\N{WORD JOINER}{start[1]}")
    return text


def _ranks(values: Floats) -> str:
    return base64_of(np.rint(np.clip(np.nan_to_num(values), 0, 1) * _RANKS).astype(np.uint16))
