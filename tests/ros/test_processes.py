"""`pytpc processes` on a workspace of ten packages with plugins, which is built."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from pytpc.api.building import BuildOptions, build, processes
from pytpc.base.errors import MissingToolError
from pytpc.base.paths import log_library, plugin, project_root

try:
    for half in (plugin, log_library):
        half()
except MissingToolError as error:
    pytest.skip(f"the C++ half is not installed: {error}", allow_module_level=True)

PLUGGED = project_root() / "tests/workspaces/plugged"
LAYERS = "src/plugged_layers/layers.xml"
UNREAD = "requires the 'robot' arg to be set"


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    workspace = tmp_path_factory.mktemp("processes") / "ws"
    shutil.copytree(PLUGGED, workspace)
    # The list of processes needs no analysis of them.
    build(workspace, BuildOptions(processes=False))
    return workspace


@pytest.fixture
def changed(built: Path):
    """The workspace; what a test changes in its sources is taken back."""
    yield built
    for path in (built / "src").rglob("*"):
        if path.is_file() and not (PLUGGED / path.relative_to(built)).is_file():
            path.unlink()
    for path in PLUGGED.rglob("*"):
        if path.is_file():
            shutil.copy(path, built / path.relative_to(PLUGGED))
    (built / "tpc-processes.yaml").unlink(missing_ok=True)


def told(*words: object, status: int = 0) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "pytpc", "processes", *map(str, words)]
    ran = subprocess.run(command, capture_output=True, text=True, cwd=project_root(), check=False)
    assert ran.returncode == status, ran.stderr
    return ran


def shown(workspace: Path) -> dict[str, Any]:
    return json.loads(told(workspace, "--json").stdout)


def units_of(found: dict[str, Any]) -> dict[str, list[str]]:
    return {one["name"]: [unit["link_unit"] for unit in one["units"]] for one in found["processes"]}


# Silent, which nothing names, and Floor are in none; `drive` is two processes.
def test_programs_with_the_plugins_that_launch_files_name(built):
    found = shown(built)
    assert units_of(found) == {
        "nodelet/nodelet": ["plugged_nodelets", "plugged_limits"],
        "plugged_drive/drive@careful": [
            "drive_node",
            "plugged_careful",
            "plugged_limits",
            "plugged_map",
            "plugged_layers",
        ],
        "plugged_drive/drive@direct": ["drive_node", "plugged_direct"],
    }
    why = {
        (one["name"], choice["base"]): (choice["why"], [each["name"] for each in choice["plugins"]])
        for one in found["processes"]
        for choice in one["choices"]
    }
    assert why == {
        ("nodelet/nodelet", "nodelet::Nodelet"): ("launch", ["plugged_nodelets/Alarm"]),
        ("plugged_drive/drive@careful", "plugged::Planner"): (
            "parameters",
            ["plugged_careful/Careful"],
        ),
        ("plugged_drive/drive@careful", "plugged::Layer"): (
            "parameters",
            ["plugged_layers/Inflation"],
        ),
        ("plugged_drive/drive@direct", "plugged::Planner"): ("code", ["plugged_direct/Direct"]),
    }
    starts = {one["name"]: one["starts"] for one in found["processes"]}
    assert [
        (Path(one["file"]).name, one["lineno"], one["node"]) for one in starts["nodelet/nodelet"]
    ] == [("nodelets.launch", 3, "/robot/manager")]
    assert found["faults"] == []
    ((path, reason),) = found["unread"].items()
    assert (Path(path).name, UNREAD in reason) == ("unfinished.launch", True)


def test_in_words(built):
    command = [sys.executable, "-m", "pytpc", "processes"]
    env = {**os.environ, "PYTHONPATH": str(project_root())}
    ran = subprocess.run(command, capture_output=True, text=True, cwd=built, env=env, check=True)
    assert "plugged_drive/drive@direct: 2 link units, " in ran.stdout
    assert "plugins plugged_direct/Direct (plugged::Planner; named in the code)" in ran.stdout
    assert UNREAD in ran.stderr


def test_without_launch_files_the_default_counts_and_without_a_default_all_do(changed):
    for path in (changed / "src/plugged_bringup").glob("*/*"):
        path.unlink()
    (found,) = processes(changed).found
    assert [unit.name for unit in found.units] == ["drive_node", "plugged_direct"]
    # With a planner that loads layers, and nothing that names one.
    launch = (PLUGGED / "src/plugged_bringup/launch/careful.launch").read_text()
    launch = "\n".join(line for line in launch.splitlines() if "rosparam" not in line)
    (changed / "src/plugged_bringup/launch/careful.launch").write_text(launch)
    (found,) = processes(changed).found
    layers = next(one for one in found.choices if one.base == "plugged::Layer")
    assert layers.why == "all"
    assert [one.name for one in layers.plugins] == [
        "plugged_layers/Inflation",
        "plugged_layers/Floor",
    ]


def test_a_yaml_file_that_no_launch_file_reads_is_a_way_to_start(changed):
    for path in (changed / "src/plugged_bringup/launch").iterdir():
        path.unlink()
    (changed / "src/plugged_bringup/config/robot.yaml").write_text(
        "planner: plugged_twins/Silent\n"
    )
    (found,) = processes(changed).found
    assert [unit.name for unit in found.units] == ["drive_node", "plugged_twins", "plugged_limits"]
    assert [start.path.name for start in found.starts] == ["robot.yaml"]


# The file of another build: its environment and its files count.
def test_another_base(built, tmp_path):
    workspace = tmp_path / "ws"
    shutil.copytree(PLUGGED, workspace)
    found = json.loads(told(workspace, "--base", built / ".tpc", "--json").stdout)
    assert units_of(found) == units_of(shown(built))


# In a namespace around the node, and commented out in a file that nobody reads.
def test_parameters_around_the_node(changed):
    launches = changed / "src/plugged_bringup/launch"
    for path in launches.iterdir():
        path.unlink()
    (launches / "robot.launch").write_text(
        '<launch><group ns="robot"><param name="planner" value="plugged_twins/Silent"/>'
        '<node pkg="plugged_drive" type="drive" name="drive"/></group></launch>'
    )
    (changed / "src/plugged_bringup/config/old.yaml").write_text("# plugged_careful/Careful\n")
    (found,) = processes(changed).found
    assert [one.name for one in found.plugins] == ["plugged_twins/Silent"]


def test_the_written_corrections_change_nothing_and_are_kept(changed):
    before = shown(changed)
    path = changed / "tpc-processes.yaml"
    assert told(changed, "--write").stdout == f"written: {path}\n"
    written = path.read_text()
    (said,) = [
        one for one in told(changed, "--write", status=1).stderr.splitlines() if "error" in one
    ]
    assert said.endswith("is there already; edit it, or remove it first")
    assert path.read_text() == written
    after = shown(changed)
    assert units_of(after) == units_of(before)
    assert {choice["why"] for one in after["processes"] for choice in one["choices"]} == {
        "corrected"
    }


def test_corrections_replace_what_was_found(changed):
    (changed / "tpc-processes.yaml").write_text(
        "processes:\n"
        "  plugged_drive/drive:\n"
        "    - name: silent\n"
        "      plugins: [plugged_twins/Silent]\n"
        "      libraries: [libplugged_map.so]\n"
        "  nodelet/nodelet: []\n"
    )
    assert units_of(shown(changed)) == {
        "silent": ["drive_node", "plugged_twins", "plugged_limits", "plugged_map"]
    }


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        (
            "processes:\n  plugged_drive/driv: []\n",
            2,
            "no program plugged_drive/driv was built; did you mean",
        ),
        (
            "processes:\n  plugged_drive/drive:\n  - plugins: [x/Y]\n",
            3,
            "no package declares a plugin x/Y",
        ),
        (
            "processes:\n  plugged_drive/drive:\n  - libraries:\n    - libz.so\n",
            4,
            "no library libz.so was built",
        ),
        (
            "processes:\n  plugged_drive/drive:\n  - plugin: []\n",
            3,
            "unknown key plugin; there are",
        ),
        ("processes:\n  plugged_drive/drive: 3\n", 2, "a list of processes is expected"),
        ("process: 3\n", 1, "unknown key process; processes is expected"),
        ("- 3\n", 1, "names with values are expected"),
    ],
)
def test_wrong_corrections(changed, text, line, message):
    path = changed / "tpc-processes.yaml"
    path.write_text(text)
    (said,) = [one for one in told(changed, status=1).stderr.splitlines() if "error" in one]
    assert f"{path}:{line}: {message}" in said


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("lib/libplugged_layers", "lib/libgone", "layers.xml:1: no library lib/libgone was built"),
        ('type="plugged::Floor" ', "", "layers.xml:3: <class> has no type"),
        ("</library>", "", "layers.xml:5: not XML: no element found"),
        (
            "plugged_layers/Floor",
            "plugged_layers/Inflation",
            "layers.xml:3: there is another plugin plugged_layers/Inflation for plugged::Layer, in",
        ),
    ],
)
def test_wrong_declarations_are_said_and_the_rest_is_found(changed, old, new, message):
    path = changed / LAYERS
    path.write_text(path.read_text().replace(old, new))
    found = processes(changed)
    (fault,) = found.faults
    assert message in fault
    assert "plugged_drive/drive@direct" in [one.name for one in found.found]


def test_an_export_of_a_file_that_is_not_there(changed):
    (changed / LAYERS).unlink()
    (fault,) = processes(changed).faults
    assert fault.endswith(
        "package.xml: <plugged_core plugin=...> names ${prefix}/layers.xml, which is not there"
    )


def test_a_workspace_that_was_not_built(tmp_path):
    (said,) = told(tmp_path, status=1).stderr.splitlines()
    assert said.endswith("not built with TPC yet; build it with: pytpc build")


def test_a_folder_that_is_not_there(tmp_path):
    (said,) = told(tmp_path / "gone", status=1).stderr.splitlines()
    assert "no such folder" in said
