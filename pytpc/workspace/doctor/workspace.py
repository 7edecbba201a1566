"""Checks of a workspace: packages, what they need, build folders. Nothing is changed.

``look_at_workspace`` and ``look_at_known`` read; the checks are functions of what these have seen.
"""

from __future__ import annotations

import os
import re
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pytpc.base.errors import InputError, WorkspaceError
from pytpc.base.paths import OWN_FOLDER, ROS_PREFIXES, prefix, sourced_prefixes
from pytpc.workspace.cmake_block import patch_text, restore_text
from pytpc.workspace.cmake_syntax import UTF8_BOM, Kind, commands, find_fault, tokens
from pytpc.workspace.doctor.finding import Finding, error, note, warning
from pytpc.workspace.doctor.machine import UNSUITED, output_of
from pytpc.workspace.doctor.ros2 import KnownRos2, check_ros2, is_ros2_alone, look_at_ros2
from pytpc.workspace.packages import (
    MANIFEST,
    Manifest,
    find_cycle,
    package_folders,
    read_list_file,
    read_manifest,
)

_COMMENTS = (Kind.LINE_COMMENT, Kind.BRACKET_COMMENT)
_CMAKE_BUILD_TYPES = ("catkin", "cmake", "ament_cmake")

# clang, or CMake's own choice, which tpc.cmake replaces by clang.
_REPLACED = re.compile(r"clang(\+\+)?-\d+$|(^|/)c(c|\+\+)$")


_CACHE = "CMakeCache.txt"
_CACHE_LINE = re.compile(r"^(\w+):\w+=(.*)$", re.MULTILINE)
# The deepest build folder is .tpc/build/PACKAGE.
_BUILD_DEPTH = 3
_ODD_NAMES = 20


@dataclass(frozen=True, slots=True)
class SeenPackage:
    """A package's folder as it was found.

    ``manifest`` is what could be read, or why it could not; ``lists`` the bytes of CMakeLists.txt,
    None where there is none, or why they cannot be read.
    """

    folder: Path
    manifest: Manifest | InputError
    lists: bytes | InputError | None
    is_writable: bool = True


@dataclass(frozen=True, slots=True)
class BuildFolder:
    """A folder with a CMakeCache.txt: sources, compiler of C++ (else of C), toolchain file."""

    folder: Path
    source: Path
    compiler: str
    toolchain: str


@dataclass(frozen=True, slots=True)
class SeenWorkspace:
    """What ``look_at_workspace`` saw; ``odd_names`` are files whose names are not UTF-8."""

    folder: Path
    packages: Sequence[SeenPackage]
    builds: Sequence[BuildFolder] = ()
    odd_names: Sequence[str] = ()
    is_writable: bool = True

    @property
    def is_for_ros2_alone(self) -> bool:
        """Whether there are packages of ROS 2, and none of ROS 1."""
        return {manifest.ros for manifest in _manifests(self)} - {""} == {"2"}


@dataclass(frozen=True, slots=True)
class Known:
    """The packages and builds that TPC knows outside of the workspace.

    ``packages`` have a package.xml in a prefix that CMake looks in; ``debian`` are the packages
    that apt offers, ``installed`` those that dpkg has; ``ros2`` is what is known of ROS 2.
    """

    packages: frozenset[str]
    debian: frozenset[str]
    installed: frozenset[str]
    cmake_file: str
    own_builds: Path
    ros2: KnownRos2 = field(default_factory=KnownRos2)


def look_at_workspace(workspace: Path) -> SeenWorkspace:
    """See which packages and build folders a workspace has.

    Raises:
        WorkspaceError: no such folder.
        MissingToolError: catkin_pkg is not installed.
    """
    if not workspace.is_dir():
        raise WorkspaceError("no such folder", workspace)
    folder = workspace.absolute()
    return SeenWorkspace(
        folder,
        [_look_at_package(found) for found in package_folders(folder)],
        list(_build_folders(folder)),
        _odd_names(folder),
        os.access(folder, os.W_OK | os.X_OK),
    )


def look_at_known(workspace: Path) -> Known:
    """See which packages CMake's prefixes, apt and dpkg have."""
    prefixes = [*sourced_prefixes(), *ROS_PREFIXES]
    shares = [path for one in prefixes for path in (one / "share").glob(f"*/{MANIFEST}")]
    installed = output_of(["dpkg-query", "-W", "-f", "${Package} ${db:Status-Status}\n"])
    return Known(
        packages=frozenset(path.parent.name for path in shares if not is_ros2_alone(path.parent)),
        debian=frozenset(output_of(["apt-cache", "pkgnames"]).split()),
        installed=frozenset(
            line.split()[0] for line in installed.splitlines() if line.endswith(" installed")
        ),
        cmake_file=str(prefix() / "share/tpc/cmake/tpc.cmake"),
        own_builds=workspace.absolute() / OWN_FOLDER,
        ros2=look_at_ros2(),
    )


