"""The lists of examples/rclcpp_nodes stand on their lines and are complete in themselves."""

from __future__ import annotations

from collections import Counter

import pytest

from suite.expectations import RCLCPP_PACKAGE, load, nodes
from suite.known import RCLCPP_KNOWN
from suite.reported import raw

NODES = nodes(RCLCPP_PACKAGE)
TYPES = {"parameter", "flag", "derived"}
KEYS = {"about", "expect", "absent", "limits", "params", "messages"}


def test_suite_is_large() -> None:
    lists = [load(node, RCLCPP_PACKAGE) for node in NODES]
    assert len(lists) >= 55
    assert sum(len(one.expect) for one in lists) >= 160
    assert sum(len(one.absent) for one in lists) >= 60


def test_every_node_has_a_list() -> None:
    assert sorted(path.stem for path in (RCLCPP_PACKAGE / "nodes").glob("*.cpp")) == NODES
    assert set(RCLCPP_KNOWN) <= set(NODES)


@pytest.mark.parametrize("node", NODES)
def test_list_stands_on_its_lines(node: str) -> None:
    for entry in load(node, RCLCPP_PACKAGE).entries:
        lines = (RCLCPP_PACKAGE / entry.file).read_text("utf-8").splitlines()
        assert entry.text in lines[entry.line - 1], entry


@pytest.mark.parametrize("node", NODES)
def test_list_is_complete_in_itself(node: str) -> None:
    data = raw(node, RCLCPP_PACKAGE)
    assert set(data) <= KEYS
    expectation = load(node, RCLCPP_PACKAGE)
    assert expectation.expect or expectation.absent
    for entry in (*expectation.expect, *expectation.limits):
        assert entry.parameter, entry
        assert entry.type in TYPES, entry
    assert all(entry.why for entry in expectation.entries)
    places = Counter((each.line, each.text, each.parameter) for each in expectation.entries)
    assert [place for place, times in places.items() if times > 1] == []
    assert f'"{node}"' in (RCLCPP_PACKAGE / f"nodes/{node}.cpp").read_text("utf-8")
