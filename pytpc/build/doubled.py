"""Source files that are linked into two link units of one process.

The dynamic linker takes each function from the unit that it loads first. The analysis of that unit
may know less than that of the other one, whose comparisons then never report.
"""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Iterable, Iterator
from itertools import permutations
from pathlib import Path

from pytpc.static.link_unit import Doubled, LinkUnit
from pytpc.workspace.cmake_targets import LinkTarget, link_targets


def doubled_sources(folders: Iterable[Path], units: Iterable[LinkUnit]) -> list[Doubled]:
    """The source files of all build folders whose comparisons in one link unit do not report.

    They are found where CMake's file API tells the sources: within a package.

    Raises:
        InputError: an answer of CMake is broken.
    """
    known = {(unit.package, unit.link_unit): unit for unit in units}
    found = {each for folder in folders for each in _of(link_targets(folder) or [], known)}
    return sorted(found, key=lambda each: (each.package, each.file, each.link_unit, each.runs))


def _of(targets: list[LinkTarget], known: dict[tuple[str, str], LinkUnit]) -> Iterator[Doubled]:
    sharing: defaultdict[Path, list[LinkTarget]] = defaultdict(list)
    for target in targets:
        if (target.package, target.name) in known and target.built:
            for source in target.sources:
                sharing[source].append(target)
    by_name = {target.name: target for target in targets}
    for source, together in sharing.items():
        for first, second in permutations(together, 2):
            if not _is_first(first, second, by_name):
                continue
            own = _places(known[second.package, second.name], source)
            silent = own - _places(known[first.package, first.name], source)
            if silent:
                yield Doubled(second.package, second.name, first.name, str(source), len(silent))


def _is_first(first: LinkTarget, second: LinkTarget, by_name: dict[str, LinkTarget]) -> bool:
    """Whether a process that has both takes the functions of ``first``.

    A program comes before the libraries that it links. A library that another one links is there
    before a program loads that one as a plugin.
    """
    if not second.is_library:
        return False
    if first.is_library:
        return first.name in _needed(second, by_name)
    return second.name in _needed(first, by_name)


def _needed(target: LinkTarget, by_name: dict[str, LinkTarget]) -> set[str]:
    """The names of the targets that this one is linked with, directly or through others."""
    seen: set[str] = set()
    todo = [target]
    while todo:
        new = todo.pop().needs - seen
        seen |= new
        todo += [by_name[name] for name in new if name in by_name]
    return seen


def _places(unit: LinkUnit, source: Path) -> set[tuple[int, int]]:
    return {
        (found.lineno, found.column)
        for found in unit.comparisons
        if found.type != "constant" and os.path.normpath(unit.absolute(found.file)) == str(source)
    }
