"""The checks of the machine: a machine on which all is well, with one thing wrong at a time."""

import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from pytpc.base.paths import COLCON_EXTENSIONS, build_tools, prefix, ros_places
from pytpc.workspace.doctor import machine as doctor_machine
from pytpc.workspace.doctor.finding import Finding, Severity, by_severity, error, note, warning
from pytpc.workspace.doctor.machine import (
    UNSUITED,
    InstalledProgram,
    Machine,
    ccache_settings,
    check_machine,
    look_at_machine,
    version_of,
)

MIB = 1024 * 1024
RCL_HEADER = "include/rcl/rcl/rcl.h"
SOUND = Machine(
    programs={
        name: InstalledProgram(
            Path("/usr/bin", name), (3, 25, 1) if name == "cmake" else (19, 1, 7)
        )
        for name in build_tools()
    },
    python=Path("/usr/bin/python3"),
    modules={"em": "3.3.4", "catkin_pkg": "0.5.2"},
    extensions=frozenset(COLCON_EXTENSIONS),
    prefix=Path("/opt/tpc"),
    ros={"catkin": Path("/usr"), "roscpp": Path("/usr")},
    disk_free=50_000 * MIB,
    memory_free=8_000 * MIB,
)


def without(name: str) -> dict[str, InstalledProgram]:
    return {other: program for other, program in SOUND.programs.items() if other != name}


def with_version(name: str, *version: int) -> dict[str, InstalledProgram]:
    return {**SOUND.programs, name: InstalledProgram(Path("/usr/bin", name), version)}


def env(**variables: str) -> Machine:
    return replace(SOUND, environment=variables)


def test_nothing_is_wrong_with_a_sound_machine() -> None:
    assert check_machine(SOUND) == []


E, W, N = Severity.ERROR, Severity.WARNING, Severity.NOTE
CASES = [
    (replace(SOUND, programs=without("ld.lld-19")), E, "ld.lld-19 is not installed", "lld-19"),
    (
        replace(SOUND, programs=with_version("ld.lld-19", 19, 1, 2)),
        W,
        "different releases: clang-19 19.1.7, clang++-19 19.1.7, ld.lld-19 19.1.2",
        "--only-upgrade",
    ),
    # cmake_language(DEFER) came with 3.19.
    (
        replace(SOUND, programs=with_version("cmake", 3, 18, 4)),
        E,
        "CMake 3.18.4 is too old: 3.19 is needed",
        "pip install cmake",
    ),
    (
        replace(SOUND, extensions=SOUND.extensions - {"colcon-ros", "colcon-bash"}),
        E,
        "colcon has no bash, ros",
        "apt-get install python3-colcon-bash python3-colcon-ros",
    ),
    (replace(SOUND, modules={"em": "3.3.4"}), E, "cannot import catkin_pkg", "python3-catkin-pkg"),
    (replace(SOUND, modules={**SOUND.modules, "em": "4.1"}), E, "empy 4.1", "pip uninstall empy"),
    (
        replace(SOUND, python=Path("/opt/conda/bin/python3")),
        N,
        "the first python3 on PATH is not the system's; `pytpc build`, `record` and `run` use"
        " /usr/bin/python3 all the same",
        'export PATH="/usr/bin:$PATH"',
    ),
    (
        replace(SOUND, python=Path("/home/ana/.pyenv/shims/python3")),
        N,
        "the first python3 on PATH is pyenv's; `pytpc build`",
        'export PATH="/usr/bin:$PATH"',
    ),
    (
        replace(env(VIRTUAL_ENV="/home/ana/venv"), python=Path("/home/ana/venv/bin/python3")),
        N,
        "is that of a virtual environment;",
        "deactivate",
    ),
    (
        replace(SOUND, missing_parts=("share/tpc/flags",)),
        E,
        "incomplete: share/tpc/flags missing",
        "make setup",
    ),
    (replace(SOUND, trial="undefined symbol: x"), E, "with TPC: undefined symbol: x", "make setup"),
    (replace(SOUND, ros={"catkin": Path("/usr")}), W, "roscpp of ROS 1 not found", "libroscpp-dev"),
    (
        replace(SOUND, unlinked=("libroscpp.so.4d",)),
        E,
        "built for another ROS: libroscpp.so.4d not found",
        " -DCMAKE_CXX_COMPILER=clang++-19 -DCMAKE_INSTALL_PREFIX=/opt/tpc ",
    ),
    (
        replace(SOUND, unlinked=("libroscpp.so.4d",), prefix=Path("/opt/a b")),
        E,
        "built for another ROS",
        "-S '/opt/a b'/share/tpc/runtime_log -B $build ",
    ),
    # Where there is no ROS 1, the library was not built for another one: its core needs none.
    (
        replace(SOUND, unlinked=("libroscpp.so.4d",), ros={}),
        W,
        "catkin and roscpp of ROS 1 not found: catkin packages cannot be built",
        "libroscpp-dev",
    ),
    (
        replace(SOUND, rcl=Path("/opt/ros/kilted"), has_ros2_part=False, prefix=Path("/opt/a b")),
        W,
        "no part for ROS 2, so C++ nodes of ROS 2 write files alone",
        " -DCMAKE_INSTALL_PREFIX='/opt/a b' -DTPC_ROS2_PREFIX=/opt/ros/kilted && ",
    ),
    (
        replace(SOUND, rcl=Path("/opt/ros/kilted"), has_ros2_part=False, has_rcl_header=False),
        W,
        "to build it, install the headers of rcl",
        "apt-get install ros-kilted-rcl",
    ),
    (env(CXX="g++"), N, "CXX=g++ is ignored", "unset CXX"),
    (env(CFLAGS="-O2 -fsanitize=address,undefined"), W, "-fsanitize=address,undefined", "unset"),
    (env(LDFLAGS="-static"), W, "-static cannot be combined", "unset LDFLAGS"),
    (env(TPC_DISABLE="1"), W, "switched off", "unset TPC_DISABLE"),
    (replace(SOUND, disk_free=199 * MIB), E, "199 MiB are free", "df"),
    (replace(SOUND, disk_free=300 * MIB), W, "300 MiB are free", "df"),
    (replace(SOUND, memory_free=512 * MIB), W, "512 MiB of memory", "--executor sequential"),
    (replace(SOUND, ccache={"compiler_check": "none"}), W, "ccache ignores", "=mtime"),
    (replace(SOUND, ccache={"run_second_cpp": "false"}), W, "preprocessed", "=true"),
]


