"""The devel space of a build: which files stand for a package, and the environment with it.

The folders are made by hand as colcon and catkin leave them; tests/ros/test_devel_space.py builds.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from pytpc.build.devel_space import package_places, write_devel_space
from pytpc.build.nodes_env import nodes_env, with_devel_space, without_devel_space
from pytpc.python_runtime.instrument import _RELAYING
from pytpc.workspace.colcon import Bases
from pytpc.workspace.packages import Package

PYTHON = f"#!{sys.executable}\n"
# catkin's script.py.in, as `catkin_install_python` leaves it in the devel space.
RELAY = """#!/usr/bin/python3
# -*- coding: utf-8 -*-
# generated from catkin/cmake/template/script.py.in
python_script = '{script}'
"""


class Workspace:
    """A workspace with one package that was built and installed."""

    def __init__(self, folder: Path) -> None:
        self.bases = Bases.of(folder)
        self.source = folder / "src/robot"
        self.made = self.bases.build / "robot/devel"
        self.installed = self.bases.install / "robot"
        self.write({"src/robot/package.xml": "", ".tpc/build/robot/devel/.catkin": ""})

    def write(self, files: Mapping[str, str], mode: int = 0o644) -> None:
        """Write files below the workspace."""
        for name, text in files.items():
            path = self.bases.root.parent / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
            path.chmod(mode)

    def script(self, name: str, text: str, mode: int = 0o755, installed: str | None = None) -> Path:
        """A script in the sources, and its installed copy."""
        self.write({f"src/robot/{name}": text}, mode)
        copy = self.installed / "lib/robot" / Path(name).name
        copy.parent.mkdir(parents=True, exist_ok=True)
        copy.write_text(text if installed is None else installed)
        copy.chmod(0o755)
        return self.source / name

    def devel(self) -> dict[str, str]:
        """The files of the devel space, with where links lead to, or `file`."""
        write_devel_space(self.bases, [Package("robot", self.source, "catkin")])
        space = self.bases.devel
        return {
            str(path.relative_to(space)): str(path.readlink()) if path.is_symlink() else "file"
            for path in sorted(space.rglob("*"))
            if path.is_symlink() or (path.is_file() and path.name[0] != ".")
        }


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    return Workspace(tmp_path / "a robot")


def test_without_install_rules_a_package_is_its_source_folder(workspace: Workspace) -> None:
    made = workspace.made
    workspace.write(
        {
            "src/robot/launch/a.launch": "",
            ".tpc/build/robot/devel/lib/robot/cmake.lock": "",
            ".tpc/build/robot/devel/lib/libplan.so": "",
            ".tpc/build/robot/devel/lib/libplan.a": "",
            ".tpc/build/robot/devel/lib/pkgconfig/robot.pc": "",
            ".tpc/build/robot/devel/lib/python3/dist-packages/robot/__init__.py": "",
            ".tpc/build/robot/devel/share/robot/cmake/robotConfig.cmake": "",
            ".tpc/install/robot/share/robot/package.xml": "",
            ".tpc/install/robot/share/robot/package.dsv": "",
            ".tpc/install/robot/share/robot/cmake/robotConfig.cmake": "",
        }
    )
    workspace.write({".tpc/build/robot/devel/lib/robot/driver": "\x7fELF"}, 0o755)
    python = "lib/python3/dist-packages/robot/__init__.py"
    assert workspace.devel() == {
        "lib/libplan.so": f"{made}/lib/libplan.so",
        python: f"{made}/{python}",
        "lib/robot/driver": f"{made}/lib/robot/driver",
    }
    assert package_places(workspace.bases.devel) == [str(workspace.source)]


def test_what_is_installed_is_not_doubled(workspace: Workspace) -> None:
    workspace.write(
        {
            ".tpc/build/robot/devel/lib/robot/driver": "built",
            ".tpc/install/robot/lib/robot/driver": "installed",
            ".tpc/build/robot/devel/lib/libplan.so": "",
            ".tpc/install/robot/lib/libplan.so": "",
            "src/robot/config/a.yaml": "a: 2\n",
            ".tpc/install/robot/share/robot/config/a.yaml": "a: 1\n",
        }
    )
    # A changed source is no reason to read the copy.
    found = workspace.devel()
    assert found == {"lib/robot/driver": f"{workspace.installed}/lib/robot/driver"}
    assert package_places(workspace.bases.devel) == [str(workspace.source)]


def test_an_executable_script_is_found_in_the_sources_by_itself(workspace: Workspace) -> None:
    workspace.script("scripts/node.py", PYTHON)
    assert workspace.devel() == {}
    # With another file of that name, roslaunch would take either.
    workspace.write({"src/robot/old/node.py": "other"}, 0o755)
    assert workspace.devel() == {"lib/robot/node.py": f"{workspace.source}/scripts/node.py"}


@pytest.mark.parametrize("reason", ["not executable", "another first line"])
def test_a_script_that_cannot_run_where_it_is_has_a_relay(
    workspace: Workspace, reason: str
) -> None:
    text = f"{PYTHON}import sys, helper\nprint(__name__, __file__, helper.X, sys.argv[1:])\n"
    if reason == "not executable":
        source = workspace.script("scripts/node.py", text, 0o644)
    else:
        source = workspace.script("scripts/node.py", text.replace(PYTHON, "#!/none\n"))
        relay = RELAY.format(script=source)
        workspace.write({".tpc/build/robot/devel/lib/robot/node.py": relay}, 0o755)
        (workspace.installed / "lib/robot/node.py").write_text(text)
    workspace.script("lib/helper.py", "X = 1\n", 0o644)
    found = workspace.devel()
    assert found["lib/robot/node.py"] == "file"
    # Both are used as they are now.
    source.write_text(source.read_text().replace("helper.X", "helper.X + 5"))
    (workspace.source / "lib/helper.py").write_text("X = 2\n")
    node = workspace.bases.devel / "lib/robot/node.py"
    ran = subprocess.run([node, "a"], capture_output=True, text=True, check=False)
    assert ran.stdout == f"__main__ {source} 7 ['a']\n", ran.stderr
    # The runtime of Python nodes looks for this.
    assert _RELAYING[0] in node.read_bytes()


def test_a_script_keeps_the_modules_that_are_installed_beside_it(workspace: Workspace) -> None:
    workspace.script("scripts/node.py", f"{PYTHON}from helper import X\nprint(X)\n")
    workspace.script("lib/helper.py", "X = 3\n", 0o644)
    assert workspace.devel()["lib/robot/node.py"] == "file"
    node = workspace.bases.devel / "lib/robot/node.py"
    assert subprocess.check_output([node], text=True) == "3\n"


def test_other_scripts_run_as_installed_if_the_source_is_not_executable(
    workspace: Workspace,
) -> None:
    workspace.script("scripts/start.sh", "#!/bin/sh\n", 0o644)
    workspace.script("scripts/made.py", "#!@PYTHON@\n", 0o755, installed=PYTHON)
    installed = workspace.installed / "lib/robot"
    assert workspace.devel() == {
        "lib/robot/made.py": f"{installed}/made.py",
        "lib/robot/start.sh": f"{installed}/start.sh",
    }


def test_files_that_only_the_installation_has_come_to_those_of_the_sources(
    workspace: Workspace,
) -> None:
    share = workspace.installed / "share/robot"
    workspace.write(
        {
            "src/robot/config/a.yaml": "a: 1\n",
            "src/robot/launch/a.launch": "",
            "src/robot/maps/m.yaml": "m: 1\n",
            ".tpc/install/robot/share/robot/package.xml": "",
            ".tpc/install/robot/share/robot/config/a.yaml": "a: 1\n",
            # configure_file() made it.
            ".tpc/install/robot/share/robot/config/made.yaml": "b: 1\n",
            # install(DIRECTORY maps/ DESTINATION share/robot/world)
            ".tpc/install/robot/share/robot/world/m.yaml": "m: 1\n",
        }
    )
    source = workspace.source
    assert workspace.devel() == {
        "share/robot/config/a.yaml": f"{source}/config/a.yaml",
        "share/robot/config/made.yaml": f"{share}/config/made.yaml",
        "share/robot/launch": f"{source}/launch",
        "share/robot/maps": f"{source}/maps",
        "share/robot/package.xml": f"{source}/package.xml",
        "share/robot/world/m.yaml": f"{source}/maps/m.yaml",
    }
    assert package_places(workspace.bases.devel) == [f"{workspace.bases.devel}/share/robot"]


def test_what_nodes_wrote_into_a_folder_of_links_is_kept(workspace: Workspace) -> None:
    made = ".tpc/install/robot/share/robot"
    workspace.write(
        {
            "src/robot/config/a.yaml": "a: 1\n",
            f"{made}/config/made.yaml": "",
            f"{made}/maps/made.yaml": "",
            "src/robot/maps/m.yaml": "",
        }
    )
    workspace.devel()
    share = workspace.bases.devel / "share/robot"
    (share / "map.pgm").write_text("map")
    (share / "maps/new.yaml").write_text("new")
    # As by a program that writes a file beside, and renames it.
    (share / "config/a.yaml").unlink()
    (share / "config/a.yaml").write_text("a: 2\n")
    # In the next build, `maps` is a link into the sources.
    (workspace.installed / "share/robot/maps/made.yaml").unlink()
    for _ in range(2):
        found = {name for name, to in workspace.devel().items() if to == "file"}
        written = {"written/share/robot/config/a.yaml", "written/share/robot/maps/new.yaml"}
        assert found == {"share/robot/map.pgm", *written}
    assert (share / "map.pgm").read_text() == "map"
    assert (share / "config/a.yaml").read_text() == "a: 1\n"
    kept = workspace.bases.devel / "written/share/robot/config/a.yaml"
    assert kept.read_text() == "a: 2\n"
    (share / "config/a.yaml").unlink()
    (share / "config/a.yaml").write_text("a: 3\n")
    workspace.devel()
    assert kept.read_text() == "a: 3\n"
    assert [path.name for path in (workspace.source / "maps").iterdir()] == ["m.yaml"]


def test_a_workspace_that_is_one_package_does_not_hold_itself(tmp_path: Path) -> None:
    workspace = Workspace(tmp_path)
    workspace.write({"package.xml": "", ".tpc/install/robot/share/robot/made.yaml": ""})
    write_devel_space(workspace.bases, [Package("robot", tmp_path, "catkin")])
    share = workspace.bases.devel / "share/robot"
    assert {path.name for path in share.iterdir()} == {"made.yaml", "package.xml", "src"}


def test_generated_data_of_the_devel_space_is_no_other_place(workspace: Workspace) -> None:
    # dynamic_reconfigure and actionlib leave such files in both.
    workspace.write(
        {
            ".tpc/build/robot/devel/share/robot/docs/Robot.dox": "",
            ".tpc/install/robot/share/robot/docs/Robot.dox": "",
        }
    )
    made = workspace.made
    assert workspace.devel() == {"share/robot/docs/Robot.dox": f"{made}/share/robot/docs/Robot.dox"}
    assert package_places(workspace.bases.devel) == [str(workspace.source)]


def test_packages_that_are_not_built_are_left_out(workspace: Workspace) -> None:
    packages = [
        Package("robot", workspace.source, "catkin"),
        Package("new", workspace.source.with_name("new"), "catkin"),
    ]
    write_devel_space(workspace.bases, packages)
    assert package_places(workspace.bases.devel) == [str(workspace.source)]


def test_the_environment_has_it_in_front_and_gives_it_back(workspace: Workspace) -> None:
    workspace.write(
        {
            ".tpc/build/robot/devel/lib/libplan.so": "",
            ".tpc/build/robot/devel/lib/python3/dist-packages/robot/__init__.py": "",
        }
    )
    workspace.devel()
    devel = workspace.bases.devel
    before = {
        "CMAKE_PREFIX_PATH": "/ws/install:/opt/ros",
        "PATH": "/bin",
        "PYTHONPATH": "/a:",
        "ROS_PACKAGE_PATH": f"/ws/share:{workspace.source}",
    }
    after = with_devel_space(before, devel)
    assert after == {
        "CMAKE_PREFIX_PATH": f"{devel}:/ws/install:/opt/ros",
        "LD_LIBRARY_PATH": f"{devel}/lib",
        "PATH": "/bin",
        "PYTHONDONTWRITEBYTECODE": "tpc",
        "PYTHONPATH": f"{devel}/lib/python3/dist-packages:/a:",
        "ROS_PACKAGE_PATH": f"{workspace.source}:/ws/share",
        "TPC_DEVEL": str(devel),
    }
    assert with_devel_space(after, devel) == after
    assert without_devel_space(after) == {**before, "ROS_PACKAGE_PATH": "/ws/share"}
    assert without_devel_space(before) == before


def test_a_devel_space_of_the_user_is_not_taken_for_ours(tmp_path: Path) -> None:
    (tmp_path / "devel").mkdir()
    (tmp_path / "devel/.catkin").write_text(str(tmp_path / "src"))
    assert with_devel_space({"PATH": "/bin"}, tmp_path / "devel") == {"PATH": "/bin"}


def test_a_workspace_with_an_install_space_of_its_own_is_taken_as_it_is(
    workspace: Workspace,
) -> None:
    workspace.devel()
    workspace.write({"install/setup.bash": "export ROS_PACKAGE_PATH=/theirs\n"})
    found = nodes_env(workspace.bases.root.parent)
    assert found["ROS_PACKAGE_PATH"] == "/theirs"
    workspace.write({".tpc/install/setup.bash": "export ROS_PACKAGE_PATH=/ours\n"})
    found = nodes_env(workspace.bases.root.parent)
    assert found["ROS_PACKAGE_PATH"] == f"{workspace.source}:/ours"
