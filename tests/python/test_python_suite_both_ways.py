"""The nodes of examples/python_nodes publish the same under ``pytpc run``, message by message."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import pytest

from pytpc.static.static_info import StaticInfo
from suite.both_ways import Results, differences
from suite.expectations import PYTHON_PACKAGE, load, nodes
from suite.python_run import missing_modules, run_nodes
from suite.report import analyse_python

ROOT = Path(__file__).parents[2]
ROOMS = ("python_analysis", "python_runtime")
WITH_BOTH = all(importlib.util.find_spec(f"pytpc.{name}") for name in ROOMS)
# What a timed node publishes is not the same twice.
NODES = [node for node in nodes(PYTHON_PACKAGE) if not load(node, PYTHON_PACKAGE).timed]

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(not WITH_BOTH, reason="there is no pytpc analyse, or no pytpc run yet"),
]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("python-suite")


@pytest.fixture(scope="module")
def static(folder: Path) -> StaticInfo:
    return analyse_python(folder)


@pytest.fixture(scope="module")
def results(static: StaticInfo, folder: Path) -> Results:
    runner = str(ROOT / "pytpc/python_runtime/run.py")
    run = [sys.executable, runner, "--static", str(folder / "static.json")]
    able = [node for node in NODES if not missing_modules(node)]
    variants = {"plain": [], "reporting": run}
    return run_nodes(folder, able, variants, env={"TPC_SINK": "rosout"}, least_s=0.0)


@pytest.mark.parametrize("node", NODES)
def test_publishes_the_same(results: Results, folder: Path, node: str) -> None:
    if missing := missing_modules(node):
        pytest.skip(f"not installed here: {', '.join(missing)}")
    said = (folder / "out" / f"reporting-{node}.log").read_text("utf-8")
    assert "bad callback" not in said
    # A second SIGINT may meet the interpreter's exit: the statuses say nothing here.
    results[node]["plain"].status = None
    assert list(differences(node, results[node])) == []


def test_nodes_report(static: StaticInfo, results: Results) -> None:
    comparing = {unit.link_unit for unit in static.units if unit.comparisons}
    reporting = {node for node, variants in results.items() if variants["reporting"].reports}
    assert not any(variants["plain"].reports for variants in results.values())
    assert reporting <= comparing
    assert len(reporting) > 0.85 * len(comparing & set(results))
