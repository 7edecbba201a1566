"""The source text around a comparison, and the steps from the read to the exposing statement."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from pytpc.base.source_bytes import source_bytes
from pytpc.static.across import changes
from pytpc.static.explanations import where
from pytpc.static.link_unit import Comparison
from pytpc.static.static_info import StaticInfo

LONGEST_LINE = 160
"""Longer lines are cut."""

_CONTEXT = 3
_LARGEST_SOURCE = 4 << 20


@dataclass(frozen=True)
class Line:
    """A line of source text; ``here`` marks the comparison's own."""

    number: int
    text: str
    here: bool


@dataclass(frozen=True)
class StepView:
    """A line of the source on the way from the parameter's read to what is exposed.

    ``entered`` is the link unit of the line where the way comes from another one, else empty.
    """

    place: str
    what: str
    code: str
    here: bool
    entered: str = ""


def way_of(found: Comparison) -> list[StepView]:
    """The steps of a comparison's way; empty where the static information has none."""
    return [
        StepView(
            place=where(step) if step.file else "",
            what=step.what,
            code=(step.source_code or "")[:LONGEST_LINE],
            here=(step.file, step.lineno) == (found.file, found.lineno),
            entered=entered or "",
        )
        for step, entered in zip(found.path, changes(found.path), strict=True)
    ]


def source_lines(static_info: StaticInfo, found: Comparison) -> tuple[list[Line], str]:
    """The line of a comparison with three lines before and after it.

    Returns:
        The lines, and a note where only the line that the analysis kept can be shown: the file is
        gone, or its line is no longer what was compiled.
    """
    own = [Line(found.lineno, found.source_code or "", True)]
    path = static_info.source_path(found.key)
    lines = _decoded_lines(path)
    if lines is None:
        return (own if found.source_code else []), "the source file is not on this machine"
    if not 1 <= found.lineno <= len(lines) or (
        found.source_code is not None
        and lines[found.lineno - 1].strip() != found.source_code.strip()
    ):
        return (own if found.source_code else []), "the source file has changed since the build"
    first = max(1, found.lineno - _CONTEXT)
    shown = lines[first - 1 : found.lineno + _CONTEXT]
    indent = min((len(s) - len(s.lstrip()) for s in shown if s.strip()), default=0)
    return [
        Line(number, text[indent:][:LONGEST_LINE], number == found.lineno)
        for number, text in enumerate(shown, start=first)
    ], ""


def source_file_lines(path: Path) -> list[bytes] | None:
    """A file's lines in UTF-8; None where it is not there, or too large to be anyone's source."""
    try:
        if path.stat().st_size > _LARGEST_SOURCE:
            return None
        return [line.rstrip(b"\r") for line in source_bytes(path).split(b"\n")]
    except OSError:
        return None


def _decoded_lines(path: Path) -> list[str] | None:
    lines = source_file_lines(path)
    if lines is None:
        return None
    return [line.decode("utf-8", "replace").rstrip().expandtabs(4) for line in lines]
