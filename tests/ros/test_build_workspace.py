"""Real builds: colcon, clang and the passes on a small catkin package."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from pytpc.base.errors import MissingToolError, WorkspaceError
from pytpc.base.paths import cmake_file, log_library, plugin
from pytpc.build.build import build_workspace, workspace_env
from pytpc.static.static_info import collect
from pytpc.workspace import patch
from pytpc.workspace.colcon import BuildError, BuildOptions, build_environment

try:
    for half in (cmake_file, plugin, log_library):
        half()
except MissingToolError as error:
    pytest.skip(f"the C++ half is not installed: {error}", allow_module_level=True)

MANIFEST = """<package format="2">
  <name>tiny</name><version>0.1.0</version><description>d</description>
  <maintainer email="a@b.org">a</maintainer><license>x</license>
  <buildtool_depend>catkin</buildtool_depend><depend>roscpp</depend><depend>std_msgs</depend>
</package>
"""
CMAKELISTS = """cmake_minimum_required(VERSION 3.10)
project(tiny)
find_package(catkin REQUIRED COMPONENTS roscpp std_msgs)
catkin_package()
include_directories(${catkin_INCLUDE_DIRS})
add_executable(tiny_node src/node.cpp)
target_link_libraries(tiny_node ${catkin_LIBRARIES})
install(TARGETS tiny_node RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
"""
# One comparison: line 10, value > limit, with a publish on line 13 that hangs on it.
NODE = """#include <ros/ros.h>
#include <std_msgs/Float64.h>
class Node {
public:
  Node() {
    nh_.param("limit", limit_, 0.5);
    pub_ = nh_.advertise<std_msgs::Float64>("out", 1);
  }
  void step(double value) {
    if (value > limit_) {
      std_msgs::Float64 message;
      message.data = value;
      pub_.publish(message);
    }
  }
private:
  ros::NodeHandle nh_;
  ros::Publisher pub_;
  double limit_;
};
int main(int argc, char **argv) {
  ros::init(argc, argv, "tiny");
  Node node;
  for (int i = 0; i < 9; ++i)
    node.step(i * 0.125);
}
"""


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A workspace that was built once; the tests below look at it and build it again."""
    workspace = tmp_path_factory.mktemp("built") / "a workspace"
    make_package(workspace)
    build_workspace(workspace)
    return workspace


def make_package(workspace: Path) -> Path:
    package = workspace / "src" / "tiny"
    (package / "src").mkdir(parents=True)
    (package / "package.xml").write_text(MANIFEST, encoding="utf-8")
    (package / "CMakeLists.txt").write_text(CMAKELISTS, encoding="utf-8")
    (package / "src" / "node.cpp").write_text(NODE, encoding="utf-8")
    return package


def test_the_comparison_is_found(built: Path) -> None:
    (unit,) = collect(built / ".tpc/build").units
    assert (unit.package, unit.link_unit, unit.status) == ("tiny", "tiny_node", "ok")
    (found,) = (one for one in unit.comparisons if one.type != "constant")
    assert (found.source, found.relation, found.default) == ("limit", ">", 0.5)
    assert (found.file, found.lineno, found.distance) == ("src/node.cpp", 10, 1)
    assert (found.read_at.lineno, found.exposed_at.lineno) == (6, 13)
    assert found.source_code == "if (value > limit_) {"


def test_nothing_but_our_own_folder_is_new(built: Path) -> None:
    assert sorted(path.name for path in built.iterdir()) == [".tpc", "src"]
    files = sorted(str(path.relative_to(built)) for path in (built / "src").rglob("*.*"))
    assert files == [
        "src/tiny/CMakeLists.txt",
        "src/tiny/package.xml",
        "src/tiny/src/node.cpp",
    ]


def test_the_node_is_found_in_the_workspaces_environment(built: Path) -> None:
    environment = workspace_env(built / ".tpc/install")
    found = subprocess.run(
        ["rospack", "find", "tiny"], env=environment, capture_output=True, text=True, check=True
    )
    assert found.stdout.strip() == str(built / ".tpc/install/tiny/share/tiny")
    node = built / ".tpc/install/tiny/lib/tiny/tiny_node"
    needed = subprocess.run(
        ["ldd", node], env=environment, capture_output=True, text=True, check=True
    )
    assert "not found" not in needed.stdout
    assert "libtpc_log.so" in needed.stdout


def test_a_second_build_finds_the_same_and_removes_what_is_gone(built: Path) -> None:
    first = (built / ".tpc/static.json").read_bytes()
    text = (built / "src/tiny/CMakeLists.txt").read_text(encoding="utf-8")
    stale = built / ".tpc/build/tiny/tpc/renamed_node.json"
    shutil.copy(built / ".tpc/build/tiny/tpc/tiny_node.json", stale)
    manifest = stale.with_name("renamed_node.link.json")
    shutil.copy(stale.with_name("tiny_node.link.json"), manifest)
    result = build_workspace(built)
    assert (built / ".tpc/static.json").read_bytes() == first
    assert result.static.left_out == ()
    assert not stale.exists()
    assert not manifest.exists()
    assert (built / "src/tiny/CMakeLists.txt").read_text(encoding="utf-8") == text


def test_two_packages_whose_projects_are_called_alike_are_two(tmp_path: Path) -> None:
    """Catkin wants a project to be called as its package is; plain CMake does not."""
    plain = "<export><build_type>cmake</build_type></export></package>"
    for name in ("left", "right"):
        package = make_package(tmp_path / name)
        manifest = MANIFEST.replace("<name>tiny", f"<!-- once <name>old</name> --><name>{name}")
        (package / "package.xml").write_text(
            manifest.replace("</package>", plain), encoding="utf-8"
        )
        lists = CMAKELISTS.replace("catkin_package()\n", "").replace(
            "${CATKIN_PACKAGE_BIN_DESTINATION}", "lib/tiny"
        )
        (package / "CMakeLists.txt").write_text(lists, encoding="utf-8")
    static = build_workspace(tmp_path).static
    assert [(unit.package, unit.link_unit) for unit in static.units] == [
        ("left", "tiny_node"), ("right", "tiny_node"),
    ]  # fmt: skip
    assert len(static.thresholds) == 2


def test_a_unit_without_analysis_is_noticed(tmp_path: Path) -> None:
    package = make_package(tmp_path)
    # A compile rule of the package's own, which TPC's flags are not in.
    native = (
        'set(CMAKE_C_COMPILE_OBJECT "<CMAKE_C_COMPILER> -o <OBJECT> -c <SOURCE>")\n'
        "add_executable(native src/native.c)\n"
    )
    (package / "CMakeLists.txt").write_text(CMAKELISTS + native, encoding="utf-8")
    (package / "src/native.c").write_text("int main(void) { return 0; }\n", encoding="utf-8")
    result = build_workspace(tmp_path)
    assert [unit.link_unit for unit in result.units] == ["tiny_node"]
    assert [(unit.package, unit.link_unit) for unit in result.static.left_out] == [
        ("tiny", "native")
    ]


def test_the_findings_follow_a_changed_file(tmp_path: Path) -> None:
    package = make_package(tmp_path)
    build_workspace(tmp_path)
    changed = NODE.replace("  void step", "  // one line more\n  void step")
    (package / "src/node.cpp").write_text(changed, encoding="utf-8")
    (found,) = build_workspace(tmp_path).static.thresholds.values()
    assert (found.lineno, found.exposed_at.lineno) == (11, 14)


def test_an_interrupted_build_goes_on(tmp_path: Path) -> None:
    make_package(tmp_path)
    command = [sys.executable, "-m", "pytpc", "build", tmp_path]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        assert next(process.stderr) == "Starting >>> tiny\n"
        object_file = tmp_path / ".tpc/build/tiny/CMakeFiles/tiny_node.dir"
        deadline = time.monotonic() + 60
        while not object_file.is_dir() and time.monotonic() < deadline:
            time.sleep(0.05)
        process.send_signal(signal.SIGINT)
        assert process.stderr.read().endswith("pytpc: interrupted\n")
    assert process.returncode == 130
    assert not (tmp_path / ".tpc/static.json").exists()
    (found,) = build_workspace(tmp_path).static.thresholds.values()
    assert found.source == "limit"


# Functions in functions are gcc's own.
NESTED = """int twice(int value);
int twice(int value) {
  int add(int other) { return value + other; }
  return add(value);
}
"""


def test_a_package_that_clang_does_not_take_is_built_without_tpc(tmp_path: Path) -> None:
    package = make_package(tmp_path)
    other = tmp_path / "src" / "nested"
    shutil.copytree(package, other)
    for name in ("package.xml", "CMakeLists.txt"):
        text = (other / name).read_text("utf-8").replace("tiny", "nested")
        (other / name).write_text(text.replace("src/node.cpp", "src/node.cpp src/nested.c"))
    (other / "src/nested.c").write_text(NESTED, encoding="utf-8")
    with pytest.raises(BuildError) as caught:
        build_workspace(tmp_path, BuildOptions(fallback=False))
    assert caught.value.package == "nested"
    result = build_workspace(tmp_path)
    assert list(result.left_alone) == ["nested"]
    assert "function definition is not allowed here" in result.left_alone["nested"]
    assert [unit.package for unit in result.units] == ["tiny"]
    (left_out,) = result.static.left_out
    assert left_out.reason == "its package does not build with TPC"
    comment = (tmp_path / ".tpc/install/nested/lib/nested/nested_node").read_bytes()
    assert b"GCC: (" in comment
    assert b"clang version" not in comment
    # Mended, it is built with TPC again when asked to.
    (other / "src/nested.c").write_text("int twice;\n", encoding="utf-8")
    assert list(build_workspace(tmp_path).left_alone) == ["nested"]
    again = build_workspace(tmp_path, BuildOptions(retry=True))
    assert (again.left_alone, again.static.left_out) == ({}, ())
    assert [unit.package for unit in again.units] == ["nested", "tiny"]


def test_a_fault_in_the_sources_is_shown(tmp_path: Path) -> None:
    package = make_package(tmp_path)
    node = package / "src" / "node.cpp"
    node.write_text(NODE.replace("limit_) {", "limits_) {"), encoding="utf-8")
    with pytest.raises(BuildError) as caught:
        build_workspace(tmp_path)
    assert caught.value.package == "tiny"
    # It is gcc's word: without TPC the package was tried as well.
    assert any("was not declared in this scope" in line for line in caught.value.tail)


def test_a_build_folder_of_another_compiler_is_noticed(tmp_path: Path) -> None:
    package = make_package(tmp_path)
    folder = tmp_path / ".tpc/build/tiny"
    lists = package / "CMakeLists.txt"
    lists.write_text("cmake_minimum_required(VERSION 3.16)\nproject(tiny)\n", encoding="utf-8")
    subprocess.run(
        ["cmake", "-S", package, "-B", folder, "-DCMAKE_CXX_COMPILER=g++"],
        env=build_environment(),
        check=True,
        capture_output=True,
    )
    lists.write_text(CMAKELISTS, encoding="utf-8")
    with pytest.raises(WorkspaceError, match="delete this folder") as caught:
        build_workspace(tmp_path)
    assert caught.value.path == str(folder)
    shutil.rmtree(folder)
    assert len(build_workspace(tmp_path).units) == 1


def test_a_patched_package_finds_the_same_in_the_users_own_build(tmp_path: Path) -> None:
    package = make_package(tmp_path)
    patch.run(tmp_path)
    environment = build_environment()
    command = ["cmake", "-S", package, "-B", tmp_path / "build"]
    command += ["-DPYTHON_EXECUTABLE=/usr/bin/python3", "-DCMAKE_BUILD_TYPE=Release"]
    subprocess.run(command, env=environment, check=True, capture_output=True)
    subprocess.run(
        ["cmake", "--build", tmp_path / "build"], env=environment, check=True, capture_output=True
    )
    file = tmp_path / "build/tpc/tiny_node.json"
    listed = json.loads(file.read_text(encoding="utf-8"))["comparisons"]
    (found,) = (one for one in listed if one["type"] != "constant")
    # The block moves the code of CMakeLists.txt, not that of the node.
    assert (found["lineno"], found["source"]) == (10, "limit")
    patch.run(tmp_path, restore=True)
    assert (package / "CMakeLists.txt").read_text(encoding="utf-8") == CMAKELISTS


def test_the_callers_python_does_not_matter(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    wrong = tmp_path / "bin" / "python3"
    wrong.parent.mkdir()
    wrong.write_text("#!/bin/sh\nexit 1\n", encoding="ascii")
    wrong.chmod(0o755)
    monkeypatch.setenv("PATH", f"{wrong.parent}:{os.environ['PATH']}")
    make_package(tmp_path / "ws")
    assert len(build_workspace(tmp_path / "ws").units) == 1
