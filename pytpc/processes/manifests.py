"""The manifests of links: which files of bitcode a link unit was made of."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError
from pytpc.processes.process import Unit

_SCHEMA = 1
_SYSTEM = ("/usr/lib", "/lib")


@dataclass(frozen=True, slots=True)
class Manifest:
    """What a link unit was made of.

    ``objects`` are its files of bitcode and its archives, in the order of the linker, each with
    whether all members of an archive count; ``native`` are those that hold machine code. ``rules``
    and ``excluded`` are options of the analysis.
    """

    source_root: str
    objects: tuple[tuple[Path, bool], ...]
    native: tuple[Path, ...]
    profile: str
    rules: tuple[str, ...]
    excluded: tuple[str, ...]
    constants: bool


def read_manifest_of(unit: Unit) -> Manifest | None:
    """The manifest of a link unit; None if its link wrote none.

    Raises:
        InputError: it cannot be read, or is of another version of TPC.
    """
    path = unit.manifest
    if not path.is_file():
        return None
    data: Any = parse_json(path)
    try:
        if data["schema"] != _SCHEMA:
            raise InputError("of another version of TPC; build again with `pytpc build`", path)
        options = data["options"]
        # Files of the compiler and of libraries that are installed have no bitcode.
        own = [
            one
            for one in data["objects"]
            if one["kind"] == "bitcode" or not one["path"].startswith(_SYSTEM)
        ]
        return Manifest(
            data["source_root"],
            tuple(
                (Path(one["path"]), bool(one["whole_archive"]))
                for one in own
                if one["kind"] != "native"
            ),
            tuple(Path(one["path"]) for one in own if one["kind"] == "native"),
            options["profile"],
            tuple(options["rules"]),
            tuple(options["excluded"]),
            bool(options["constants"]),
        )
    except (KeyError, TypeError) as error:
        raise InputError(f"not a manifest of a link: {error!r}", path) from error
