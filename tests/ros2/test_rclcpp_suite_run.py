"""The nodes of examples/rclcpp_nodes: what is found in each, and that reports change nothing.

They are built and run where rclcpp is installed: no package registry has it.
"""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from pytpc.build.build import workspace_env
from pytpc.ingest.reading import read
from pytpc.recording.events import Events
from ros2_rclcpp import needs_rclcpp
from suite.build import Suite, build_suite, instrumented, link_plain
from suite.expectations import RCLCPP_PACKAGE, Verdict, nodes
from suite.known import RCLCPP_KNOWN, RCLCPP_REPORTS_KNOWN
from suite.rclcpp_run import Heard, run_nodes
from suite.report import judge_all
from suite.reported import not_as_listed, raw

NODES = nodes(RCLCPP_PACKAGE)
pytestmark = needs_rclcpp


@dataclass
class Runs:
    """What was heard in each run, how each program ended, and what was reported."""

    plain: Heard
    reporting: Heard
    status: dict[str, tuple[int, int]]
    events: Events


@pytest.fixture(scope="module")
def suite(tmp_path_factory: pytest.TempPathFactory) -> Suite:
    return build_suite(tmp_path_factory.mktemp("rclcpp-suite") / "ws", package=RCLCPP_PACKAGE)


@pytest.fixture(scope="module")
def verdicts(suite: Suite) -> dict[str, Verdict]:
    return {each.node: each for each in judge_all(suite.result.static, RCLCPP_PACKAGE)}


@pytest.fixture(scope="module")
def runs(suite: Suite, domain: dict[str, str], tmp_path_factory: pytest.TempPathFactory) -> Runs:
    folder = tmp_path_factory.mktemp("rclcpp-graph")
    env = workspace_env(suite.result.bases.install)
    reports = {"TPC_SINK": "file", "TPC_FOLDER": str(folder / "reports")}
    plain, before = run_nodes(link_plain(suite), env, domain, folder / "plain")
    with_passes = instrumented(suite)
    reporting, after = run_nodes(with_passes, {**env, **reports}, domain, folder / "reporting")
    status = {node: (before[node], after[node]) for node in before}
    return Runs(plain, reporting, status, read(folder / "reports").events)


def require_built(suite: Suite, node: str) -> None:
    if node not in {unit.link_unit for unit in suite.result.units}:
        assert node.startswith("exp_action"), "only those may be left out"
        pytest.skip("not installed: test_msgs")


@pytest.mark.parametrize("node", NODES)
def test_finds_what_a_reader_finds(suite: Suite, verdicts: dict[str, Verdict], node: str) -> None:
    require_built(suite, node)
    verdict = verdicts[node]
    if node in RCLCPP_KNOWN:
        assert not verdict.is_right, f"{node} is right now: take it out of suite.known"
        pytest.xfail(RCLCPP_KNOWN[node])
    assert verdict.is_right, (verdict.missing, verdict.false)


@pytest.mark.parametrize("node", NODES)
def test_publishes_the_same(suite: Suite, runs: Runs, node: str) -> None:
    require_built(suite, node)
    for topic, count in raw(node, RCLCPP_PACKAGE)["messages"].items():
        name = f"/{node}/{topic}"
        assert len(runs.plain[name]) == count, runs.plain[name]
        assert runs.reporting[name] == runs.plain[name]
    assert runs.status[node] == (0, 0)


@pytest.mark.parametrize("node", NODES)
def test_reports_what_the_list_says(suite: Suite, runs: Runs, node: str) -> None:
    require_built(suite, node)
    (unit,) = (each for each in suite.result.units if each.link_unit == node)
    wrong = list(not_as_listed(runs.events, unit, RCLCPP_PACKAGE))
    if node in RCLCPP_REPORTS_KNOWN:
        assert wrong, f"{node} is right now: take it out of suite.known"
        pytest.xfail(RCLCPP_REPORTS_KNOWN[node])
    assert wrong == []
