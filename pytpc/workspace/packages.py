"""The packages of a workspace: found as colcon finds them, read with catkin_pkg."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any
from xml.parsers import expat

from pytpc.base.closest import no_folder
from pytpc.base.errors import InputError, MissingToolError, WorkspaceError
from pytpc.base.source_bytes import read_bytes
from pytpc.workspace.cmake_syntax import find_fault
from pytpc.workspace.ros2 import ROS_VERSION, default_ros

MANIFEST = "package.xml"
IGNORE_MARKERS = frozenset({"COLCON_IGNORE", "CATKIN_IGNORE", "AMENT_IGNORE"})
PRODUCTS = frozenset({"build", "install", "log", "devel"})
# What catkin_make, catkin_tools and colcon leave in build, devel and install spaces of any name.
PRODUCT_MARKERS = frozenset({".built_by", ".catkin", ".colcon_install_layout"})


@dataclass(frozen=True, slots=True)
class Package:
    """A package: its name, its folder, and the build type of its manifest (``catkin``, ...).

    ``needs`` are the names of the packages that it needs to be built or run.
    """

    name: str
    path: Path
    build_type: str
    needs: tuple[str, ...] = ()

    @property
    def cmakelists(self) -> Path:
        """The package's CMakeLists.txt; a package in Python alone has none."""
        return self.path / "CMakeLists.txt"

    @property
    def ros(self) -> str:
        """The ROS that it is for; see ``ros_of``."""
        return ros_of(self.build_type)


@dataclass(frozen=True, slots=True)
class Manifest:
    """The contents of a package.xml: names of other packages, in its order, conditions evaluated.

    ``build_depends`` are needed to build the package, ``run_depends`` to run it, ``test_depends``
    for its tests.
    """

    name: str
    build_type: str
    build_depends: tuple[str, ...]
    run_depends: tuple[str, ...]
    test_depends: tuple[str, ...] = ()

    @property
    def ros(self) -> str:
        """The ROS that the package is for; see ``ros_of``."""
        return ros_of(self.build_type)

    @property
    def needs(self) -> tuple[str, ...]:
        """The packages that are built before it, as colcon and catkin order them."""
        return tuple(dict.fromkeys((*self.build_depends, *self.run_depends)))


def ros_of(build_type: str) -> str:
    """The ROS that a build type belongs to, "1" or "2"; empty for plain CMake."""
    if build_type == "catkin":
        return "1"
    return "2" if build_type.startswith("ament") else ""


def find_packages(workspace: Path) -> list[Package]:
    """All packages below a folder, sorted by path.

    Symbolic links are followed, each folder once. Folders with a file ``COLCON_IGNORE``,
    ``CATKIN_IGNORE`` or ``AMENT_IGNORE`` and hidden folders are skipped, and so are folders called
    build, install, log or devel, unless such a folder is a package itself, and the build, devel
    and install spaces that tools have marked as such. Packages do not nest.

    Raises:
        WorkspaceError: no such folder, no package in it, or two packages with one name.
        InputError: a package.xml that cannot be read as one, with its line where there is one.
        MissingToolError: catkin_pkg is not installed.
    """
    if not workspace.is_dir():
        raise WorkspaceError(no_folder(workspace), workspace)
    packages = []
    for folder in package_folders(workspace):
        manifest = read_manifest(folder)
        packages.append(Package(manifest.name, folder, manifest.build_type, manifest.needs))
    if not packages:
        raise WorkspaceError(
            f"no packages here: no {MANIFEST} in this folder or below; give the one with src",
            workspace,
        )
    by_name: dict[str, Package] = {}
    for package in packages:
        other = by_name.setdefault(package.name, package)
        if other is not package:
            raise WorkspaceError(
                f"package {package.name} occurs twice: {other.path} and {package.path}", workspace
            )
    return packages


def select_packages(packages: Sequence[Package], names: Iterable[str]) -> list[Package]:
    """The packages with these names, in the order of ``packages``; all where no name is given.

    Raises:
        WorkspaceError: no package has one of the names; the message says which comes close.
    """
    wanted = set(names)
    known = [package.name for package in packages]
    for name in sorted(wanted.difference(known)):
        close = get_close_matches(name, known, n=1)
        hint = f"; did you mean {close[0]}?" if close else f"; there are: {', '.join(known)}"
        raise WorkspaceError(f"no package {name} in this workspace{hint}")
    return [package for package in packages if not wanted or package.name in wanted]


def packages_up_to(packages: Sequence[Package], names: Iterable[str]) -> list[Package]:
    """The packages with these names, and those that they need; all if no name is given.

    colcon selects the same for ``--packages-up-to``. The order is that of ``packages``.
    """
    by_name = {package.name: package for package in packages}
    wanted = [name for name in names if name in by_name] or list(by_name)
    reached: set[str] = set()
    while wanted:
        name = wanted.pop()
        if name not in reached:
            reached.add(name)
            wanted += [need for need in by_name[name].needs if need in by_name]
    return [package for package in packages if package.name in reached]


def refuse_cycles(packages: Sequence[Package], workspace: Path) -> None:
    """Check that the packages can be ordered.

    Raises:
        WorkspaceError: some need one another; with their names in a circle.
    """
    cycle = find_cycle({package.name: package.needs for package in packages})
    if cycle:
        raise WorkspaceError(f"circular dependency: {' -> '.join(cycle)}", workspace)


