"""tpc.cmake finds packages that no install() rule installs where they were built.

The folders are as colcon and catkin leave them; the configuration files are shortened.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from pytpc.base.errors import MissingToolError
from pytpc.base.paths import SYSTEM_PATH, cmake_file

try:
    TOOLCHAIN = cmake_file()
except MissingToolError as error:
    pytest.skip(f"the C++ half is not installed: {error}", allow_module_level=True)

# The lines of catkin's pkgConfig.cmake.in that say what a package gives to others.
CONFIG = """if(NOT "include " STREQUAL " ")
  set(_include_dirs "include")
endif()
set(libraries "core;boost_thread")
set(core_FOUND_IN "{place}")
"""
LISTS = """cmake_minimum_required(VERSION 3.16)
project(robot NONE)
find_package(core REQUIRED NO_MODULE PATHS "${TPC_BASE}/install/core")
message(STATUS "core is in ${core_FOUND_IN}")
"""


def write(path: Path, text: str = "") -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)


@pytest.fixture
def base(tmp_path: Path) -> Path:
    """The folder of a build: a package whose header and library are not installed."""
    base, source = tmp_path / "a ws/.tpc", tmp_path / "a ws/src/core"
    write(source / "include/core/core.h")
    write(base / "build/core/devel/.catkin", str(source))
    write(base / "build/core/devel/lib/libcore.so")
    for prefix, place in (("build/core/devel", "devel"), ("install/core", "install")):
        config = base / prefix / "share/core/cmake/coreConfig.cmake"
        write(config, CONFIG.format(place=place))
    write(tmp_path / "robot/CMakeLists.txt", LISTS)
    return base


def place_of_core(base: Path) -> str:
    robot = base.parents[1] / "robot"
    given = (f"-DCMAKE_TOOLCHAIN_FILE={TOOLCHAIN}", f"-DTPC_BASE={base}")
    ran = subprocess.run(
        ["cmake", "-S", robot, "-B", robot / "build", *given],
        env={"PATH": SYSTEM_PATH},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ran.returncode == 0, ran.stderr
    (line,) = (line for line in ran.stdout.splitlines() if "core is in" in line)
    return line.rpartition(" ")[2]


def install(base: Path, *what: str) -> None:
    for name in what:
        write(base / "install/core" / name)


def test_what_is_not_installed_is_found_where_it_was_built(base: Path) -> None:
    assert place_of_core(base) == "devel"
    # Generated headers alone do not make it complete, as in a package with messages.
    install(base, "include/core/Message.h", "lib/libcore.so")
    assert place_of_core(base) == "devel"
    # With rules for all of it, the installed package is taken; boost_thread is another's.
    install(base, "include/core/core.h")
    assert place_of_core(base) == "install"


def test_without_its_library_it_is_not_installed(base: Path) -> None:
    install(base, "include/core/core.h")
    assert place_of_core(base) == "devel"


def test_a_package_that_was_installed_is_taken_from_there(base: Path) -> None:
    install(base, "include/core/core.h", "lib/libcore.so")
    assert place_of_core(base) == "install"
    # A build folder that was never configured says nothing.
    shutil.rmtree(base / "build/core")
    assert place_of_core(base) == "install"
