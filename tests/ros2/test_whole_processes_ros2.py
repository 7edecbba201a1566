"""`pytpc build` and `pytpc processes` on a container of components, on real rclcpp.

PyPI has no wheel of rclcpp. These tests run where a ROS 2 with it was sourced, or is in
``/opt/ros``.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from pytpc.api.building import WholeBuild, build, processes
from pytpc.base.paths import project_root
from pytpc.processes.process import Process
from pytpc.workspace.ros2 import AMENT
from ros2_rclcpp import ROS, needs_rclcpp

COMPOSED = project_root() / "tests/workspaces/composed"
pytestmark = needs_rclcpp


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, WholeBuild]]:
    """The workspace, and what was built in the environment of a ROS 2 that is sourced."""
    workspace = tmp_path_factory.mktemp("composed") / "ws"
    shutil.copytree(COMPOSED, workspace)
    with pytest.MonkeyPatch.context() as patch:
        for name in ("ROS_VERSION", "ROS_DISTRO", "PYTHONPATH", "VIRTUAL_ENV"):
            patch.delenv(name, raising=False)
        patch.setenv("PATH", f"{ROS}/bin:{os.defpath}")
        patch.setenv("LD_LIBRARY_PATH", f"{ROS}/lib")
        for name in (AMENT, "CMAKE_PREFIX_PATH", "COLCON_PREFIX_PATH"):
            patch.setenv(name, str(ROS))
        yield workspace, build(workspace)


def kinds(process: Process) -> list[str]:
    return [plugin.kind for plugin in process.plugins]


# The marked line of limit.cpp compares for both components; the container loads the camera alone.
def test_a_parameter_of_the_loaded_component_is_found_across_the_libraries(built):
    _, whole = built
    assert whole.failure is None
    assert [(one.process.name, one.failure) for one in whole.analysed] == [
        ("composed_container/container", None)
    ]
    static = whole.build.static
    assert [
        (Path(one.file).name, one.lineno, one.source, one.processes)
        for one in static.comparisons.values()
    ] == [("limit.cpp", 6, "min_light", ("composed_container/container",))]


def test_a_container_may_load_all_components_unless_a_file_says_which(built):
    workspace, _ = built
    units = ["container", "composed_nodes", "composed_limits"]
    (process,) = processes(workspace).found
    assert [unit.name for unit in process.units] == units
    assert kinds(process) == ["composed::Camera"]
    corrected = workspace / "tpc-processes.yaml"
    text = corrected.read_text()
    corrected.unlink()
    try:
        (process,) = processes(workspace).found
    finally:
        corrected.write_text(text)
    assert [unit.name for unit in process.units] == units
    assert kinds(process) == ["composed::Camera", "composed::Lamp"]
