"""The checks of a workspace, on real folders and on what was seen of them."""

import json
import os
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from packages import add_package, install_prefix

from pytpc.cli import machine_commands
from pytpc.cli.main import main
from pytpc.workspace.cmake_block import patch_text
from pytpc.workspace.doctor.finding import Finding, Severity
from pytpc.workspace.doctor.machine import Machine
from pytpc.workspace.doctor.workspace import (
    Known,
    check_workspace,
    debian_names,
    look_at_known,
    look_at_workspace,
    read_cache,
    unsuited_flags,
)
from pytpc.workspace.packages import find_cycle

CMAKE_FILE = "/opt/tpc/share/tpc/cmake/tpc.cmake"
LISTS = b"cmake_minimum_required(VERSION 3.16)\nproject(p)\n"
CATKIN = "<export><build_type>catkin</build_type></export>"


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    folder = tmp_path / "ws"
    add_package(folder / "src/arm", cmakelists=LISTS)
    return folder


def known(workspace: Path, **more: frozenset[str]) -> Known:
    given = {"packages": frozenset[str](), "debian": frozenset[str](), "installed": frozenset()}
    return Known(**{**given, **more}, cmake_file=CMAKE_FILE, own_builds=workspace / ".tpc")


def check(workspace: Path, **more: frozenset[str]) -> list[Finding]:
    return check_workspace(look_at_workspace(workspace), known(workspace, **more))


def only(findings: list[Finding]) -> tuple[str, str, str | None, str | None]:
    (found,) = findings
    return found.severity.value, found.what, found.where, found.mend


def test_nothing_is_wrong_with_a_sound_workspace(workspace: Path) -> None:
    assert check(workspace) == []


def test_a_folder_without_packages(tmp_path: Path) -> None:
    assert only(check(tmp_path))[:2] == (
        "error",
        "no packages here: no package.xml in this folder or below",
    )


def test_a_broken_manifest_does_not_hide_the_rest(workspace: Path) -> None:
    other = add_package(workspace / "src/face", cmakelists=b"project(face)\nif(X\n")
    (other / "package.xml").write_bytes(b"<package>\n<name>face</nam>\n</package>\n")
    first, second = check(workspace)
    assert (first.severity, first.where) == (Severity.ERROR, f"{other}/package.xml:2")
    assert first.what.startswith("not XML: ")
    assert (second.severity, second.where) == (Severity.ERROR, f"{other}/CMakeLists.txt:2")


def test_a_catkin_package_needs_its_file_and_project(workspace: Path) -> None:
    bare = add_package(workspace / "src/bare", more=CATKIN)
    assert only(check(workspace))[:3] == (
        "error",
        "a catkin package without this file",
        f"{bare}/CMakeLists.txt",
    )
    (bare / "CMakeLists.txt").write_bytes(b"include(common.cmake)\n")
    assert only(check(workspace))[:2] == ("error", "does not call project() itself")
    (bare / "CMakeLists.txt").unlink()
    (bare / "CMakeLists.txt").symlink_to("nowhere")
    assert only(check(workspace))[1] == "a symbolic link that leads nowhere"


def test_one_name_twice(workspace: Path) -> None:
    add_package(workspace / "src/copy", "arm", cmakelists=LISTS)
    severity, what, _, mend = only(check(workspace))
    source = workspace / "src"
    assert (severity, what) == (
        "error",
        f"package arm occurs 2 times: {source}/arm, {source}/copy",
    )
    assert mend == f"touch {source}/copy/COLCON_IGNORE"


def test_a_circle_is_named(workspace: Path) -> None:
    add_package(workspace / "src/a", cmakelists=LISTS, more="<depend>b</depend>")
    add_package(workspace / "src/b", cmakelists=LISTS, more="<build_depend>c</build_depend>")
    add_package(workspace / "src/c", cmakelists=LISTS, more="<depend>a</depend>")
    assert only(check(workspace))[:2] == (
        "error",
        "circular dependency: a -> b -> c -> a",
    )


@pytest.mark.parametrize(
    ("needs", "cycle"),
    [
        ({}, []),
        ({"a": ["b"], "b": ["c"], "c": []}, []),
        ({"a": ["b", "c"], "b": ["d"], "c": ["d"]}, []),
        ({"a": ["a"]}, ["a", "a"]),
        ({"a": ["b"], "b": ["c"], "c": ["b"]}, ["b", "c", "b"]),
        ({"a": [], "x": ["y"], "y": ["a", "x"]}, ["x", "y", "x"]),
    ],
)
def test_circles(needs: dict[str, list[str]], cycle: list[str]) -> None:
    assert find_cycle(needs) == cycle


