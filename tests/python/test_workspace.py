"""Finding and reading the packages of a workspace, and the tools that a build needs."""

import os
from pathlib import Path

import pytest
from packages import MANIFEST, add_package

from pytpc.base import paths
from pytpc.base.errors import InputError, MissingToolError, WorkspaceError
from pytpc.workspace.packages import find_packages, read_cmakelists, select_packages


def names(workspace: Path) -> list[str]:
    return [package.name for package in find_packages(workspace)]


def test_packages_are_found_at_any_depth_sorted_by_path(tmp_path: Path) -> None:
    add_package(tmp_path / "src/b/deep/er/zebra")
    add_package(tmp_path / "src/b/ape")
    add_package(tmp_path / "src/a/yak")
    assert names(tmp_path) == ["yak", "ape", "zebra"]


def test_a_folder_may_itself_be_a_package_and_packages_do_not_nest(tmp_path: Path) -> None:
    add_package(tmp_path, "outer")
    add_package(tmp_path / "test/inner")
    assert names(tmp_path) == ["outer"]


@pytest.mark.parametrize("marker", ["COLCON_IGNORE", "CATKIN_IGNORE", "AMENT_IGNORE"])
def test_marked_folders_are_skipped(tmp_path: Path, marker: str) -> None:
    add_package(tmp_path / "src/kept")
    add_package(tmp_path / "src/group/one")
    (tmp_path / "src/group" / marker).touch()
    (add_package(tmp_path / "src/two") / marker).touch()
    assert names(tmp_path) == ["kept"]


@pytest.mark.parametrize("folder", ["build", "install", "log", "devel", ".git", ".tpc"])
def test_products_and_hidden_folders_are_skipped(tmp_path: Path, folder: str) -> None:
    add_package(tmp_path / "src/kept")
    add_package(tmp_path / folder / "share/kept")
    add_package(tmp_path / "nested" / folder / "share/kept")
    assert names(tmp_path) == ["kept"]


def test_a_package_may_be_called_like_a_product(tmp_path: Path) -> None:
    add_package(tmp_path / "src/log")
    assert names(tmp_path) == ["log"]


def test_symbolic_links_are_followed_once(tmp_path: Path) -> None:
    add_package(tmp_path / "elsewhere/arm")
    (tmp_path / "ws/src").mkdir(parents=True)
    (tmp_path / "ws/src/arm").symlink_to(tmp_path / "elsewhere/arm")
    (tmp_path / "ws/src/loop").symlink_to(tmp_path / "ws")
    (tmp_path / "ws/src/second").symlink_to(tmp_path / "elsewhere/arm")
    (found,) = find_packages(tmp_path / "ws")
    assert found.path == tmp_path / "ws/src/arm"


def test_build_types_follow_their_conditions(tmp_path: Path) -> None:
    both = (
        '<export><build_type condition="$ROS_VERSION == 1">catkin</build_type>'
        '<build_type condition="$ROS_VERSION == 2">ament_cmake</build_type></export>'
    )
    add_package(tmp_path / "a", more="<export><build_type>cmake</build_type></export>")
    add_package(tmp_path / "b", more=both)
    add_package(tmp_path / "c")
    types = [package.build_type for package in find_packages(tmp_path)]
    assert types == ["cmake", "catkin", "catkin"]


@pytest.mark.parametrize("there", [False, True])
def test_a_workspace_without_packages_is_one_clear_line(tmp_path: Path, there: bool) -> None:
    folder = tmp_path / "ws"
    if there:
        (folder / "src").mkdir(parents=True)
    with pytest.raises(WorkspaceError) as caught:
        find_packages(folder)
    reason = "no packages here: no package.xml in this folder or below; give the one with src"
    assert str(caught.value) == f"{folder}: {reason if there else 'no such folder'}"


def test_two_packages_with_one_name_are_both_named(tmp_path: Path) -> None:
    one, two = add_package(tmp_path / "one", "arm"), add_package(tmp_path / "two", "arm")
    with pytest.raises(WorkspaceError) as caught:
        find_packages(tmp_path)
    assert str(caught.value) == f"{tmp_path}: package arm occurs twice: {one} and {two}"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", ":1: not XML: no element found, column 1"),
        ("<package>\n <name>a</nam>\n</package>", ":2: not XML: mismatched tag, column 11"),
        ("<package>\n\n<name>a & b</name></package>", ":3: not XML: not well-formed"),
        ('<?xml version="1.0" encoding="klingon"?><package/>', ": not a package manifest: "),
        ("<packet/>", ': not a package manifest: The manifest must contain a single "package"'),
        ("<package><version>1.0.0</version></package>", ": not a package manifest: "),
        ('<package format="9"/>', ": not a package manifest: "),
        ('<package format="two"/>', ": not a package manifest: "),
        (
            MANIFEST.format(name="Bad Name!", more="<depends>x</depends>"),
            ": not a package manifest",
        ),
    ],
)
def test_a_broken_manifest_is_one_line_with_its_place(
    tmp_path: Path, text: str, expected: str
) -> None:
    add_package(tmp_path / "a")
    broken = tmp_path / "b" / "package.xml"
    broken.parent.mkdir()
    broken.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        find_packages(tmp_path)
    assert str(caught.value).startswith(f"{broken}{expected}")
    assert "\n" not in str(caught.value)