def read_cache(text: str, folder: Path) -> BuildFolder:
    """Read the build folder's settings from its CMakeCache.txt."""
    values = dict(_CACHE_LINE.findall(text))
    return BuildFolder(
        folder,
        Path(values.get("CMAKE_HOME_DIRECTORY", "")),
        values.get("CMAKE_CXX_COMPILER") or values.get("CMAKE_C_COMPILER", ""),
        values.get("CMAKE_TOOLCHAIN_FILE", ""),
    )


def _look_at_package(folder: Path) -> SeenPackage:
    path = folder / "CMakeLists.txt"
    manifest: Manifest | InputError
    lists: bytes | InputError | None
    try:
        manifest = read_manifest(folder)
    except InputError as fault:
        manifest = fault
    try:
        lists = read_list_file(path)
        if lists is None and path.is_symlink():
            lists = InputError("a symbolic link that leads nowhere", path)
    except InputError as fault:
        lists = fault
    return SeenPackage(folder, manifest, lists, os.access(folder, os.W_OK | os.X_OK))


def _build_folders(workspace: Path) -> Iterator[BuildFolder]:
    for here, below, files in os.walk(workspace):
        folder = Path(here)
        if _CACHE in files:
            below.clear()
            yield read_cache((folder / _CACHE).read_text("utf-8", "replace"), folder)
        elif len(folder.relative_to(workspace).parts) >= _BUILD_DEPTH:
            below.clear()
        below[:] = sorted(name for name in below if name == OWN_FOLDER or not name.startswith("."))


def _odd_names(workspace: Path) -> list[str]:
    """Paths with names that are not UTF-8, at most twenty, shown with escapes."""
    found: list[str] = []
    for here, below, files in os.walk(workspace):
        below[:] = sorted(name for name in below if not name.startswith("."))
        for name in sorted([*below, *files]):
            try:
                name.encode()
            except UnicodeEncodeError:
                path = os.fsencode(Path(here) / name)
                found.append(path.decode("utf-8", "backslashreplace"))
                if len(found) == _ODD_NAMES:
                    return found
    return found


def check_workspace(seen: SeenWorkspace, known: Known) -> list[Finding]:
    """All findings about a workspace."""
    if not seen.packages:
        return [error(f"no packages here: no {MANIFEST} in this folder or below", seen.folder)]
    findings = [
        *(one for package in seen.packages for one in _package(package, known)),
        *_names(seen),
        *_cycles(seen),
        *_dependencies(seen, known),
        *check_ros2(seen.folder, _manifests(seen), known.ros2, known.debian, known.installed),
        *_builds(seen, known),
    ]
    if not seen.is_writable:
        findings.append(
            error("cannot be written, but a build creates .tpc here", seen.folder, "chmod u+w")
        )
    findings += [
        warning("a file name that is not UTF-8; some tools cannot show it", name, "mv it")
        for name in seen.odd_names
    ]
    return findings


def debian_names(name: str, *, distribution: str | None = None) -> list[str]:
    """The names that Debian or a ROS distribution may have for a package; the likeliest first.

    Debian has roscpp as libroscpp-dev, rospy as python3-rospy, message_generation as
    ros-message-generation, catkin as catkin.
    """
    plain = name.lower().replace("_", "-")
    first = [f"ros-{distribution}-{plain}"] if distribution else []
    return [*first, f"lib{plain}-dev", f"ros-{plain}", f"python3-{plain}", plain]


def unsuited_flags(lists: bytes) -> list[tuple[int, str]]:
    """Flags in a list file that do not go together with TPC, with their lines."""
    found: list[tuple[int, str]] = []
    for token in tokens(lists.removeprefix(UTF8_BOM)):
        if token.kind in _COMMENTS:
            continue
        text = token.text.decode("latin-1")
        found += [
            (token.line + text.count("\n", 0, match.start()), match[0])
            for match in UNSUITED.finditer(text)
        ]
    return found


def _package(package: SeenPackage, known: Known) -> Iterator[Finding]:
    if isinstance(package.manifest, InputError):
        yield _of(package.manifest)
        build_type = ""
    else:
        build_type = package.manifest.build_type
    path = package.folder / "CMakeLists.txt"
    if isinstance(package.lists, InputError):
        yield _of(package.lists)
        return
    if package.lists is None:
        if build_type in _CMAKE_BUILD_TYPES:
            yield error(f"a {build_type} package without this file", path)
        return
    fault = find_fault(package.lists)
    if fault is not None:
        yield error(f"CMake cannot parse this file: {fault.message}", f"{path}:{fault.line}")
        return
    if not any(command.name == "project" for command in commands(package.lists)):
        yield error(
            "does not call project() itself",
            path,
            "add project(NAME) after cmake_minimum_required()",
        )
    yield from _block(package.lists, path, known.cmake_file)
    if not package.is_writable:
        yield note("cannot be written: TPC can build it but not patch it", package.folder)
    for line, flag in unsuited_flags(package.lists):
        yield warning(
            f"{flag} cannot be combined with TPC: targets that use it are not instrumented",
            f"{path}:{line}",
        )


