"""Both scores of all TPCs and parameters at many times, for rankings and for rank curves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt

from pytpc.base.errors import TpcError
from pytpc.diagnosis.question import PLAIN, WINDOW_S, Question
from pytpc.diagnosis.results.advice import RankCurves
from pytpc.diagnosis.scores.scores import Formula, ParameterTable, by_parameter, combined, type1
from pytpc.diagnosis.scores.summary_scores import LogTables, type2_of_summaries
from pytpc.recording.events import Events, Floats
from pytpc.recording.marks import MarkType
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summaries
from pytpc.static.parameters import parameter_name
from pytpc.static.static_info import StaticInfo

STEP_S = 0.1
"""10 Hz."""

# Some 2 GB in all five tables. A mission that seems to take decades has two clocks in it.
_MOST_NUMBERS = 50_000_000


@dataclass(frozen=True)
class Tpcs:
    """The n TPCs on parameters, sorted by key; those with constants are left out.

    ``keys`` are theirs, ``distance`` float64[n], ``parameters`` the name of each one's parameter.
    """

    keys: tuple[str, ...]
    distance: Floats
    parameters: tuple[str, ...]

    @classmethod
    def of(cls, static_info: StaticInfo) -> Tpcs:
        """The TPCs that the analysis found."""
        found = static_info.thresholds
        keys = tuple(sorted(found))
        return cls(
            keys,
            np.array([found[key].distance for key in keys], dtype=np.float64),
            tuple(parameter_name(found[key]) for key in keys),
        )

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The p parameters, sorted: the columns of a `ParameterTable`."""
        return tuple(sorted(set(self.parameters)))

    @cached_property
    def keys_of(self) -> dict[str, tuple[str, ...]]:
        """The TPCs of each parameter, in the order of their keys."""
        found: dict[str, list[str]] = {name: [] for name in self.names}
        for key, name in zip(self.keys, self.parameters, strict=True):
            found[name].append(key)
        return {name: tuple(keys) for name, keys in found.items()}


class TpcScores(NamedTuple):
    """Both scores of the TPCs, float64[times, n] each."""

    first: Floats
    second: Floats


class Tables(NamedTuple):
    """Both scores of the parameters."""

    first: ParameterTable
    second: ParameterTable

    def of(self, kind: MarkType) -> ParameterTable:
        """The one for marks of that type."""
        return self.first if kind == "I" else self.second

    @property
    def combined(self) -> Floats:
        """float64[t, p]: the better of both ranks, for marks without a type."""
        return combined(self.first.ranks, self.second.ranks)


def tpc_scores(
    tpcs: Tpcs, reports: LogTables, times_ns: npt.ArrayLike, window_s: float = WINDOW_S
) -> TpcScores:
    """Both scores of every TPC at all times.

    Args:
        tpcs: n of them.
        reports: the events with ``tpcs.keys`` as their keys (`Events.with_keys`).
        times_ns: int64[t], in any order.
        window_s: the window of type II in seconds.
    """
    times = np.atleast_1d(np.asarray(times_ns, dtype=np.int64))
    asked = (tpcs.distance.tobytes(), times.tobytes(), window_s)
    known = _KEPT.get(reports.events)
    same = known is not None and known.summaries is reports.summaries and known.asked == asked
    if known is not None and same and reports.before is None:
        return known.scores
    formula = Formula(window_s)
    scores = TpcScores(
        type1(reports.events, times, tpcs.distance, formula, reports.before),
        type2_of_summaries(reports, times, tpcs.distance, formula),
    )
    if reports.before is None and times.size <= _MOST_KEPT:
        _KEPT[reports.events] = _KeptScores(reports.summaries, asked, scores)
    return scores


class _KeptScores(NamedTuple):
    """The last scores of a table: each mark's ranking and all marks together ask for the same."""

    summaries: Summaries
    asked: tuple[bytes, bytes, float]
    scores: TpcScores


_KEPT: WeakKeyDictionary[Events, _KeptScores] = WeakKeyDictionary()
_MOST_KEPT = 1000


def parameter_tables(tpcs: Tpcs, scores: TpcScores) -> Tables:
    """The scores of the TPCs joined by parameter, with ranks."""
    names, distance, keys = tpcs.parameters, tpcs.distance, tpcs.keys
    return Tables(*(by_parameter(one, names, distance, keys) for one in scores))


def rank_curves(
    recording: Recording,
    static_info: StaticInfo,
    question: Question = PLAIN,
    *,
    step_s: float = STEP_S,
) -> RankCurves:
    """The curves of a mission, from its begin to its end every ``step_s`` seconds.

    Each value is what an observer would have got at that time: nothing later counts.

    Raises:
        ValueError: ``step_s`` is less than a nanosecond.
        TpcError: there are too many steps.
    """
    step_ns = round(step_s * 1e9)
    if step_ns < 1:
        raise ValueError("step_s is less than a nanosecond")
    tpcs = Tpcs.of(static_info)
    steps = (recording.end_ns - recording.start_ns) // step_ns + 1
    if steps * max(1, len(tpcs.keys)) > _MOST_NUMBERS:
        raise TpcError(
            f"{recording.name}: {recording.seconds:.0f} s in steps of {step_s:g} s are too many for"
            f" {len(tpcs.keys)} comparisons; take longer steps (or are there two clocks in it?)"
        )
    times = recording.start_ns + step_ns * np.arange(steps, dtype=np.int64)
    events = recording.events.with_keys(tpcs.keys)
    scores = tpc_scores(tpcs, LogTables(events, recording.summaries), times, question.window_s)
    tables = parameter_tables(tpcs, scores)
    return RankCurves(
        times_ns=times,
        parameters=tables.first.names,
        score1=tables.first.scores,
        score2=tables.second.scores,
        rank1=tables.first.ranks,
        rank2=tables.second.ranks,
        combined=tables.combined,
    )
