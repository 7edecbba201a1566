"""Undoes what ``pytpc apply`` did to a file."""

from __future__ import annotations

from pathlib import Path

from pytpc.base.errors import InputError
from pytpc.values.apply import FileChange, replace_file, undo_change
from pytpc.values.journal import Journal, JournalEntry


def entry_of(journal: Journal, what: str) -> JournalEntry:
    """The change to undo.

    Args:
        journal: of the changes.
        what: its number, a file of which the last change is meant, or empty for the last of all.

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
