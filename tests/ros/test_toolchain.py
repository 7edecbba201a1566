"""What `pytpc toolchain` prints, pasted into a shell: each tool builds, and is analysed."""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner
from test_build_workspace import make_package

from pytpc.base.errors import MissingToolError
from pytpc.base.paths import cmake_file, installed, log_library, plugin
from pytpc.cli.main import main
from pytpc.static.static_info import collect
from pytpc.workspace.colcon import build_environment

try:
    for half in (cmake_file, plugin, log_library):
        half()
    installed("share/tpc/colcon/index.yaml")
except MissingToolError as error:
    pytest.skip(f"the C++ half is not installed: {error}", allow_module_level=True)


def instructions(tool: str, *options: str) -> str:
    result = CliRunner().invoke(main, ["toolchain", tool, *options])
    assert result.exit_code == 0, result.output
    return result.stdout


def paste(text: str, folder: Path, programs: Path) -> str:
    """Run the commands as a person would, those of ``pytpc`` left out."""
    lines = [line for line in text.splitlines() if not line.startswith("pytpc ")]
    inherited = build_environment()
    environment = {
        **{name: inherited[name] for name in inherited if not name.startswith("COLCON_")},
        "PATH": f"{programs}{os.pathsep}{inherited['PATH']}",
        "HOME": str(programs.parent),
        "COLCON_HOME": str(programs.parent / "colcon"),
        "MAKEFLAGS": "-j2",
    }
    ran = subprocess.run(
        ["sh", "-e"],
        input="\n".join(lines),
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=500,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran.stdout


@pytest.fixture
def programs(tmp_path: Path) -> Path:
    """A folder for programs that come first on PATH."""
    folder = tmp_path / "bin"
    folder.mkdir()
    return folder


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    folder = tmp_path / "a workspace"
    make_package(folder)
    return folder


def assert_analysed(folder: Path) -> None:
    (unit,) = collect(folder).units
    assert (unit.link_unit, unit.status) == ("tiny_node", "ok")
    (found,) = (one for one in unit.comparisons if one.type != "constant")
    assert (found.source, found.lineno) == ("limit", 10)


def test_plain_cmake(workspace: Path, programs: Path) -> None:
    paste(instructions("cmake"), workspace / "src/tiny", programs)
    assert_analysed(workspace / "src/tiny/build_tpc")


@pytest.mark.skipif(shutil.which("catkin_make") is None, reason="catkin_make is not installed")
def test_catkin_make(workspace: Path, programs: Path) -> None:
    paste(instructions("catkin_make"), workspace, programs)
    assert_analysed(workspace / "build_tpc")
    assert (workspace / "devel_tpc/lib/tiny/tiny_node").is_file()
    assert not (workspace / "devel").exists()


@pytest.mark.skipif(shutil.which("catkin") is None, reason="catkin_tools is not installed")
def test_catkin_tools(workspace: Path, programs: Path) -> None:
    (workspace / ".catkin_tools").mkdir()
    paste(instructions("catkin_tools"), workspace, programs)
    assert_analysed(workspace / "build_tpc")
    assert (workspace / "devel_tpc/lib/tiny/tiny_node").exists()


OTHERS = """build:
  rel-with-deb-info:
    cmake-args: ['-DCMAKE_BUILD_TYPE=RelWithDebInfo']
  ccache:
    cmake-args: ['-DCMAKE_C_COMPILER_LAUNCHER=ccache', '-DCMAKE_CXX_COMPILER_LAUNCHER=ccache']
  ninja:
    cmake-args: ['-GNinja']
"""


@pytest.mark.skipif(
    importlib.util.find_spec("colcon_mixin") is None, reason="colcon-mixin is not installed"
)
@pytest.mark.skipif(shutil.which("ccache") is None, reason="ccache is not installed")
def test_colcon_with_the_usual_mixins(workspace: Path, programs: Path) -> None:
    colcon = programs / "colcon"
    start = "import sys; from colcon_core.command import main; sys.exit(main())"
    colcon.write_text(f'#!/bin/sh\nexec {sys.executable} -c "{start}" "$@"\n', encoding="utf-8")
    colcon.chmod(0o755)
    others = programs.parent / "others"
    others.mkdir()
    (others / "others.mixin").write_text(OTHERS, encoding="utf-8")
    (others / "index.yaml").write_text("mixin: [others.mixin]\n", encoding="utf-8")
    ours = instructions("colcon", "--profile", "thesis")
    text = f"colcon mixin add usual {(others / 'index.yaml').as_uri()}\ncolcon mixin update\n{ours}"
    text = text.replace("--mixin tpc ", "--mixin tpc rel-with-deb-info ccache ninja tpc-constants ")
    assert "tpc-constants" in text
    paste(text, workspace, programs)
    assert_analysed(workspace / "build_tpc")
    cache = (workspace / "build_tpc/tiny/CMakeCache.txt").read_text(encoding="utf-8")
    for line in (
        "CMAKE_GENERATOR:INTERNAL=Ninja",
        "CMAKE_BUILD_TYPE:STRING=RelWithDebInfo",
        "CMAKE_CXX_COMPILER_LAUNCHER:UNINITIALIZED=ccache",
        "TPC_PROFILE:UNINITIALIZED=thesis",
        "TPC_CONSTANTS:UNINITIALIZED=ON",
    ):
        assert line in cache
    assert sorted(path.name for path in workspace.iterdir()) == [
        "build_tpc",
        "install_tpc",
        "log",
        "src",
    ]