def test_a_long_chain_is_no_recursion() -> None:
    chain = {str(number): [str(number + 1)] for number in range(5000)}
    assert find_cycle(chain) == []


def test_dependencies_that_are_not_here(workspace: Path) -> None:
    more = (
        "<build_depend>geometry_msgs</build_depend><exec_depend>rospy</exec_depend>"
        "<depend>arm</depend><depend>roscpp</depend><depend>boost</depend>"
        "<exec_depend>eigen</exec_depend>"
        '<depend condition="$ROS_VERSION == 2">rclcpp</depend>'
    )
    add_package(workspace / "src/user", cmakelists=LISTS, more=more)
    found = check(
        workspace,
        packages=frozenset({"roscpp"}),
        debian=frozenset(
            {"libgeometry-msgs-dev", "ros-geometry-msgs", "python3-rospy", "libboost-dev"}
        ),
        installed=frozenset({"libboost-dev", "ros-geometry-msgs"}),
    )
    assert [(one.severity.value, one.what, one.mend) for one in found] == [
        (
            "error",
            "geometry_msgs is not installed, needed to build user",
            "apt-get install libgeometry-msgs-dev",
        ),
        ("warning", "rospy is not installed, needed to run user", "apt-get install python3-rospy"),
        (
            "warning",
            "eigen is neither in the workspace nor installed as a package of that name,"
            " needed to run user",
            f"rosdep install --from-paths {workspace}",
        ),
    ]


def test_names_in_debian() -> None:
    assert debian_names("tf2_ros") == [
        "libtf2-ros-dev",
        "ros-tf2-ros",
        "python3-tf2-ros",
        "tf2-ros",
    ]
    assert debian_names("tf2_ros", distribution="noetic")[0] == "ros-noetic-tf2-ros"


def test_flags_that_do_not_go_together(workspace: Path) -> None:
    lists = LISTS + (
        b"# -fsanitize=address in a comment\n"
        b'set(CMAKE_CXX_FLAGS "${CMAKE_CXX_FLAGS}\n -fsanitize=thread -O1")\n'
        b"target_link_options(x PRIVATE -static -static-libgcc)\n"
    )
    # Two lines of LISTS, one comment, the argument begins on line 4.
    assert unsuited_flags(lists) == [(5, "-fsanitize=thread"), (6, "-static")]
    (workspace / "src/arm/CMakeLists.txt").write_bytes(lists)
    assert [(one.severity, one.where) for one in check(workspace)] == [
        (Severity.WARNING, f"{workspace}/src/arm/CMakeLists.txt:5"),
        (Severity.WARNING, f"{workspace}/src/arm/CMakeLists.txt:6"),
    ]


def test_blocks(workspace: Path) -> None:
    path = workspace / "src/arm/CMakeLists.txt"
    path.write_bytes(patch_text(LISTS, CMAKE_FILE))
    assert check(workspace) == []
    path.write_bytes(patch_text(LISTS, "/old/tpc.cmake"))
    assert only(check(workspace)) == (
        "warning",
        "TPC's block points to another installation",
        str(path),
        "pytpc patch WORKSPACE",
    )
    path.write_bytes(patch_text(LISTS, CMAKE_FILE).replace(b" OPTIONAL", b""))
    severity, what, where, _ = only(check(workspace))
    assert (severity, where) == ("warning", f"{path}:1")
    assert "edited by hand" in what


def cache(folder: Path, source: Path, compiler: str, toolchain: str = "") -> None:
    folder.mkdir(parents=True)
    (folder / "CMakeCache.txt").write_text(
        f"# a comment\nCMAKE_CXX_COMPILER:FILEPATH={compiler}\n"
        f"CMAKE_HOME_DIRECTORY:INTERNAL={source}\n"
        + (f"CMAKE_TOOLCHAIN_FILE:UNINITIALIZED={toolchain}\n" if toolchain else ""),
        encoding="utf-8",
    )


