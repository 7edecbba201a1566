"""Lets all methods rank the missions that nobody has ranked yet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path

from pytpc.study.data import missions
from pytpc.study.judge import POSITIONS_FILE, Judged, judge, save_positions
from pytpc.study.methods import METHODS
from pytpc.study.plan import Half
from pytpc.study.report.folder import Progress
from pytpc.study.report.positions import read_positions


def rank_missions(
    folder: Path,
    halves: Sequence[Half],
    on_progress: Progress | None = None,
    *,
    again: bool = False,
) -> None:
    """Complete ``results/positions.parquet`` by the missions of ``halves`` that it does not have.

    Args:
        folder: the study's.
        halves: nothing is read of other missions; what stands about them stays.
        on_progress: called with (missions read, missions in all).
        again: rank those of ``halves`` anew, for the methods have changed.

    Raises:
        InputError: a mission or the table cannot be read.
        TpcError: the table cannot be written.
    """
    path = folder / POSITIONS_FILE
    known: list[Judged] = list(read_positions(path)) if path.exists() else []
    kept = [row for row in known if not (again and row.half in halves)]
    ranked = {_mission(row) for row in kept}
    added = [
        row
        for mission in missions(folder, halves, on_progress)
        if (mission.system, mission.treatment, mission.seed) not in ranked
        for row in judge(mission, METHODS)
    ]
    if added or len(kept) != len(known):
        rows = [Judged(**{f.name: getattr(row, f.name) for f in fields(Judged)}) for row in kept]
        save_positions(sorted([*rows, *added], key=_mission), folder)


def _mission(row: Judged) -> tuple[str, str, int]:
    return (row.system, row.treatment, row.seed)
