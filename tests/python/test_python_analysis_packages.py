"""Which programs of a workspace are nodes, and where their modules are found."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from click.testing import CliRunner

from pytpc.base.errors import InputError
from pytpc.cli.main import main
from pytpc.python_analysis.sources.cmake_programs import read_programs
from pytpc.python_analysis.sources.packages import NameFault, entries
from pytpc.python_analysis.sources.scripts import Entry
from pytpc.python_analysis.sources.setup_files import read_setup
from pytpc.static.static_info import StaticInfo

MANIFEST = """<package format="2"><name>{}</name><version>0.0.1</version>
<description>d</description><license>BSD</license>
<maintainer email="someone@example.org">x</maintainer></package>"""
NODE = """import rospy
from std_msgs.msg import Float64
def main():
    limit = rospy.get_param('~limit')
    pub = rospy.Publisher('out', Float64)
    rospy.init_node('n')
    rospy.Subscriber('in', Float64, lambda m: pub.publish(m) if m.data > limit else None)
"""


def write(folder: Path, **files: str) -> Path:
    """Write files of a package; in their names ``__`` stands for a slash, and ``_py`` for .py."""
    name = folder.name
    (folder).mkdir(parents=True, exist_ok=True)
    (folder / "package.xml").write_text(MANIFEST.format(name))
    for path, text in files.items():
        put(folder, path, text)
    return folder


def put(folder: Path, path: str, text: str) -> None:
    file = folder / path
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)


def names(found: list[Entry]) -> list[tuple[str, str, str]]:
    """Name, script below its package, and the module and function where it begins."""
    return [(e.name, str(e.script.relative_to(e.root)), e.begin) for e in found]


SETUPS = {
    "setup.py": (
        "from setuptools import find_packages, setup\nname = 'talk'\n"
        "setup(name=name, packages=find_packages(exclude=['test']),\n"
        "      entry_points={'console_scripts': ['say = ' + name + '.nodes.say:main',\n"
        "                                        f'{name}_hear = talk.hear:Hearer.run [x]']})\n"
    ),
    "setup.cfg": (
        "[options]\npackages = talk, talk.nodes\n[options.entry_points]\nconsole_scripts =\n"
        "    say = talk.nodes.say:main\n    talk_hear = talk.hear:Hearer.run\n"
    ),
    "pyproject.toml": (
        '[project]\nname = "talk"\n[project.scripts]\nsay = "talk.nodes.say:main"\n'
        'talk_hear = "talk.hear:Hearer.run"\n'
    ),
}


@pytest.mark.parametrize("kind", SETUPS)
def test_entry_points(kind: str, tmp_path: Path) -> None:
    folder = write(tmp_path / "talk")
    put(folder, kind, SETUPS[kind])
    put(folder, "talk/__init__.py", "")
    put(folder, "talk/nodes/__init__.py", "")
    # A guard besides makes no second unit of it.
    put(folder, "talk/nodes/say.py", NODE + "if __name__ == '__main__':\n    main()\n")
    put(folder, "talk/hear.py", "import rclpy\nclass Hearer:\n    def run(): rclpy.init()\n")
    found = entries(folder)
    assert sorted(names(found)) == [
        ("say", "talk/nodes/say.py", "main"),
        ("talk_hear", "talk/hear.py", "Hearer.run"),
    ]
    assert {entry.module for entry in found} == {"talk.nodes.say", "talk.hear"}


def test_an_entry_point_that_leads_nowhere_is_said(tmp_path: Path) -> None:
    folder = write(tmp_path / "talk")
    put(folder, "setup.py", "setup(entry_points={'console_scripts': ['say=talk.gone:main']})")
    faults: list[InputError] = []
    assert entries(folder, faults.append) == []
    assert [str(fault) for fault in faults] == [
        f"{folder}: the program say begins in talk.gone, which is not in this package"
    ]


def test_the_entry_function_is_the_begin(tmp_path: Path) -> None:
    folder = write(tmp_path / "talk")
    put(folder, "setup.py", SETUPS["setup.py"])
    put(folder, "talk/__init__.py", "")
    put(folder, "talk/nodes/__init__.py", "")
    # Only the begin hands `limit` its value.
    text = NODE.replace("def main():", "def main(limit=None):")
    put(folder, "talk/nodes/say.py", text)
    put(folder, "talk/hear.py", "x = 1\n")
    output = tmp_path / "out.json"
    done = CliRunner().invoke(main, ["analyse", str(folder), "-o", str(output)])
    assert (done.exit_code, done.stderr) == (0, "")
    (unit,) = StaticInfo.load(output).units
    (found,) = unit.comparisons
    assert (unit.link_unit, unit.package, found.file) == ("say", "talk", "talk/nodes/say.py")
    assert (found.source, found.lineno, found.relation) == ("~limit", 7, ">")


@pytest.mark.parametrize(
    "text",
    [
        "from catkin_pkg.python_setup import generate_distutils_setup\n"
        "d = generate_distutils_setup(packages=['utils'], package_dir={'': 'lib'})\nsetup(**d)",
        "args = dict(packages=['utils'], package_dir={'utils': 'lib/utils'})\nsetup(**args)",
        "kw = {'package_dir': {'': 'lib'}}\nsetup(py_modules=['other'], packages=['utils'], **kw)",
    ],
)
def test_package_dir(text: str, tmp_path: Path) -> None:
    folder = write(tmp_path / "guard")
    put(folder, "setup.py", text)
    put(folder, "lib/utils/__init__.py", "")
    put(folder, "lib/utils/params.py", "import rospy\nTOP = rospy.get_param('top')\n")
    put(folder, "scripts/watch.py", NODE.replace("rospy.get_param('~limit')", "params.TOP"))
    put(
        folder,
        "scripts/watch.py",
        "from utils import params\n"
        + (folder / "scripts/watch.py").read_text()
        + "if __name__ == '__main__':\n    main()\n",
    )
    (entry,) = entries(folder)
    assert list(entry.places("utils.params")) == [folder / "lib/utils/params.py"]


def test_setup_py_is_not_run_and_odd_ones_are_no_error(tmp_path: Path) -> None:
    odd = (
        "import sys\nopen('/dev/null/x')\nsys.exit(1)\nname = name\n"
        "setup(packages=name, package_dir={1: 2, **rest}, scripts='scripts/one',\n"
        "      py_modules=['', '/', '..', '%(a)s' % {}, '{0.a}'.format('b'), '{[0]}'.format(3)],\n"
        "      entry_points={'console_scripts': ['a' % 3, '{'.format(1), 'b=c', None, 'd=e:f']})\n"
    )
    (tmp_path / "setup.py").write_text(odd)
    faults: list[InputError] = []
    found = read_setup(tmp_path, faults.append)
    assert (found.programs, found.scripts, found.packages) == ({"d": "e:f"}, ["scripts/one"], None)
    assert faults == []
    # No name of these is a module's, and none of them is asked for what it cannot have.
    assert found.modules == ["", "/", ".."]
    put(tmp_path, "package.xml", MANIFEST.format("odd"))
    assert entries(tmp_path, faults.append) == []
    (fault,) = faults
    assert fault.message == "the program d begins in e, which is not in this package"
    faults.clear()
    (tmp_path / "setup.py").write_text("setup(\n")
    (tmp_path / "pyproject.toml").write_text("[project\n")
    (tmp_path / "setup.cfg").write_text("no section\n")
    assert read_setup(tmp_path, faults.append).programs == {}
    assert [Path(fault.path or "").name for fault in faults] == [
        "setup.py", "setup.cfg", "pyproject.toml"
    ]  # fmt: skip


LISTS = """cmake_minimum_required(VERSION 3.5)
project(guard)
set(HERE ${CMAKE_CURRENT_SOURCE_DIR}/scripts)
catkin_install_python(PROGRAMS ${HERE}/one.py "scripts/two" # a comment
  DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
file(GLOB FOUND RELATIVE ${PROJECT_SOURCE_DIR} bin/*.py)
list(APPEND ALL ${FOUND} sh/run.sh)
foreach(name IN LISTS ALL ITEMS more.py)
  install(PROGRAMS ${name} DESTINATION lib/${PROJECT_NAME})
  if(name MATCHES x)
    install(PROGRAMS not/${name} DESTINATION x)
  endif()
endforeach()
if(THERE)
  install(PROGRAMS last.py DESTINATION x)
endif()
install(FILES scripts/no.py DESTINATION x)
install(TARGETS PROGRAMS)
add_subdirectory(sub)
ament_python_install_package(${PROJECT_NAME} PACKAGE_DIR py)
"""


def test_programs_of_cmake(tmp_path: Path) -> None:
    put(tmp_path, "CMakeLists.txt", LISTS)
    put(tmp_path, "sub/CMakeLists.txt", "install(PROGRAMS three.py ${UNKNOWN} DESTINATION x)\n")
    put(tmp_path, "bin/b.py", "")
    put(tmp_path, "bin/a.py", "")
    found = read_programs(tmp_path, pytest.fail)
    assert found.python == [tmp_path / "scripts/one.py", tmp_path / "scripts/two"]
    assert found.others == [
        tmp_path / name
        for name in ("bin/a.py", "bin/b.py", "sh/run.sh", "more.py", "last.py", "sub/three.py")
    ]
    assert found.packages == {"guard": tmp_path / "py"}


def test_variables_of_cmake_that_are_added_to_again_and_again(tmp_path: Path) -> None:
    # As both branches of an `if` count, each `set` would double what there was: 2 to the 60.
    lines = ["set(FLAGS -O2)", *(f'set(FLAGS "${{FLAGS}} -f{each}")' for each in range(60))]
    lines += ["set(BOTH a b)", f'set(ALL "{"${BOTH}" * 60}")', "install(PROGRAMS one.py ${ALL})"]
    put(tmp_path, "CMakeLists.txt", "\n".join(lines))
    assert read_programs(tmp_path, pytest.fail).others[0] == tmp_path / "one.py"


def test_a_list_file_that_cmake_cannot_parse_is_said(tmp_path: Path) -> None:
    put(tmp_path, "CMakeLists.txt", "project(x)\ninstall(PROGRAMS a.py\n")
    faults: list[InputError] = []
    assert read_programs(tmp_path, faults.append).others == []
    (fault,) = faults
    assert (fault.path, fault.line) == (str(tmp_path / "CMakeLists.txt"), 2)


def test_installed_scripts_are_nodes_without_guard_or_shebang(tmp_path: Path) -> None:
    folder = write(tmp_path / "guard")
    programs = "scripts/plain scripts/plain.py scripts/run.sh scripts/gone.py"
    put(folder, "CMakeLists.txt", f"catkin_install_python(PROGRAMS {programs} DESTINATION x)\n")
    put(folder, "scripts/plain", NODE + "main()\n")
    put(folder, "scripts/plain.py", NODE + "main()\n")
    put(folder, "scripts/library.py", NODE)
    put(folder, "scripts/run.sh", '#!/bin/sh\necho "$1" now\n')
    put(folder, "more.py", NODE + "main()\n")
    # What a program imports is a module, though it is installed beside it.
    put(
        folder,
        "CMakeLists.txt",
        (folder / "CMakeLists.txt").read_text()
        + "install(PROGRAMS both.py scripts/beside.py DESTINATION x)\n",
    )
    put(folder, "scripts/beside.py", NODE)
    put(folder, "scripts/plain.py", "import beside\n" + NODE + "main()\n")
    faults: list[InputError] = []
    assert [str(e.script.relative_to(folder)) for e in entries(folder, faults.append)] == [
        "scripts/plain", "scripts/plain.py"
    ]  # fmt: skip
    # What is said to be Python and is none is said.
    assert [fault.path for fault in faults] == [str(folder / "scripts/run.sh")]
    put(folder, "setup.py", "setup(scripts=['more.py'])")
    assert "more" in [entry.name for entry in entries(folder, faults.append)]


GUARD = "if __name__ == '__main__':\n    pass\n"


@pytest.mark.parametrize(
    ("text", "is_node"),
    [
        ("import sys\nprint(sys.argv)\n", False),
        # Messages are no way to the robot.
        ("from std_msgs.msg import Float64\nFloat64().publish()\n", False),
        ("import rospy\nrospy.get_param('x')\n", True),
        ("def f():\n    from rospy import Publisher\n    Publisher('x', 1)\n", True),
        ("import rospy\nx = rospy.Time()\n", False),
        ("import helper\nhelper.run()\n", True),
        ("from helper import run\n", True),
        ("from . import helper\n", True),
        ("import plain\n", False),
        ("import broken\n", False),
        ("from " + "." * 99 + " import x\n", False),
        ("import rclpy\nrclpy.init()\n", True),
    ],
)
def test_what_has_nothing_to_do_with_ros_is_no_node(
    text: str, is_node: bool, tmp_path: Path
) -> None:
    put(tmp_path, "helper.py", "import plain, rospy\ndef run():\n    rospy.get_param('x')\n")
    put(tmp_path, "plain.py", "import demo\n")
    put(tmp_path, "broken.py", "print 'rospy'\n")
    put(tmp_path, "demo.py", text + GUARD)
    found = [entry.name for entry in entries(tmp_path)]
    assert found == (["demo"] if is_node else [])
    # Who names a script means it.
    assert [entry.name for entry in entries(tmp_path / "demo.py")] == ["demo"]


UTILS = """import rospy
def get(name):
    return rospy.get_param(name)
def above(a, b):
    return a > b
"""
USER = """import rospy
from std_msgs.msg import Float64
from my_utils.params import above, get
pub = rospy.Publisher('out', Float64)
top = get('~top')
rospy.Subscriber('in', Float64, lambda m: pub.publish(m) if above(m.data, top) else None)
if __name__ == '__main__':
    rospy.init_node('user')
"""


def workspace(folder: Path) -> Path:
    """A node of one package, which imports another package's module."""
    utils = write(folder / "src/my_utils")
    put(
        utils,
        "setup.py",
        "setup(**generate_distutils_setup(packages=['my_utils'], package_dir={'': 'src'}))",
    )
    put(utils, "src/my_utils/__init__.py", "")
    put(utils, "src/my_utils/params.py", UTILS)
    put(utils, "scripts/params.py", "x = 1\n")
    put(write(folder / "src/user"), "nodes/user.py", USER)
    return folder / "src"


def test_modules_of_other_packages_are_followed(tmp_path: Path) -> None:
    source = workspace(tmp_path)
    output = tmp_path / "out.json"
    for given in ([source], [source / "user", source / "my_utils"]):
        words = ["analyse", *map(str, given), "-o", str(output)]
        done = CliRunner().invoke(main, words)
        assert (done.exit_code, done.stderr) == (0, "")
        static = StaticInfo.load(output)
        (unit,) = static.units
        (found,) = unit.comparisons
        # Outside of the package's own folder a file has its absolute path, as in C++.
        assert unit.source_root == str(source / "user")
        assert found.file == str(source / "my_utils/src/my_utils/params.py")
        assert (found.lineno, found.column, found.source) == (5, 12, "~top")
        assert [(r.file, r.lineno) for r in unit.parameters] == [(found.file, 3)]
        (place,) = static.tpcs
        assert place.file == found.file
    # Alone, the other package is not at hand.
    done = CliRunner().invoke(main, ["analyse", str(source / "user"), "-o", str(output)])
    assert StaticInfo.load(output).units[0].comparisons == ()


def test_a_package_hides_modules_of_others(tmp_path: Path) -> None:
    source = workspace(tmp_path)
    put(source / "user", "setup.py", "setup(packages=['my_utils'])")
    put(source / "user", "my_utils/__init__.py", "")
    (entry,) = entries(source)
    assert next(entry.places("my_utils")) == source / "user/my_utils/__init__.py"


def test_a_broken_manifest_is_one_warning(tmp_path: Path) -> None:
    source = workspace(tmp_path)
    put(source, "user/package.xml", "<package>\n<name>other</nam>\n")
    put(source, "user/nodes/second.py", USER)
    output = tmp_path / "out.json"
    done = CliRunner().invoke(main, ["analyse", str(source), "-o", str(output)])
    assert done.exit_code == 0
    (line,) = done.stderr.splitlines()
    where = f"{source}/user/package.xml:2"
    assert line.startswith(f"user/package.xml reports nothing: {where}: not XML: mismatched tag")
    assert line.endswith("; using the folder's name as the package's")
    units = StaticInfo.load(output).units
    assert {(unit.package, unit.link_unit) for unit in units} == {
        ("user", "user"),
        ("user", "second"),
    }
    faults: list[InputError] = []
    (entry,) = entries(source / "user/nodes/user.py", faults.append)
    assert entry.package == "user"
    assert [type(fault) for fault in faults] == [NameFault]


def test_folders_that_are_left_out(tmp_path: Path) -> None:
    node = NODE + GUARD
    for place in ("a", "build/b", "test/c", ".d/d", "off/e", "made/f"):
        put(tmp_path, f"{place}/node.py", node)
    (tmp_path / "off/COLCON_IGNORE").touch()
    (tmp_path / "made/.catkin").touch()
    # A package may have such a name.
    put(write(tmp_path / "log"), "node.py", node)
    assert [entry.package for entry in entries(tmp_path)] == ["a", "log"]


def test_links(tmp_path: Path) -> None:
    put(tmp_path, "there/deep/node.py", NODE + GUARD)
    source = write(tmp_path / "ws/one")
    (source / "linked").symlink_to(tmp_path / "there")
    (tmp_path / "there/deep/up").symlink_to(tmp_path / "there")
    (source / "circle").symlink_to(source)
    (source / "loop.py").symlink_to("loop.py")
    (source / "gone.py").symlink_to("nothing.py")
    os.mkfifo(source / "pipe.py")
    os.mkfifo(source / "pipe")
    faults: list[InputError] = []
    assert [entry.name for entry in entries(tmp_path / "ws", faults.append)] == ["node"]
    assert [(Path(fault.path or "").name, fault.message) for fault in faults] == [
        ("gone.py", "cannot be read: No such file or directory"),
        ("loop.py", "cannot be read: Too many levels of symbolic links"),
        ("pipe.py", "not a regular file"),
    ]


def test_a_name_that_is_not_utf_8_is_left_out(tmp_path: Path) -> None:
    put(tmp_path, "node.py", NODE + GUARD)
    Path(os.fsdecode(os.fsencode(tmp_path) + b"/n\xffde.py")).write_text(NODE + GUARD)
    faults: list[InputError] = []
    assert [entry.name for entry in entries(tmp_path, faults.append)] == ["node"]
    (fault,) = faults
    assert str(fault).isascii()
    assert r"n\xffde.py: the name of this file is not UTF-8" in str(fault)