def _block(lists: bytes, path: Path, cmake_file: str) -> Iterator[Finding]:
    try:
        plain = restore_text(lists)
        if plain != lists and patch_text(lists, cmake_file) != lists:
            yield warning(
                "TPC's block points to another installation",
                path,
                "pytpc patch WORKSPACE",
            )
    except WorkspaceError as fault:
        where = path if fault.line is None else f"{path}:{fault.line}"
        yield warning(fault.message, where)


def _names(seen: SeenWorkspace) -> Iterator[Finding]:
    folders: dict[str, list[Path]] = defaultdict(list)
    for package in seen.packages:
        if isinstance(package.manifest, Manifest):
            folders[package.manifest.name].append(package.folder)
    for name, found in folders.items():
        if len(found) > 1:
            yield error(
                f"package {name} occurs {len(found)} times: {', '.join(map(str, found))}",
                seen.folder,
                f"touch {found[-1] / 'COLCON_IGNORE'}",
            )


def _cycles(seen: SeenWorkspace) -> Iterator[Finding]:
    cycle = find_cycle({manifest.name: manifest.needs for manifest in _manifests(seen)})
    if cycle:
        yield error(
            f"circular dependency: {' -> '.join(cycle)}",
            seen.folder,
            f"take {cycle[1]} out of the package.xml of {cycle[0]}",
        )


def _dependencies(seen: SeenWorkspace, known: Known) -> Iterator[Finding]:
    own = {manifest.name for manifest in _manifests(seen)}
    users: dict[tuple[str, bool], list[str]] = defaultdict(list)
    for manifest in (each for each in _manifests(seen) if each.ros != "2"):
        for name in manifest.build_depends:
            users[name, True].append(manifest.name)
        for name in manifest.run_depends:
            if name not in manifest.build_depends:
                users[name, False].append(manifest.name)
    for (name, is_built_with), packages in users.items():
        if name in own or name in known.packages:
            continue
        offered = [one for one in debian_names(name) if one in known.debian]
        if any(one in known.installed for one in (name, *offered[:1])):
            continue
        by = f"needed to {'build' if is_built_with else 'run'} {', '.join(packages)}"
        if offered:
            say = error if is_built_with else warning
            yield say(f"{name} is not installed, {by}", mend=f"apt-get install {offered[0]}")
        else:
            yield warning(
                f"{name} is neither in the workspace nor installed as a package of that name, {by}",
                mend=f"rosdep install --from-paths {seen.folder}",
            )


def _builds(seen: SeenWorkspace, known: Known) -> Iterator[Finding]:
    patched = {
        package.folder.resolve()
        for package in seen.packages
        if isinstance(package.lists, bytes) and _has_block(package.lists)
    }
    plain: dict[Path, list[BuildFolder]] = defaultdict(list)
    for build in seen.builds:
        if build.folder.is_relative_to(known.own_builds):
            if build.toolchain != known.cmake_file:
                yield error(
                    "was configured without TPC or with another installation of it, and CMake keeps"
                    " a build folder's compiler",
                    build.folder,
                    f"rm -r {build.folder}",
                )
        elif build.toolchain != known.cmake_file and not re.search(_REPLACED, build.compiler):
            source = build.source.resolve()
            if any(folder == source or folder.is_relative_to(source) for folder in patched):
                yield warning(
                    f"was configured with the compiler {build.compiler}, which CMake keeps: the"
                    " patched package is not instrumented",
                    build.folder,
                    f"rm -r {build.folder}",
                )
            else:
                plain[build.folder.parent].append(build)
    for base, builds in plain.items():
        yield note(
            f"was configured with the compiler {builds[0].compiler}: a patched package needs"
            " another build folder",
            builds[0].folder if len(builds) == 1 else base,
        )


def _has_block(lists: bytes) -> bool:
    try:
        return restore_text(lists) != lists
    except WorkspaceError:
        return True


def _manifests(seen: SeenWorkspace) -> list[Manifest]:
    found = [package.manifest for package in seen.packages]
    return [manifest for manifest in found if isinstance(manifest, Manifest)]


def _of(fault: InputError) -> Finding:
    where = fault.path if fault.line is None else f"{fault.path}:{fault.line}"
    return error(fault.message, where)