# On Debian /bin is a link to /usr/bin.
def test_the_python_of_ros_2_may_be_the_first_one(tmp_path: Path) -> None:
    package = tmp_path / "lib/python3.11/site-packages/rclpy/__init__.py"
    package.parent.mkdir(parents=True)
    package.touch()
    assert check_machine(replace(SOUND, python=tmp_path / "bin/python3")) == []


def test_the_systems_python_under_another_name_is_no_finding(tmp_path: Path) -> None:
    (tmp_path / "bin").symlink_to("/usr/bin")
    assert check_machine(replace(SOUND, python=tmp_path / "bin/python3")) == []


@pytest.mark.parametrize(("machine", "severity", "what", "mend"), CASES)
def test_one_thing_wrong_is_one_finding(
    machine: Machine, severity: Severity, what: str, mend: str
) -> None:
    (found,) = check_machine(machine)
    assert found.severity is severity
    assert what in found.what
    assert mend in (found.mend or "")


@pytest.mark.parametrize(
    "machine",
    [
        env(CC="/usr/bin/clang-19", CXX="ccache /opt/tpc/bin/tpc-clang++"),
        env(CFLAGS="-static-libgcc -fno-profile-arcs -O2", TPC_DISABLE="OFF"),
        replace(SOUND, programs=with_version("cmake", 3, 19)),
        replace(SOUND, ccache={"compiler_check": "content", "run_second_cpp": "true"}),
    ],
)
def test_what_is_well_is_not_said(machine: Machine) -> None:
    assert check_machine(machine) == []


def test_that_the_log_library_has_a_part_for_ros_2_is_said() -> None:
    (found,) = check_machine(replace(SOUND, rcl=Path("/opt/ros/kilted")))
    assert (found.severity.value, found.where, found.mend) == ("note", "/opt/ros/kilted", None)
    assert found.what == "C++ nodes report to ROS 2: the log library was built for it"


