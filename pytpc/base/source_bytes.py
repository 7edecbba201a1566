"""The bytes of a file, and those of a source file as columns count them: in UTF-8."""

from __future__ import annotations

import hashlib
import io
import tokenize
from pathlib import Path

from pytpc.base.regular_files import read_file


def read_bytes(path: Path) -> bytes:
    """The bytes of a file.

    Raises:
        InputError: it cannot be read, is no file, or is larger than any file of text.
    """
    return read_file(path)


def sha256_of(path: Path) -> str:
    """The SHA-256 of a file's bytes.

    Raises:
        InputError: it cannot be read.
    """
    return hashlib.sha256(read_bytes(path)).hexdigest()


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
