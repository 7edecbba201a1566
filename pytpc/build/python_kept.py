"""What an earlier build found in Python, and whether it still holds.

It holds while all that the analysis reads is the same, byte for byte: the Python of all packages,
what says which of it is a program, the rules, and the analysis itself.
"""

from __future__ import annotations

import hashlib
import json
import os
import sys
from collections.abc import Iterable, Iterator
from dataclasses import asdict, replace
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import dump_json, parse_json
from pytpc.base.errors import InputError
from pytpc.build.python_units import PythonUnits, analysis_files
from pytpc.python_analysis.rules_file import Rules
from pytpc.static.link_unit import LeftOut, LinkUnit
from pytpc.static.static_info import python_unit_file

KEPT_FILE = "python.json"
_PRODUCTS = frozenset({"__pycache__", "node_modules"})
# What says how a package is called, and which of its files are programs or modules.
_DECLARING = frozenset({"package.xml", "setup.cfg", "pyproject.toml", "CMakeLists.txt"})


def digest_of(roots: Iterable[Path], rules: Rules, asked: Iterable[str]) -> str:
    """A digest that changes when the result of the analysis may change.

    Args:
        roots: the folders of all packages that may be imported from.
        rules: what reads and what exposes.
        asked: what else the result depends on.
    """
    digest = hashlib.sha256()
    said = json.dumps(asdict(rules), sort_keys=True, default=sorted)
    for text in (sys.version, said, *asked):
        digest.update(text.encode("utf-8", "surrogateescape") + b"\0")
    for path in (*analysis_files(), *(file for root in roots for file in _read_files(root))):
        try:
            content = path.read_bytes()
        except OSError:
            content = b"unreadable"
        digest.update(os.fsencode(path) + b"\0" + hashlib.sha256(content).digest())
    return digest.hexdigest()


def load_kept(path: Path, build_base: Path, digest: str) -> PythonUnits | None:
    """The units that a build wrote with the same ``digest``; None where they do not all hold."""
    try:
        data = parse_json(path)
        if not isinstance(data, dict) or data["digest"] != digest:
            return None
        units = tuple(_unit(build_base / package, *which) for package, *which in data["written"])
        return PythonUnits(units, tuple(LeftOut(*left_out) for left_out in data["left_out"]))
    except (OSError, InputError, KeyError, TypeError, ValueError):
        # Missing or edited: everything is analysed again.
        return None


def _unit(folder: Path, name: str, digest: str) -> LinkUnit:
    """A unit as it was written; unchanged files need no second check.

    Raises:
        OSError: the file is gone.
        ValueError: it has changed.
    """
    data = python_unit_file(folder, name).read_bytes()
    if hashlib.sha256(data).hexdigest() != digest:
        raise ValueError("changed since it was written")
    return replace(LinkUnit.from_checked(json.loads(data)), build_folder=str(folder.absolute()))


def save_kept(path: Path, build_base: Path, digest: str, found: PythonUnits) -> None:
    """Remember what was written.

    Raises:
        TpcError: the file cannot be written.
        OSError: one of the units' files cannot be read.
    """
    written = []
    for unit in found.units:
        data = python_unit_file(build_base / unit.package, unit.link_unit).read_bytes()
        written.append([unit.package, unit.link_unit, hashlib.sha256(data).hexdigest()])
    left_out = [[one.package, one.link_unit, one.reason] for one in found.left_out]
    write_atomic(path, dump_json({"digest": digest, "written": written, "left_out": left_out}))


def _read_files(root: Path) -> Iterator[Path]:
    """The files of a package that the analysis may read, in an order that stays."""
    seen: set[str] = set()
    for folder, below, files in os.walk(root, followlinks=True):
        real = os.path.realpath(folder)
        if real in seen:
            below.clear()
            continue
        seen.add(real)
        below[:] = sorted(name for name in below if name not in _PRODUCTS and name[0] != ".")
        for name in sorted(files):
            path = Path(folder, name)
            if name in _DECLARING or path.suffix == ".py" or _is_script(path):
                yield path


def _is_script(path: Path) -> bool:
    try:
        if not path.is_file():
            return False
        with path.open("rb") as stream:
            return b"#!" in stream.read(8)
    except OSError:
        return False
