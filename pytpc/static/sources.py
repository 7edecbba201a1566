"""The source files of static information: their content when it was built, and whether it holds."""

from __future__ import annotations

import hashlib
from collections import defaultdict
from dataclasses import replace
from pathlib import Path

from pytpc.static.link_unit import LinkUnit
from pytpc.static.static_info import StaticInfo


def with_source_digests(static: StaticInfo) -> StaticInfo:
    """The same with the SHA-256 of each source file with a comparison or a read.

    Files that cannot be read are left out.
    """
    found = [(file, _digest(Path(file))) for file in _files(static)]
    known = tuple((file, digest) for file, digest in found if digest is not None)
    return replace(static, sources=known)


def changed_sources(static: StaticInfo, written_ns: int | None = None) -> list[str]:
    """The source files that are not as they were when they were analysed, sorted.

    A file that is not on this machine has not changed.

    Args:
        static: if it was built without digests, the lines of its comparisons are compared.
        written_ns: when its file was written; without digests, only later files are looked at.
            None: all of them are.
    """
    known = dict(static.sources)
    if known:
        now = {file: _digest(Path(file)) for file in known}
        return [file for file in known if now[file] not in (None, known[file])]
    lines = _known_lines(static)
    return [file for file in sorted(lines) if _is_other(Path(file), lines[file], written_ns)]


def sources_of(unit: LinkUnit) -> set[str]:
    """The source files with a comparison or a read, by absolute path."""
    names = {each.file for each in unit.comparisons} | {each.file for each in unit.parameters}
    return {unit.absolute(name) for name in names if name}


def _files(static: StaticInfo) -> list[str]:
    return sorted(set[str]().union(*map(sources_of, static.units)))


def _known_lines(static: StaticInfo) -> dict[str, dict[int, str]]:
    """The text of the lines that are known, by file and number."""
    found = defaultdict[str, dict[int, str]](dict)
    for unit in static.units:
        for each in unit.comparisons:
            if each.source_code is not None:
                found[unit.absolute(each.file)][each.lineno] = each.source_code.strip()
    return found


def _is_other(path: Path, known: dict[int, str], written_ns: int | None) -> bool:
    try:
        if written_ns is not None and path.stat().st_mtime_ns <= written_ns:
            return False
        lines = path.read_bytes().decode("utf-8", "replace").splitlines()
    except OSError:
        return False
    return any(
        number > len(lines) or lines[number - 1].strip() != known[number] for number in known
    )


def _digest(path: Path) -> str | None:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest() if path.is_file() else None
    except OSError:
        return None
