"""Workspaces of ROS 2, built by colcon, and their nodes on a graph.

A node in C++ is built only as far as PyPI's wheels go: they have no rclcpp, and their files for
CMake name folders of the machine that they were made on.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from patience import PATIENCE_S
from pytpc.base.paths import project_root
from pytpc.build.build import BuildResult, build_workspace
from pytpc.build.nodes_env import nodes_env
from pytpc.cli.env_commands import static_file
from pytpc.ingest.reading import read
from pytpc.ros.node_start import with_python
from pytpc.workspace.colcon import BuildError, BuildOptions
from pytpc.workspace.ros2 import has_cmake_package
from ros2_graph import PYTHON, ros2_env
from ros2_workspace import make_ros2_workspace

# The node compares these with 6.5.
SPEEDS = [float(step) for step in range(10)]


def activate(monkeypatch: pytest.MonkeyPatch) -> None:
    """As in a terminal in which the environment with rclpy is active."""
    for name in ("AMENT_PREFIX_PATH", "ROS_VERSION", "ROS_DISTRO", "PYTHONPATH"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("VIRTUAL_ENV", str(PYTHON.parents[1]))


@pytest.fixture
def ros2_of_wheels(monkeypatch: pytest.MonkeyPatch) -> None:
    activate(monkeypatch)


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, BuildResult]]:
    workspace = make_ros2_workspace(tmp_path_factory.mktemp("ros2") / "ws")
    with pytest.MonkeyPatch.context() as patch:
        activate(patch)
        yield workspace, build_workspace(workspace)


def sources(workspace: Path) -> list[str]:
    return sorted(str(path) for path in (workspace / "src").rglob("*") if path.is_file())


def test_packages_in_python_are_installed(built: tuple[Path, BuildResult]) -> None:
    workspace, result = built
    prefix = workspace / ".tpc/install/guard"
    script = prefix / "lib/guard/speed_guard"
    assert script.read_text().startswith(f"#!{PYTHON}3\n")
    assert (prefix / "share/ament_index/resource_index/packages/guard").is_file()
    assert (prefix / "share/guard/launch/guard.launch.py").is_file()
    assert (prefix / "share/guard/config/guard.yaml").is_file()
    assert result.ros2 is not None
    assert result.ros2.words == f"{PYTHON}3, which has rclpy"
    assert [(unit.package, unit.link_unit) for unit in result.units] == [("guard", "speed_guard")]
    # Nothing was written beside the sources.
    assert [one for one in sources(workspace) if "egg-info" in one or ".pyc" in one] == []


def test_an_installed_node_reports_in_the_environment_of_the_build(
    built: tuple[Path, BuildResult], domain: dict[str, str], tmp_path: Path
) -> None:
    workspace, _ = built
    env = with_python(nodes_env(workspace, ros2_env(domain)), static_file(workspace))
    # As `ros2 run guard speed_guard` finds it.
    ask = "from ament_index_python import get_package_prefix as of; print(of('guard'))"
    found = subprocess.run(
        [PYTHON, "-c", ask], env=env, capture_output=True, text=True, timeout=PATIENCE_S, check=True
    )
    script = Path(found.stdout.strip()) / "lib/guard/speed_guard"
    assert script == workspace / ".tpc/install/guard/lib/guard/speed_guard"
    reports = {"TPC_SINK": "file", "TPC_FOLDER": str(tmp_path / "reports")}
    ran = subprocess.run(
        [script],
        env={**env, **reports},
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert (ran.returncode, ran.stderr) == (0, "")
    events = read(tmp_path / "reports").events
    assert events.cmp.tolist() == SPEEDS
    assert set(events.thresh.tolist()) == {6.5}
    assert events.result.tolist() == [False] * 7 + [True] * 3


def test_run_gives_an_installed_node_its_workspace(
    built: tuple[Path, BuildResult], domain: dict[str, str], tmp_path: Path
) -> None:
    workspace, _ = built
    node = workspace / ".tpc/install/guard/lib/guard/speed_guard"
    reports = {"TPC_SINK": "file", "TPC_FOLDER": str(tmp_path / "reports")}
    ran = subprocess.run(
        [sys.executable, "-m", "pytpc", "run", str(node)],
        cwd=project_root(),
        env=ros2_env(domain, **reports),
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert (ran.returncode, ran.stderr) == (0, "")
    assert read(tmp_path / "reports").events.cmp.tolist() == SPEEDS


@pytest.mark.usefixtures("ros2_of_wheels")
@pytest.mark.skipif(
    not has_cmake_package("ament_cmake_auto", [Path("/usr")]),
    reason="ament_cmake_auto is not installed (apt-get install ament-cmake)",
)
def test_a_build_says_which_package_of_ros_2_is_missing(tmp_path: Path) -> None:
    package = tmp_path / "ws/src/talker"
    package.mkdir(parents=True)
    (package / "package.xml").write_text(
        """<package format="3"><name>talker</name><version>0.1.0</version>
        <description>d</description><maintainer email="a@b.org">a</maintainer><license>x</license>
        <buildtool_depend>ament_cmake_auto</buildtool_depend><depend>no_such_package</depend>
        <export><build_type>ament_cmake</build_type></export></package>"""
    )
    (package / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.16)\nproject(talker)\n"
        "find_package(ament_cmake_auto REQUIRED)\nament_auto_find_build_dependencies()\n"
        "ament_auto_add_executable(talker talker.cpp)\nament_auto_package()\n"
    )
    (package / "talker.cpp").write_text("#include <no_such_package/node.hpp>\nint main() {}\n")
    with pytest.raises(BuildError, match="no_such_package of ROS 2 is not installed") as raised:
        build_workspace(tmp_path / "ws", BuildOptions(fallback=False))
    assert "rosdep's key no_such_package" in str(raised.value)
    # With nothing missing, the program is installed where `ros2 run` looks for it.
    (package / "talker.cpp").write_text("int main() {}\n")
    result = build_workspace(tmp_path / "ws", BuildOptions(fallback=False))
    prefix = result.bases.install / "talker"
    assert (prefix / "lib/talker/talker").is_file()
    assert (prefix / "share/ament_index/resource_index/packages/talker").is_file()
    assert [unit.link_unit for unit in result.units] == ["talker"]
