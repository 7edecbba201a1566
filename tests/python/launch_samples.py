"""A workspace with launch and YAML files for the tests of origins and apply."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

needs_roslaunch = pytest.mark.skipif(
    shutil.which("roslaunch") is None, reason="roslaunch is not installed"
)

# Line numbers are counted from 1 in each text.
MAIN = """<launch>
  <arg name="rate" default="4.0"/>
  <arg name="speed" default="1.5"/>
  <arg name="extra" default="$(find robot)/config/extra.yaml"/>
  <param name="/use_sim_time" value="true"/>
  <param name="~shared" value="7"/>
  <rosparam command="load" file="$(find robot)/config/params.yaml"/>
  <rosparam file="$(arg extra)"/>
  <group ns="left">
    <param name="gain" value="$(arg rate)" type="double"/>
    <node pkg="robot" type="arm" name="arm">
      <param name="speed" value="$(arg speed)"/>
      <param name="limit"
             value="0.25"/>
      <rosparam>
        torque: 3.5
        joints: {elbow: 1.0, wrist: 2.0}
      </rosparam>
    </node>
  </group>
  <include file="$(find robot)/launch/inner.launch" ns="right">
    <arg name="depth" value="$(arg speed)"/>
  </include>
  <param name="computed" value="$(eval 2 * 3)"/>
  <param name="text" command="false"/>
  <rosparam param="alone">5</rosparam>
  <param name="again" value="1"/>
  <param name="again" value="2"/>
  <node pkg="robot" type="leg" name="leg" args="-v _step:=0.5 _fast:=true"/>
  <param name="leg/step" value="0.4"/>
</launch>
"""
INNER = """<launch>
  <arg name="depth"/>
  <arg name="width" default="9"/>
  <param name="depth" value="$(arg depth)"/>
  <param name="width" value="$(arg width)"/>
</launch>
"""
PARAMS = """# the robot
mission:
  limit: 0.035   # a share
  angle: deg(90)
  names: [a, b]
arm: &arm {mass: 2, size: 3}
other:
  <<: *arm
  size: 4
top: yes
"""
EXTRA = """mission:
  limit: 0.058
"""
MANIFEST = "<package><name>robot</name></package>\n"

MISSION_PARAMS = "# mine\nmission:\n  limit: 0.058  # too high\n  other: 3\n"


def make_package(folder: Path) -> Path:
    """The package ``robot`` below ``folder``; returns its main launch file."""
    package = folder / "robot"
    for name, text in (
        ("package.xml", MANIFEST),
        ("launch/main.launch", MAIN),
        ("launch/inner.launch", INNER),
        ("config/params.yaml", PARAMS),
        ("config/extra.yaml", EXTRA),
    ):
        path = package / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return package / "launch" / "main.launch"


def environment(folder: Path) -> dict[str, str]:
    """An environment in which roslaunch finds the package."""
    path = os.environ.get("PATH", "")
    return {"PATH": f"/usr/bin:/bin:{path}", "HOME": str(folder), "ROS_PACKAGE_PATH": str(folder)}
