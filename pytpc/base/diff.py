"""Unified diffs of files, byte for byte."""

from __future__ import annotations

import difflib
import re


def unified_diff(name: bytes, before: bytes, after: bytes) -> bytes:
    """The change of the file ``name`` as a diff that ``patch -p1`` takes."""
    lines = difflib.diff_bytes(
        difflib.unified_diff, _lines(before), _lines(after), b"a/" + name, b"b/" + name
    )
    ended = (
        line if line.endswith(b"\n") else line + b"\n\\ No newline at end of file\n"
        for line in lines
    )
    return b"".join(ended)


def _lines(data: bytes) -> list[bytes]:
    """Lines as diff and patch count them: a carriage return alone ends none."""
    return re.findall(rb"[^\n]*\n|[^\n]+", data)
