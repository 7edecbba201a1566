"""The nodes of examples/rclpy_nodes on a ROS 2 graph: with reports they publish the same.

All run in one process and one executor, once plain and once with reports into a file. How many
messages they publish, and the values that their comparisons report, stand in their lists.
"""

from __future__ import annotations

import ast
import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

import pytest

from pytpc.ingest.reading import read
from pytpc.recording.events import Events
from pytpc.ros.node_start import RUN
from pytpc.static.static_info import StaticInfo
from ros2_graph import PYTHON, run_python
from suite.expectations import RCLPY_PACKAGE, nodes
from suite.report import analyse_python
from suite.reported import not_as_listed, raw

HOST = Path(__file__).parents[1] / "suite/rclpy_host.py"
INPUT = [-6.0, -2.0, 1.0, 3.0, 6.0, 9.0]
NODES = nodes(RCLPY_PACKAGE)


@dataclass
class Runs:
    """What was heard in each run, and what was reported."""

    plain: dict[str, list[str]]
    reporting: dict[str, list[str]]
    events: Events
    static: StaticInfo
    left_out: dict[str, str]


def missing(names: list[str]) -> dict[str, str]:
    """The nodes that import a module which is not installed for ROS 2, and that module."""
    imports = {}
    for name in names:
        tree = ast.parse((RCLPY_PACKAGE / f"nodes/{name}.py").read_text("utf-8"))
        found = [one.module for one in tree.body if isinstance(one, ast.ImportFrom) and one.module]
        imports[name] = found
    wanted = sorted({module for found in imports.values() for module in found})
    program = (
        "import importlib.util, json, sys\n"
        "def there(name):\n"
        "    try: return importlib.util.find_spec(name) is not None\n"
        "    except ModuleNotFoundError: return False\n"
        "print(json.dumps([name for name in sys.argv[1:] if not there(name)]))\n"
    )
    ran = subprocess.run([PYTHON, "-c", program, *wanted], capture_output=True, check=True)
    absent = set(json.loads(ran.stdout))
    return {
        name: sorted(absent & set(found))[0]
        for name, found in imports.items()
        if absent & set(found)
    }


@pytest.fixture(scope="module")
def runs(domain: dict[str, str], tmp_path_factory: pytest.TempPathFactory) -> Runs:
    folder = tmp_path_factory.mktemp("rclpy-suite")
    static = analyse_python(folder, RCLPY_PACKAGE)
    left_out = missing(NODES)
    able = [node for node in NODES if node not in left_out]
    lists = {node: raw(node, RCLPY_PACKAGE) for node in able}
    config = folder / "config.json"
    config.write_text(
        json.dumps(
            {
                "folder": str(RCLPY_PACKAGE / "nodes"),
                "nodes": able,
                "input": INPUT,
                "params": {
                    node: data["params"] for node, data in lists.items() if "params" in data
                },
                "messages": {node: data["messages"] for node, data in lists.items()},
            }
        )
    )
    heard = {}
    reports = {"TPC_SINK": "file", "TPC_FOLDER": str(folder / "reports")}
    for name, words, env in (
        ("plain", (HOST,), {}),
        ("reporting", (RUN, "--static", folder / "static.json", HOST), reports),
    ):
        output = folder / f"{name}.json"
        ran = run_python(words[0], domain, *map(str, words[1:]), str(config), str(output), **env)
        assert ran.returncode == 0, ran.stderr
        heard[name] = json.loads(output.read_text("utf-8"))
    events = read(folder / "reports").events
    return Runs(heard["plain"], heard["reporting"], events, static, left_out)


@pytest.mark.parametrize("node", NODES)
def test_publishes_the_same(runs: Runs, node: str) -> None:
    if node in runs.left_out:
        pytest.skip(f"not installed for ROS 2: {runs.left_out[node]}")
    for topic, count in raw(node, RCLPY_PACKAGE)["messages"].items():
        name = f"/{topic[3:]}" if topic.startswith("../") else f"/{node}/{topic}"
        assert len(runs.plain[name]) == count, runs.plain[name]
        assert runs.reporting[name] == runs.plain[name]


@pytest.mark.parametrize("node", NODES)
def test_reports_what_the_list_says(runs: Runs, node: str) -> None:
    if node in runs.left_out:
        pytest.skip(f"not installed for ROS 2: {runs.left_out[node]}")
    (unit,) = (each for each in runs.static.units if each.link_unit == node)
    assert list(not_as_listed(runs.events, unit, RCLPY_PACKAGE)) == []
