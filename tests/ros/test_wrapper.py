"""Real builds that are not CMake, by the compiler wrappers: make, Autoconf and Meson."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from pytpc.base.errors import MissingToolError
from pytpc.base.paths import installed, log_library, plugin, prefix
from pytpc.ingest.reading import read
from pytpc.recording.events import Events
from pytpc.ros.ros1.graph import RosGraph
from pytpc.static.link_unit import LinkUnit
from pytpc.static.static_info import collect
from pytpc.workspace.colcon import build_environment

try:
    for half in (plugin, log_library):
        half()
    WRAPPER = installed("bin/tpc-clang++")
except MissingToolError as error:
    pytest.skip(f"the C++ half is not installed: {error}", allow_module_level=True)

# The read stands on line 4, the comparison on line 8, the publish on line 11.
STEP = """#include "step.h"
#include <std_msgs/Float64.h>
Stepper::Stepper() {
  nh_.param("limit", limit_, 0.5);
  pub_ = nh_.advertise<std_msgs::Float64>("out", 1);
}
void Stepper::step(double value) {
  if (value > limit_) {
    std_msgs::Float64 message;
    message.data = value;
    pub_.publish(message);
  }
}
"""
HEADER = """#pragma once
#include <ros/ros.h>
struct Stepper {
  Stepper();
  void step(double value);
  ros::NodeHandle nh_;
  ros::Publisher pub_;
  double limit_;
};
"""
# Nine steps: 0, 0.125, ..., 1.0; the last four are above the limit.
NODE = """#include "step.h"
int main(int argc, char **argv) {
  ros::init(argc, argv, "stepper");
  Stepper stepper;
  for (int i = 0; i < 9; ++i)
    stepper.step(i * 0.125);
}
"""
MAKEFILE = """CXXFLAGS = -O2 -Wall -Werror -fPIC $(shell pkg-config --cflags roscpp)
LDLIBS = $(shell pkg-config --libs roscpp)
all: whole parted
%.o: %.cpp step.h
\t$(CXX) $(CXXFLAGS) -c $< -o $@
libstep.a: step.o
\t$(AR) rcs $@ $^
libstep.so.1: step.o
\t$(CXX) -shared -Wl,-soname,$@ $^ -o $@ $(LDLIBS)
whole: node.o libstep.a
\t$(CXX) node.o -L. -l:libstep.a $(LDLIBS) -o $@
parted: node.o libstep.so.1
\t$(CXX) node.o ./libstep.so.1 -Wl,-rpath,'$$ORIGIN' $(LDLIBS) -o $@
"""
MANIFEST = """<package format="2">
  <name>stepper</name><version>0.1.0</version><description>d</description>
  <maintainer email="a@b.org">a</maintainer><license>x</license>
