"""A workspace of a dozen packages, built every way in; and its tests, with TPC and without.

What has to be found stands in the sources, as ``TPC`` and the parameters behind a comparison.
"""

import os
import re
import shutil
import subprocess
from collections.abc import Iterable
from pathlib import Path

import pytest

from pytpc.base.errors import MissingToolError
from pytpc.base.paths import cmake_file, installed, log_library, plugin
from pytpc.build.build import build_workspace, workspace_env
from pytpc.build.collect import collect_sources
from pytpc.ingest.reading import read
from pytpc.ros.ros1.graph import RosGraph
from pytpc.static.link_unit import LeftOut
from pytpc.static.static_info import StaticInfo
from pytpc.workspace import patch
from pytpc.workspace.colcon import Bases, BuildOptions, build_environment
from pytpc.workspace.packages import read_manifest

try:
    for half in (cmake_file, plugin, log_library):
        half()
    installed("bin/tpc-clang++")
except MissingToolError as error:
    pytest.skip(f"the C++ half is not installed: {error}", allow_module_level=True)

WORKSPACES = Path(__file__).parents[1] / "workspaces"
MARK = re.compile(r"// TPC (?P<names>.+)|/\* TPC (?P<c_names>.+) \*/")
# How many of the values 0 to 7 are above 2.5: those from 3 on.
FILTERED = "5 passed"
LEFT_OUT = {
    ("dozen_c", "quiet_node"): "its property TPC_INSTRUMENT is OFF",
    ("dozen_tested", "test_doubler"): "it is a test (set TPC_TESTS=ON to analyse tests too)",
    ("dozen_tested", "test_node"): "it is a test (set TPC_TESTS=ON to analyse tests too)",
}
UNITS = {
    "c_node",
    "dozen_shared",
    "libs_node",
    "by_macro",
    "left_node",
    "right_node",
    "odd_node",
    "dozen_filters",
    "dozen_nodelet",
    "load_filter",
    "reconfigured_node",
    "strict_node",
    "own_lto",
    "ipo",
    "no_ros",
    "dozen_tested",
    "doubler_node",
    "user_node",
}
# For the ways in which CMake has no part, or knows no workspace: libraries of all kinds, a package
# that uses them, plugins, C, and odd names. Each with its link units.
FEWER = {
    "dozen_msgs": (),
    "dozen_libs": ("dozen_shared", "libs_node"),
    "dozen_user": ("user_node",),
    "dozen_plugins": ("dozen_filters", "dozen_nodelet", "load_filter"),
    "deep/er/dozen_c": ("c_node",),
    "mit Abstand/größe": ("odd_node",),
}
# The same keys by every way: package, target and place are the same. What a header or a static
# library brings into another package has the path by which it was found there.
Found = set[tuple[str, int, str]]


def expected(sources: Path) -> Found:
    """File name, line and parameter of each comparison, as the sources say."""
    found: Found = set()
    for path in (path for path in sources.rglob("*") if path.suffix in {".c", ".cpp", ".h"}):
        for number, line in enumerate(path.read_text("utf-8").splitlines(), start=1):
            mark = MARK.search(line)
            names = (mark["names"] or mark["c_names"]).split(", ") if mark else []
            found |= {(path.name, number, name) for name in names}
    return found


def found(static: StaticInfo) -> Found:
    return {
        (Path(one.file).name, one.lineno, one.source or "") for one in static.thresholds.values()
    }


def own_keys(static: StaticInfo) -> set[str]:
    return {key for key, one in static.thresholds.items() if not Path(one.file).is_absolute()}


def left_out(units: Iterable[LeftOut]) -> dict[tuple[str, str], str]:
    return {(unit.package, unit.link_unit): unit.reason for unit in units}


