"""Two packages with a header in common, really built: one place, two keys, and what is stale."""

import json
import os
import shutil
from pathlib import Path

import pytest

from pytpc.base.errors import MissingToolError
from pytpc.base.paths import cmake_file, log_library, plugin, require_ros, require_tools
from pytpc.build.build import BuildResult, build_workspace
from pytpc.build.collect import collect_sources
from pytpc.conditions.cpp_conditions import libclang
from pytpc.conditions.lookup import look_up_conditions
from pytpc.static.places import Tpc

try:
    for half in (cmake_file, plugin, log_library, require_ros, require_tools):
        half()
except MissingToolError as error:
    pytest.skip(f"cannot build: {error}", allow_module_level=True)

HEADER = """#pragma once
#include <ros/ros.h>
#include <std_msgs/Float64.h>
namespace common {
class Gate {
public:
  explicit Gate(ros::NodeHandle &nh) : pub_(nh.advertise<std_msgs::Float64>("alarm", 1)) {
    nh.param("gate_limit", limit_, 2.5);
  }
  void check(double value, bool armed) {
    if (armed &&
        value > limit_)
      pub_.publish(std_msgs::Float64());
  }

private:
  ros::Publisher pub_;
  double limit_;
};
} // namespace common
"""
NODE = """#include <common/gate.h>
int main(int argc, char **argv) {
  ros::init(argc, argv, "node");
  ros::NodeHandle nh;
  common::Gate gate(nh);
  for (int i = 0; ros::ok(); ++i) {
    gate.check(i, argc > 1);
    ros::spinOnce();
  }
}
"""
LINE, COLUMN = 12, 15


def package(folder: Path, needs: str, more: str) -> None:
    """A catkin package of one node that is called after it."""
    name = folder.name
    (folder / "src").mkdir(parents=True)
    (folder / "src/node.cpp").write_text(NODE, encoding="utf-8")
    depends = "".join(f"<depend>{need}</depend>" for need in needs.split())
    (folder / "package.xml").write_text(
        f'<package format="2"><name>{name}</name><version>1.0.0</version>'
        '<description>d</description><maintainer email="a@b.org">m</maintainer>'
        "<license>none</license>"
        f"<buildtool_depend>catkin</buildtool_depend>{depends}</package>\n",
        encoding="utf-8",
    )
    (folder / "CMakeLists.txt").write_text(
        f"cmake_minimum_required(VERSION 3.10)\nproject({name})\n"
        f"find_package(catkin REQUIRED COMPONENTS {needs})\n{more}"
        "include_directories(${catkin_INCLUDE_DIRS})\n"
        f"add_executable({name}_node src/node.cpp)\n"
        f"target_link_libraries({name}_node ${{catkin_LIBRARIES}})\n",
        encoding="utf-8",
    )


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> BuildResult:
    workspace = tmp_path_factory.mktemp("shared header")
    common = workspace / "src/common"
    package(
        common,
        "roscpp std_msgs",
        "catkin_package(INCLUDE_DIRS include)\ninclude_directories(include)\n"
        "install(DIRECTORY include/common/ DESTINATION ${CATKIN_PACKAGE_INCLUDE_DESTINATION})\n",
    )
    (common / "include/common").mkdir(parents=True)
    (common / "include/common/gate.h").write_text(HEADER, encoding="utf-8")
    package(workspace / "src/arm", "roscpp std_msgs common", "catkin_package()\n")
    return build_workspace(workspace)


def gate_of(tpcs: tuple[Tpc, ...]) -> Tpc:
    (tpc,) = (tpc for tpc in tpcs if tpc.parameter == "gate_limit")
    return tpc


def workspace_of(built: BuildResult) -> Path:
    return built.bases.root.parent


def test_a_header_of_two_packages_is_one_place(built: BuildResult) -> None:
    header = workspace_of(built) / "src/common/include/common/gate.h"
    installed = workspace_of(built) / ".tpc/install/common/include/common/gate.h"
    # The other package has compiled the copy that was installed.
    assert dict(built.static.copies) == {str(installed): str(header)}
    tpc = gate_of(built.static.tpcs)
    assert (tpc.file, tpc.package, tpc.place) == (
        str(header), "common", "include/common/gate.h",
    )  # fmt: skip
    assert (tpc.lineno, tpc.column) == (LINE, COLUMN)
    assert tpc.link_units == ("arm/arm_node", "common/common_node")
    assert len({each.key for each in tpc.keys}) == 2


def test_collect_says_the_same_as_the_build(built: BuildResult) -> None:
    collected = collect_sources([workspace_of(built)])
    assert collected.dropped == ()
    assert collected.static == built.static
    assert json.loads(built.bases.static_info.read_bytes()) == built.static.to_json()


@pytest.mark.skipif(not libclang(), reason="libclang 19 is not installed")
def test_the_condition_is_read_as_it_was_compiled(built: BuildResult, tmp_path: Path) -> None:
    tpc = gate_of(built.static.tpcs)
    (answer,) = look_up_conditions(built.static, [tpc], cache=tmp_path).values()
    assert answer.condition is not None
    assert answer.condition.text == "armed &&\n        value > limit_"
    # The flags of the build were found.
    assert answer.note == ""


def test_what_was_linked_without_tpc_is_stale(built: BuildResult, tmp_path: Path) -> None:
    base = tmp_path / "build"
    shutil.copytree(built.bases.build, base, symlinks=True)
    (program,) = (
        path for path in base.rglob("arm_node") if path.is_file() and os.access(path, os.X_OK)
    )
    program.unlink()
    shutil.copy("/bin/true", program)
    collected = collect_sources([base])
    assert [(each.file.unit.link_unit, each.reason) for each in collected.dropped] == [
        ("arm_node", "it was linked again without TPC")
    ]
    assert gate_of(collected.static.tpcs).link_units == ("common/common_node",)


def test_what_has_no_target_any_more_is_stale(built: BuildResult, tmp_path: Path) -> None:
    base = tmp_path / "build"
    shutil.copytree(built.bases.build, base, symlinks=True)
    unit = base / "arm/tpc/arm_node.json"
    data = json.loads(unit.read_bytes())
    # Of a target of before, as a rebuild of one package by hand leaves it.
    text = json.dumps({**data, "link_unit": "old_node"}).replace(
        data["comparisons"][0]["key"], "6f1c0f4e-7a1b-5c3d-8e2f-000000000001"
    )
    (base / "arm/tpc/old_node.json").write_text(text, encoding="utf-8")
    collected = collect_sources([base])
    assert [(each.file.unit.link_unit, each.reason) for each in collected.dropped] == [
        ("old_node", "its target no longer exists")
    ]
