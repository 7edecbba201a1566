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

    A mission that was flown or marked anew since it was ranked is ranked again.

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
    ranked: dict[tuple[str, str, int], list[Judged]] = {}
    for row in kept:
        ranked.setdefault(_mission(row), []).append(row)
    is_new = len(kept) != len(known)
    for mission in missions(folder, halves, on_progress):
        place = (mission.system, mission.treatment, mission.seed)
        if place in ranked and all(row.digest == mission.digest for row in ranked[place]):
            continue
        ranked[place] = list(judge(mission, METHODS))
        is_new = True
    if is_new:
        names = [field.name for field in fields(Judged)]
        rows = [
            Judged(**{name: getattr(row, name) for name in names})
            for place in sorted(ranked)
            for row in ranked[place]
        ]
        save_positions(rows, folder)


def _mission(row: Judged) -> tuple[str, str, int]:
    return (row.system, row.treatment, row.seed)
