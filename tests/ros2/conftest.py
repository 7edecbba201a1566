"""What the tests on a real ROS 2 graph share: a domain of their own."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from pytpc_evaluation.demo.ros2_robot import own_domain
from ros2_graph import ros2_env


@pytest.fixture(scope="session")
def domain() -> Iterator[dict[str, str]]:
    """The environment of a graph that no other test or user of this machine is on."""
    with own_domain() as variables:
        yield variables


@pytest.fixture
def env(domain: dict[str, str], tmp_path: Path) -> dict[str, str]:
    """The environment of a user on that graph, with a home and a runtime folder of its own."""
    runtime = tmp_path / "run"
    runtime.mkdir(mode=0o700)
    return ros2_env(domain, XDG_RUNTIME_DIR=str(runtime), HOME=str(tmp_path))