def test_packages_are_selected_in_their_own_order(tmp_path: Path) -> None:
    for name in ("arm", "face", "leg"):
        add_package(tmp_path / name)
    found = find_packages(tmp_path)
    assert [package.name for package in select_packages(found, ["leg", "arm"])] == ["arm", "leg"]
    assert select_packages(found, []) == found
    with pytest.raises(
        WorkspaceError, match="no package fcae in this workspace; did you mean face"
    ):
        select_packages(found, ["arm", "fcae"])
    with pytest.raises(WorkspaceError, match="there are: arm, face, leg"):
        select_packages(found, ["zzz"])


def test_a_cmakelists_is_read_and_checked(tmp_path: Path) -> None:
    (package,) = find_packages(add_package(tmp_path / "arm"))
    assert read_cmakelists(package) is None
    package.cmakelists.write_bytes(b"project(arm)\r\n")
    assert read_cmakelists(package) == b"project(arm)\r\n"
    package.cmakelists.write_bytes(b'project(arm)\n\nmessage("x)\n')
    with pytest.raises(InputError) as caught:
        read_cmakelists(package)
    assert (caught.value.path, caught.value.line) == (str(package.cmakelists), 3)
    package.cmakelists.unlink()
    package.cmakelists.symlink_to(tmp_path / "nowhere")
    with pytest.raises(InputError, match="a symbolic link that leads nowhere"):
        read_cmakelists(package)
    package.cmakelists.unlink()
    package.cmakelists.mkdir()
    with pytest.raises(InputError, match="cannot be read: Is a directory"):
        read_cmakelists(package)


def test_the_installed_half_is_below_the_prefix(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("TPC_PREFIX", str(tmp_path))
    places = {
        "lib/tpc/TpcPasses.so": paths.plugin,
        "lib/libtpc_log.so": paths.log_library,
        "share/tpc/cmake/tpc.cmake": paths.cmake_file,
    }
    for place, find in places.items():
        with pytest.raises(MissingToolError, match="make setup") as caught:
            find()
        assert caught.value.path == str(tmp_path / place)
        (tmp_path / place).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / place).touch()
        assert find() == tmp_path / place


def test_without_a_prefix_the_projects_own_build_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("TPC_PREFIX", raising=False)
    assert paths.prefix() == Path(__file__).resolve().parents[2] / "build" / "install"


def test_the_systems_programs_come_first(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "/home/me/bin::/bin:/opt/bin:/usr/bin")
    assert paths.search_path() == "/usr/bin:/bin:/home/me/bin:/opt/bin"


def add_program(folder: Path, name: str) -> None:
    (folder / name).write_text("#!/bin/sh\n", encoding="ascii")
    (folder / name).chmod(0o755)


def test_absent_tools_are_one_line_with_the_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(paths, "SYSTEM_PATH", str(tmp_path))
    monkeypatch.setenv("PATH", str(tmp_path))
    for name in paths.build_tools():
        add_program(tmp_path, name)
    assert paths.require_tools()["clang-19"] == tmp_path / "clang-19"
    (tmp_path / "llvm-ranlib-19").unlink()
    with pytest.raises(MissingToolError) as caught:
        paths.require_tools()
    assert str(caught.value) == (
        "llvm-ranlib-19 not found on this machine; install it with: apt-get install llvm-19"
    )
    (tmp_path / "clang-19").unlink()
    (tmp_path / "clang++-19").unlink()
    with pytest.raises(MissingToolError) as caught:
        paths.require_tools()
    assert str(caught.value) == (
        "clang-19, clang++-19 and llvm-ranlib-19 not found on this machine; install it with:"
        " apt-get install clang-19 llvm-19"
    )


def test_ros_is_looked_for_in_every_prefix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    catkin, roscpp = tmp_path / "catkin", tmp_path / "roscpp"
    config = catkin / "share/catkin/cmake/catkinConfig.cmake"
    header = roscpp / "include/ros/ros.h"
    monkeypatch.setattr(paths, "ROS_PREFIXES", [])
    monkeypatch.setenv("CMAKE_PREFIX_PATH", f"{catkin}{os.pathsep}{roscpp}")
    with pytest.raises(
        MissingToolError, match="catkin and roscpp of ROS 1 not found on this machine"
    ):
        paths.require_ros()
    config.parent.mkdir(parents=True)
    config.touch()
    with pytest.raises(MissingToolError, match=r"^roscpp of ROS 1 not found"):
        paths.require_ros()
    header.parent.mkdir(parents=True)
    header.touch()
    paths.require_ros()


@pytest.mark.parametrize("marker", [".built_by", ".catkin", ".colcon_install_layout"])
def test_spaces_of_any_name_that_a_tool_has_marked_are_skipped(tmp_path: Path, marker: str) -> None:
    add_package(tmp_path / "src/arm")
    add_package(tmp_path / "space/share/arm")
    (tmp_path / "space" / marker).touch()
    assert [package.path for package in find_packages(tmp_path)] == [tmp_path / "src/arm"]
