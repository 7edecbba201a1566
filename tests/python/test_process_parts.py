"""The parts of `pytpc processes`: files, declarations of ROS 2, and what launch files start."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from packages import add_package

from pytpc.processes.binaries import COMPONENT, Libraries, cyclic_needs, read_binary
from pytpc.processes.plugins import declared_plugins
from pytpc.processes.starts import starts_of, words_in
from pytpc.values.trace import LaunchNode, Trace
from pytpc.workspace.packages import find_packages

LOADER = """
namespace pluginlib {
template <class T> struct ClassLoader {
  virtual ~ClassLoader() {}
};
}
"""
AMENT = "<export><build_type>ament_cmake</build_type></export>"
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


def test_a_program_without_a_dynamic_linker(tmp_path):
    found = read_binary(compiled(tmp_path, "program", "int main() {}", "-static", "-no-pie"))
    assert found is not None
    assert found.is_program


@pytest.mark.parametrize("content", [b"", b"\x7fELF", b"\x7fELF" + bytes(60), b"#!/bin/sh\n"])
def test_files_that_are_no_programs(tmp_path, content):
    path = tmp_path / "file"
    path.write_bytes(content)
    assert read_binary(path) is None
    assert read_binary(tmp_path / "none") is None


# The index of ROS 2: pluginlib's files name XML, components' files name classes and libraries.
def test_plugins_and_components_of_ros2(tmp_path):
    add_package(tmp_path / "src/grid", more=AMENT)
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
        f"{index}/rclcpp_components/grid:2: no library lib/libgone.so was built;"
        " build its package, or correct the path",
    )


@pytest.mark.parametrize(
    ("head", "fault"),
    [
        ('<?xml version="1.0" encoding="GB2312"?>', "its encoding cannot be read"),
        ('<?xml version="1.0" encoding="none"?>', "its encoding cannot be read"),
        ("", ""),
    ],
)
def test_plugin_files_with_other_encodings_and_languages(tmp_path, head, fault):
    add_package(tmp_path / "src/grid", more=AMENT)
    found = []
    # Of two prefixes with the package, the first counts: the second has a plugin more.
    for name, more in (("new", ""), ("old", '<class type="a::B" base_class_type="nav::Layer"/>')):
        prefix = tmp_path / name
        index = prefix / INDEX / "nav__pluginlib__plugin"
        index.mkdir(parents=True)
        (index / "grid").write_text("layers.xml\n")
        (prefix / "layers.xml").write_text(
            f'{head}<library path="layers">{more}'
            '<class type="grid::Wall" base_class_type="nav::Layer"/></library>'
        )
        found.append(prefix)
    python = (
        '<library path="src"><class type="a.B" base_class_type="rqt_gui_py::Plugin"/></library>'
    )
    (tmp_path / "new" / INDEX / "rqt__pluginlib__plugin").mkdir()
    (tmp_path / "new" / INDEX / "rqt__pluginlib__plugin/grid").write_text("python.xml\n")
    (tmp_path / "new/python.xml").write_text(python)
    libraries = {"liblayers.so": tmp_path / "liblayers.so"}
    declared = declared_plugins(find_packages(tmp_path / "src"), found, libraries)
    assert [one.name for one in declared.plugins] == ([] if fault else ["grid::Wall"])
    assert [fault in one for one in declared.faults] == ([True] if fault else [])


# The name of a class in an inline namespace, and that of a type with another name, are no faults.
def test_classes_that_the_library_does_not_have(tmp_path):
    add_package(tmp_path / "src/grid", more=AMENT)
    text = """
