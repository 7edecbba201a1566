"""Small missions for the tests of fleets, and tasks for their engine."""

from __future__ import annotations

import os
import shutil
import signal
from dataclasses import replace
from pathlib import Path

import numpy as np

from pytpc.recording.marks import Mark
from pytpc.recording.mission import load_recording, save_recording

EXAMPLE = Path(__file__).parents[2] / "examples/recorded_mission"
STATIC = EXAMPLE / "static.json"
START_S = 1_700_000_000


def mission(folder: Path, number: int, *, marks: int = 0, rows: int = 3000) -> Path:
    """The first evaluations of the example, on another day for each number, with some marks."""
    whole = load_recording(EXAMPLE)
    events = whole.events.take(slice(0, rows))
    shift = (START_S + 86_400 * number) * 10**9 - int(events.time_ns[0])
    columns = events.columns() | {"time_ns": events.time_ns + np.int64(shift)}
    moved = type(events).of(**columns, keys=events.keys, nodes=events.nodes)
    times = moved.time_ns[:: max(1, rows // (marks + 1))][1 : marks + 1].tolist()
    found = tuple(Mark(time, "I", "ana", "") for time in times)
    span = {"start_ns": int(moved.time_ns[0]), "end_ns": int(moved.time_ns[-1])}
    folder.mkdir(parents=True)
    save_recording(replace(whole, events=moved, marks=found, **span), folder)
    for name in ("static.json", "params.yaml"):
        shutil.copy(EXAMPLE / name, folder)
    return folder


def square(number: int) -> list[int]:
    return [number * number]


def joined(parts: list[list[int]]) -> list[int]:
    return [one for part in parts for one in part]


def dies_once(job: tuple[Path, int]) -> list[int]:
    """The task of number 5 kills its worker, the first time that it is done."""
    folder, number = job
    with (folder / f"{number}").open("a") as stream:
        stream.write("x")
    if number == 5 and not (folder / "died").exists():
        (folder / "died").touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return square(number)


def dies(number: int) -> list[int]:
    """The task of number 5 kills its worker whenever it is done."""
    if number == 5:
        os.kill(os.getpid(), signal.SIGKILL)
    return square(number)


def dies_for_good(died: Path) -> list[int]:
    """The task kills its worker, and says so to those that start after it."""
    died.touch()
    os.kill(os.getpid(), signal.SIGKILL)
    return []


def fails(number: int) -> list[int]:
    raise ZeroDivisionError(f"{number} / 0")
