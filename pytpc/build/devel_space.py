"""The devel space of a build: what nodes run is what the sources say, installed or not.

Most workspaces of ROS 1 have no ``install()`` rules, because people run them from the devel space
of ``catkin_make``. There a package is its source folder: launch files, configuration and scripts
are used as they are, and only what was built comes from elsewhere. ``pytpc build`` installs each
package into a prefix of its own, and then makes the same out of this: the folder ``devel``, one
prefix with links for all packages, like the linked devel space of catkin_tools.

==================  ============================================================================
``.catkin``         the folder of each package, as catkin writes them; ROS_PACKAGE_PATH has them
``lib/PACKAGE``     its programs; see `pytpc.build.devel_programs`
``lib``             libraries that no rule installs
``lib/python3*``    generated messages, and catkin's relays to the Python packages in the sources
``share/PACKAGE``   what only the build makes. Where a package installs files that are in another
                    place of its sources, or nowhere, this is the folder of the package: with links
                    to its sources, and to these files. What nodes write there, the next build keeps
``written``         files of which the place is taken since, or leads into the sources
==================  ============================================================================

Nothing is written into the sources.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from pytpc.base.errors import WorkspaceError
from pytpc.base.paths import OWN_FOLDER
from pytpc.build.devel_programs import Sources, place_programs
from pytpc.build.reconcile import known_targets
from pytpc.workspace.colcon import Bases
from pytpc.workspace.packages import MANIFEST, Package

_PLACES = ".catkin"
_WRITTEN = Path("written")
# Marks a folder of products for catkin_tools and colcon, with the name of the tool.
_BUILDER = ".built_by"
_OURS = "pytpc build\n"
_SEPARATOR = ";"
# In `share/PACKAGE`, for CMake and for shells.
_NO_DATA = frozenset({MANIFEST, "cmake", "environment", "hook", "catkin_env_hook"})
_FOR_SHELLS = frozenset({".bash", ".dsv", ".ps1", ".sh", ".zsh"})
_OF_BUILD = frozenset({"cmake", "pkgconfig"})


def write_devel_space(bases: Bases, packages: Iterable[Package]) -> None:
    """Write the devel space of the packages that are built, in place of an earlier one.

    Raises:
        WorkspaceError: it cannot be written.
    """
    folder = bases.devel
    fresh, old = (folder.with_name(f"{folder.name}.{word}") for word in ("new", "old"))
    try:
        shutil.rmtree(fresh, ignore_errors=True)
        fresh.mkdir(parents=True)
        places = [
            str(_place(bases, package, fresh))
            for package in packages
            if (bases.build / package.name).is_dir()
        ]
        (fresh / _PLACES).write_text(_SEPARATOR.join(places), encoding="utf-8")
        (fresh / _BUILDER).write_text(_OURS, encoding="utf-8")
        _keep_written(folder, fresh)
        # A robot may run from it.
        shutil.rmtree(old, ignore_errors=True)
        if folder.exists():
            folder.replace(old)
        fresh.replace(folder)
        shutil.rmtree(old, ignore_errors=True)
    except OSError as error:
        raise WorkspaceError(f"cannot be written: {error.strerror or error}", folder) from error


def package_places(devel: Path) -> list[str]:
    """The folders of the packages of a devel space; none if there is no such space of ours."""
    try:
        if (devel / _BUILDER).read_text(encoding="utf-8") != _OURS:
            return []
        text = (devel / _PLACES).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        return []
    return [place for place in text.split(_SEPARATOR) if place]


def _place(bases: Bases, package: Package, space: Path) -> Path:
    """Put what belongs to a package into the space; return the folder of the package."""
    name, root = package.name, package.path.absolute()
    made, installed = bases.build / name / "devel", bases.install / name
    sources = Sources(root)
    _link_built(made, installed, space, name)
    programs = space / "lib" / name
    place_programs(made / "lib" / name, installed / "lib" / name, sources, programs)
    for path in _uninstalled(bases.build / name, installed):
        _link(path, programs / path.name)
    generated = dict(_files(made / "share" / name))
    only_installed = {
        rest: sources.copied(path) or path
        for rest, path in _files(installed / "share" / name)
        if not (root / rest).exists() and rest not in generated
    }
    share = space / "share" / name
    _link_all(generated, share)
    if not only_installed:
        return root
    _link_all(only_installed, share)
    _fill(share, root)
    return bases.devel / "share" / name


def _link_built(made: Path, installed: Path, space: Path, name: str) -> None:
    """Link libraries that were not installed, Python and programs for the PATH."""
    for top in ("lib", "bin"):
        for rest, path in _files(made / top):
            is_python = rest.parts[0].startswith("python")
            if top == "lib" and not is_python:
                is_library = ".so" in rest.name and rest.parts[0] != name
                if not is_library or (installed / top / rest).exists():
                    continue
            _link(path, space / top / rest)


def _uninstalled(build: Path, installed: Path) -> list[Path]:
    """The programs of a package of another build type than catkin that are installed nowhere."""
    if (build / "devel").is_dir():
        return []
    built = [target for target in known_targets(build) or () if not target.is_library]
    files = {target.artifact for target in built if target.artifact and target.built}
    there = {name for _, _, names in os.walk(installed) for name in names}
    return sorted(path for path in files if path.name not in there and ".so" not in path.name)


def _keep_written(folder: Path, fresh: Path) -> None:
    """Copy what nodes wrote into the folders of packages, in which we put nothing but links."""
    # Of two of one name, the later one stays.
    for top in (_WRITTEN, "share"):
        for place, _, names in os.walk(folder / top):
            for path in (Path(place, name) for name in names):
                if path.is_symlink() or not path.is_file():
                    continue
                rest = path.relative_to(folder)
                above = [fresh / one for one in rest.parents]
                if (fresh / rest).is_symlink() or any(one.is_symlink() for one in above):
                    rest = _WRITTEN / rest
                (fresh / rest).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy2(path, fresh / rest)


def _files(folder: Path) -> Iterator[tuple[Path, Path]]:
    """The data in a folder: each file by its path in it. What is for CMake and shells is not."""
    for place, below, names in os.walk(folder):
        at_top = Path(place) == folder
        below[:] = sorted(n for n in below if not (at_top and n in _NO_DATA | _OF_BUILD))
        for name in sorted(names):
            path = Path(place, name)
            if at_top and (name in _NO_DATA or path.suffix in _FOR_SHELLS):
                continue
            if path.suffix != ".pyc":
                yield path.relative_to(folder), path


def _link_all(files: Mapping[Path, Path], folder: Path) -> None:
    for rest, path in files.items():
        _link(path, folder / rest)


def _link(target: Path, link: Path) -> None:
    """Link a file, unless an earlier package has one of this name."""
    link.parent.mkdir(parents=True, exist_ok=True)
    if not link.is_symlink() and not link.exists():
        link.symlink_to(target)


def _fill(folder: Path, source: Path) -> None:
    """Link what a source folder has besides; folders in both are filled in turn."""
    for entry in sorted(source.iterdir()):
        link = folder / entry.name
        # Ours is there where the workspace is one package.
        if entry.name in {".git", OWN_FOLDER}:
            continue
        if link.is_dir() and not link.is_symlink() and entry.is_dir():
            _fill(link, entry)
        else:
            _link(entry, link)
