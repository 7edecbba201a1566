"""The changes that ``pytpc apply`` made, so that they can be undone byte for byte.

One JSON file for each change, in ``$XDG_STATE_HOME/tpc/applied`` (``~/.local/state`` where that is
not set). It is written before the file is changed, and removed when the change is taken back.
"""

from __future__ import annotations

import base64
import contextlib
import fcntl
import hashlib
import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

from pytpc.base.atomic import stage_beside
from pytpc.base.errors import InputError, TpcError
from pytpc.base.paths import home
from pytpc.base.source_bytes import read_bytes

SCHEMA = 1
_MOST_TRIES = 1000


@dataclass(frozen=True, slots=True)
class JournalEntry:
    """One change.

    ``path`` is the file and ``before`` its bytes; of a change of a running robot both are None and
    ``live`` says what to do. ``after`` is the SHA-256 of the file as it was left. Values are as
    they are shown.
    """

    number: int
    time: str
    parameter: str
    old: str
    new: str
    path: Path | None
    before: bytes | None
    after: str
    live: Mapping[str, Any]

    @property
    def place(self) -> str:
        """The file, or the robot."""
        return str(self.path) if self.path is not None else str(self.live.get("master", "?"))


def folder_of(env: Mapping[str, str]) -> Path:
    """Where the journal is.

    Raises:
        TpcError: the user has no home folder.
    """
    chosen = env.get("XDG_STATE_HOME", "")
    # The standard says that a relative one is not to be used.
    base = Path(chosen) if chosen.startswith("/") else home() / ".local" / "state"
    return base / "tpc" / "applied"


def digest(data: bytes) -> str:
    """The SHA-256 of a file."""
    return hashlib.sha256(data).hexdigest()


class Journal:
    """The changes that can be undone."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    @contextlib.contextmanager
    def held(self) -> Iterator[None]:
        """While this is held, no other process changes a file; a second one waits.

        Raises:
            TpcError: the folder cannot be written.
        """
        try:
            self._folder.mkdir(parents=True, exist_ok=True, mode=0o700)
            descriptor = os.open(
                self._folder / ".lock", os.O_CREAT | os.O_RDWR | os.O_CLOEXEC, 0o600
            )
        except OSError as error:
            raise TpcError(
                f"the change cannot be recorded for --undo: {error.strerror}", self._folder
            ) from error
        try:
            # Some file systems of a network have no locks; then it is as it would be without.
            with contextlib.suppress(OSError):
                fcntl.flock(descriptor, fcntl.LOCK_EX)
            yield
        finally:
            os.close(descriptor)

    def entries(self) -> list[JournalEntry]:
        """All changes that can be read, the oldest first."""
        return self._all()[0]

    def broken(self) -> list[InputError]:
        """The faults of the entries that cannot be read; the others can still be used."""
        return self._all()[1]

    def _all(self) -> tuple[list[JournalEntry], list[InputError]]:
        entries, errors = list[JournalEntry](), list[InputError]()
        try:
            paths = sorted(path for path in self._folder.glob("*.json") if path.stem.isdigit())
        except OSError:
            paths = []
        for path in paths:
            try:
                entries.append(_read(path))
            except InputError as error:
                errors.append(error)
        return sorted(entries, key=lambda entry: entry.number), errors

    def add_file(
        self, parameter: str, values: tuple[str, str], path: Path, before: bytes, after: bytes
    ) -> JournalEntry:
        """Write down a change of a file that is about to be made.

        Raises:
            TpcError: it cannot be written; then nothing should be changed.
        """
        content = {
            "path": str(path),
            "before": base64.b64encode(before).decode("ascii"),
            "after": digest(after),
            "live": {},
        }
        return self._add(parameter, values, content)

    def add_live(
        self, parameter: str, values: tuple[str, str], live: Mapping[str, Any]
    ) -> JournalEntry:
        """Write down a change of a running robot, as ``add_file`` does."""
        content = {"path": None, "before": None, "after": digest(b""), "live": dict(live)}
        return self._add(parameter, values, content)

    def _add(
        self, parameter: str, values: tuple[str, str], content: Mapping[str, Any]
    ) -> JournalEntry:
        document = {
            "schema": SCHEMA,
            "time": datetime.now().astimezone().isoformat(timespec="seconds"),
            "parameter": parameter,
            "old": values[0],
            "new": values[1],
            **content,
        }
        data = json.dumps(document, indent=1).encode() + b"\n"
        try:
            # The content of a file may be private.
            self._folder.mkdir(parents=True, exist_ok=True, mode=0o700)
            staged = stage_beside(self._folder / "new", data, 0o600)
            try:
                target = self._link(staged)
            finally:
                staged.unlink()
        except OSError as error:
            raise TpcError(
                f"the change cannot be recorded for --undo: {error.strerror}", self._folder
            ) from error
        return _read(target)

    def _link(self, staged: Path) -> Path:
        """Give a file the next number; two commands at once get two."""
        numbers = [int(path.stem) for path in self._folder.glob("*.json") if path.stem.isdigit()]
        first = max(numbers, default=0) + 1
        for number in range(first, first + _MOST_TRIES):
            target = self._folder / f"{number:06d}.json"
            with contextlib.suppress(FileExistsError):
                os.link(staged, target)
                return target
        raise OSError(0, "no number is free")

    def remove(self, entry: JournalEntry) -> None:
        """Forget a change that was undone or failed."""
        (self._folder / f"{entry.number:06d}.json").unlink(missing_ok=True)


def _read(path: Path) -> JournalEntry:
    try:
        document = json.loads(read_bytes(path))
        if document["schema"] != SCHEMA:
            raise ValueError(f"version {document['schema']}")
        before = document["before"]
        return JournalEntry(
            int(path.stem),
            str(document["time"]),
            str(document["parameter"]),
            str(document["old"]),
            str(document["new"]),
            None if document["path"] is None else Path(document["path"]),
            None if before is None else base64.b64decode(before, validate=True),
            str(document["after"]),
            dict(document["live"]),
        )
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(f"not a recorded change: {error}", path) from error
