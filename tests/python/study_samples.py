"""A small folder of a study: one robot by hand, and the recorded mission of the examples.

The robot ``alpha`` compares once a second from 1 to 20 s: ``t > ~low`` (5) and ``t > ~high`` (30);
once, at 3 s, ``1 > ~other`` (0), in Python; never ``~never``. So it does in all of its missions.
"""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from mission_samples import comparison, events, link_unit, ns

from pytpc.recording.marks import Mark, MarkType
from pytpc.recording.mission import Recording, save_recording
from pytpc.static.link_unit import Tool
from pytpc.static.static_info import StaticInfo

RECORDED = Path(__file__).parents[2] / "examples" / "recorded_mission"
STATIC = StaticInfo.of(
    [
        link_unit([comparison(0, "~low"), comparison(1, "~high"), comparison(3, "~never")]),
        replace(
            link_unit([comparison(2, "~other", file="scripts/node")]),
            link_unit="node.py",
            tool=Tool("tpc", "0.1.0", "", "default", "python"),
        ),
    ]
)
SECONDS = range(1, 21)
EVENTS = events(
    [
        *((t, 0, t > 5, t, 5) for t in SECONDS),
        *((t, 1, False, t, 30) for t in SECONDS),
        (3, 2, True, 1, 0),
    ]
)
Said = tuple[float, str, MarkType, MarkType]
"""A mark: seconds, user, the right type, and what was said."""

TYPE1 = {"type": "type1", "parameter": "~low", "node": "/node", "old": 8, "new": 5, "tipping": 7}
TYPE2 = {"type": "type2", "parameter": "~high", "node": "/node", "old": 10, "new": 30,
         "tipping": 26}  # fmt: skip


@dataclass(frozen=True)
class Row:
    """A row of positions.parquet."""

    system: str
    treatment: str
    type: str
    half: str
    seed: int
    labels: str
    position: float | None
    confidence: float | None = None
    marks: int = 3
    who: str = "all"
    method: str = "tpc"
    parameters: int = 4
    top: str = "~low"
    tied: int = 1
    round: int = 1


def make_study(folder: Path) -> Path:
    """All of it; returns ``folder``."""
    STATIC.save(folder / "systems" / "alpha" / "static.json")
    (folder / "systems" / "image_capture").mkdir()
    shutil.copy(RECORDED / "static.json", folder / "systems" / "image_capture")
    flights = [
        ("type1_low", 1, TYPE1, [(8, "user1", "I", "II"), (7, "user2", "I", "I")]),
        ("type1_low", 2, TYPE1, []),
        ("type2_high", 1, TYPE2, [(15, "user1", "II", "I"), (16, "user2", "II", "II")]),
        ("type2_high", 2, TYPE2, [(13, "user1", "II", "II")]),
        ("fault_wires", 1, {"type": "fault"}, [(10, "user1", "II", "II")]),
        ("clean", 1, {"type": "clean"}, [(9, "user2", "I", "I")]),
        ("clean", 2, {"type": "clean"}, []),
    ]
    halves = {"type1_low": "tuning", "type2_high": "held-back", "fault_wires": "tuning"}
    planned = []
    for name, seed, treatment, marks in flights:
        fly(folder, ("alpha", name, seed), treatment, marks)
        half = halves.get(name) or ("tuning" if seed == 1 else "held-back")
        planned.append(plan("alpha", name, seed, half))
    fly_recorded(folder)
    planned.append(plan("image_capture", "type2_min_coverage_limit", 1, "held-back"))
    document = {"schema": 1, "versions": {}, "seeds": [1, 2], "missions": planned}
    (folder / "study.json").write_text(json.dumps(document))
    write_rows(folder / "results/positions.parquet", [asdict(row) for row in positions()])
    write_rows(folder / "results/suggestions.parquet", suggestions())
    (folder / "results/suggestion-chains.json").write_text(json.dumps(chains()))
    return folder


def plan(system: str, name: str, seed: int, half: str, **changes: Any) -> dict[str, Any]:
    """What study.json says of a mission."""
    return {
        "folder": f"missions/{system}/{name}/seed-{seed}",
        "system": system,
        "treatment": name,
        "seed": seed,
        "half": half,
        "state": "done",
        "remarks": [],
        "error": "",
        **changes,
    }


def fly(
    folder: Path, place: tuple[str, str, int], treatment: dict[str, Any], said: Sequence[Said]
) -> Path:
    """The folder of a mission (system, treatment, seed), whole."""
    system, name, seed = place
    target = folder / "missions" / system / name / f"seed-{seed}"
    marks = [Mark(ns(seconds), right, user) for seconds, user, right, _ in said]
    save_recording(Recording(f"seed-{seed}", EVENTS, tuple(marks), 0, ns(20)), target)
    nothing = dict.fromkeys(("parameter", "node", "old", "new"))
    whole = {"name": name, **nothing, "launch": {}, "effect": "It goes | wrong.", **treatment}
    (target / "treatment.json").write_text(json.dumps(whole))
    (target / "params.yaml").write_text("{}\n")
    (target / "run.json").write_text(json.dumps({"args": {"seed": str(seed)}}))
    times = np.arange(0.0, 20.0, 0.5)
    columns = {"time": times, "x": times / 4, "yaw": np.mod(times, 6.0) - 3, "pictures": times > 9}
    pq.write_table(pa.table(columns), target / "sights.parquet")
    write_said(target, said)
    (target / "done.json").write_text("{}")
    return target


