"""The flags with which a file is parsed as the build compiled it.

They come from CMake's file API (the ``compileGroups`` of a target), else from
compile_commands.json, else they are guessed. Only flags that change the meaning of the source are
kept.
"""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError
from pytpc.base.paths import ROS_PREFIXES
from pytpc.static.link_unit import LinkUnit

_REPLY = Path(".cmake/api/v1/reply")
_WITH_VALUE = frozenset(
    {"-D", "-U", "-I", "-isystem", "-iquote", "-idirafter", "-include", "-imacros", "-isysroot"}
)
_KEPT = (
    *("-D", "-U", "-I", "-isystem", "-iquote", "-idirafter", "-isysroot", "--sysroot="),
    *("-std=", "-stdlib=", "-nostdinc", "-pthread", "-march=", "-mavx", "-msse", "-mfpu", "-m32"),
    *("-fopenmp", "-fexceptions", "-fno-exceptions", "-frtti", "-fno-rtti", "-fms-extensions"),
    *("-fsigned-char", "-funsigned-char", "-fshort-enums", "-fchar8_t", "-fno-char8_t"),
)
_C_SUFFIX = ".c"


@dataclass(frozen=True, slots=True)
class Flags:
    """Arguments for clang; ``of_build`` is False where nothing is known of the build."""

    arguments: tuple[str, ...]
    of_build: bool


def flags_for(file: str, unit: LinkUnit) -> Flags:
    """How ``file`` was compiled into ``unit``.

    A header gets the flags of a source file of the unit. If the build folder is gone, or its files
    cannot be read, the flags are guessed.
    """
    language = ("-x", "c" if file.endswith(_C_SUFFIX) else "c++")
    if unit.build_folder is not None:
        folder = Path(unit.build_folder)
        for find in (_of_file_api, _of_compile_commands):
            try:
                found = find(folder, unit.link_unit, file)
            except (InputError, LookupError, TypeError, AttributeError, ValueError):
                continue
            if found is not None:
                return Flags((*language, *meaningful(found)), True)
    return Flags((*language, *_made_up(file, unit)), False)


def meaningful(arguments: Iterable[str]) -> list[str]:
    """The arguments that give the source its meaning: paths, macros, the standard.

    Those for other compilers, the optimiser, plugins, warnings and output are left out. Headers
    that CMake has precompiled are included as text.
    """
    # Arguments for clang's front end have the same names behind -Xclang.
    rest = iter([argument for argument in arguments if argument != "-Xclang"])
    kept: list[str] = []
    for argument in rest:
        if argument in _WITH_VALUE:
            value = next(rest, None)
            kept += [argument, value] if value is not None else []
        elif argument.startswith(_KEPT):
            kept.append(argument)
    return kept


def _of_file_api(folder: Path, name: str, file: str) -> list[str] | None:
    targets = list(_targets(folder))
    targets.sort(key=lambda described: described[0]["name"] != name)
    fallback: list[str] | None = None
    for target, root in targets:
        groups = target.get("compileGroups", [])
        for source in target.get("sources", []):
            if os.path.normpath(root / source["path"]) == file and "compileGroupIndex" in source:
                return _of_group(groups[source["compileGroupIndex"]])
        if target["name"] == name:
            fallback = next((_of_group(g) for g in groups if g["language"] == "CXX"), None)
    return fallback


def _targets(folder: Path) -> Iterator[tuple[dict[str, Any], Path]]:
    """The targets of CMake's answer, each with the folder that its paths are relative to."""
    reply = folder / _REPLY
    indexes = sorted(reply.glob("index-*.json"))
    if not indexes:
        return
    index: Any = parse_json(indexes[-1])
    for found in index["objects"]:
        if found["kind"] == "codemodel":
            model: Any = parse_json(reply / found["jsonFile"])
            root = Path(model["paths"]["source"])
            for target in model["configurations"][0]["targets"]:
                described: Any = parse_json(reply / target["jsonFile"])
                yield described, root


def _of_group(group: dict[str, Any]) -> list[str]:
    arguments: list[str] = []
    for fragment in group.get("compileCommandFragments", []):
        arguments += shlex.split(fragment["fragment"])
    arguments += [f"-D{define['define']}" for define in group.get("defines", [])]
    for include in group.get("includes", []):
        arguments += ["-isystem" if include.get("isSystem") else "-I", include["path"]]
    return arguments


def _of_compile_commands(folder: Path, _: str, file: str) -> list[str] | None:
    path = folder / "compile_commands.json"
    if not path.is_file():
        return None
    commands: Any = parse_json(path)
    other: list[str] | None = None
    for command in commands:
        source = os.path.normpath(Path(command["directory"]) / command["file"])
        arguments = command.get("arguments") or shlex.split(command["command"])
        if source == file:
            return list(arguments)
        if other is None and not source.endswith(_C_SUFFIX):
            other = list(arguments)
    return other


def _made_up(file: str, unit: LinkUnit) -> Iterator[str]:
    yield "-std=gnu++17"
    root = Path(unit.source_root)
    for folder in (root / "include", root / "src", root, Path(file).parent):
        yield from ("-I", str(folder))
    for prefix in ROS_PREFIXES:
        yield from ("-isystem", str(prefix / "include"))
