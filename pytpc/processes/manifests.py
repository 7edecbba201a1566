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
class ObjectFile:
    """An object or archive that was linked.

    ``whole`` says whether all members of an archive count, ``lazy`` whether an object counts only
    if others need it, as a member of an archive does.
    """

    path: Path
    whole: bool
    lazy: bool

    def as_json(self) -> dict[str, Any]:
        """What ``tpc-merge`` reads."""
        return {"path": str(self.path), "whole": self.whole, "lazy": self.lazy}


@dataclass(frozen=True, slots=True)
class Manifest:
    """What a link unit was made of.

    ``objects`` are its files of bitcode, of machine code and its archives, in the order of the
    linker. ``rules`` and ``excluded`` are options of the analysis.
    """

    source_root: str
    objects: tuple[ObjectFile, ...]
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
                ObjectFile(Path(one["path"]), bool(one["whole_archive"]), bool(one["lazy"]))
                for one in own
            ),
            options["profile"],
            tuple(options["rules"]),
            tuple(options["excluded"]),
            bool(options["constants"]),
        )
    except (KeyError, TypeError) as error:
        raise InputError(f"not a manifest of a link: {error!r}", path) from error