def fly_recorded(folder: Path) -> Path:
    """The recorded mission, its treatment of the second round and without a known tipping point."""
    target = folder / "missions/image_capture/type2_min_coverage_limit/seed-1"
    shutil.copytree(RECORDED, target)
    treatment = json.loads((target / "treatment.json").read_text())
    changes = {"tipping": None, "round": 2}
    (target / "treatment.json").write_text(json.dumps({**treatment, **changes}))
    marks = json.loads((target / "marks.json").read_text())["marks"]
    write_said(target, [(m["time_ns"] / 1e9, "user1", m["type"], m["type"]) for m in marks])
    (target / "done.json").write_text("{}")
    return target


def write_said(target: Path, said: Sequence[Said]) -> None:
    """marks.parquet."""
    rows = [
        {"time_ns": ns(seconds), "observer": user, "cause": 0, "right": right, "said": as_said}
        for seconds, user, right, as_said in sorted(said)
    ]
    schema = pa.schema(
        [("time_ns", pa.int64()), ("observer", pa.string()), ("cause", pa.int32()),
         ("right", pa.string()), ("said", pa.string())]
    )  # fmt: skip
    pq.write_table(pa.Table.from_pylist(rows, schema=schema), target / "marks.parquet")


def write_rows(path: Path, rows: Sequence[dict[str, Any]]) -> None:
    """A table of results."""
    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(pa.Table.from_pylist(list(rows)), path)


def positions() -> list[Row]:
    """Verdicts of `tpc` and the thesis's, those of single users of typed marks alone."""
    low, high = ("alpha", "type1_low", "type1", "tuning"), ("alpha", "type2_high", "type2")
    picture = ("image_capture", "type2_min_coverage_limit", "type2", "held-back", 1)
    return [
        Row(*low, 1, "typed", 1, 0.9),
        Row(*low, 2, "typed", None, None, marks=0),
        Row(*high, "held-back", 1, "typed", 1, 0.85),
        Row(*high, "held-back", 2, "typed", 4, 0.3),
        Row(*picture, "typed", 2, 0.82, parameters=41, round=2),
        Row(*high, "held-back", 1, "untyped", 1, 0.85),
        Row(*high, "held-back", 2, "untyped", 1.5, 0.3, tied=2),
        Row(*picture, "untyped", 3, 0.82, parameters=41, round=2),
        Row(*high, "held-back", 1, "confused", 3, 0.2),
        Row(*high, "held-back", 2, "confused", None, None, marks=0),
        Row(*picture, "confused", 20, 0.1, parameters=41, round=2),
        Row(*high, "held-back", 1, "typed", 3.5, None, method="thesis", tied=2),
        Row(*high, "held-back", 2, "typed", 2, None, method="thesis"),
        Row(*picture, "typed", 30, None, method="thesis", parameters=41, round=2),
        Row(*high, "held-back", 1, "typed", 1, 0.85, who="user1"),
        Row(*high, "held-back", 1, "typed", 4, 0.85, who="user2"),
        Row("alpha", "clean", "clean", "tuning", 1, "typed", None, 0.2),
        Row("alpha", "clean", "clean", "held-back", 2, "typed", None, None, marks=0),
        Row("alpha", "fault_wires", "fault", "tuning", 1, "typed", None, 0.85),
    ]


def suggestions() -> list[dict[str, Any]]:
    """Of one treatment; nothing was suggested for the others."""
    columns = {"system": "alpha", "treatment": "type2_high", "type": "type2", "half": "held-back"}
    own = {**columns, "parameter": "~high", "node": "/node", "reached": True, "failure": ""}
    return [
        {**own, "seed": 1, "value": 9.5, "gone": True, "new": False},
        {**own, "seed": 2, "value": 12.0, "gone": False, "new": True},
    ]


def chains() -> list[dict[str, Any]]:
    """By hand: of ``type2_high`` with two seeds, and of ``type1_low``, which waits."""

    def chain(name: str, seed: int, half: str, variant: str, *came: tuple[Any, Any]):
        place = {"system": "alpha", "treatment": name, "type": name[:5], "half": half, "seed": seed}
        tries = [
            {"parameter": "~high", "node": "/node", "value": 1.0 + n, "basis": "log",
             "gone": gone, "new_error": new, "reason": ""}
            for n, (gone, new) in enumerate(came)
        ]  # fmt: skip
        return {**place, "variant": variant, "old": 1.0, "new": 2.0, "order": [], "tries": tries}

    high = ("type2_high", "held-back")
    return [
        chain(high[0], 1, high[1], "smallest", (True, True)),
        chain(high[0], 1, high[1], "lasting", (True, False)),
        chain(high[0], 2, high[1], "lasting", (False, True), (True, False)),
        chain("type1_low", 1, "tuning", "lasting", (False, False), (None, None)),
    ]
