"""Python nodes of real workspaces report by the environment: ``record``, and ``env`` in a shell.

catkin leaves a script in two layouts: a relay to the source in the devel space, and a copy with
another first line in the install space. In both the node imports a module of its package.
"""

from __future__ import annotations

import shlex
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
from click.testing import CliRunner
from started_by_hand import roslaunch

from pytpc.base.errors import MissingToolError
from pytpc.base.paths import SYSTEM_PATH, cmake_file, log_library, plugin, require_ros
from pytpc.cli.main import main
from pytpc.ingest.reading import read
from pytpc.static.static_info import StaticInfo

LAUNCH = "src/talk/launch/talk.launch"
PATIENCE_S = 120
COUNT = 70

try:
    require_ros()
except MissingToolError as error:
    pytest.skip(str(error), allow_module_level=True)

FILES = {
    "package.xml": """<package format="2">
  <name>talk</name><version>0.1.0</version><description>d</description>
  <maintainer email="a@b.org">a</maintainer><license>x</license>
  <buildtool_depend>catkin</buildtool_depend><depend>rospy</depend><depend>std_msgs</depend>
</package>
""",
    "CMakeLists.txt": """cmake_minimum_required(VERSION 3.10)
project(talk)
find_package(catkin REQUIRED)
catkin_python_setup()
catkin_package()
catkin_install_python(PROGRAMS nodes/talker.py DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
install(DIRECTORY launch DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION})
""",
    "setup.py": """from setuptools import setup
from catkin_pkg.python_setup import generate_distutils_setup
setup(**generate_distutils_setup(packages=["talk"], package_dir={"": "src"}))
""",
    "src/talk/__init__.py": "",
    "src/talk/limits.py": """def is_high(x, limit):
    return x > limit
""",
    # Of the numbers 0 to 6, ten times each, those above 3 go out: each has a comparison in the
    # module, and one here.
    "nodes/talker.py": f"""#!/usr/bin/env python3
import rospy
from std_msgs.msg import Bool, Float64
from talk.limits import is_high

if __name__ == "__main__":
    rospy.init_node("talker")
    limit = rospy.get_param("~limit", 2.0)
    lowest = rospy.get_param("~lowest", 1.0)
    out = rospy.Publisher("out", Float64, queue_size=10)
    done = rospy.Publisher("/mission/done", Bool, queue_size=1, latch=True)
    for number in range({COUNT}):
        x = float(number % 7)
        if is_high(x, limit):
            out.publish(x)
        if x < lowest:
            out.publish(-x)
    done.publish(True)
    if rospy.get_param("~stay"):
        rospy.spin()
""",
    "launch/talk.launch": """<launch>
  <arg name="stay" default="false"/>
  <node pkg="talk" type="talker.py" name="talker" required="true" output="screen">
    <param name="stay" value="$(arg stay)"/>
    <param name="limit" value="3.0"/>
  </node>
</launch>
""",
}


def write_workspace(folder: Path) -> Path:
    for name, text in FILES.items():
        path = folder / "src/talk" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    (folder / "src/talk/nodes/talker.py").chmod(0o755)
    return folder


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace that ``pytpc build`` built."""
    try:
        for half in (cmake_file, plugin, log_library):
            half()
    except MissingToolError as error:
        pytest.skip(f"the C++ half is not installed: {error}")
    workspace = write_workspace(tmp_path_factory.mktemp("built"))
    done = CliRunner().invoke(main, ["build", str(workspace)])
    assert done.exit_code == 0, done.output
    return workspace


@pytest.fixture(scope="module")
def devel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace that catkin_make built without anything of TPC, and its static information."""
    workspace = write_workspace(tmp_path_factory.mktemp("devel"))
    ran = subprocess.run(
        ["catkin_make"],
        cwd=workspace,
        env={"PATH": SYSTEM_PATH, "HOME": str(workspace)},
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )
    assert ran.returncode == 0, ran.stderr
    static = str(workspace / ".tpc/static.json")
    collected = CliRunner().invoke(main, ["collect", str(workspace), "-o", static])
    assert collected.exit_code == 0, collected.output
    return workspace


def check(reports: Path, static: Path) -> None:
    """Both comparisons were made of each number, and reported with their values."""
    found = read(sorted(reports.glob("*.tpc")))
    known = StaticInfo.load(static)
    events = found.events
    made = Counter(
        (known.comparisons[events.keys[code]].source, thresh, bool(result))
        for code, thresh, result in zip(events.key, events.thresh, events.result, strict=True)
    )
    # 4, 5 and 6 are above 3, ten times each; 0 is below 1.
    assert made == {
        ("~limit", 3.0, True): 30,
        ("~limit", 3.0, False): 40,
        ("~lowest", 1.0, True): 10,
        ("~lowest", 1.0, False): 60,
    }
    assert events.nodes == ("/talker",)
    assert (found.malformed, found.notes) == (0, ())


@pytest.mark.parametrize("name", ["built", "devel"])
def test_record_has_the_reports_of_python_nodes(name, request, tmp_path):
    workspace: Path = request.getfixturevalue(name)
    out = tmp_path / "out"
    command = ["record", str(workspace), str(workspace / LAUNCH), "stay:=true", "-o", str(out)]
    options = ["--until", "/mission/done", "--wall-time", "--timeout", str(PATIENCE_S)]
    env = {"TPC_SINK": "file", "TPC_FILE_RESERVE": "0"}
    done = CliRunner().invoke(main, [*command, *options], env=env)
    assert done.exit_code == 0, done.output
    assert "(done)" in done.output
    check(out / "tpc", workspace / ".tpc/static.json")


def pytpc_env(*words: str | Path) -> str:
    command = shlex.join([sys.executable, "-m", "pytpc", "env", *map(str, words)])
    return f'eval "$({command})"'


def test_env_and_roslaunch_in_a_devel_space(devel, tmp_path):
    words = f"source {shlex.quote(str(devel / 'devel/setup.bash'))}; {pytpc_env(devel)}"
    said = roslaunch(tmp_path, words, shlex.quote(str(devel / LAUNCH)))
    assert "tpc:" not in said
    check(tmp_path / "tpc", devel / ".tpc/static.json")


def test_env_with_setup_in_an_install_space(built, tmp_path):
    said = roslaunch(tmp_path, pytpc_env(built, "--setup"), shlex.quote(str(built / LAUNCH)))
    assert "tpc:" not in said
    check(tmp_path / "tpc", built / ".tpc/static.json")
