"""The lists of examples/rclpy_nodes name existing places, and the analysis finds what they say."""

from __future__ import annotations

import json
from collections import Counter

import pytest

from pytpc.static.static_info import StaticInfo
from suite.expectations import RCLPY_PACKAGE, Verdict, load, nodes
from suite.known import RCLPY_KNOWN
from suite.lists import wrong_with
from suite.report import analyse_python, judge_all

NODES = nodes(RCLPY_PACKAGE)
TYPES = {"parameter", "flag", "derived"}
KEYS = {"about", "expect", "absent", "limits", "params", "messages"}


@pytest.fixture(scope="module")
def static(tmp_path_factory: pytest.TempPathFactory) -> StaticInfo:
    return analyse_python(tmp_path_factory.mktemp("suite"), RCLPY_PACKAGE)


@pytest.fixture(scope="module")
def verdicts(static: StaticInfo) -> dict[str, Verdict]:
    return {verdict.node: verdict for verdict in judge_all(static, RCLPY_PACKAGE)}


def test_suite_is_large() -> None:
    lists = [load(node, RCLPY_PACKAGE) for node in NODES]
    assert len(lists) >= 55
    assert sum(len(one.expect) for one in lists) >= 120
    assert sum(len(one.absent) for one in lists) >= 70


@pytest.mark.parametrize("node", NODES)
def test_list_stands_on_its_places(node: str) -> None:
    for entry in load(node, RCLPY_PACKAGE).entries:
        assert wrong_with(entry, RCLPY_PACKAGE) is None, entry


@pytest.mark.parametrize("node", NODES)
def test_list_is_complete_in_itself(node: str) -> None:
    data = json.loads((RCLPY_PACKAGE / f"nodes/{node}.json").read_text("utf-8"))
    assert set(data) <= KEYS
    expectation = load(node, RCLPY_PACKAGE)
    assert expectation.expect or expectation.absent
    for entry in (*expectation.expect, *expectation.limits):
        assert entry.parameter, entry
        assert entry.type in TYPES, entry
        assert (entry.type == "flag") == (entry.relation == "flag"), entry
    assert all(entry.why for entry in expectation.entries)
    places = Counter(
        (entry.line, entry.column, entry.parameter, entry.relation) for entry in expectation.entries
    )
    assert [place for place, times in places.items() if times > 1] == []


@pytest.mark.parametrize("node", NODES)
def test_program_is_complete(node: str) -> None:
    path = RCLPY_PACKAGE / f"nodes/{node}.py"
    source = path.read_text("utf-8")
    compile(source, str(path), "exec")
    assert path.stat().st_mode & 0o111 == 0o111
    assert f'"{node}"' in source


def test_analyses_every_node(static: StaticInfo) -> None:
    units = {unit.link_unit: unit for unit in static.units}
    assert sorted(units) == NODES
    assert {unit.package for unit in units.values()} == {"rclpy_nodes"}
    assert [unit.link_unit for unit in units.values() if unit.status != "ok"] == []


@pytest.mark.parametrize("node", NODES)
def test_finds_what_a_reader_finds(verdicts: dict[str, Verdict], node: str) -> None:
    verdict = verdicts[node]
    is_right = (verdict.missing, verdict.false) == ((), ())
    if node in RCLPY_KNOWN:
        assert not is_right, f"{node} is right now: take it out of suite.known"
        pytest.xfail(RCLPY_KNOWN[node])
    assert is_right, (verdict.missing, verdict.false)
