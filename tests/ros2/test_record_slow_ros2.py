"""`pytpc record` beside nodes that answer late, and topics of all qualities of service."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
import yaml
from rosbags.rosbag2.storage_mcap import McapReader

from patience import PATIENCE_S
from pytpc.ingest.ros2 import decode_string
from ros2_commands import interrupted, recorder, running
from ros2_graph import PYTHON

NODE = Path(__file__).with_name("late_node.py")
# For longer than a node of usual speed takes to answer.
LONG_S = 8.0


@pytest.fixture
def late(env: dict[str, str], tmp_path: Path):
    with running([str(PYTHON), str(NODE)], env, tmp_path) as node:
        assert node.stdout.readline() == "ready\n", node.stderr.read()
        yield node


def step(node) -> None:
    node.stdin.write("\n")
    node.stdin.flush()


def said(path: Path) -> dict[str, set[bytes]]:
    """The texts on the topics of a file that is closed, or that still grows."""
    reader = McapReader(path)
    reader.open()
    found: dict[str, set[bytes]] = {}
    try:
        kept = [one for one in reader.connections if one.topic in {"/map", "/scan"}]
        for one, _, raw in reader.messages(kept):
            found.setdefault(one.topic, set()).add(decode_string(raw))
    finally:
        reader.close()
    return found


def test_late_answers_and_all_qualities_of_service_are_recorded(
    env: dict[str, str], tmp_path: Path, late
) -> None:
    with recorder(env, tmp_path, "--topic", "/map", "--topic", "/scan") as process:
        time.sleep(LONG_S)
        step(late)
        grows = tmp_path / "mission/mission.mcap.active"
        wait_for_bytes(grows, b"reliable")
        step(late)
        wait_for_bytes(grows, b"best effort")
        interrupted(process)
    assert said(tmp_path / "mission/mission.mcap") == {
        "/map": {b"once"},
        "/scan": {b"reliable", b"best effort"},
    }
    nodes = yaml.safe_load((tmp_path / "mission/params_start.yaml").read_text())
    assert set(nodes) == {"/robot1/late"}
    values = nodes["/robot1/late"]["ros__parameters"]
    assert values["limits.speed"] == 6.5
    assert values["qos_overrides./scan.publisher.depth"] == 7


def wait_for_bytes(path: Path, wanted: bytes) -> None:
    until = time.monotonic() + PATIENCE_S
    while wanted not in path.read_bytes():
        assert time.monotonic() < until
        time.sleep(0.1)
