"""Checks of the packages of a workspace that are for ROS 2: the ROS 2 itself, and what they need.

On a machine with both, a package of ROS 1 has the name of one of ROS 2 (std_msgs): it is here, but
of no use to a package of ROS 2. Packages are told apart by their manifests and by the marker that
those of ROS 2 have in the index of ament.
"""

from __future__ import annotations

import os
import re
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pytpc.base.paths import ROS_PREFIXES, sourced_prefixes
from pytpc.base.wording import many
from pytpc.workspace.doctor.finding import Finding, error, note, warning
from pytpc.workspace.packages import MANIFEST, Manifest
from pytpc.workspace.ros2 import MARKERS, Ros2, find_ros2, has_cmake_package, how_to_source

_CATKIN = re.compile(r"<(?:buildtool_depend|build_type)\b[^>]*>\s*catkin\s*<")
_MOST_NAMES = 6


@dataclass(frozen=True, slots=True)
class KnownRos2:
    """What is known of the ROS 2 of a machine.

    ``packages`` are those of ROS 2 or of no ROS in its prefixes, ``of_ros1`` those of ROS 1 on this
    machine; ``source`` is the command that gives a shell a ROS 2, ``distribution`` the name of the
    one that was sourced.
    """

    ros2: Ros2 | None = None
    packages: frozenset[str] = frozenset()
    of_ros1: frozenset[str] = frozenset()
    has_ament_cmake: bool = False
    source: str = "source /opt/ros/DISTRO/setup.bash"
    distribution: str = ""


def look_at_ros2(environment: Mapping[str, str] = os.environ) -> KnownRos2:
    """See which packages the ROS 2 of this machine has, and which are those of ROS 1."""
    ros2 = find_ros2(environment)
    taken = [*sourced_prefixes(environment), *(ros2.prefixes if ros2 else ()), Path("/usr")]
    here = {prefix: _manifests(prefix) for prefix in dict.fromkeys([*taken, *ROS_PREFIXES])}
    return KnownRos2(
        ros2,
        frozenset(name for one in taken for name, ros in here[one].items() if ros != "1"),
        frozenset(name for found in here.values() for name, ros in found.items() if ros == "1"),
        has_cmake_package("ament_cmake", taken),
        how_to_source(environment),
        environment.get("ROS_DISTRO", "") if environment.get("ROS_VERSION") == "2" else "",
    )


def is_ros2_alone(share: Path) -> bool:
    """Whether ``share/PACKAGE`` of a prefix is of no use to ROS 1; Debian's are for both."""
    prefix = share.parents[1]
    return prefix != Path("/usr") and (prefix / MARKERS / share.name).is_file()


def check_ros2(
    folder: Path,
    manifests: Sequence[Manifest],
    known: KnownRos2,
    debian: Collection[str],
    installed: Collection[str],
) -> list[Finding]:
    """All findings about the packages that are for ROS 2; none if there are no such packages.

    Args:
        folder: the workspace.
        manifests: all of its packages.
        known: of this machine.
        debian: the packages that apt offers.
        installed: those that are installed.
    """
    ours = [manifest for manifest in manifests if manifest.ros == "2"]
    if not ours:
        return []
    here = {*known.packages, *installed, *(manifest.name for manifest in manifests)}
    return [
        *_which(folder, manifests, ours, known),
        *(_missing(folder, need, known, debian) for need in _needs(ours, here)),
    ]


def _manifests(prefix: Path) -> dict[str, str]:
    """The packages of a prefix, each with its ROS: "1", "2", or "" for none."""
    found: dict[str, str] = {}
    for path in (prefix / "share").glob(f"*/{MANIFEST}"):
        name = path.parent.name
        if (prefix / MARKERS / name).is_file():
            found[name] = "2"
        else:
            found[name] = "1" if _CATKIN.search(path.read_text("utf-8", "replace")) else ""
    return found


def _which(
    folder: Path, manifests: Sequence[Manifest], ours: Sequence[Manifest], known: KnownRos2
) -> Iterator[Finding]:
    """Which packages are for which ROS, and under which Python those of ROS 2 run."""
    told = f"{_named(ours)}: for ROS 2"
    others = [manifest for manifest in manifests if manifest.ros == "1"]
    if others:
        told += f"; {_named(others)}: for ROS 1, and built apart from those"
    is_compiled = any(manifest.build_type != "ament_python" for manifest in ours)
    if is_compiled and not known.has_ament_cmake:
        yield error(f"{told}; ament_cmake was not found", folder, known.source)
    elif known.ros2 is None:
        yield warning(
            f"{told}; no ROS 2 was sourced: packages do not find what it has, and its nodes in"
            " Python would run under /usr/bin/python3, which has no rclpy",
            folder,
            known.source,
        )
    else:
        yield note(f"{told}; nodes of ROS 2 in Python run under {known.ros2.words}", folder)


@dataclass(frozen=True, slots=True)
class _Need:
    """A package that some need, to be built or only to run."""

    name: str
    users: tuple[str, ...]
    is_built_with: bool

    @property
    def words(self) -> str:
        return f"needed to {'build' if self.is_built_with else 'run'} {', '.join(self.users)}"


def _needs(ours: Iterable[Manifest], here: Collection[str]) -> Iterator[_Need]:
    """What is needed and not here."""
    users: dict[tuple[str, bool], list[str]] = defaultdict(list)
    for manifest in ours:
        for name in manifest.needs:
            users[name, name in manifest.build_depends].append(manifest.name)
    for (name, is_built_with), packages in users.items():
        if name not in here:
            yield _Need(name, tuple(packages), is_built_with)


def _missing(folder: Path, need: _Need, known: KnownRos2, debian: Collection[str]) -> Finding:
    name = need.name
    say = error if need.is_built_with else warning
    of_distribution = f"ros-{known.distribution}-{name.replace('_', '-')}"
    offered = next((one for one in (of_distribution, name) if one in debian), None)
    install = f"rosdep install --ignore-src --from-paths {folder}"
    if offered is not None:
        install = f"apt-get install {offered}"
    if name in known.of_ros1:
        return say(
            f"{name} is here for ROS 1 only, {need.words}, which is for ROS 2",
            mend=install if known.distribution else known.source,
        )
    if offered is not None:
        return say(f"{name} is not installed, {need.words}", mend=install)
    return warning(
        f"{name} is neither in the workspace nor in a ROS 2 that was sourced, {need.words};"
        f" rosdep's key is {name}",
        mend=install if known.ros2 is not None else f"{known.source} && {install}",
    )


def _named(manifests: Sequence[Manifest]) -> str:
    """The names of packages, or their number."""
    if len(manifests) > _MOST_NAMES:
        return many(len(manifests), "package")
    return ", ".join(manifest.name for manifest in manifests)
