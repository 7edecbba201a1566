"""What the robot did, read from the topics of a bag."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from mission_samples import STORE, BagFile, line, ns

from pytpc.base.errors import InputError
from pytpc_evaluation.stats.states import robot_state

TYPES = STORE.types


def header(seconds: float):
    at = ns(seconds)
    stamp = TYPES["builtin_interfaces/msg/Time"](sec=at // 10**9, nanosec=at % 10**9)
    return TYPES["std_msgs/msg/Header"](seq=0, stamp=stamp, frame_id="map")


def pose(x: float, yaw: float):
    point = TYPES["geometry_msgs/msg/Point"](x=x, y=2 * x, z=1.0)
    turned = TYPES["geometry_msgs/msg/Quaternion"](
        x=0.0, y=0.0, z=math.sin(yaw / 2), w=math.cos(yaw / 2)
    )
    return TYPES["geometry_msgs/msg/Pose"](position=point, orientation=turned)


class RobotBag(BagFile):
    def stamped(self, seconds: float, topic: str, x: float, yaw: float = 0.0, stamp: float = 0.0):
        message = TYPES["geometry_msgs/msg/PoseStamped"](header=header(stamp), pose=pose(x, yaw))
        self._write(topic, "geometry_msgs/msg/PoseStamped", "/robot", ns(seconds), message)

    def number(self, seconds: float, topic: str, value: float):
        message = TYPES["std_msgs/msg/Float64"](data=value)
        self._write(topic, "std_msgs/msg/Float64", "/robot", ns(seconds), message)


@pytest.fixture
def bag(tmp_path) -> Path:
    path = tmp_path / "m.bag"
    with RobotBag(path) as writer:
        writer.log(10, "/node", line(0, 1, 2, 1))
        for second, yaw in ((11, 3.0), (12, -3.0)):
            writer.stamped(second, "/goal_pose", 99.0)
            writer.stamped(second, "/other", 50.0)
            writer.stamped(second, "/uav/pose", second, yaw, stamp=second - 0.5)
        for second, text in ((11, "search"), (12, "search"), (13, "track")):
            writer.text(second, "/mission/state", "/node", text)
        for second, value in ((12, math.nan), (13, 2.5)):
            writer.number(second, "/battery", value)
    return path


# The goal is another's pose; of the two others /uav/pose is called like a robot. Its time is its
# stamp, 10.5 and 11.5, from the begin at 10. The yaw goes on from 3 over pi: 2 pi - 3 = 3.2832.
def test_what_is_drawn_without_being_asked_for(bag):
    state = robot_state(bag, ns(10))
    assert [series.label for series in state.series] == ["x", "y", "z", "yaw"]
    x, y, z, yaw = state.series
    assert (x.times.tolist(), x.values.tolist()) == ([0.5, 1.5], [11.0, 12.0])
    assert (y.values.tolist(), z.values.tolist()) == ([22.0, 24.0], [1.0, 1.0])
    assert yaw.values == pytest.approx([3.0, 2 * math.pi - 3.0])
    (phases,) = state.phases
    assert (phases.label, phases.names) == ("/mission/state.data", ("search", "track"))
    assert phases.times.tolist() == [1.0, 3.0]


def test_fields_that_are_asked_for(bag):
    wanted = ["/battery.data", "other.pose.position.x", "/uav/pose.pose.orientation.w"]
    state = robot_state(bag, ns(10), [*wanted, "/mission/state.data"])
    battery, other, w = state.series
    assert (battery.label, other.label) == ("/battery.data", "/other.pose.position.x")
    assert battery.times.tolist() == [2.0, 3.0]
    assert math.isnan(battery.values[0])
    assert battery.values[1] == 2.5
    assert other.values.tolist() == [50.0, 50.0]
    assert w.values == pytest.approx([math.cos(1.5), math.cos(-1.5)])
    assert len(state.phases) == 1


@pytest.mark.parametrize(
    ("wanted", "said"),
    [
        ("/nothing.data", "no topic /nothing; there are /battery, /goal_pose, /mission/state"),
        ("/battery.volts", "/battery has no volts; there are data"),
        ("/battery.data.x", "/battery has no x; there is nothing below it"),
        ("/other.pose", "/other.pose is neither a number nor a text; there are position, orient"),
        ("/battery", "'/battery' is not TOPIC.FIELD"),
        ("/battery.", "'/battery.' is not TOPIC.FIELD"),
    ],
)
def test_fields_that_are_not_there(bag, wanted, said):
    with pytest.raises(InputError) as caught:
        robot_state(bag, 0, [wanted])
    assert said in str(caught.value)
    assert str(caught.value).startswith(str(bag))


def test_a_bag_without_anything_to_draw(tmp_path):
    path = tmp_path / "m.bag"
    with RobotBag(path) as writer:
        writer.log(10, "/node", line(0, 1, 2, 1))
        writer.stamped(10, "/goal", 1.0)
    state = robot_state(path, 0)
    assert (state.series, state.phases) == ((), ())


def test_a_broken_bag(bag):
    raw = bag.read_bytes()
    bag.write_bytes(raw[: len(raw) // 2])
    with pytest.raises(InputError, match="the robot's state cannot be read"):
        robot_state(bag, 0)
    with pytest.raises(InputError, match="the robot's state cannot be read"):
        robot_state(bag.with_name("none.bag"), 0)
