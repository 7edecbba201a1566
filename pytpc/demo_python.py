"""The Python half of a demonstration: nodes in Python are analysed, and run with reports.

Both are done by commands, as a user would do it: ``pytpc analyse``, and ``pytpc/run.py`` before the
node's own command.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from pytpc.demo_examples import Example
from pytpc.errors import RunError
from pytpc.paths import project_root
from pytpc.static_info import StaticInfo

_RUNNER = "pytpc/run.py"


def analyse_nodes(example: Example, folder: Path) -> list[StaticInfo]:
    """Analyse each node in Python; ``<folder>/<node>.json`` is what was found.

    Nodes share modules, and a module reports by the keys of the node that it runs in: therefore
    each node has a file of its own.

    Raises:
        RunError: a node cannot be analysed.
        InputError: what was written cannot be read.
    """
    folder.mkdir(parents=True, exist_ok=True)
    found = []
    for node in example.python_nodes:
        static = static_file(folder, node)
        _run(["-m", "pytpc", "analyse", str(example.folder / node), "-o", str(static)])
        found.append(StaticInfo.load(static))
    return found


def joined(static: StaticInfo, others: Sequence[StaticInfo]) -> StaticInfo:
    """The static information of several sources as one.

    Raises:
        InputError: a link unit, or a key, occurs twice.
    """
    every = (static, *others)
    copies = {copy: original for one in every for copy, original in one.copies}
    return StaticInfo.of(
        (unit for one in every for unit in one.units),
        copies=copies,
        left_out=(unit for one in every for unit in one.left_out),
    )


def launch_arguments(folder: Path, interpreter: str = "/usr/bin/python3") -> Mapping[str, str]:
    """The arguments with which an example's launch file runs its Python nodes with reports.

    Args:
        folder: where ``analyse_nodes`` wrote.
        interpreter: that of the nodes.
    """
    return {
        "python_runner": f"{interpreter} {project_root() / _RUNNER}",
        "python_static": str(folder.absolute()),
    }


def static_file(folder: Path, node: str) -> Path:
    """Where the static information of a node is, whose script is ``node``."""
    return folder / f"{Path(node).stem}.json"


def _run(words: Sequence[str]) -> None:
    ran = subprocess.run(
        [sys.executable, *words], capture_output=True, text=True, check=False, cwd=project_root()
    )
    if ran.returncode != 0:
        said = ran.stderr.strip().splitlines() or ["it says nothing"]
        raise RunError(f"pytpc {words[2]} ended with status {ran.returncode}: {said[-1]}")
