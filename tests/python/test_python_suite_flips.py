"""The lists of examples/python_nodes are true: flipping a comparison shows where they say so.

No analysis is involved: each node runs with every other outcome of one comparison flipped, and what
it exposes is compared with what it exposed before.
"""

from __future__ import annotations

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from suite.expectations import PYTHON_PACKAGE, load, nodes
from suite.python_run import missing_modules

ROOT = Path(__file__).parents[2]

pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("rospy") is None, reason="the messages are ROS's"
)


@pytest.fixture(scope="module")
def shown() -> dict[str, dict[str, bool]]:
    """For each node its entries by place, and whether flipping one shows."""
    # A process of its own: nodes leave threads and modules behind.
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    ran = subprocess.run(
        [sys.executable, "-m", "suite.flips"],
        env=environment,
        cwd=ROOT,
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    data: dict[str, dict[str, bool]] = json.loads(ran.stdout)
    return data


@pytest.mark.parametrize("node", nodes(PYTHON_PACKAGE))
def test_shows_what_the_list_says(shown: dict[str, dict[str, bool]], node: str) -> None:
    if missing := missing_modules(node):
        pytest.skip(f"not installed here: {', '.join(missing)}")
    expectation = load(node, PYTHON_PACKAGE)
    wanted = [(entry, True) for entry in (*expectation.expect, *(expectation.constants or ()))]
    wanted += [(entry, entry.decides) for entry in expectation.absent]
    places = {f"{entry.file}:{entry.line}:{entry.column}": shows for entry, shows in wanted}
    assert shown[node] == places
