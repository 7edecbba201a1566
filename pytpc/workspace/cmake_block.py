"""The block that TPC writes at the top of a CMakeLists.txt: bytes in, bytes out.

The three lines come first in the file (after a UTF-8 byte order mark), in the line ending of the
file, and taking them away gives the file as it was, byte for byte, whatever its encoding.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass

from pytpc.base.errors import WorkspaceError
from pytpc.workspace.cmake_syntax import UTF8_BOM

_OPENING = (
    b"# >>> tpc >>> These three lines are TPC's; `pytpc patch --restore WORKSPACE` removes them."
)
_CLOSING = b"# <<< tpc <<<"
_BLOCK = re.compile(
    rb"^" + re.escape(_OPENING) + rb"(?P<end>\r?\n)"
    rb'include\("(?:[^"\\\r\n]|\\[^\r\n])*" OPTIONAL\)(?P=end)'
    + re.escape(_CLOSING)
    + rb"(?P=end)",
    re.MULTILINE,
)
MARKER = re.compile(rb"^[ \t]*#[^\n]*(?:>>> tpc >>>|<<< tpc <<<)", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class _Split:
    """A file cut at the block: mark + before + block + after."""

    mark: bytes
    before: bytes
    block: bytes
    after: bytes


def patch_text(data: bytes, cmake_file: str) -> bytes:
    """Put the block in, or bring the path in a block that is there up to date.

    Args:
        data: the bytes of a CMakeLists.txt.
        cmake_file: absolute path of tpc.cmake.

    Returns:
        The bytes with the block; the same bytes where it is there already.

    Raises:
        WorkspaceError: somebody changed or moved the block; with its line, without a path.
    """
    parts = _split(data)
    if parts.before:
        raise WorkspaceError(
            "TPC's block must come first in the file; move it there or delete its three lines",
            line=parts.before.count(b"\n") + 1,
        )
    ending = _line_ending(parts.block or parts.after)
    lines = [_OPENING, _include(cmake_file), _CLOSING, b""]
    return parts.mark + ending.join(lines) + parts.after


def restore_text(data: bytes) -> bytes:
    """Take the block out; the reverse of ``patch_text``, byte for byte.

    Returns:
        The bytes without the block; the same bytes where there is none.

    Raises:
        WorkspaceError: somebody changed the block; with its line, without a path.
    """
    parts = _split(data)
    return parts.mark + parts.before + parts.after


def _split(data: bytes) -> _Split:
    mark = UTF8_BOM if data.startswith(UTF8_BOM) else b""
    body = data[len(mark) :]
    block = _BLOCK.search(body)
    if block is None:
        _refuse_markers(body, 0)
        return _Split(mark, b"", b"", body)
    before, after = body[: block.start()], body[block.end() :]
    _refuse_markers(before, 0)
    _refuse_markers(after, body.count(b"\n", 0, block.end()))
    return _Split(mark, before, block[0], after)


def _refuse_markers(text: bytes, lines_before: int) -> None:
    """A marker outside a whole block means that the block was edited, copied or cut."""
    marker = MARKER.search(text)
    if marker is not None:
        raise WorkspaceError(
            "TPC's block was edited by hand, so nothing is touched; delete its lines"
            " (from # >>> tpc >>> to # <<< tpc <<<) and try again",
            line=lines_before + text.count(b"\n", 0, marker.start()) + 1,
        )


def _line_ending(text: bytes) -> bytes:
    first = text.find(b"\n")
    return b"\r\n" if first > 0 and text[first - 1 : first] == b"\r" else b"\n"


def _include(cmake_file: str) -> bytes:
    """The include, with what CMake would expand in a quoted argument escaped.

    ``@`` too: before cmake_minimum_required() policy CMP0053 is not set, and ``@NAME@`` expands.
    """
    escaped = re.sub(rb'([\\"$@])', rb"\\\1", os.fsencode(cmake_file))
    escaped = escaped.replace(b"\n", b"\\n").replace(b"\r", b"\\r")
    return b'include("' + escaped + b'" OPTIONAL)'
