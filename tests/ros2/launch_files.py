"""Launch files of ROS 2 and a params file, with the line of each value in a comment."""

from __future__ import annotations

from pathlib import Path

PARAMS = """\
/**:
  ros__parameters:
    rate: 10
    speed_limit: 4.0
robot1:
  guard:
    ros__parameters:
      limits: {min: 0.058}
"""
PYTHON = """\
import os
from launch import LaunchDescription
from launch.actions import (DeclareLaunchArgument, ExecuteProcess, GroupAction,
                            IncludeLaunchDescription, TimerAction)
from launch.launch_description_sources import AnyLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import (ComposableNodeContainer, LifecycleNode, Node, PushRosNamespace,
                                SetParameter)
from launch_ros.descriptions import ComposableNode

HERE = os.path.dirname(__file__)
PARAMS = os.path.join(HERE, "params.yaml")


def generate_launch_description():
    common = {"word": "fast", "nested": {"a": 1, "b": 2.5}}
    return LaunchDescription([
        DeclareLaunchArgument("limit",
                              default_value="4.5"),
        SetParameter(name="shared", value=7),
        PushRosNamespace("robot1"),
        Node(package="p", executable="guard", name="guard",
             parameters=[
                 PARAMS,
                 {"speed_limit": LaunchConfiguration("limit"),
                  "gain": 0.25},
                 common,
             ]),
        Node(package="p", executable="nameless", parameters=[{"x": 1}]),
        TimerAction(period=3.0, actions=[
            LifecycleNode(package="p", executable="life", name="life", namespace="deep",
                          parameters=[{"y": [1.0, 2.0]}])]),
        GroupAction([
            IncludeLaunchDescription(
                AnyLaunchDescriptionSource(os.path.join(HERE, "inner.launch.xml")),
                launch_arguments={"rate": "9"}.items())]),
        ComposableNodeContainer(
            name="box", namespace="", package="rclcpp_components", executable="container",
            composable_node_descriptions=[
                ComposableNode(package="p", plugin="p::Cam", name="cam",
                               parameters=[{"fps": 30}, PARAMS])]),
        ExecuteProcess(cmd=["false", "--ros-args", "-r", "__node:=raw", "--params-file", PARAMS,
                            "-p", "k:=1e3"]),
    ])
"""
XML = """\
<launch>
  <arg name="rate" default="8"/>
  <push_ros_namespace namespace="arm"/>
  <node pkg="p" exec="inner" name="inner">
    <param name="rate" value="$(var rate)"/>
    <param name="limits">
      <param name="min" value="0.5"/>
    </param>
    <param from="$(dirname)/params.yaml"/>
  </node>
</launch>
"""
YAML = """\
launch:
- arg:
    name: limit
    default: "4.5"
- set_parameter:
    name: shared
    value: "7"
- node:
    pkg: p
    exec: guard
    name: guard
    namespace: robot1
    param:
    - name: speed_limit
      value: $(var limit)
    - name: gain
      value: 0.25
    - name: deep
      param:
      - name: er
        value: 3.0
    - from: $(dirname)/params.yaml
"""


def write_launch_files(folder: Path) -> None:
    """Write robot.launch.py, inner.launch.xml, yaml.launch.yaml and params.yaml."""
    for name, text in (
        ("robot.launch.py", PYTHON),
        ("inner.launch.xml", XML),
        ("yaml.launch.yaml", YAML),
        ("params.yaml", PARAMS),
    ):
        (folder / name).write_text(text)
