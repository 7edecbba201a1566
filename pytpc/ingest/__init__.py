"""Reads recordings of a mission into events, summaries and marks: ``read``, ``load_recording``."""

from pytpc.ingest.reading import read, read_bag
from pytpc.recording.mission import (
    Dropped,
    MalformedRecord,
    Recording,
    load_recording,
    save_recording,
)

__all__ = [
    "Dropped",
    "MalformedRecord",
    "Recording",
    "load_recording",
    "read",
    "read_bag",
    "save_recording",
]