@pytest.fixture(scope="module")
def variables(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The environment of the builds; one compiler cache for all."""
    cache = tmp_path_factory.mktemp("ccache")
    return {
        **build_environment(),
        "CCACHE_DIR": str(cache),
        "CMAKE_C_COMPILER_LAUNCHER": "ccache",
        "CMAKE_CXX_COMPILER_LAUNCHER": "ccache",
        "PYTHON_EXECUTABLE": "/usr/bin/python3",
    }


@pytest.fixture(scope="module")
def sources(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The packages, one of them with a file that cannot be written."""
    folder = tmp_path_factory.mktemp("workspace") / "src"
    shutil.copytree(WORKSPACES / "dozen/src", folder)
    (folder / "mit Abstand/größe/CMakeLists.txt").chmod(0o444)
    return folder


def contents(folder: Path) -> dict[str, tuple[bytes, int]]:
    files = (path for path in folder.rglob("*") if path.is_file() and not path.is_symlink())
    return {
        str(path.relative_to(folder)): (path.read_bytes(), path.stat().st_mode) for path in files
    }


def run(command: list[str | Path], folder: Path, variables: dict[str, str]) -> str:
    ran = subprocess.run(
        command,
        cwd=folder,
        # catkin_make believes this one.
        env={**variables, "PWD": str(folder)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=900,
        check=False,
    )
    assert ran.returncode == 0, ran.stdout[-5000:]
    return ran.stdout


@pytest.fixture(scope="module")
def by_colcon(
    sources: Path, variables: dict[str, str], tmp_path_factory: pytest.TempPathFactory
) -> StaticInfo:
    """`pytpc build`, beside the workspace."""
    base = tmp_path_factory.mktemp("colcon")
    before = contents(sources)
    with pytest.MonkeyPatch.context() as patched:
        for name, value in variables.items():
            patched.setenv(name, value)
        result = build_workspace(sources.parent, BuildOptions(bases=Bases(base)))
    assert contents(sources) == before
    assert sorted(path.name for path in sources.parent.iterdir()) == ["src"]
    assert (left_out(result.static.left_out), result.left_alone) == (LEFT_OUT, {})
    filters_run(base / "install", base / "graph")
    return result.static


def filters_run(install: Path, folder: Path) -> None:
    """The plugins are found by their names, so their static initialisers are still there."""
    environment = workspace_env(install)
    (program,) = (path for path in install.rglob("load_filter") if path.is_file())
    with RosGraph(environment, folder) as graph:
        ran = subprocess.run(
            [program],
            env={
                **environment,
                **{"ROS_MASTER_URI": graph.uri, "ROS_IP": "127.0.0.1"},
                **{"TPC_SINK": "file", "TPC_FOLDER": str(folder / "reports")},
            },
            capture_output=True,
            text=True,
            timeout=600,
            check=False,
        )
    assert ran.stdout.splitlines()[-1:] == [FILTERED], ran.stderr
    assert len(read(sorted((folder / "reports").glob("*.tpc"))).events) > 0


def check(static: StaticInfo, sources: Path, by_colcon: StaticInfo) -> None:
    assert found(static) == expected(sources)
    assert {unit.link_unit for unit in static.units} == UNITS
    assert not static.failed
    assert own_keys(static) == own_keys(by_colcon)


def expected_of_fewer(sources: Path) -> Found:
    return {one for place in FEWER for one in expected(sources / place)}


def units_of_fewer() -> set[str]:
    return {unit for units in FEWER.values() for unit in units}


def test_colcon_finds_all_and_changes_nothing(by_colcon: StaticInfo, sources: Path) -> None:
    check(by_colcon, sources, by_colcon)


def test_catkin_make_on_a_patched_workspace_does_the_same(
    by_colcon: StaticInfo, sources: Path, variables: dict[str, str], tmp_path: Path
) -> None:
    """And the workspace's own tests pass; and it is as it was."""
    before = contents(sources)
    workspace = sources.parent
    patch.run(workspace)
    try:
        run(["catkin_make"], workspace, variables)
        check(collect_sources([workspace]).static, sources, by_colcon)
        results = results_of(workspace, variables)
        assert left_out(collect_sources([workspace]).static.left_out) == LEFT_OUT
        filters_run(workspace / "devel", tmp_path / "graph")
    finally:
        patch.run(workspace, restore=True)
        (sources / "CMakeLists.txt").unlink(missing_ok=True)
    assert contents(sources) == before
    for folder in ("build", "devel"):
        shutil.rmtree(workspace / folder)
    # gtest's two tests, rostest's one, each with none that failed; without TPC just the same.
    assert results == [
        "gtest-test_doubler.xml: 2 0 0",
        "rostest-test_node.xml: 1 0 0",
        "rosunit-node.xml: 1 0 0",
    ]
    run(["catkin_make", "--pkg", "dozen_tested"], workspace, variables)
    assert results_of(workspace, variables) == results
    assert [*(workspace / "build").rglob("tpc/*.json")] == []


def results_of(workspace: Path, variables: dict[str, str]) -> list[str]:
    """The results of the package's own tests: tests, errors and failures of each file."""
    environment = {
        **variables,
        **workspace_env(workspace / "devel"),
        "CCACHE_DIR": variables["CCACHE_DIR"],
    }
    run(["catkin_make", "run_tests_dozen_tested"], workspace, environment)
    results = workspace / "build/test_results/dozen_tested"
    counts = re.compile(r'<testsuites? [^>]*?\btests="(\d+)"')
    lines = []
    for path in sorted(results.rglob("*.xml")):
        text = path.read_text("utf-8")
        tests = counts.search(text)
        bad = [
            sum(int(number) for number in re.findall(rf'<testsuite [^>]*\b{what}="(\d+)"', text))
            for what in ("errors", "failures")
        ]
        if tests:
            lines.append(f"{path.name}: {tests[1]} {bad[0]} {bad[1]}")
    return lines


def test_plain_cmake_does_the_same(
    by_colcon: StaticInfo, sources: Path, variables: dict[str, str], tmp_path: Path
) -> None:
    """Each package by itself with Ninja, with the toolchain, installed into one place."""
    for place in FEWER:
        folder = tmp_path / "build" / Path(place).name
        configure: list[str | Path] = ["cmake", "-G", "Ninja", "-S", sources / place, "-B", folder]
        configure += [f"-DCMAKE_TOOLCHAIN_FILE={cmake_file()}", "-DCMAKE_BUILD_TYPE=Release"]
        configure += [f"-DCMAKE_INSTALL_PREFIX={tmp_path}/i", f"-DCMAKE_PREFIX_PATH={tmp_path}/i"]
        run([*configure, "-DPYTHON_EXECUTABLE=/usr/bin/python3"], tmp_path, variables)
        run(["cmake", "--build", folder, "--target", "install"], tmp_path, variables)
    static = collect_sources([tmp_path]).static
    assert found(static) == expected_of_fewer(sources)
    assert {unit.link_unit for unit in static.units} == units_of_fewer()
    assert not static.failed
    packages = {unit.package for unit in static.units}
    own = {
        key
        for unit in by_colcon.units
        if unit.package in packages
        for key in (one.key for one in unit.comparisons)
    }
    assert own_keys(static) == own & own_keys(by_colcon)


def test_the_compiler_wrappers_find_the_same(
    by_colcon: StaticInfo, sources: Path, variables: dict[str, str], tmp_path: Path
) -> None:
    """CC and CXX alone: nothing is patched, and CMake knows nothing of TPC."""
    wrapper = installed("bin/tpc-clang++")
    environment = {
        **variables,
        "CC": str(wrapper.with_name("tpc-clang")),
        "CXX": str(wrapper),
        "TPC_SOURCE_ROOT": str(sources),
    }
    names = ";".join(read_manifest(sources / place).name for place in FEWER)
    command: list[str | Path] = ["catkin_make", "-C", sources.parent, "--build", tmp_path / "b"]
    command += [f"-DCATKIN_DEVEL_PREFIX={tmp_path}/devel", f"-DCATKIN_WHITELIST_PACKAGES={names}"]
    run(command, tmp_path, environment)
    (sources / "CMakeLists.txt").unlink()
    static = collect_sources([tmp_path / "devel"]).static
    assert found(static) == expected_of_fewer(sources)
    # What CMake knows of its targets is not known here: the one that is to be quiet reports.
    assert {unit.link_unit for unit in static.units} == units_of_fewer() | {"quiet_node"}


def test_a_second_workspace_lies_over_the_first(
    by_colcon: StaticInfo, sources: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """ament and plain CMake, beside a package that needs those of the first; merged install."""
    built = by_colcon.units[0].build_folder
    assert built is not None
    for name, value in workspace_env(Path(built).parents[1] / "install").items():
        monkeypatch.setenv(name, value)
    (tmp_path / "src").mkdir()
    shutil.copytree(sources / "dozen_user", tmp_path / "src/dozen_user")
    for place in (WORKSPACES / "others/src").iterdir():
        (tmp_path / "src" / place.name).symlink_to(place)
    result = build_workspace(tmp_path, BuildOptions(colcon_args=["--merge-install"]))
    # From below come the counter's header and the gate's static library.
    below = {("counter.h", 13, "count/every"), ("gate.cpp", 9, "gate/level")}
    own = expected(tmp_path / "src/dozen_user") | expected(WORKSPACES / "others/src")
    assert found(result.static) == own | below
    assert [unit.link_unit for unit in result.units] == ["user_node", "ament_node"]
    node = tmp_path / ".tpc/install/lib/others_ament/ament_node"
    needed = subprocess.run(
        ["ldd", node], env={"PATH": os.defpath}, capture_output=True, text=True, check=True
    )
    assert "libtpc_log" in needed.stdout
    assert "not found" not in needed.stdout
