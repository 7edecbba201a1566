"""The states of the ground robot's mission, without a graph."""

from __future__ import annotations

import importlib.util
from importlib.util import find_spec
from types import ModuleType, SimpleNamespace

import pytest

from pytpc_evaluation.demo.demo_examples import NAVIGATION

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
def module_of(monkeypatch):
    """A module of the mission by its name."""

    def load(name: str) -> ModuleType:
        path = NAVIGATION.folder / "src" / "navigation" / f"{name}.py"
        spec = importlib.util.spec_from_file_location(f"navigation_{name}", path)
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        # There is no master.
        monkeypatch.setattr(module.rospy, "get_param", lambda name, default: default)
        return module

    return load


def test_lamp_and_horn_are_off_at_the_end_though_the_time_is_up_while_they_are_on(module_of):
    states, mission = module_of("states"), Recorded()
    states.Signal(mission).enter(now=None)
    assert mission.asked == [("lamp", True)]
    states.Done(mission).enter(now=None)
    assert dict(mission.asked[1:]) == {"stand": None, "lamp": False, "horn": False, "finish": None}
    # Who waits for the end finds it dark.
    assert mission.asked[-1] == ("finish", None)


def test_a_way_that_was_given_up_is_not_the_next_one(module_of):
    watch = module_of("drive_watch").DriveWatch()
    given_up = SimpleNamespace(goal_id=1, given_up=True)
    watch.update_recovery(given_up)
    assert watch.given_up(1)
    watch.forget(now=None)
    # It was sent before the recovery heard of goal 2.
    watch.update_recovery(given_up)
    assert not watch.given_up(2)
