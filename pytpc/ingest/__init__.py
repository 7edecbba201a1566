"""Recordings of a mission become events and marks: ``read_bag``, ``load_recording``."""

from pytpc.ingest.bag import read_bag
from pytpc.ingest.recording import (
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
    "read_bag",
    "save_recording",
]
