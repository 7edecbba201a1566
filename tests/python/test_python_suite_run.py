"""Every node of examples/python_nodes runs on a real roscore, and publishes."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest

from suite.both_ways import Results
from suite.expectations import PYTHON_PACKAGE, nodes
from suite.python_run import missing_modules, run_nodes

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("python-suite")


@pytest.fixture(scope="module")
def results(folder: Path) -> Results:
    able = [node for node in nodes(PYTHON_PACKAGE) if not missing_modules(node)]
    return run_nodes(folder, able)


@pytest.mark.parametrize("node", nodes(PYTHON_PACKAGE))
def test_runs(results: Results, folder: Path, node: str) -> None:
    if missing := missing_modules(node):
        pytest.skip(f"not installed here: {', '.join(missing)}")
    said = (folder / "out" / f"plain-{node}.log").read_text("utf-8")
    # rospy says the one, Python the other; a script that fails ends with another status.
    assert "bad callback" not in said
    assert "Exception in thread" not in said
    # Ended by SIGINT: rospy ends in order, or by a second one that meets the interpreter's exit.
    assert results[node]["plain"].status in (0, -signal.SIGINT), said
    # dynamic_reconfigure publishes below the node's own name whatever happens.
    assert [topic for topic in results[node]["plain"].topics if not topic.startswith(f"{node}/")]
