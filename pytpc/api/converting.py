"""Recordings of one mission, each report once, as Parquet or CSV."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from pytpc.ingest.duplicates import TOLERANCE_NS
from pytpc.ingest.reading import opened
from pytpc.recording.mission import Recording

__all__ = ["TOLERANCE_NS", "Converted", "convert"]

Progress = Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class Converted:
    """What was written: the recording without its events, and how many there are."""

    recording: Recording
    events: int
    comparisons: int
    summaries: int


def convert(
    inputs: Sequence[Path],
    output: Path,
    *,
    tolerance_ns: int = TOLERANCE_NS,
    on_read: Progress | None = None,
    on_written: Progress | None = None,
) -> Converted:
    """Convert the recordings of one mission, with little memory.

    Args:
        inputs: bags, binary files, logs, CSV, folders of such files, converted missions.
        output: a folder, or a file: .parquet (the events) or .csv (the thesis's form). Its disk
            needs 35 bytes of temporary space per report.
        tolerance_ns: how far apart in time one report may be in two inputs.
        on_read: called with (bytes read, bytes in all).
        on_written: called with (reports written, reports in all).

    Raises:
        InputError: an input cannot be read.
        TpcError: the output cannot be written.
    """
    is_folder = output.is_dir()
    suffix = "" if is_folder else output.suffix
    scratch = output if is_folder else _existing_folder(output)
    with opened(inputs, scratch, on_read, tolerance_ns=tolerance_ns) as merged:
        if suffix == ".parquet":
            recording = merged.save_parquet(output, on_written)
        elif suffix == ".csv":
            recording = merged.save_csv(output, on_written)
        else:
            recording = merged.save(output, on_written)
    return Converted(recording, merged.events, merged.comparisons, merged.summaries)


def _existing_folder(path: Path) -> Path:
    """The nearest folder above ``path`` that exists."""
    return next((folder for folder in path.absolute().parents if folder.is_dir()), Path("/"))