def test_build_folders_keep_their_compiler(workspace: Path) -> None:
    arm = workspace / "src/arm"
    own = workspace / ".tpc/build/arm"
    cache(own, arm, "/usr/bin/c++")
    assert only(check(workspace))[2:] == (str(own), f"rm -r {own}")
    (own / "CMakeCache.txt").unlink()
    own.rmdir()
    cache(own, arm, "/usr/bin/clang++-19", CMAKE_FILE)
    assert check(workspace) == []
    plain = workspace / "build/arm"
    # Where nobody named a compiler, clang takes its place.
    cache(plain, arm, "/usr/bin/c++")
    assert check(workspace) == []
    (plain / "CMakeCache.txt").unlink()
    plain.rmdir()
    cache(plain, arm, "/usr/bin/g++")
    assert only(check(workspace))[:3] == (
        "note",
        "was configured with the compiler /usr/bin/g++: a patched package needs another"
        " build folder",
        str(plain),
    )
    (arm / "CMakeLists.txt").write_bytes(patch_text(LISTS, CMAKE_FILE))
    severity, what, where, mend = only(check(workspace))
    assert (severity, where, mend) == ("warning", str(plain), f"rm -r {plain}")
    assert "the compiler /usr/bin/g++" in what


def test_the_one_build_folder_of_catkin_make(workspace: Path) -> None:
    cache(workspace / "build", workspace / "src", "/usr/bin/g++")
    assert only(check(workspace))[0] == "note"
    (workspace / "src/arm/CMakeLists.txt").write_bytes(patch_text(LISTS, CMAKE_FILE))
    assert only(check(workspace))[0] == "warning"


def test_a_c_project_has_its_compiler() -> None:
    text = "CMAKE_C_COMPILER:STRING=/usr/bin/cc\nCMAKE_HOME_DIRECTORY:INTERNAL=/s\n"
    found = read_cache(text, Path("/b"))
    assert (found.compiler, found.source, found.toolchain) == ("/usr/bin/cc", Path("/s"), "")


def test_a_name_that_is_not_utf8(workspace: Path) -> None:
    odd = os.fsdecode(os.fsencode(workspace / "src/arm") + b"/caf\xe9.cpp")
    Path(odd).touch()
    severity, _, where, _ = only(check(workspace))
    assert (severity, where) == ("warning", f"{workspace}/src/arm/caf\\xe9.cpp")


def test_what_is_installed_is_looked_for(
    workspace: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    add_package(tmp_path / "overlay/share/claw")
    monkeypatch.setenv("CMAKE_PREFIX_PATH", str(tmp_path / "overlay"))
    assert "claw" in look_at_known(workspace).packages
    # A package of ROS 2 is of no use to one of ROS 1 that needs its name.
    index = tmp_path / "overlay/share/ament_index/resource_index/packages"
    index.mkdir(parents=True)
    (index / "claw").touch()
    assert "claw" not in look_at_known(workspace).packages


# --- the command


@pytest.fixture
def sound(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A machine with nothing wrong, and one package of an installed half."""
    monkeypatch.setattr(machine_commands, "look_at_machine", lambda _folder: Machine())
    monkeypatch.setattr(machine_commands, "check_machine", lambda _machine, **_: [])
    monkeypatch.setenv("TPC_PREFIX", str(tmp_path / "prefix"))
    install_prefix(tmp_path / "prefix")


def run(*arguments: object) -> tuple[int, str, str]:
    result = CliRunner().invoke(main, ["doctor", *map(str, arguments)])
    return result.exit_code, result.stdout, result.stderr


def test_all_is_well(workspace: Path, sound: None) -> None:
    assert run(workspace) == (0, "no problems found\n", "")
    assert run() == (0, "no problems found\n", "")
    assert run(workspace, "--json") == (0, "[]\n", "")


def test_a_warning_is_shown_and_is_no_failure(workspace: Path, sound: None) -> None:
    (workspace / "src/arm/CMakeLists.txt").write_bytes(LISTS + b"add_link_options(-static)\n")
    status, out, _ = run(workspace)
    assert status == 0
    assert "-static cannot be combined" in out
    assert out.splitlines()[-1] == "1 warning"


def test_an_error_is_a_failure(workspace: Path, sound: None) -> None:
    (workspace / "src/arm/CMakeLists.txt").write_bytes(b"add_link_options(-static)\nx(")
    status, out, _ = run(workspace, "--json")
    data: Any = json.loads(out)
    assert status == 1
    assert [one["severity"] for one in data] == ["error"]
    assert data[0]["where"] == f"{workspace}/src/arm/CMakeLists.txt:2"
    assert run(workspace / "none")[0] == 1
