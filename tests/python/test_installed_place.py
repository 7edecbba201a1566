"""Installed from a wheel: which C++ half is used, what messages say, and whose programs build."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from pytpc.base import paths
from pytpc.base.errors import MissingToolError
from pytpc.workspace.colcon import build_environment
from pytpc.workspace.doctor.machine import unlinked_in
from pytpc.workspace.toolchain import mixin_index


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Pytpc as a wheel installs it, with the halves for 19 and 22; no compiler is installed."""
    for release in ("19", "22"):
        share = tmp_path / f"native/llvm-{release}/share/tpc"
        share.mkdir(parents=True)
        (share / "clang-version").write_text(f"{release}\n")
    (tmp_path / "bin").mkdir()
    monkeypatch.setattr(paths, "_CARRIED", tmp_path / "native")
    monkeypatch.setattr(paths, "is_checkout", lambda: False)
    monkeypatch.setattr(paths, "SYSTEM_PATH", str(tmp_path / "bin"))
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))
    for name in ("TPC_PREFIX", "TPC_CLANG_VERSION", "CONDA_PREFIX"):
        monkeypatch.delenv(name, raising=False)
    return tmp_path


def add_program(folder: Path, name: str) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text("#!/bin/sh\n")
    (folder / name).chmod(0o755)


def test_the_half_is_that_of_the_compiler_which_is_there(place: Path) -> None:
    assert paths.prefix() == place / "native/llvm-19"
    add_program(place / "bin", "clang++-22")
    assert paths.prefix() == place / "native/llvm-22"
    assert paths.clang_release() == "22"
    assert "ld.lld-22" in paths.build_tools()
    # With both, the one that is built by default.
    add_program(place / "bin", "clang++-19")
    assert paths.prefix() == place / "native/llvm-19"


def test_a_release_can_be_chosen(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    add_program(place / "bin", "clang++-19")
    monkeypatch.setenv("TPC_CLANG_VERSION", "22")
    assert paths.prefix() == place / "native/llvm-22"
    monkeypatch.setenv("TPC_CLANG_VERSION", "18")
    with pytest.raises(MissingToolError) as caught:
        paths.plugin()
    assert str(caught.value) == (
        "TPC_CLANG_VERSION is 18: TPC works with clang 19 and 22; unset TPC_CLANG_VERSION"
    )


def test_a_chosen_prefix_says_its_own_release(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TPC_PREFIX", str(place / "native/llvm-22"))
    assert paths.clang_release() == "22"


def test_an_older_clang_is_refused_by_name(place: Path) -> None:
    add_program(place / "bin", "clang-14")
    add_program(place / "bin", "clang-format-19")
    add_program(place / "bin", "clang-18")
    with pytest.raises(MissingToolError) as caught:
        paths.require_tools(["clang-19"])
    assert str(caught.value) == (
        "clang-19 not found on this machine (here is clang 14 and 18; TPC works with clang 19"
        " and 22); install it with: apt-get install clang-19"
    )


def test_an_incomplete_wheel_is_installed_again(place: Path) -> None:
    with pytest.raises(MissingToolError) as caught:
        paths.plugin()
    assert "-m pip install --force-reinstall --no-deps WHEEL" in str(caught.value)
    assert "make setup" not in str(caught.value)


def test_an_incomplete_debian_package_is_installed_again(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(paths, "_DEBIAN_HOME", place)
    assert paths.how_to_install() == "apt-get install --reinstall pytpc"


def test_the_mixin_of_a_wheel_is_filled_in(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(place / "data"))
    prefix = place / "native/llvm-19"
    (prefix / "share/tpc/colcon").mkdir()
    (prefix / "share/tpc/colcon/index.yaml").write_text("mixin: [tpc.mixin]\n")
    mixin = prefix / "share/tpc/colcon/tpc.mixin"
    mixin.write_text("x: '-DCMAKE_TOOLCHAIN_FILE=@TPC_CMAKE_FILE@'\n")
    index = mixin_index(prefix)
    assert index == place / "data/tpc/colcon/llvm-19/index.yaml"
    assert index.read_text() == "mixin: [tpc.mixin]\n"
    assert index.with_name("tpc.mixin").read_text() == (
        f"x: '-DCMAKE_TOOLCHAIN_FILE={prefix}/share/tpc/cmake/tpc.cmake'\n"
    )
    # Where CMake configured it, it is used as it is.
    mixin.write_text("x: '-DCMAKE_TOOLCHAIN_FILE=/opt/tpc/share/tpc/cmake/tpc.cmake'\n")
    assert mixin_index(prefix) == prefix / "share/tpc/colcon/index.yaml"


def test_what_the_log_library_lacks_is_named() -> None:
    said = "\tlibroscpp.so.4d => not found\n\tlibc.so.6 => /lib/libc.so.6 (0x00007f)\n"
    assert unlinked_in(said) == ("libroscpp.so.4d",)


def test_a_build_leaves_conda_out(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    conda = place / "conda"
    monkeypatch.setenv("CONDA_PREFIX", str(conda))
    monkeypatch.setenv("CONDA_DEFAULT_ENV", "base")
    monkeypatch.setenv("PYTHONHOME", str(conda))
    monkeypatch.setenv("LDFLAGS", f"-L{conda}/lib")
    monkeypatch.setenv("CFLAGS", "-O1")
    folders = {
        "PATH": f"{conda}/bin:/opt/tools/bin",
        "LD_LIBRARY_PATH": f"{conda}/lib:/opt/ros/noetic/lib",
        "CMAKE_PREFIX_PATH": f"{conda}:{conda}/x86_64-conda-linux-gnu/sysroot/usr:/opt/ros/noetic",
    }
    for name, value in folders.items():
        monkeypatch.setenv(name, value)
    environment = build_environment()
    assert environment["PATH"] == f"{place}/bin:/opt/tools/bin"
    assert environment["LD_LIBRARY_PATH"] == "/opt/ros/noetic/lib"
    assert environment["CMAKE_PREFIX_PATH"] == "/opt/ros/noetic"
    assert environment["CFLAGS"] == "-O1"
    assert not {"CONDA_PREFIX", "CONDA_DEFAULT_ENV", "PYTHONHOME", "LDFLAGS"} & set(environment)
    assert os.environ["CONDA_PREFIX"] == str(conda)


def test_a_conda_environment_with_ros_is_used(place: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    conda = place / "conda"
    header = conda / "include/ros/ros.h"
    header.parent.mkdir(parents=True)
    header.touch()
    monkeypatch.setenv("CONDA_PREFIX", str(conda))
    monkeypatch.setenv("CMAKE_PREFIX_PATH", str(conda))
    assert build_environment()["CMAKE_PREFIX_PATH"] == str(conda)


def test_the_shims_of_pyenv_are_no_place_for_programs(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (place / "pyenv/versions").mkdir(parents=True)
    add_program(place / "pyenv/shims", "cmake")
    (place / "shims").mkdir()
    monkeypatch.setenv("PATH", f"{place}/pyenv/shims:{place}/shims")
    assert paths.search_path() == f"{place}/bin:{place}/shims"
