"""The states of the ground robot's mission, without a graph."""

from __future__ import annotations

import importlib.util
from importlib.util import find_spec

import pytest

from pytpc.demo_examples import NAVIGATION

if find_spec("rospy") is None:
    pytest.skip("ROS is not installed", allow_module_level=True)


class Recorded:
    """A mission, and what its states ask of it, in order."""

    def __init__(self) -> None:
        self.pilot = self
        self.asked: list[tuple[str, object]] = []

    def stand(self) -> None:
        self.asked.append(("stand", None))

    def light(self, on: bool) -> None:
        self.asked.append(("lamp", on))

    def sound(self, on: bool) -> None:
        self.asked.append(("horn", on))

    def finish(self) -> None:
        self.asked.append(("finish", None))


@pytest.fixture
def states(monkeypatch):
    path = NAVIGATION.folder / "src" / "navigation" / "states.py"
    spec = importlib.util.spec_from_file_location("navigation_states", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    # There is no master.
    monkeypatch.setattr(module.rospy, "get_param", lambda name, default: default)
    return module


def test_lamp_and_horn_are_off_at_the_end_though_the_time_is_up_while_they_are_on(states):
    mission = Recorded()
    states.Signal(mission).enter(now=None)
    assert mission.asked == [("lamp", True)]
    states.Done(mission).enter(now=None)
    assert dict(mission.asked[1:]) == {"stand": None, "lamp": False, "horn": False, "finish": None}
    # Who waits for the end finds it dark.
    assert mission.asked[-1] == ("finish", None)
