"""The checks of packages for ROS 2: manifests as data, on machines with one ROS, or both."""

from pathlib import Path

import pytest

from pytpc.workspace.doctor.finding import Finding
from pytpc.workspace.doctor.machine import Machine, check_machine
from pytpc.workspace.doctor.ros2 import KnownRos2, check_ros2, look_at_ros2
from pytpc.workspace.packages import Manifest
from pytpc.workspace.ros2 import SYSTEM_PYTHON, Ros2

WS = Path("/ws")
KILTED = Ros2((Path("/opt/ros/kilted"),), SYSTEM_PYTHON)
SOURCED = KnownRos2(KILTED, frozenset({"rclpy", "std_msgs"}), has_ament_cmake=True)
NODE = Manifest("guard", "ament_python", (), ("rclpy", "std_msgs"))
SOURCE = "source /opt/ros/DISTRO/setup.bash"


def check(*manifests: Manifest, known: KnownRos2, debian: tuple[str, ...] = ()) -> list[Finding]:
    return check_ros2(WS, manifests, known, debian, ())


def shown(finding: Finding) -> tuple[str, str, str | None]:
    return finding.severity.value, finding.what, finding.mend


def test_a_workspace_without_packages_of_ros_2_has_no_findings() -> None:
    assert check(Manifest("arm", "catkin", ("roscpp",), ()), known=KnownRos2()) == []


def test_which_ros_a_workspace_is_for_and_which_python() -> None:
    (found,) = check(NODE, known=SOURCED)
    assert shown(found) == (
        "note",
        "guard: for ROS 2; nodes of ROS 2 in Python run under /usr/bin/python3, of the ROS 2 in"
        " AMENT_PREFIX_PATH",
        None,
    )
    (found,) = check(NODE, Manifest("arm", "catkin", ("roscpp",), ()), known=SOURCED)
    assert found.what.startswith("guard: for ROS 2; arm: for ROS 1, and built apart from those; ")


def test_packages_of_the_same_name_of_ros_1_do_not_count() -> None:
    known = KnownRos2(None, frozenset(), frozenset({"std_msgs"}))
    which, rclpy, std_msgs = check(NODE, known=known)
    assert shown(which)[::2] == ("warning", SOURCE)
    assert "which has no rclpy" in which.what
    assert shown(rclpy) == (
        "warning",
        "rclpy is neither in the workspace nor in a ROS 2 that was sourced, needed to run guard;"
        " rosdep's key is rclpy",
        f"{SOURCE} && rosdep install --ignore-src --from-paths /ws",
    )
    assert shown(std_msgs) == (
        "warning",
        "std_msgs is here for ROS 1 only, needed to run guard, which is for ROS 2",
        SOURCE,
    )


def test_what_a_build_needs_is_an_error_where_apt_has_it() -> None:
    compiled = Manifest("talker", "ament_cmake", ("rclcpp",), ())
    known = KnownRos2(KILTED, frozenset(), has_ament_cmake=True, distribution="kilted")
    _, found = check(compiled, known=known, debian=("ros-kilted-rclcpp",))
    assert shown(found) == (
        "error",
        "rclcpp is not installed, needed to build talker",
        "apt-get install ros-kilted-rclcpp",
    )


def test_without_ament_cmake_nothing_of_it_is_built() -> None:
    found, _ = check(Manifest("talker", "ament_cmake", ("rclcpp",), ()), known=KnownRos2())
    assert shown(found) == ("error", "talker: for ROS 2; ament_cmake was not found", SOURCE)


def test_packages_are_told_apart_by_the_index_of_ament(tmp_path: Path) -> None:
    manifests = {
        "std_msgs": "<package><buildtool_depend>catkin</buildtool_depend></package>",
        "rclpy": "<package/>",
        "maths": "<package/>",
    }
    for name, text in manifests.items():
        (tmp_path / "share" / name).mkdir(parents=True)
        (tmp_path / "share" / name / "package.xml").write_text(text)
    index = tmp_path / "share/ament_index/resource_index/packages"
    index.mkdir(parents=True)
    (index / "rclpy").touch()
    known = look_at_ros2({"AMENT_PREFIX_PATH": str(tmp_path), "PATH": ""})
    assert {"rclpy", "maths"} <= known.packages
    assert "std_msgs" not in known.packages
    assert "std_msgs" in known.of_ros1


@pytest.mark.parametrize(("for_ros1", "number"), [(True, 1), (False, 0)])
def test_ros_1_is_not_missed_where_only_ros_2_is_built(for_ros1: bool, number: int) -> None:
    found = check_machine(Machine(), for_ros1=for_ros1)
    assert sum("of ROS 1 not found" in one.what for one in found) == number
