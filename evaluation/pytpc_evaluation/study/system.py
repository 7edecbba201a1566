"""A robot of the study as it flies: built once, with the static information of both languages."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError
from pytpc.base.paths import MERGED_FILE
from pytpc.build.build import build_workspace, workspace_env
from pytpc.ros.node_start import mission_env
from pytpc.static.static_info import StaticInfo
from pytpc.workspace.colcon import Bases
from pytpc_evaluation.demo.demo_examples import Example, link_package
from pytpc_evaluation.study.digest import build_digest, sources_digest, tools_digest

_BUILT_FILE = "built.json"


@dataclass(frozen=True)
class BuiltSystem:
    """A robot that is built.

    ``env`` is the environment of its nodes, whose reports go to files; ``plain_env`` that of
    programs which only know its messages. ``digest`` stands for the build.
    """

    example: Example
    static: StaticInfo
    env: Mapping[str, str]
    plain_env: Mapping[str, str]
    digest: str


def system_folder(example: Example, out: Path) -> Path:
    """Where a robot is built in the study's folder."""
    return out / "systems" / example.name


def prepare(
    example: Example, out: Path, on_output: Callable[[str], None] | None = None
) -> tuple[BuiltSystem, bool]:
    """Build a robot, unless it is built from the same sources, by the same tools, already.

    Args:
        example: the robot.
        out: the study's folder.
        on_output: called with each line of the build.

    Returns:
        What flies, and whether it was built now.

    Raises:
        TpcError: it does not build; see ``build_workspace``.
    """
    folder = system_folder(example, out)
    workspace, static_file = folder / "ws", folder / MERGED_FILE
    link_package(example, workspace)
    bases = Bases.of(workspace)
    marker = {
        "sources": sources_digest(example),
        "tools": tools_digest(),
        "place": str(workspace.absolute()),
    }
    before = _read(folder / _BUILT_FILE)
    is_built = (bases.install / "setup.bash").is_file() and before == marker
    if not is_built:
        (folder / _BUILT_FILE).unlink(missing_ok=True)
        if isinstance(before, dict) and before.get("place") != marker["place"]:
            # CMake's caches and the set-up scripts know where they were.
            shutil.rmtree(bases.root, ignore_errors=True)
        build_workspace(workspace, on_output=on_output).static.save(static_file)
        write_atomic(folder / _BUILT_FILE, json.dumps(marker).encode() + b"\n")
    static = StaticInfo.load(static_file)
    plain_env = workspace_env(bases.install)
    env = {**mission_env(plain_env, bases.static_info), "TPC_SINK": "file"}
    return BuiltSystem(example, static, env, plain_env, build_digest(example, static)), not is_built


def _read(path: Path) -> object:
    try:
        return parse_json(path)
    except InputError:
        return None
