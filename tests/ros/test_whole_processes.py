"""`pytpc build` analyses processes across libraries and plugins; on a workspace that is built."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from pytpc.api.building import BuildOptions, WholeBuild, build
from pytpc.base.errors import MissingToolError
from pytpc.base.paths import log_library, plugin, project_root
from pytpc.static.static_info import StaticInfo

try:
    for half in (plugin, log_library):
        half()
except MissingToolError as error:
    pytest.skip(f"the C++ half is not installed: {error}", allow_module_level=True)

PLUGGED = project_root() / "tests/workspaces/plugged"
EXPECTED = re.compile(r"// TPC (.*)")
CAREFUL = ["plugged_careful", "plugged_drive", "plugged_layers", "plugged_limits", "plugged_map"]


def expected() -> set[tuple[str, int, str]]:
    """File, line and parameter of the places that are marked in the sources."""
    return {
        (path.name, number, name.strip())
        for path in sorted((PLUGGED / "src").rglob("*.cpp"))
        for number, line in enumerate(path.read_text().splitlines(), start=1)
        if (marked := EXPECTED.search(line))
        for name in marked[1].split(",")
    }


def places(static: StaticInfo) -> set[tuple[str, int, str]]:
    return {
        (Path(one.file).name, one.lineno, one.source.split("/")[-1].lstrip("~"))
        for one in static.comparisons.values()
    }


def stamps(workspace: Path) -> dict[str, int]:
    """When each program and library was linked."""
    folders = (workspace / ".tpc/build").glob("*/devel/lib")
    return {
        path.name: path.stat().st_mtime_ns
        for folder in folders
        for path in folder.rglob("*")
        if path.is_file() and not path.is_symlink() and os.access(path, os.X_OK)
    }


def links(workspace: Path) -> dict[str, int]:
    """When the linker last wrote what it read, for each link unit."""
    lists = (workspace / ".tpc/build").glob("*/tpc/*.link.json.d")
    return {path.name.partition(".")[0]: path.stat().st_mtime_ns for path in lists}


@pytest.fixture(scope="module")
def first(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, WholeBuild]:
    workspace = tmp_path_factory.mktemp("whole") / "ws"
    shutil.copytree(PLUGGED, workspace)
    return workspace, build(workspace)


# The tests below build the same workspace again, one after the other.
def test_places_across_libraries_are_found_and_twins_stay_silent(first):
    _, whole = first
    assert places(whole.build.static) == expected()
    assert whole.failure is None
    assert [(one.process.name, one.failure) for one in whole.analysed] == [
        ("nodelet/nodelet", None),
        ("plugged_drive/drive@careful", None),
        ("plugged_drive/drive@direct", None),
    ]


def test_a_comparison_names_the_processes_that_found_it(first):
    workspace, whole = first
    found = {
        one.source.split("/")[-1].lstrip("~"): one.processes
        for one in whole.build.static.comparisons.values()
    }
    assert found == {
        "alarm_level": ("nodelet/nodelet",),
        "slow_distance": ("plugged_drive/drive@careful",),
        "inflation_radius": ("plugged_drive/drive@careful",),
        "lethal_cost": ("plugged_drive/drive@careful",),
        "stop_distance": ("plugged_drive/drive@direct",),
    }
    assert not list((workspace / ".tpc/build").glob("*/tpc/*.plans/later"))


def test_nothing_changed_links_nothing(first):
    workspace, whole = first
    before = stamps(workspace)
    begun: list[str] = []
    again = build(workspace, on_process=lambda name, _done, _all: begun.append(name))
    assert stamps(workspace) == before
    assert begun == []
    assert places(again.build.static) == places(whole.build.static)
    assert not any(one.is_new for one in again.analysed)


def test_a_changed_file_analyses_its_processes_alone(first):
    workspace, whole = first
    source = workspace / "src/plugged_direct/src/direct.cpp"
    text = source.read_text()
    keys = set(whole.build.static.comparisons)
    before = stamps(workspace)
    begun: list[str] = []
    source.write_text(f"{text}\n// a remark\n")
    try:
        build(workspace, on_process=lambda name, _done, _all: begun.append(name))
        changed = {name for name, at in stamps(workspace).items() if before[name] != at}
        assert begun == ["plugged_drive/drive@direct"]
        assert changed == {"libplugged_direct.so"}
        source.write_text(text.replace("//", "\n//", 1))
        moved = build(workspace).build.static
        assert len(moved.comparisons) == len(keys)
    finally:
        source.write_text(text)
    assert set(build(workspace).build.static.comparisons) == keys


def test_other_code_in_a_library_links_nothing_that_uses_it(first):
    workspace, whole = first
    source = workspace / "src/plugged_map/src/map.cpp"
    text = source.read_text()
    before, stamped = links(workspace), stamps(workspace)
    source.write_text(f"{text}\n// a remark\n")
    try:
        again = build(workspace)
    finally:
        source.write_text(text)
    changed = {name for name, at in links(workspace).items() if before[name] != at}
    assert changed == {"plugged_map"}
    # make would have linked it again.
    used_by = "libplugged_careful.so.1.2.3"
    assert stamps(workspace)[used_by] > stamped[used_by]
    assert again.build.static.comparisons.keys() == whole.build.static.comparisons.keys()


def test_each_unit_alone_on_request_and_where_the_budget_ends(first, monkeypatch):
    workspace, whole = first
    alone = build(workspace, BuildOptions(processes=False))
    assert alone.analysed == ()
    assert places(alone.build.static) < places(whole.build.static)
    assert all(one.processes is None for one in alone.build.static.comparisons.values())
    with monkeypatch.context() as patched:
        patched.setattr("pytpc.processes.analysis._MOST_FUNCTIONS", 3)
        ended = build(workspace)
    assert {one.plan for one in ended.analysed} == {None}
    assert all("too large" in str(one.failure) for one in ended.analysed)
    assert places(ended.build.static) == places(alone.build.static)
    assert places(build(workspace).build.static) == places(whole.build.static)


def test_a_build_that_ends_between_its_links_is_taken_up(first, monkeypatch):
    workspace, whole = first
    source = workspace / "src/plugged_direct/src/direct.cpp"
    text = source.read_text()

    def end(*_: object) -> None:
        raise KeyboardInterrupt

    source.write_text(f"{text}\n// another remark\n")
    with monkeypatch.context() as patched:
        patched.setattr("pytpc.processes.whole.analyse_processes", end)
        with pytest.raises(KeyboardInterrupt):
            build(workspace)
    command = [sys.executable, "-m", "pytpc", "collect", str(workspace), "-o"]
    told = subprocess.run(
        [*command, str(workspace / "collected.json")],
        capture_output=True,
        text=True,
        check=True,
        cwd=project_root(),
    )
    assert "its processes are not analysed yet; run `pytpc build` again" in " ".join(
        (told.stdout + told.stderr).split()
    )
    source.write_text(text)
    assert places(build(workspace).build.static) == places(whole.build.static)


def test_a_library_without_bitcode_is_said(first):
    workspace, _ = first
    lists = workspace / "src/plugged_limits/CMakeLists.txt"
    text = lists.read_text()
    lists.write_text(f"set(TPC_DISABLE ON)\n{text}")
    command = [sys.executable, "-m", "pytpc", "build", str(workspace)]
    try:
        told = subprocess.run(
            command, capture_output=True, text=True, check=True, cwd=project_root()
        )
    finally:
        lists.write_text(text)
    assert "libplugged_limits.so: has no bitcode" in told.stderr
    names = {name for _, _, name in places(StaticInfo.load(workspace / ".tpc/static.json"))}
    assert "inflation_radius" in names
    assert "slow_distance" not in names
