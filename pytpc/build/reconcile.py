"""Which link units a build has, which of them were analysed, and why the others were not.

CMake's file API says what is linked; ``tpc/targets.tsv``, which tpc.cmake leaves in the build
folder, says what it left out and why; the object files and the linked file say the rest.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError
from pytpc.static.link_unit import LeftOut, LinkUnit
from pytpc.static.static_info import manifest_of
from pytpc.workspace.cmake_targets import LinkTarget, link_targets

_RECORD = Path("tpc/targets.tsv")
_FIELDS = 5
_BITCODE = (b"BC\xc0\xde", b"\xde\xc0\x17\x0b")
_CACHE = "CMakeCache.txt"


@dataclass(frozen=True, slots=True)
class Recorded:
    """A link unit that tpc.cmake recorded; ``left_out`` is why it is not analysed, or empty."""

    package: str
    name: str
    artifact: Path
    static_info: Path
    left_out: str

    @property
    def plans(self) -> Path:
        """The folder with what its processes found; there is none before CMake has run."""
        return self.static_info.with_suffix(".plans")

    @property
    def waits(self) -> Path:
        """The file that is there until its processes are analysed."""
        return self.plans / "later"

    @property
    def was_delayed(self) -> bool:
        """Whether its last link made no analysis because its processes come first."""
        manifest = manifest_of(self.static_info)
        if not manifest.is_file():
            return False
        try:
            found: Any = parse_json(manifest)
            return bool(found.get("later"))
        except (InputError, AttributeError):
            return False


def build_folders(base: Path) -> list[Path]:
    """CMake's build folders: ``base`` itself, or those right below it, sorted.

    colcon and catkin_tools have a build folder for each package, catkin_make one for all.

    Raises:
        InputError: no such folder.
    """
    if not base.is_dir():
        raise InputError("no such build folder", base)
    if (base / _CACHE).is_file():
        return [base]
    return sorted(folder for folder in base.iterdir() if (folder / _CACHE).is_file())


def recorded_units(build_folder: Path) -> list[Recorded] | None:
    """The link units that tpc.cmake recorded in a build folder; None if it recorded none.

    Raises:
        InputError: the file is broken, with the line.
    """
    path = build_folder / _RECORD
    try:
        text = path.read_text("utf-8")
    except FileNotFoundError:
        return None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot be read: {error}", path) from error
    units = []
    for number, line in enumerate(text.split("\n")[:-1], start=1):
        fields = line.split("\t")
        if len(fields) != _FIELDS:
            raise InputError(f"{len(fields)} fields where {_FIELDS} are", path, number)
        package, name, artifact, static_info, left_out = fields
        units.append(Recorded(package, name, Path(artifact), Path(static_info), left_out))
    return units


def known_targets(build_folder: Path) -> list[LinkTarget] | None:
    """The link units that CMake named; before it was asked, those that tpc.cmake recorded.

    Returns:
        None where neither left anything.

    Raises:
        InputError: an answer of CMake, or the record, is broken.
    """
    targets = link_targets(build_folder)
    if targets is not None:
        return targets
    recorded = recorded_units(build_folder)
    if recorded is None:
        return None
    return [LinkTarget(unit.name, unit.package, unit.artifact) for unit in recorded]


def target_names(build_folder: Path) -> set[tuple[str, str]]:
    """Package and name of all link units that CMake knows, those not built at present among them.

    Raises:
        InputError: an answer of CMake, or the record, is broken.
    """
    known = (*(link_targets(build_folder) or ()), *(recorded_units(build_folder) or ()))
    return {(unit.package, unit.name) for unit in known}


def left_out_units(build_folder: Path) -> list[LeftOut]:
    """The link units whose file is there and that were not analysed, sorted by package and name.

    Raises:
        InputError: an answer of CMake, or the record, is broken.
    """
    recorded = recorded_units(build_folder)
    by_name = {unit.name: unit for unit in recorded or ()}
    left_out = []
    for target in known_targets(build_folder) or ():
        if not target.built:
            continue
        unit = by_name.get(target.name)
        here = build_folder / _RECORD.parent / f"{target.name}.json"
        reason: str | None = None
        if unit is not None:
            reason = None if unit.static_info.is_file() else _why(unit, target)
        elif recorded is not None:
            reason = "it was built by a part of the build that tpc.cmake does not see"
        elif not here.is_file():
            reason = "its package was configured without TPC"
        if reason is not None:
            package = unit.package if unit is not None else target.package
            left_out.append(LeftOut(package, target.name, reason))
    return sorted(left_out, key=lambda unit: (unit.package, unit.link_unit))


def stale_files(build_folder: Path, files: list[Path]) -> Iterator[Path]:
    """The ``files`` whose link unit this build folder no longer has."""
    recorded = recorded_units(build_folder)
    targets = link_targets(build_folder)
    if targets is None and recorded is None:
        return
    names = {target.name for target in targets or ()} | {unit.name for unit in recorded or ()}
    left_out = {unit.static_info for unit in recorded or () if unit.left_out}
    for path in files:
        if path.stem not in names or path in left_out:
            yield path


def remark(unit: LinkUnit) -> str:
    """The status of an analysed unit: ``ok``, or why it has no or too few comparisons."""
    if unit.status != "ok":
        return "left as it was"
    if unit.incomplete is not None:
        return "not analysed to the end"
    counts = unit.counts
    if not counts.comparisons and not counts.parameter_reads and not counts.exposing_statements:
        return "no ROS call"
    if not counts.comparisons and counts.without_debug_info:
        return "no debug information"
    return "ok"


def _why(unit: Recorded, target: LinkTarget) -> str:
    if unit.left_out:
        return unit.left_out
    if unit.waits.is_file() or unit.was_delayed:
        return "it was built, but its processes are not analysed yet; run `pytpc build` again"
    objects = sorted(target.objects.rglob("*.o")) if target.objects is not None else []
    beginnings = [_beginning(path) for path in objects]
    if objects and not any(data.startswith(_BITCODE) for data in beginnings):
        return "its objects are native code, not compiled with -flto"
    # clang writes this word into bitcode that is not for ThinLTO.
    if any(
        data.startswith(_BITCODE) and b"ThinLTO" not in path.read_bytes()
        for path, data in zip(objects, beginnings, strict=True)
    ):
        return "it was compiled for ThinLTO, which never sees a whole link unit"
    return (
        "the linker did not run the analysis, or its file was removed since; "
        f"remove {unit.artifact} and build again"
    )


def _beginning(path: Path) -> bytes:
    with path.open("rb") as stream:
        return stream.read(4)
