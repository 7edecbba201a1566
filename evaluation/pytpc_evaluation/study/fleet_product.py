"""Has the product rank the missions of a question, as ``pytpc fleet add`` and ``rank`` do.

All missions of a system are added once, to ``sets/SYSTEM`` in the folder of fleets, and as their
marks alone say, to ``sets/SYSTEM-by-marks``. The data set of a question has links to the files of
its missions alone, so that nothing else can be seen.
"""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pytpc.api.dask_engine import Engine
from pytpc.api.fleet_adding import AddOptions, add
from pytpc.api.fleet_adding import Verdict as Said
from pytpc.api.fleet_asking import rank
from pytpc.api.fleet_given import Given
from pytpc.base.errors import TpcError
from pytpc.diagnosis.results.fleet import FleetRanking
from pytpc.fleet.data_set import Fleet, Place
from pytpc_evaluation.study.case import Verdict
from pytpc_evaluation.study.fleet_judge import Progress
from pytpc_evaluation.study.fleet_questions import FleetQuestion

_SETS = "sets"


def add_flown(
    out: Path,
    rows: Iterable[Mapping[str, Any]],
    engine: Engine,
    on_progress: Progress | None = None,
    *,
    by_marks: bool = False,
) -> dict[str, Place]:
    """Add flown missions to the data sets of their systems, unless they are there.

    Those without a wrong parameter are said to be good, the others bad, unless it is ``by_marks``.

    Args:
        out: the folder of fleets.
        rows: of ``flights.json``.
        engine: where the work is done.
        on_progress: called with (missions done, missions in all).

    Returns:
        The place of each mission in its data set, by its folder.

    Raises:
        TpcError: a mission cannot be added, or a data set not written.
    """
    groups: dict[tuple[str, Said | None], list[Mapping[str, Any]]] = {}
    for row in rows:
        if row["state"] == "done":
            right: Said = "good" if row["parameter"] is None else "bad"
            said = None if by_marks else right
            groups.setdefault((row["system"], said), []).append(row)
    whole, before = sum(map(len, groups.values())), 0
    places = {}
    for (system, said), own in groups.items():
        given = [Given(out / row["folder"], row["robot"]) for row in own]
        options = AddOptions(static=out / "systems" / system / "static.json", verdict=said)

        def told(done: int, _: int, before: int = before) -> None:
            if on_progress is not None:
                on_progress(before + done, whole)

        for row, added in zip(
            own, add(_fleet(out, system, by_marks), given, options, engine, told), strict=True
        ):
            if added.place is None:
                raise TpcError(added.why, added.path)
            places[str(row["folder"])] = added.place
        before += len(own)
    return places


@dataclass(frozen=True)
class FleetRanker:
    """Ranks with the product's API; the places are from ``add_flown``, without and by marks."""

    engine: Engine
    places: Mapping[str, Place]
    by_marks: Mapping[str, Place]

    def __call__(self, question: FleetQuestion, out: Path) -> dict[str, Verdict]:
        """Rank the missions of a question."""
        by_marks = question.shape == "by-marks"
        known = self.by_marks if by_marks else self.places
        places = [known[folder] for folder in (*question.bad, *question.good)]
        return verdicts_of(ranking_of(out, question.system, places, self.engine, by_marks=by_marks))


def ranking_of(
    out: Path, system: str, places: Sequence[Place], engine: Engine, *, by_marks: bool = False
) -> FleetRanking:
    """What the product says of some missions of a system.

    Args:
        out: the folder of fleets.
        system: the robot.
        places: of the missions, from ``add_flown``.
        engine: where the work is done.
        by_marks: as they were added.

    Raises:
        TpcError: a mission cannot be read, or they cannot be ranked.
    """
    whole = _fleet(out, system, by_marks)
    with tempfile.TemporaryDirectory(prefix=".question-", dir=out / _SETS) as folder:
        link_missions(Path(whole.url), places, Path(folder))
        found = rank(Fleet(folder), engine)
    if found.unread:
        raise TpcError(found.unread[0].why, Path(whole.url))
    return found.answer


def link_missions(whole: Path, places: Sequence[Place], part: Path) -> None:
    """Make a data set of some missions of another one, by links to its files.

    Args:
        whole: the other data set.
        places: of the missions.
        part: an empty folder.

    Raises:
        TpcError: a file cannot be linked.
    """
    try:
        shutil.copyfile(whole / "fleet.json", part / "fleet.json")
        tables = [one for one in whole.iterdir() if one.is_dir() and one.name != "builds"]
        sources = [
            one for table in tables for place in places for one in table.glob(f"{place.folder}/*")
        ]
        for source in (*(whole / "builds").iterdir(), *sources):
            target = part / source.relative_to(whole)
            target.parent.mkdir(parents=True, exist_ok=True)
            os.link(source, target)
    except OSError as error:
        raise TpcError(f"cannot be linked: {error.strerror}", part) from error


def verdicts_of(ranking: FleetRanking) -> dict[str, Verdict]:
    """The product's order, and those by Importance and by what no good mission has."""
    suspects = ranking.suspects
    first = suspects[0].probability if suspects else 0.0
    return {
        "fleet": Verdict(
            tuple(one.parameter for one in suspects),
            first,
            tuple(-float(one.position) for one in suspects),
            ranking.none,
        ),
        "fleet-importance": _by({one.parameter: one.importance for one in suspects}),
        "fleet-differs": _by({one.parameter: one.differs or 0.0 for one in suspects}),
    }


def _by(scores: Mapping[str, float]) -> Verdict:
    """Those with a score, the highest first; the others are not found."""
    found = {name: score for name, score in scores.items() if score > 0}
    order = sorted(found, key=lambda name: (-found[name], name))
    return Verdict(tuple(order), scores=tuple(found[name] for name in order))


def _fleet(out: Path, system: str, by_marks: bool) -> Fleet:
    return Fleet(str((out / _SETS / f"{system}{'-by-marks' if by_marks else ''}").absolute()))
