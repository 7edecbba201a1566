"""What recordings say of a robot's parameters, for `lint`."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pytpc.api.missions import read_named, with_names_of
from pytpc.lint.facts import Crossing
from pytpc.lint.finding import Spot
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_values import ParameterValues, SetValue, ValueChange
from pytpc.static.parameters import DYNAMIC, base_key, resolved
from pytpc.static.static_info import StaticInfo
from pytpc.values.origins import START_FILE
from pytpc.values.recording import params_file, read_parameters


@dataclass(frozen=True, slots=True)
class Recorded:
    """The changes of values while the robot ran, and the thresholds that were never crossed."""

    changes: tuple[ValueChange, ...] = ()
    crossings: tuple[Crossing, ...] = ()


@dataclass(slots=True)
class _Side:
    """The evaluations of one comparison in one node, all with the same outcome so far."""

    parameter: str
    spot: Spot
    source_code: str
    threshold: float = math.nan
    evaluations: int = 0
    seconds: float = 0.0
    nearest: float = math.inf
    result: bool = False
    recordings: int = 0
    is_crossed: bool = False


def recorded(missions: Sequence[Path], static: StaticInfo) -> Recorded:
    """Read recordings of one robot.

    Args:
        missions: bags, files or folders.
        static: of the build that was recorded.

    Raises:
        InputError: one cannot be read.
    """
    changes: list[ValueChange] = []
    sides: dict[tuple[str, str], _Side] = {}
    for mission in missions:
        recording = read_named(mission)
        changes += _changes(recording, mission)
        named = with_names_of(recording, static, mission)
        for key, comparison in named.comparisons.items():
            if comparison.type not in ("parameter", "derived") or comparison.source is None:
                continue
            unit = named.unit_of(key)
            spot = Spot(unit.absolute(comparison.file), comparison.lineno)
            for node in sorted(recording.nodes_of.get(key, ())):
                name = resolved(comparison.source, node.partition(" ")[0])
                if DYNAMIC not in name:
                    new = _Side(name, spot, comparison.source_code or "the comparison")
                    side = sides.setdefault((base_key(key), name), new)
                    _add(side, recording, key, node)
    return Recorded(tuple(changes), tuple(_crossings(sides)))


def _changes(recording: Recording, mission: Path) -> Iterator[ValueChange]:
    yield from ParameterValues(recording.values).changes()
    folder = mission if mission.is_dir() else mission.parent
    start, end = folder / START_FILE, params_file(mission)
    if start.is_file() and end is not None and not recording.values:
        before, after = read_parameters(start), read_parameters(end)
        found = [SetValue(recording.start_ns, name, value) for name, value in before.items()]
        found += [
            SetValue(recording.end_ns, name, value)
            for name, value in after.items()
            if name in before
        ]
        yield from ParameterValues(found).changes()


def _add(side: _Side, recording: Recording, key: str, node: str) -> None:
    """Add what a recording has of a comparison in a node."""
    times: list[int] = []
    results: set[bool] = set()
    evaluations = 0
    table = recording.summaries
    rows = table.rows_in(key, node)
    if len(rows):
        evaluations = int(table.count[rows].sum())
        results |= set(map(bool, table.res[rows]))
        times += [int(table.begin_ns[rows].min()), int(table.end_ns[rows].max())]
        side.is_crossed |= bool(table.flops[rows].any())
        low, high = table.diff_min[rows], table.diff_max[rows]
        side.is_crossed |= bool(np.any((low < 0) & (high > 0)))
        near = np.minimum(np.abs(low), np.abs(high))
        side.nearest = min(
            side.nearest, float(np.nanmin(near)) if np.isfinite(near).any() else math.inf
        )
        side.threshold = float(table.thresh[rows[-1]])
    events = recording.events
    rows = events.rows_in(key, node)
    if len(rows):
        evaluations = max(evaluations, len(rows))
        results |= set(map(bool, events.res[rows]))
        times += [int(events.time_ns[rows[0]]), int(events.time_ns[rows[-1]])]
        apart = np.abs(events.cmp[rows] - events.thresh[rows])
        if np.isfinite(apart).any():
            side.nearest = min(side.nearest, float(np.nanmin(apart)))
        side.threshold = float(events.thresh[rows[-1]])
    if not evaluations:
        return
    side.is_crossed |= len(results) > 1 or (side.recordings > 0 and side.result not in results)
    side.result = results.pop()
    side.evaluations += evaluations
    side.seconds += (max(times) - min(times)) / 1e9
    side.recordings += 1


def _crossings(sides: dict[tuple[str, str], _Side]) -> Iterator[Crossing]:
    """One for each parameter none of whose comparisons was crossed: that with most evaluations."""
    crossed = {side.parameter for side in sides.values() if side.is_crossed}
    most: dict[str, _Side] = {}
    for side in sides.values():
        if side.evaluations and side.parameter not in crossed:
            before = most.get(side.parameter)
            if before is None or before.evaluations < side.evaluations:
                most[side.parameter] = side
    for side in most.values():
        yield Crossing(
            side.parameter,
            side.spot,
            side.source_code,
            side.threshold,
            side.evaluations,
            side.seconds,
            side.nearest if math.isfinite(side.nearest) else math.nan,
            side.result,
            side.recordings,
        )
