"""The parts of `pytpc processes`: files, declarations of ROS 2, and what launch files start."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from pytpc.processes.binaries import COMPONENT, Libraries, cyclic_needs, read_binary
from pytpc.processes.plugins import declared_plugins
from pytpc.processes.starts import starts_of
from pytpc.values.trace import LaunchNode, Trace
from pytpc.workspace.packages import find_packages

LOADER = """
namespace pluginlib {
template <class T> struct ClassLoader {
  virtual ~ClassLoader() {}
};
}
"""
INDEX = "share/ament_index/resource_index"


def compiled(folder: Path, name: str, text: str, *words: str) -> Path:
    source, made = folder / f"{name}.cpp", folder / name
    source.write_text(text)
    flags = ["-shared", "-fPIC", f"-Wl,-soname,{name}"] if name.endswith(".so") else []
    command = ["c++", *flags, "-o", made, source, f"-L{folder}", "-Wl,--no-as-needed", *words]
    subprocess.run(command, check=True)
    return made


def test_the_base_classes_of_loaded_plugins(tmp_path):
    text = f"""{LOADER}
struct Plain {{}};
namespace robot {{ namespace nav {{ struct Planner {{}}; }} template <class T> struct Kit {{}}; }}
pluginlib::ClassLoader<robot::nav::Planner> planners;
pluginlib::ClassLoader<Plain> plain;
pluginlib::ClassLoader<robot::Kit<int>> templates;
const char *text() {{ return "robot/Fast"; }}
const char *longer() {{ return "a robot/Slow"; }}
"""
    found = read_binary(compiled(tmp_path, "libasks.so", text))
    assert found is not None
    assert (found.soname, found.is_program) == ("libasks.so", False)
    assert found.asks == {"robot::nav::Planner", "Plain"}
    assert found.texts(["robot/Fast", "robot/Slow", "robot/Fas"]) == {"robot/Fast"}


def test_needed_libraries_in_the_order_of_the_linker(tmp_path):
    compiled(tmp_path, "libdeep.so", "int deep() { return 1; }")
    compiled(tmp_path, "libleft.so", "int left() { return 1; }", "-ldeep")
    compiled(tmp_path, "libright.so", "int right() { return 1; }")
    main = "int main() {}"
    program = compiled(tmp_path, "program", main, "-lleft", "-lright", "-Wl,-rpath,$ORIGIN")
    ours = {"libleft.so": tmp_path / "libleft.so"}
    # libright.so and libdeep.so are found by the folder that the program, or nobody, names.
    names = [
        one.path.name for one in Libraries(ours).all_of([program]) if tmp_path in one.path.parents
    ]
    assert names == ["program", "libleft.so", "libright.so"]
    libraries = Libraries({path.name: path for path in tmp_path.glob("*.so")})
    names = [one.path.name for one in libraries.all_of([program]) if tmp_path in one.path.parents]
    assert names == ["program", "libleft.so", "libright.so", "libdeep.so"]
    binary = libraries.binary(program)
    assert binary is not None
    assert binary.is_program


def test_libraries_that_need_one_another(tmp_path):
    compiled(tmp_path, "libone.so", "int one() { return 1; }")
    two = compiled(tmp_path, "libtwo.so", "int two() { return 1; }", "-lone")
    one = compiled(tmp_path, "libone.so", "int one() { return 1; }", "-ltwo")
    libraries = Libraries({"libone.so": one, "libtwo.so": two})
    binaries = [binary for binary in libraries.all_of([one]) if binary.path in (one, two)]
    assert len(binaries) == 2
    assert cyclic_needs(binaries) == ["libone.so", "libtwo.so", "libone.so"]


@pytest.mark.parametrize("content", [b"", b"\x7fELF", b"\x7fELF" + bytes(60), b"#!/bin/sh\n"])
def test_files_that_are_no_programs(tmp_path, content):
    path = tmp_path / "file"
    path.write_bytes(content)
    assert read_binary(path) is None
    assert read_binary(tmp_path / "none") is None


def package(folder: Path, name: str) -> None:
    (folder / name).mkdir(parents=True)
    (folder / name / "package.xml").write_text(
        f"""<package format="3"><name>{name}</name><version>1.0.0</version>
<description>d</description><maintainer email="a@b.org">a</maintainer><license>x</license>
<buildtool_depend>ament_cmake</buildtool_depend>
<export><build_type>ament_cmake</build_type></export></package>"""
    )


# The index of ROS 2: pluginlib's files name XML, components' files name classes and libraries.
def test_plugins_and_components_of_ros2(tmp_path):
    package(tmp_path / "src", "grid")
    prefix = tmp_path / "install"
    for name, text in {
        "nav__pluginlib__plugin/grid": "share/grid/layers.xml\nshare/grid/gone.xml\n",
        "rclcpp_components/grid": "grid::Camera;lib/libcamera.so\ngrid::Gone;lib/libgone.so\n",
        "rclcpp_components/other": "other::Camera;lib/libcamera.so\n",
    }.items():
        path = prefix / INDEX / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    (prefix / "share/grid").mkdir()
    (prefix / "share/grid/layers.xml").write_text(
        '<class_libraries><library path="layers">\n'
        '<class type="grid::Wall" base_class_type="nav::Layer"/>\n'
        "</library></class_libraries>"
    )
    libraries = {name: tmp_path / name for name in ("liblayers.so", "libcamera.so")}
    found = declared_plugins(find_packages(tmp_path / "src"), [prefix, prefix], libraries)
    assert [(one.name, one.base, one.library.name, one.line) for one in found.plugins] == [
        ("grid::Wall", "nav::Layer", "liblayers.so", 2),
        ("grid::Camera", COMPONENT, "libcamera.so", 1),
    ]
    index = prefix / INDEX
    assert found.faults == (
        f"{index}/nav__pluginlib__plugin/grid: names share/grid/gone.xml, which is not there",
        f"{index}/rclcpp_components/grid:2: no library lib/libgone.so was built",
    )


def node(name: str, program: str, args: str = "", container: str = "") -> LaunchNode:
    return LaunchNode(name, "some", program, Path("x.launch"), 1, 0, args, container)


def test_what_a_launch_file_loads_into_a_node():
    nodes = [
        node("/a/manager", "nodelet", "manager"),
        node("/a/one", "nodelet", "load some/One manager extra:=1"),
        node("/b/two", "nodelet", "load some/Two /a/manager"),
        node("/b/three", "nodelet", "standalone some/Three"),
        node("/b/four", "nodelet", "unload some/Two /a/manager"),
        node("/box", "component_container"),
        node("/inner", "some::Inner", container="/box"),
    ]
    settings = {
        "/box/mode": [{"value": "old::Mode"}, {"value": ["a::B", {"type": "c/D"}]}],
        "/boxes/mode": [{"value": "e/F"}],
    }
    found = {one.node: one for one in starts_of(Trace(None, {}, settings, nodes, {}))}
    assert {name: one.loads for name, one in found.items()} == {
        "/a/manager": {"some/One", "some/Two"},
        "/b/three": {"some/Three"},
        "/box": {"some::Inner"},
    }
    assert found["/box"].names == {"mode": {"a::B", "c/D"}}
    assert found["/box"].sets("~mode")
    assert not found["/box"].sets("~de")
