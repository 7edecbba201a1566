"""What the tests on a real ROS 2 graph share: a domain of their own."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from pytpc_evaluation.demo.ros2_robot import own_domain


@pytest.fixture(scope="session")
def domain() -> Iterator[dict[str, str]]:
    """The environment of a graph that no other test or user of this machine is on."""
    with own_domain() as variables:
        yield variables
