"""Opens files that somebody else has named: no device, no pipe, nothing that has no end."""

from __future__ import annotations

import filecmp
import os
import stat
from pathlib import Path
from typing import BinaryIO

from pytpc.base.errors import InputError

LARGEST_TEXT = 1 << 26
"""Bytes of a file that is read as a whole: YAML, launch files, JSON and marks of a recording."""
_KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a named pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


def open_file(path: Path) -> BinaryIO:
    """Open a file to read.

    Raises:
        InputError: it cannot be read, or is a folder, device, socket or pipe.
    """
    try:
        # A pipe without a writer would block.
        descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK | os.O_NOCTTY)
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", path) from error
    except ValueError as error:
        raise InputError(f"cannot be read: {error}", path) from error
    try:
        _check_kind(os.fstat(descriptor).st_mode, path)
        return os.fdopen(descriptor, "rb")
    except BaseException:
        os.close(descriptor)
        raise


def real_path(path: Path) -> Path:
    """The path without symbolic links; it need not exist.

    Raises:
        InputError: the links lead to one another.
    """
    try:
        return path.resolve()
    except RuntimeError as error:
        raise InputError("is a symbolic link that leads to itself", path) from error


def check_file(path: Path) -> None:
    """Check that a path leads to a file.

    Raises:
        InputError: it leads to a folder, device, socket or pipe, or nowhere.
    """
    try:
        mode = path.stat().st_mode
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", path) from error
    _check_kind(mode, path)


def _check_kind(mode: int, path: Path) -> None:
    for is_kind, what in _KINDS:
        if is_kind(mode):
            raise InputError(f"is {what}, not a file", path)


def read_file(path: Path, most: int = LARGEST_TEXT) -> bytes:
    """The bytes of a file.

    Raises:
        InputError: it cannot be read, is no file, or has more than ``most`` bytes.
    """
    with open_file(path) as stream:
        try:
            data = stream.read(most + 1)
        except OSError as error:
            raise InputError(f"cannot be read: {error.strerror or error}", path) from error
    if len(data) > most:
        raise InputError(f"has more than {most:,} bytes, the most that is read", path)
    return data


def has_same_content(one: Path, other: Path) -> bool:
    """Whether two files have the same bytes; not if one of them cannot be read."""
    try:
        return filecmp.cmp(one, other, shallow=False)
    except OSError:
        return False