namespace grid {
struct Base { virtual ~Base() {} };
inline namespace v1 { struct Wall : Base {}; }
}
grid::Base *wall() { return new grid::Wall; }
const char *text() { return "grid::Alias"; }
"""
    library = compiled(tmp_path, "liblayers.so", text)
    index = tmp_path / INDEX
    (index / "nav__pluginlib__plugin").mkdir(parents=True)
    (index / "nav__pluginlib__plugin/grid").write_text("layers.xml\n")
    (index / "rclcpp_components").mkdir()
    (index / "rclcpp_components/grid").write_text("grid::Wall;lib/liblayers.so\nGone;layers\n")
    kinds = ("grid::Wall", "grid::Alias", "grid::Wal", "gridd::Wall", "grid::Wall<int>")
    classes = "\n".join(
        f'<class type="{kind.replace("<", "&lt;")}" base_class_type="B"/>' for kind in kinds
    )
    (tmp_path / "layers.xml").write_text(f'<library path="layers">\n{classes}\n</library>')
    packages = find_packages(tmp_path / "src")
    found = declared_plugins(packages, [tmp_path], {"liblayers.so": library})
    assert [one.kind for one in found.plugins] == [*kinds, "grid::Wall", "Gone"]
    end = "; correct its name, or build the library again"
    assert found.faults == (
        f"{tmp_path}/layers.xml:4: liblayers.so has no class grid::Wal{end}",
        f"{tmp_path}/layers.xml:5: liblayers.so has no class gridd::Wall{end}",
        f"{index}/rclcpp_components/grid:2: liblayers.so has no class Gone{end}",
    )


def test_two_files_that_declare_a_plugin_of_one_name(tmp_path):
    add_package(tmp_path / "src/grid", more=AMENT)
    index = tmp_path / INDEX / "nav__pluginlib__plugin"
    index.mkdir(parents=True)
    (index / "grid").write_text("one.xml\ntwo.xml\n")
    for name in ("one", "two"):
        (tmp_path / f"{name}.xml").write_text(
            f'<library path="{name}">\n<class name="grid/Wall" type="grid::Wall"'
            ' base_class_type="nav::Layer"/>\n</library>'
        )
    libraries = {f"lib{name}.so": tmp_path / f"lib{name}.so" for name in ("one", "two")}
    found = declared_plugins(find_packages(tmp_path / "src"), [tmp_path], libraries)
    assert [one.library.name for one in found.plugins] == ["libone.so"]
    assert found.faults == (
        f"{tmp_path}/two.xml:2: there is another plugin grid/Wall for nav::Layer, in"
        f" {tmp_path}/one.xml:2; that one counts",
    )


# The parameters of what is loaded are read in the process, and so are those around it.
def test_parameters_of_what_is_loaded_and_of_namespaces():
    nodes = [
        node("/a/box", "component_container"),
        node("/a/planner", "some::Planner", container="/a/box"),
        node("/a/other", "other"),
        node("/a/late", "some::Late", container="/far"),
        node("/a/one", "nodelet", "load some/One /gone"),
    ]
    settings = {
        "/a/planner/kind": [{"value": "x::Fast"}],
        "/a/mode": [{"value": "x::Mode"}],
        "/a/other/kind": [{"value": "x::Other"}],
        "/b/mode": [{"value": "x::Far"}],
        "/a/late/kind": [{"value": "x::Late"}],
    }
    found = {one.node: one for one in starts_of(Trace(None, {}, settings, nodes, {}))}
    assert {name: one.program for name, one in found.items() if one.loads} == {
        "/a/box": "some/component_container",
        "/far": "rclcpp_components/component_container",
        "/gone": "nodelet/nodelet",
    }
    assert found["/a/box"].words == {"x::Fast", "x::Mode"}
    assert found["/far"].words == {"x::Late", "x::Mode"}
    assert found["/a/other"].words == {"x::Other", "x::Mode"}


def test_words_without_comments(tmp_path):
    for name, text in {
        "a.yaml": "planner: x/Fast  # x/Slow\n",
        "b.launch": '<launch><!-- x/Slow --><param name="a" value="x/Fast"/></launch>',
        "c.launch.py": 'Node(plugin="x/Fast")  # x/Slow\n',
    }.items():
        (tmp_path / name).write_text(text)
        assert words_in(tmp_path / name) & {"x/Fast", "x/Slow"} == {"x/Fast"}
    (tmp_path / "broken.yaml").write_text("a: [")
    assert words_in(tmp_path / "broken.yaml") == frozenset()


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