def find_cycle(needs: Mapping[str, Sequence[str]]) -> list[str]:
    """Names that need one another in a circle, the first one again at the end; empty if none do.

    Args:
        needs: for each name the names that it needs; those without a row of their own need none.
    """
    done: set[str] = set()
    for start in sorted(needs):
        way: list[str] = []
        rest = [iter([start])]
        while rest:
            name = next(rest[-1], None)
            if name is None:
                rest.pop()
                if way:
                    done.add(way.pop())
            elif name in way:
                return [*way[way.index(name) :], name]
            elif name not in done:
                way.append(name)
                rest.append(iter(sorted(set(needs.get(name, ())))))
    return []


def read_cmakelists(package: Package) -> bytes | None:
    """The bytes of a package's CMakeLists.txt, or None where it has none.

    Raises:
        InputError: CMake cannot parse the file, with the line; or it cannot be read.
    """
    path = package.cmakelists
    data = read_list_file(path)
    if data is not None:
        check_syntax(data, path)
    elif path.is_symlink():
        raise InputError("a symbolic link that leads nowhere", path)
    return data


def read_list_file(path: Path) -> bytes | None:
    """The bytes of a CMakeLists.txt, unchecked; None if it does not exist.

    Raises:
        InputError: it cannot be read.
    """
    try:
        return path.read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", path) from error


def check_syntax(data: bytes, path: Path) -> None:
    """Check that CMake can parse the bytes of a list file.

    Raises:
        InputError: it cannot, with the line in ``path``.
    """
    fault = find_fault(data)
    if fault is not None:
        raise InputError(f"CMake cannot parse this file: {fault.message}", path, fault.line)


def package_folders(workspace: Path) -> Iterator[Path]:
    """The folders with a package.xml, sorted; ``find_packages`` says which are skipped."""
    seen: set[str] = set()
    for folder, below, files in os.walk(workspace, followlinks=True):
        real = os.path.realpath(folder)
        is_product = not PRODUCT_MARKERS.isdisjoint(files)
        if real in seen or is_product or not IGNORE_MARKERS.isdisjoint([*files, *below]):
            below.clear()
            continue
        seen.add(real)
        if MANIFEST in files:
            below.clear()
            yield Path(folder)
            continue
        below[:] = sorted(name for name in below if is_searched(Path(folder, name)))


def is_searched(folder: Path) -> bool:
    """Whether packages are looked for in a folder of this name; see ``find_packages``."""
    if folder.name.startswith("."):
        return False
    return folder.name not in PRODUCTS or (folder / MANIFEST).is_file()


def read_manifest(folder: Path) -> Manifest:
    """The package.xml of a folder.

    Conditions on ``$ROS_VERSION`` are those of the ROS that its build type is for, whatever was
    sourced. A package for both ROS is for the one that was sourced, else for ROS 1 if it is here.

    Raises:
        InputError: it cannot be read as one, with its line where there is one.
        MissingToolError: catkin_pkg is not installed.
    """
    manifest, build_type = _parsed(folder)
    return Manifest(
        manifest.name,
        build_type,
        _names(
            manifest.build_depends,
            manifest.buildtool_depends,
            manifest.build_export_depends,
            manifest.buildtool_export_depends,
        ),
        _names(manifest.exec_depends),
        _names(manifest.test_depends),
    )


def exported_plugins(folder: Path) -> list[tuple[str, str]]:
    """What the package.xml of a folder exports to pluginlib of ROS 1.

    Returns:
        For each export the package that has the base class, and the file as it is written, which
        may begin with ``${prefix}``.

    Raises:
        InputError, MissingToolError: as `read_manifest`.
    """
    manifest, _ = _parsed(folder)
    return [
        (one.tagname, one.attributes["plugin"])
        for one in manifest.exports
        if one.attributes.get("plugin") and one.evaluated_condition is not False
    ]


def _parsed(folder: Path) -> tuple[Any, str]:
    """The package.xml of a folder as catkin_pkg reads it, conditions evaluated; its build type."""
    try:
        from catkin_pkg.package import InvalidPackage, parse_package_string  # noqa: PLC0415
    except ImportError as error:
        raise MissingToolError(
            f"{sys.executable} has no catkin_pkg; run: {sys.executable} -m pip install catkin_pkg"
        ) from error
    path = folder / MANIFEST
    raw = read_bytes(path)
    try:
        expat.ParserCreate().Parse(raw, True)
        manifest = parse_package_string(raw, filename=str(path), warnings=[])
        return manifest, _evaluated(manifest)
    except expat.ExpatError as error:
        what = expat.ErrorString(error.code)
        raise InputError(
            f"not XML: {what}, column {error.offset + 1}", path, error.lineno
        ) from error
    except (InvalidPackage, ValueError, AssertionError, LookupError) as error:
        what = getattr(error, "msg", None) or str(error)
        raise InputError(f"not a package manifest: {what}", path) from error


def _evaluated(manifest: Any) -> str:  # noqa: ANN401
    """Evaluate the conditions of catkin_pkg's manifest; return the build type."""
    first = default_ros()
    build_type = ""
    for version in (first, "1" if first == "2" else "2"):
        manifest.evaluate_conditions({**os.environ, ROS_VERSION: version})
        build_type = manifest.get_build_type()
        if ros_of(build_type) in ("", version):
            break
    return build_type


def _names(*lists: Iterable[Any]) -> tuple[str, ...]:
    """The dependencies of catkin_pkg whose condition holds, each once."""
    return tuple(
        dict.fromkeys(one.name for each in lists for one in each if one.evaluated_condition)
    )
