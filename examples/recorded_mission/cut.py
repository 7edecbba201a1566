"""Cuts this example from a recorded mission of examples/image_capture: `cut.py MISSION WORKSPACE`.

Three of the robot's five nodes are kept, so that all of it is small enough for the repository.
The sources are those beside it.
"""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from pytpc.base.atomic import write_atomic
from pytpc.recording.mission import load_recording, save_recording
from pytpc.static.static_info import StaticInfo, read_static

NODES = ("face_detector", "mission", "radio_link")
SOURCES = "../image_capture"


def main(mission: Path, workspace: Path) -> None:
    """Write the example beside this file."""
    here = Path(__file__).parent
    static = read_static(workspace)
    units = [unit for unit in static.units if unit.link_unit in NODES]
    root = Path(units[0].source_root)
    cut = StaticInfo.of(units)
    recording = load_recording(mission)
    events = recording.events
    kept = np.isin(events.key, [n for n, key in enumerate(events.keys) if key in cut.comparisons])
    events = events.take(kept)
    keys = tuple(sorted({events.keys[n] for n in np.unique(events.key)}))
    events = events.with_keys(keys)
    save_recording(replace(recording, events=events, notes=()), here)
    write_static(here, cut)
    treatment = root / "treatments/type2_min_coverage_limit/treatment.json"
    write_atomic(here / "treatment.json", treatment.read_bytes())
    write_atomic(here / "params.yaml", (mission / "params.yaml").read_bytes())
    run = json.loads((mission / "run.json").read_bytes())
    run["launch"] = f"{SOURCES}/launch/{Path(run['launch']).name}"
    run["args"] = {"treatment": f"{SOURCES}/treatments/type2_min_coverage_limit/params.yaml"}
    run["reports"] = len(events)
    write_atomic(here / "run.json", json.dumps(run, indent=1).encode() + b"\n")


def write_static(here: Path, static: StaticInfo) -> None:
    """The merged document on few bytes; what follows from the rest is left out."""
    document = static.to_json()
    for name in ("tpcs", "copies", "left_out"):
        document.pop(name, None)
    for unit in document["units"]:
        unit["source_root"] = SOURCES
        unit.pop("build_folder", None)
    text = json.dumps(document, ensure_ascii=False, separators=(",", ":"))
    # A line for each comparison, so that a difference can be read.
    text = text.replace('{"key":', '\n{"key":')
    write_atomic(here / "static.json", text.encode() + b"\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
