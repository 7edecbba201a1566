"""Whether two builds are of the same code, as far as static information tells.

It knows the source files with a comparison or a read of a parameter, and what they contained. So a
change in another file is not seen.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path

from pytpc.static.link_unit import LinkUnit
from pytpc.static.sources import sources_of
from pytpc.static.static_info import StaticInfo

Build = Mapping[str, str]
"""The digest of each program, by ``program_name``. Where the workspace lies does not count.

A program has none if the content of one of its source files is not known.
"""


def program_name(unit: LinkUnit) -> str:
    """``package/program``."""
    return f"{unit.package}/{unit.link_unit}"


def build_of(static_info: StaticInfo) -> Build | None:
    """The build that static information is of; None if the digests of its sources are not known."""
    sources = dict(static_info.sources)
    if not sources:
        return None
    roots = {unit.source_root: unit.package for unit in static_info.units}
    known = [unit for unit in static_info.units if sources_of(unit) <= sources.keys()]
    return {program_name(unit): _digest(unit, sources, roots) for unit in known}


def _digest(unit: LinkUnit, sources: Mapping[str, str], roots: Mapping[str, str]) -> str:
    files = sorted(sources_of(unit))
    keys = sorted(one.key for one in unit.comparisons)
    content = sorted([_in_package(file, roots), sources[file]] for file in files)
    return hashlib.sha256(json.dumps([keys, content]).encode()).hexdigest()


def _in_package(file: str, roots: Mapping[str, str]) -> str:
    """The file's path in its package; an absolute path is another one in another workspace."""
    above = [root for root in roots if Path(file).is_relative_to(root)]
    if not above:
        return Path(file).name
    root = max(above, key=len)
    return f"{roots[root]}/{Path(file).relative_to(root)}"
