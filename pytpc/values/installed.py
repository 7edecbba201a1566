"""Installed copies of files, and the sources that they were copied from."""

from __future__ import annotations

import filecmp
import functools
import re
from pathlib import Path

from pytpc.workspace.packages import MANIFEST, package_folders

SYSTEM_FOLDERS = (Path("/usr"), Path("/opt"))
_NAME = re.compile(rb"<name>\s*([^<\s]+)\s*</name>")


def source_of(path: Path | None) -> Path | None:
    """The source of an installed copy, or the file to which a symbolic link leads.

    An install space copies ``share/PACKAGE/REST`` from the package's folder below ``src``. Where a
    package puts its files elsewhere than they stand, the only file of the same name counts.

    Returns:
        None where ``path`` is a source itself, or no source is found.
    """
    if path is None:
        return None
    real = path.resolve()
    place = _installed_place(real)
    if place is None:
        return real if real != path.absolute() and path.is_symlink() else None
    prefix, package, rest = place
    folder = _package_folder(prefix, package)
    if folder is None:
        return None
    same = folder / rest
    if same.is_file():
        return same.resolve()
    found = [one for one in sorted(folder.rglob(rest.name)) if one.is_file()]
    return found[0].resolve() if len(found) == 1 else None


def is_installed(path: Path) -> bool:
    """Whether a file is in an install space (``share/PACKAGE`` beside a set-up script)."""
    return _installed_place(path.resolve()) is not None


def of_the_system(path: Path) -> bool:
    """Whether a file was installed by a package of the system."""
    real = path.resolve()
    return any(folder in real.parents for folder in SYSTEM_FOLDERS) and "local" not in real.parts


def notes_on_file(path: Path, real: Path) -> tuple[str, ...]:
    """Notes on the file that a change goes to."""
    notes = []
    if path.resolve() != real:
        try:
            same = filecmp.cmp(path, real, shallow=False)
        except OSError:
            same = False
        differs = "" if same else ", which is older or newer than it"
        notes.append(
            f"the robot reads the installed copy {path}{differs}: build the workspace again for"
            " the change to reach it"
        )
    elif is_installed(real):
        notes.append(
            "this is an installed copy, and no source of it is found: a build overwrites it"
        )
    try:
        others = real.stat().st_nlink - 1
    except OSError:
        others = 0
    if others > 0:
        notes.append(f"{others} other names (hard links) of this file keep the old text")
    return tuple(notes)


def _installed_place(path: Path) -> tuple[Path, str, Path] | None:
    """The prefix, the package and what is below its share folder."""
    parts = path.parts
    for index in range(len(parts) - 3, 0, -1):
        if parts[index] != "share":
            continue
        prefix, package = Path(*parts[:index]), parts[index + 1]
        if (prefix / "share" / package / MANIFEST).is_file():
            return prefix, package, Path(*parts[index + 2 :])
    return None


def _package_folder(prefix: Path, package: str) -> Path | None:
    for above in prefix.parents:
        if (above / "src").is_dir() and above not in (*SYSTEM_FOLDERS, Path("/")):
            return _folders(above / "src").get(package)
    return None


@functools.lru_cache(maxsize=8)
def _folders(sources: Path) -> dict[str, Path]:
    """The folders of the packages below ``sources``, by the names in their manifests."""
    found: dict[str, Path] = {}
    for folder in package_folders(sources):
        try:
            named = _NAME.search((folder / MANIFEST).read_bytes())
        except OSError:
            continue
        if named is not None:
            found.setdefault(named[1].decode("utf-8", "replace"), folder)
    return found
