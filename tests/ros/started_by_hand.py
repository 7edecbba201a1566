"""A robot that a user starts in a shell of their own."""

from __future__ import annotations

import subprocess
from pathlib import Path

from pytpc.base.paths import SYSTEM_PATH
from pytpc.ros.ros1.graph import RosGraph

ROOT = Path(__file__).parents[2]
PATIENCE_S = 120


def roslaunch(tmp_path: Path, words: str, launch: str) -> str:
    """Type ``words`` and roslaunch with ``launch``; nodes report to files in ``tmp_path / "tpc"``.

    Returns what was said.
    """
    (tmp_path / "home").mkdir()
    user = {"PATH": SYSTEM_PATH, "HOME": str(tmp_path / "home"), "PYTHONPATH": str(ROOT)}
    sink = {"TPC_SINK": "file", "TPC_FOLDER": str(tmp_path / "tpc"), "TPC_FILE_RESERVE": "0"}
    with RosGraph(user, tmp_path / "graph") as graph:
        ran = subprocess.run(
            ["bash", "-c", f"set -e; {words}; roslaunch {launch}"],
            env={**graph.env, **sink},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
            timeout=PATIENCE_S,
        )
    return ran.stdout
