"""The flight controller of the image capture mission in rclcpp, where rclcpp is found."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from pytpc.base.paths import MERGED_FILE, project_root
from pytpc.build.build import build_workspace, workspace_env
from pytpc.static.static_info import StaticInfo
from pytpc.workspace.ros2 import find_ros2
from pytpc_evaluation.demo.demo_examples import link_packages
from pytpc_evaluation.demo.ros2_robot import Program, Ros2Robot

PACKAGE = project_root() / "examples" / "image_capture_controller"
NODE = "flight_controller"


def has_rclcpp() -> bool:
    """Whether the ROS 2 of the environment has rclcpp, with components and lifecycle nodes."""
    ros2 = find_ros2()
    needed = ("rclcpp", "rclcpp_components", "rclcpp_lifecycle")
    return ros2 is not None and all(ros2.has(package) for package in needed)


def with_controller(robot: Ros2Robot, out: Path) -> Ros2Robot:
    """The robot with the controller in C++ in place of that in Python.

    Args:
        robot: whose nodes are all in Python.
        out: the package is built in a workspace below it.

    Raises:
        TpcError: the package cannot be built.
    """
    workspace = out / "controller_ws"
    link_packages([PACKAGE], workspace)
    built = build_workspace(workspace)
    program = built.bases.install / PACKAGE.name / "lib" / PACKAGE.name / NODE
    env = workspace_env(built.bases.install, dict(os.environ))
    others = [unit for unit in robot.static.units if unit.link_unit != NODE]
    static = StaticInfo.of([*others, *built.units], left_out=robot.static.left_out)
    programs = {**robot.programs, NODE: Program((str(program),), env)}
    static.save(robot.folder / MERGED_FILE)
    return replace(robot, static=static, programs=programs)