def test_rcl_is_found_in_the_ros_2_in_use(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, file in (("a", "lib/librcl.so"), ("b", "lib/librcl.so"), ("b", RCL_HEADER)):
        (tmp_path / name / file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name / file).touch()
    for listed, expected in ((["a"], ("a", False)), (["a", "b"], ("b", True))):
        monkeypatch.setenv("AMENT_PREFIX_PATH", ":".join(f"{tmp_path}/{name}" for name in listed))
        seen = look_at_machine(tmp_path)
        assert (seen.rcl, seen.has_rcl_header) == (tmp_path / expected[0], expected[1])
    assert seen.has_ros2_part == (prefix() / "lib/libtpc_log_ros2.so").exists()


def test_paths_of_several_distributions() -> None:
    here = frozenset({Path("/opt/ros/noetic"), Path("/opt/ros/humble")})
    both = replace(
        env(CMAKE_PREFIX_PATH="/opt/ros/noetic", AMENT_PREFIX_PATH="/opt/ros/humble"), folders=here
    )
    (found,) = check_machine(both)
    assert "several ROS distributions were sourced: noetic, humble" in found.what
    other = replace(env(CMAKE_PREFIX_PATH="/opt/ros/noetic", ROS_DISTRO="humble"), folders=here)
    (found,) = check_machine(other)
    assert found.what == "ROS_DISTRO is humble, but the paths are those of noetic"
    (found,) = check_machine(env(CMAKE_PREFIX_PATH="/gone/devel"))
    assert (found.where, found.severity) == ("/gone/devel", Severity.WARNING)


def test_flags_are_told_apart_from_their_like() -> None:
    assert [match[0] for match in UNSUITED.finditer("a -static-pie; x-static -static")] == [
        "-static-pie",
        "-static",
    ]
    assert UNSUITED.search("-Wstatic -static-libstdc++ -fno-sanitize=all --coverages") is None


def test_the_worst_comes_first_and_once() -> None:
    findings = [note("a"), error("b"), warning("c"), error("d"), error("b")]
    assert [found.what for found in by_severity(findings)] == ["b", "d", "c", "a"]
    assert error("w", Path("/x"), "m").to_json() == {
        "severity": "error",
        "what": "w",
        "where": "/x",
        "mend": "m",
    }


# --- looking


@pytest.mark.parametrize(
    ("said", "version"),
    [
        ("Debian clang version 19.1.7 (3~deb12u1)\nTarget: x86_64\n", (19, 1, 7)),
        ("Debian LLD 19.1.7 (compatible with GNU linkers)", (19, 1, 7)),
        ("cmake version 3.25.1\n", (3, 25, 1)),
        ("no number", ()),
        ("", ()),
    ],
)
def test_versions_are_read(said: str, version: tuple[int, ...]) -> None:
    assert version_of(said) == version


def test_settings_of_ccache_are_read() -> None:
    said = "(default) compiler_check = mtime\n(/etc/ccache.conf) extra_files_to_hash = \nodd\n"
    assert ccache_settings(said) == {"compiler_check": "mtime", "extra_files_to_hash": ""}


def test_the_ros_packages_may_have_different_prefixes(tmp_path: Path) -> None:
    header = tmp_path / "b/include/ros/ros.h"
    header.parent.mkdir(parents=True)
    header.touch()
    assert ros_places([tmp_path / "a", tmp_path / "b"]) == {"roscpp": tmp_path / "b"}


def prefix_with(folder: Path, compiler: str) -> None:
    """An installed half whose compiler is a script."""
    for part in doctor_machine._PARTS:
        (folder / part).parent.mkdir(parents=True, exist_ok=True)
        (folder / part).touch()
    (folder / "bin/tpc-clang++").write_text(f"#!/bin/sh\n{compiler}\n", encoding="utf-8")
    (folder / "bin/tpc-clang++").chmod(0o755)


@pytest.mark.parametrize(
    ("compiler", "trial"),
    [
        ("echo; echo 'cannot load TpcDefer.so' >&2; exit 1", "cannot load TpcDefer.so"),
        ("exit 0", "the passes were not run"),
        ("mkdir tpc && touch tpc/trial.json", None),
    ],
)
def test_the_installed_half_is_tried(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, compiler: str, trial: str | None
) -> None:
    prefix_with(tmp_path, compiler)
    monkeypatch.setenv("TPC_PREFIX", str(tmp_path))
    if not Path("/usr/bin/clang++-19").exists():
        pytest.skip("clang is not installed")
    machine = look_at_machine(tmp_path / "not/there/yet")
    assert (machine.missing_parts, machine.trial) == ((), trial)
    assert machine.disk_folder == tmp_path
    assert machine.disk_free > 0
    (tmp_path / "share/tpc/flags").unlink()
    assert look_at_machine(tmp_path).missing_parts == ("share/tpc/flags",)


def test_programs_that_are_absent_or_hang_are_no_exception(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def hanging(*_: object, **__: object) -> None:
        raise subprocess.TimeoutExpired("x", 1)

    monkeypatch.setattr(subprocess, "run", hanging)
    machine = look_at_machine(Path())
    assert machine.modules == {}
    findings: list[Finding] = check_machine(machine)
    assert any("cannot import em" in found.what for found in findings)