</package>
"""


def environment(**more: str) -> dict[str, str]:
    """That of a person who has exported what `pytpc toolchain cc` prints."""
    kept = {name: value for name, value in build_environment().items() if "TPC" not in name}
    folder = prefix() / "bin"
    tools = {"CC": "tpc-clang", "CXX": "tpc-clang++", "AR": "tpc-ar", "RANLIB": "tpc-ranlib"}
    return {**kept, **{name: str(folder / tool) for name, tool in tools.items()}, **more}


def run(command: list[str], folder: Path, **more: str) -> subprocess.CompletedProcess[str]:
    ran = subprocess.run(
        command,
        cwd=folder,
        env=environment(**more),
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout + ran.stderr
    return ran


def project(folder: Path) -> Path:
    """The sources and the manifest of a package, without a build of any kind."""
    folder.mkdir(parents=True)
    files = {"step.cpp": STEP, "step.h": HEADER, "node.cpp": NODE, "package.xml": MANIFEST}
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    return folder


def units_of(folder: Path) -> dict[str, LinkUnit]:
    return {unit.link_unit: unit for unit in collect(folder).units}


def assert_found(unit: LinkUnit, file: str = "step.cpp") -> None:
    (found,) = (one for one in unit.comparisons if one.type != "constant")
    assert (unit.package, unit.status) == ("stepper", "ok")
    assert (found.source, found.relation, found.default) == ("limit", ">", 0.5)
    assert (found.file, found.lineno) == (file, 8)
    assert (found.read_at.lineno, found.exposed_at.lineno) == (4, 11)


def reports(program: Path, folder: Path) -> Events:
    """What a node reports of its comparisons when it runs in a real graph."""
    files = folder / "reports"
    settings = {"TPC_SINK": "file", "TPC_FOLDER": str(files), "TPC_FILE_RESERVE": "0"}
    with RosGraph(build_environment(), folder) as graph:
        node = graph.start("stepper", [str(program)], env=settings)
        assert node.popen.wait(20) == 0, node.tail()
    return read(sorted(files.glob("*.tpc"))).events


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A project with a Makefile, in a folder with a space, built by a parallel make."""
    folder = project(tmp_path_factory.mktemp("made") / "a folder")
    (folder / "Makefile").write_text(MAKEFILE, encoding="utf-8")
    ran = run(["make", "-j4"], folder)
    assert ran.stderr == ""
    return folder


def test_each_link_unit_of_a_makefile_has_what_is_in_it(made: Path) -> None:
    units = units_of(made)
    assert sorted(units) == ["parted", "step", "whole"]
    assert_found(units["whole"])
    assert_found(units["step"])
    assert [one for one in units["parted"].comparisons if one.type != "constant"] == []


@pytest.mark.parametrize("program", ["whole", "parted"])
def test_the_nodes_run_and_report(made: Path, tmp_path: Path, program: str) -> None:
    said = reports(made / program, tmp_path)
    assert len(said) == 9
    over = said.cmp == 0.625
    assert (said.thresh[over].tolist(), said.res[over].tolist()) == ([0.5], [1])
    assert said.res.sum() == 4


def test_a_changed_file_changes_the_static_information(made: Path, tmp_path: Path) -> None:
    folder = tmp_path / "copy"
    shutil.copytree(made, folder)
    run(["make"], folder)
    (folder / "step.cpp").write_text("\n" + STEP, encoding="utf-8")
    run(["make", "-j4"], folder)
    for name in ("whole", "step"):
        (found,) = (one for one in units_of(folder)[name].comparisons if one.type != "constant")
        assert found.lineno == 9


CONFIGURE = """AC_INIT([stepper], [0.1])
AC_CONFIG_HEADERS([config.h])
AC_PROG_CC
AC_PROG_CXX
AC_LANG([C++])
AC_C_BIGENDIAN
AC_CHECK_SIZEOF([long])
AC_CHECK_HEADERS([sys/epoll.h no_such_header.h])
AC_CHECK_FUNCS([epoll_create1 no_such_function])
AC_CHECK_LIB([m], [cos])
AC_CHECK_LIB([m], [no_such_function_either])
AC_COMPILE_IFELSE([AC_LANG_PROGRAM([[static_assert(sizeof(int) == 3, "");]])],
  [AC_DEFINE([ODD], [1], [never])])
AC_CONFIG_FILES([Makefile])
AC_OUTPUT
"""


