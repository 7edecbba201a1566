"""Builds the suite of Python nodes (catkin's devel space) and runs them on a graph of their own."""

from __future__ import annotations

import ast
import importlib.util
import os
import shlex
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from pytpc.base.errors import RunError
from pytpc.build.build import workspace_env
from pytpc.workspace.colcon import build_environment
from suite.both_ways import Results, Variant, run_all
from suite.expectations import PYTHON_PACKAGE

RUN_S = 2.0
AT_ONCE = 4
PLAIN: Mapping[str, Sequence[str]] = {"plain": ()}
# catkin takes the first python3 of the PATH unless it is told; ROS's Python is the system's.
_PYTHON = "/usr/bin/python3"


def script(node: str) -> Path:
    """The program of a node: nodes/NAME.py or nodes/NAME/NAME.py."""
    folder = PYTHON_PACKAGE / "nodes"
    alone = folder / f"{node}.py"
    return alone if alone.is_file() else folder / node / f"{node}.py"


def missing_modules(node: str) -> list[str]:
    """Modules that the node's script imports at its beginning and that are not installed here."""
    tree = ast.parse(script(node).read_text("utf-8"))
    names = {alias.name for one in tree.body if isinstance(one, ast.Import) for alias in one.names}
    names |= {one.module or "" for one in tree.body if isinstance(one, ast.ImportFrom)}
    tops = {name.partition(".")[0] for name in names} - {"python_nodes"}
    beside = {path.stem for path in script(node).parent.glob("*.py")}
    return sorted(top for top in tops - beside if importlib.util.find_spec(top) is None)


def build_devel(folder: Path) -> Path:
    """Build the package; its devel space.

    Raises:
        RunError: it does not build.
    """
    build = folder / "build"
    for command in (
        ["cmake", "-S", str(PYTHON_PACKAGE), "-B", str(build), f"-DPYTHON_EXECUTABLE={_PYTHON}"],
        ["cmake", "--build", str(build)],
    ):
        ran = subprocess.run(
            command, env=build_environment(), capture_output=True, text=True, check=False
        )
        if ran.returncode:
            said = (ran.stderr or ran.stdout).strip().splitlines() or ["it says nothing"]
            raise RunError(f"{' '.join(command[:2])} fails: {said[0]}", PYTHON_PACKAGE)
    return build / "devel"


def run_nodes(
    folder: Path,
    names: Sequence[str],
    before: Mapping[str, Sequence[str]] = PLAIN,
    *,
    env: Mapping[str, str] | None = None,
    least_s: float = RUN_S,
) -> Results:
    """Run nodes, fed by the suite's input; their output is in folder/out/VARIANT-NODE.log.

    Args:
        folder: for the build, the graph and what the nodes say.
        names: the nodes.
        before: the variants; for each the words that stand before the script.
        env: added to the nodes' environment.
        least_s: how long each node runs at the least.

    Raises:
        RunError: the package does not build, a node ends by itself, or never comes up.
    """
    installed = workspace_env(build_devel(folder))
    # The nodes run under this interpreter, which has ROS's modules and those of the tests.
    path = [str(Path(sys.executable).parent), installed["PATH"]]
    modules = [installed.get("PYTHONPATH", ""), os.environ.get("PYTHONPATH", "")]
    added = {"PATH": ":".join(path), "PYTHONPATH": ":".join(filter(None, modules)), **(env or {})}
    variants = [
        Variant(name, {node: _program(folder / name, node, words) for node in names}, added)
        for name, words in before.items()
    ]
    return run_all(
        variants, installed, folder, package=PYTHON_PACKAGE, at_once=AT_ONCE, least_s=least_s
    )


def _program(folder: Path, node: str, words: Sequence[str]) -> Path:
    """The script itself, or a program that starts it behind other words."""
    if not words:
        return script(node)
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / node
    path.write_text(f'#!/bin/sh\nexec {shlex.join([*words, str(script(node))])} "$@"\n', "utf-8")
    path.chmod(0o755)
    return path
