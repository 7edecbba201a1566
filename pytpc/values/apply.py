"""Writes a value into the file that set it, and undoes that."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from pytpc.base.atomic import replace_file
from pytpc.base.diff import unified_diff
from pytpc.base.errors import InputError, TpcError
from pytpc.base.source_bytes import read_bytes
from pytpc.values.journal import Journal, JournalEntry, digest
from pytpc.values.scalars import number_text


@dataclass(frozen=True, slots=True)
class FileChange:
    """A change of one file by a new value.

    ``path`` is the file to which symbolic links lead. ``old`` is None if no file set the parameter.
    ``notes`` are sentences for the user, ``also`` the other parameters that the line sets.
    """

    parameter: str
    path: Path
    before: bytes
    after: bytes
    old: object
    new: object
    lineno: int
    notes: tuple[str, ...] = ()
    also: tuple[str, ...] = ()

    @property
    def parameters(self) -> tuple[str, ...]:
        """All parameters that the changed line sets."""
        return (self.parameter, *self.also)


def decoded(data: bytes, path: Path) -> str:
    """The text of a YAML file, with its byte order mark.

    Raises:
        InputError: it is not UTF-8, in which alone rosparam reads it.
    """
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise InputError("not UTF-8: it is not changed", path, line) from error


def shown(value: object) -> str:
    """A value as shown to the user.

    >>> shown(0.5), shown(True), shown("a"), shown(None)
    ('0.5', 'true', 'a', 'not set')
    """
    if value is None:
        return "not set"
    if isinstance(value, bool):
        return "true" if value else "false"
    return number_text(value) if isinstance(value, float) else str(value)


def apply_change(change: FileChange, journal: Journal) -> JournalEntry:
    """Write a change and record it for undo.

    Raises:
        TpcError: the file changed since the change was worked out, or cannot be written; it is as
            it was.
    """
    with journal.held():
        if read_bytes(change.path) != change.before:
            raise TpcError("the file has changed meanwhile; run the command again", change.path)
        values = shown(change.old), shown(change.new)
        entry = journal.add_file(change.parameter, values, change.path, change.before, change.after)
        try:
            replace_file(change.path, change.after)
        except BaseException:
            journal.remove(entry)
            raise
        return entry


def undo_change(entry: JournalEntry, journal: Journal) -> FileChange:
    """Work out how to undo a change of a file; nothing is written.

    Raises:
        TpcError: the file has changed since, by a later change or by someone else.
    """
    path, before = entry.path, entry.before
    assert path is not None, "a change of a file"
    assert before is not None, "a change of a file"
    now = read_bytes(path)
    later = [e for e in journal.entries() if e.path == path and e.number > entry.number]
    if later:
        raise TpcError(f"change {later[-1].number} came later; undo that first", path)
    if now != before and digest(now) != entry.after:
        raise TpcError(
            f"has changed since: change {entry.number} is not undone; the value was {entry.old}",
            path,
        )
    return FileChange(entry.parameter, path, now, before, entry.new, entry.old, 0)


def entry_of(journal: Journal, what: str) -> JournalEntry:
    """The change to undo.

    Args:
        journal: of the changes.
        what: its number; or a file, whose last change is meant; or empty for the last of all.

    Raises:
        InputError: there is no such change.
    """
    entries = journal.entries()
    if what.isdigit() and not Path(what).exists():
        meant = [entry for entry in entries if entry.number == int(what)]
    elif what:
        real = Path(what).resolve()
        meant = [entry for entry in entries if entry.path == real]
    else:
        meant = entries
    if not meant:
        raise InputError(
            f"no change of {what} is recorded" if what else "no change is recorded: nothing to undo"
        )
    return meant[-1]


def take_back_file(entry: JournalEntry, journal: Journal, *, dry_run: bool = False) -> FileChange:
    """Undo a change of a file and forget it; return the change that this is.

    Raises:
        TpcError: the file was changed since.
    """
    with journal.held():
        change = undo_change(entry, journal)
        if not dry_run:
            replace_file(change.path, change.after)
            journal.remove(entry)
    return change


def diff_of(change: FileChange) -> str:
    """The change as a unified diff; bytes that are no UTF-8 are shown as replacement characters."""
    name = os.fsencode(str(change.path).lstrip("/"))
    return unified_diff(name, change.before, change.after).decode("utf-8", "replace")


def change_as_json(change: FileChange) -> Mapping[str, object]:
    """A change as JSON."""
    return {
        "parameter": change.parameter,
        "parameters": list(change.parameters),
        "path": str(change.path),
        "lineno": change.lineno,
        "old": change.old,
        "new": change.new,
        "changed": change.before != change.after,
        "notes": list(change.notes),
        "diff": diff_of(change),
    }