@pytest.mark.skipif(shutil.which("autoconf") is None, reason="autoconf is not installed")
def test_a_configure_script_finds_what_it_finds_with_clang(tmp_path: Path) -> None:
    sources = project(tmp_path / "sources")
    (sources / "configure.ac").write_text(CONFIGURE, encoding="utf-8")
    makefile = MAKEFILE.replace("all:", "CXX = @CXX@\nVPATH = @srcdir@\nall:", 1)
    makefile = makefile.replace("CXXFLAGS =", "CXXFLAGS = -I@srcdir@")
    (sources / "Makefile.in").write_text(makefile, encoding="utf-8")
    run(["autoheader"], sources)
    run(["autoconf"], sources)
    headers = []
    for name, more in (
        ("plain", {"CC": "clang-19", "CXX": "clang++-19"}),
        ("ours", {"TPC_SOURCE_ROOT": str(sources)}),
    ):
        folder = tmp_path / name
        folder.mkdir()
        run([str(sources / "configure")], folder, **more)
        headers.append((folder / "config.h").read_text(encoding="utf-8"))
        assert list(folder.rglob("tpc")) == []
    assert headers[0] == headers[1]
    assert "#define SIZEOF_LONG 8" in headers[1]
    assert "#define HAVE_EPOLL_CREATE1 1" in headers[1]
    run(["make", "-j4"], tmp_path / "ours", TPC_SOURCE_ROOT=str(sources))
    assert_found(units_of(tmp_path / "ours")["whole"])


MESON = """project('stepper', 'cpp', default_options: ['cpp_std=c++17', 'werror=true'])
compiler = meson.get_compiler('cpp')
assert(compiler.get_id() == 'clang')
assert(compiler.get_linker_id() == 'ld.lld')
assert(compiler.has_function('epoll_create1'))
assert(not compiler.has_function('no_such_function'))
assert(compiler.sizeof('long') == 8)
assert(not compiler.has_argument('-fno-such-argument-is-known=7'))
roscpp = dependency('roscpp')
step = static_library('step', 'step.cpp', dependencies: roscpp)
shared = shared_library('shared_step', 'step.cpp', dependencies: roscpp)
executable('whole', 'node.cpp', link_with: step, dependencies: roscpp)
executable('parted', 'node.cpp', link_with: shared, dependencies: roscpp)
"""


@pytest.mark.skipif(shutil.which("meson") is None, reason="meson is not installed")
def test_meson_asks_and_builds(tmp_path: Path) -> None:
    sources = project(tmp_path / "sources")
    (sources / "meson.build").write_text(MESON, encoding="utf-8")
    more = {"TPC_SOURCE_ROOT": str(sources)}
    run(["meson", "setup", "build"], sources, **more)
    run(["ninja", "-C", "build"], sources, **more)
    units = units_of(sources / "build")
    assert sorted(units) == ["parted", "shared_step", "whole"]
    assert_found(units["whole"])
    assert_found(units["shared_step"])


@pytest.mark.skipif(shutil.which("ccache") is None, reason="ccache is not installed")
def test_ccache_goes_before_the_wrapper(tmp_path: Path) -> None:
    folder = project(tmp_path / "sources")
    (folder / "Makefile").write_text(MAKEFILE, encoding="utf-8")
    more = {
        "CCACHE_DIR": str(tmp_path / "cache"),
        "CXX": f"ccache {WRAPPER}",
        "CCACHE_EXTRAFILES": str(prefix() / "lib/tpc/TpcDefer.so"),
    }
    run(["make", "whole"], folder, **more)
    first = (folder / "tpc/whole.json").read_bytes()
    for path in [*folder.glob("*.o"), folder / "whole", folder / "tpc/whole.json"]:
        path.unlink()
    run(["make", "whole"], folder, **more)
    assert (folder / "tpc/whole.json").read_bytes() == first
    shown = run(["ccache", "--print-stats"], folder, **more).stdout
    hits = dict(line.split("\t") for line in shown.splitlines())
    assert int(hits["direct_cache_hit"]) + int(hits["preprocessed_cache_hit"]) == 2


def test_no_path_of_the_wrapper_is_needed(tmp_path: Path) -> None:
    folder = tmp_path / "elsewhere"
    folder.mkdir()
    (folder / "tpc-clang++").symlink_to(WRAPPER)
    (folder / "a.cpp").write_text("int main() {}\n", encoding="utf-8")
    path = f"{folder}{os.pathsep}{build_environment()['PATH']}"
    run(["tpc-clang++", "a.cpp", "-o", "a"], folder, PATH=path)
    assert sorted(units_of(folder)) == ["a"]
