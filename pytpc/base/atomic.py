"""Writes files atomically: a reader sees the old one or the new one, never a part."""

from __future__ import annotations

import contextlib
import os
import re
import secrets
import stat
from collections.abc import Iterator
from pathlib import Path

from pytpc.base.errors import TpcError


def stage_beside(target: Path, data: bytes, mode: int = 0o644) -> Path:
    """Write ``data`` to a new hidden file in the folder of ``target``, and onto the disk.

    Args:
        target: the file that is to be replaced later; it need not exist.
        data: the whole content.
        mode: permission bits, before the umask.

    Returns:
        The path of the new file. The caller renames or deletes it.

    Raises:
        OSError: the folder cannot be written or the disk is full; then nothing is left behind.
    """
    staged = _beside(target)
    try:
        _write_new(staged, data, mode)
    except BaseException:
        with contextlib.suppress(OSError):
            staged.unlink()
        raise
    return staged


def stage_like(target: Path, data: bytes) -> Path:
    """``stage_beside``, with the permissions of ``target`` and, where permitted, its owner.

    Raises:
        OSError: as ``stage_beside``, or ``target`` does not exist.
    """
    staged = _beside(target)
    try:
        _write_like(staged, target.stat(), data)
    except BaseException:
        with contextlib.suppress(OSError):
            staged.unlink()
        raise
    return staged


def leftovers(target: Path) -> list[Path]:
    """What ``stage_beside`` left for ``target`` in a process that was killed, sorted."""
    name = re.compile(re.escape(f".{target.name}.tpc-") + "[0-9a-f]{8}")
    try:
        with os.scandir(target.parent) as entries:
            found = [entry.name for entry in entries if name.fullmatch(entry.name)]
    except OSError:
        return []
    return [target.with_name(name) for name in sorted(found)]


def write_atomic(target: Path, data: bytes) -> None:
    """Write ``data`` to ``target``, and create its folder if needed.

    Raises:
        TpcError: the file cannot be written; what stood there before is untouched.
    """
    with replacing(target) as staged:
        _write_new(staged, data)


def replace_file(target: Path, data: bytes) -> None:
    """Put ``data`` in the place of a file that exists; its owner and permissions stay.

    Raises:
        TpcError: the file cannot be written; what stood there before is untouched.
    """
    try:
        status = target.stat()
    except OSError as error:
        raise _unwritten(target, error) from error
    with replacing(target) as staged:
        if not os.access(target, os.W_OK):
            raise PermissionError(13, "it is read-only")
        _write_like(staged, status, data)


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A new file beside ``path`` that replaces it if the block succeeds.

    Raises:
        TpcError: it cannot be written; what stood there before is untouched.
    """
    staged = _beside(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        yield staged
        with staged.open("rb") as stream:
            os.fsync(stream.fileno())
        staged.replace(path)
    except OSError as error:
        raise _unwritten(path, error) from error
    finally:
        with contextlib.suppress(OSError):
            staged.unlink(missing_ok=True)


def _write_new(path: Path, data: bytes, mode: int = 0o644) -> None:
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, mode)
    with os.fdopen(descriptor, "wb") as stream:
        stream.write(data)
        stream.flush()
        os.fsync(stream.fileno())


def _write_like(path: Path, status: os.stat_result, data: bytes) -> None:
    _write_new(path, data)
    if (status.st_uid, status.st_gid) != (os.geteuid(), os.getegid()):
        with contextlib.suppress(PermissionError):
            os.chown(path, status.st_uid, status.st_gid)
    path.chmod(stat.S_IMODE(status.st_mode))


def _unwritten(path: Path, error: OSError) -> TpcError:
    return TpcError(f"cannot be written: {error.strerror or error}", path)


def _beside(target: Path) -> Path:
    return target.with_name(f".{target.name}.tpc-{secrets.token_hex(4)}")
