"""A file that is there as a whole or not at all."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

from simulated_world.errors import ObserverError


@contextlib.contextmanager
def replacing(target: Path) -> Iterator[Path]:
    """Give a path to write to; what was written there becomes ``target`` when all went well.

    Raises:
        ObserverError: the folder of ``target`` is missing or cannot be written.
    """
    try:
        beside = tempfile.TemporaryDirectory(prefix=f".{target.name}.", dir=target.parent)
    except OSError as error:
        raise ObserverError(f"{target}: cannot be written: {error.strerror}") from error
    with beside as folder:
        written = Path(folder) / target.name
        yield written
        with written.open("rb") as stream:
            os.fsync(stream.fileno())
        written.replace(target)
