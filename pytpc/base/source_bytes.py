"""The bytes of a file, and those of a source file as columns count them: in UTF-8."""

from __future__ import annotations

import io
import tokenize
from pathlib import Path

from pytpc.base.errors import InputError


def read_bytes(path: Path) -> bytes:
    """The bytes of a file.

    Raises:
        InputError: it cannot be read.
    """
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror or error}", path) from error


def source_bytes(path: Path) -> bytes:
    """The file in UTF-8, without a byte order mark, from the encoding that it declares (PEP 263).

    A file that declares none, or cannot be decoded, is returned as it is.

    Raises:
        OSError: it cannot be read.
    """
    raw = path.read_bytes()
    try:
        encoding, _ = tokenize.detect_encoding(io.BytesIO(raw).readline)
        return raw.decode(encoding).encode()
    except (SyntaxError, UnicodeDecodeError, LookupError):
        return raw
