"""The link units that CMake knows of, asked through its file API (cmake-file-api(7), codemodel v2).

With ThinLTO or native objects a link succeeds and the plugin never runs; only a comparison of what
was linked with what was analysed shows it.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError

_API = Path(".cmake/api/v1")
_LINKED = frozenset({"EXECUTABLE", "SHARED_LIBRARY", "MODULE_LIBRARY"})
_ANALYSED = frozenset({"CXX", "C"})


@dataclass(frozen=True, slots=True)
class LinkTarget:
    """A target that is linked as C or C++; ``artifact`` is the file that comes of it.

    ``objects`` is the folder in which its sources are compiled, where it has sources. ``sources``
    are those files, absolute; ``needs`` are the names of the targets that CMake builds before.
    """

    name: str
    package: str
    artifact: Path | None
    objects: Path | None = None
    is_library: bool = False
    sources: frozenset[Path] = frozenset()
    needs: frozenset[str] = frozenset()

    @property
    def built(self) -> bool:
        """Whether its file is there."""
        return self.artifact is not None and self.artifact.is_file()


def ask_for_targets(build_folder: Path) -> None:
    """Leave a query that CMake answers when it next configures this build folder.

    Raises:
        OSError: the folder cannot be written.
    """
    query = build_folder / _API / "query" / "codemodel-v2"
    query.parent.mkdir(parents=True, exist_ok=True)
    query.touch()


def link_targets(build_folder: Path) -> list[LinkTarget] | None:
    """The targets of a configured build folder that are linked, sorted by name.

    Returns:
        None where CMake left no answer: it is older than 3.14, or never configured the folder.

    Raises:
        InputError: an answer that is not what the manual page describes.
    """
    reply = build_folder / _API / "reply"
    indexes = sorted(reply.glob("index-*.json"))
    if not indexes:
        return None
    try:
        objects: Any = parse_json(indexes[-1])
        model = next(
            (found["jsonFile"] for found in objects["objects"] if found["kind"] == "codemodel"),
            None,
        )
        if model is None:
            return None
        codemodel: Any = parse_json(reply / model)
        configuration = codemodel["configurations"][0]
        described: list[Any] = [
            parse_json(reply / target["jsonFile"]) for target in configuration["targets"]
        ]
        targets = [
            _link_target(
                target,
                configuration["projects"][entry["projectIndex"]]["name"],
                build_folder,
                Path(codemodel["paths"]["source"]),
            )
            for target, entry in zip(described, configuration["targets"], strict=True)
            if target["type"] in _LINKED and _language(target) in _ANALYSED
        ]
    except (KeyError, IndexError, TypeError) as error:
        raise InputError(f"not an answer of CMake's file API: {error!r}", indexes[-1]) from error
    return sorted(targets, key=lambda target: target.name)


def _language(target: dict[str, Any]) -> str | None:
    """The language whose compiler links it; a target of other targets' objects has it, too."""
    link: dict[str, str] = target.get("link", {})
    groups: list[dict[str, str]] = target.get("compileGroups", [])
    return link.get("language") or next((group["language"] for group in groups), None)


def _link_target(
    target: dict[str, Any], package: str, build_folder: Path, source_folder: Path
) -> LinkTarget:
    artifacts = [build_folder / artifact["path"] for artifact in target.get("artifacts", [])]
    below = target.get("paths", {}).get("build")
    objects = None
    if below is not None and target.get("compileGroups"):
        objects = build_folder / below / "CMakeFiles" / f"{target['name']}.dir"
    compiled = [source for source in target.get("sources", []) if "compileGroupIndex" in source]
    return LinkTarget(
        target["name"],
        package,
        artifacts[0] if artifacts else None,
        objects,
        is_library=target["type"] != "EXECUTABLE",
        sources=frozenset(Path(os.path.normpath(source_folder / s["path"])) for s in compiled),
        # An identifier is the name and a hash: `costmap_2d::@6890427a1f51a3e7e1df`.
        needs=frozenset(each["id"].rpartition("::@")[0] for each in target.get("dependencies", [])),
    )
