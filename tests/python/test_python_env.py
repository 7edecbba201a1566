"""The environment of Python nodes that report: what is set, how it is undone, what a shell does."""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path

import pytest
from click.testing import CliRunner

import pytpc
from pytpc.api import record
from pytpc.base.errors import InputError
from pytpc.base.shell_words import EnvChange
from pytpc.build.build import installed
from pytpc.cli.main import main
from pytpc.ros.node_start import has_python, mission_env, with_python, without_python

ON_PATH = f"{Path(pytpc.__file__).parent}/python_runtime/on_path"


def static_text(file: str) -> str:
    """Static information with one comparison, in ``file``."""
    comparison = {
        "key": "k",
        "relation": ">",
        "file": file,
        "lineno": 1,
        "column": 1,
        "name": None,
        "source_code": "if a > b:",
    }
    unit = {"link_unit": "node", "source_root": "/src/pkg", "comparisons": [comparison]}
    return json.dumps({"schema": 1, "units": [unit]})


@pytest.fixture
def workspace(tmp_path) -> Path:
    """A workspace that was built: only what it left is there. Its name has to be quoted."""
    folder = tmp_path / "the robot's"
    (folder / ".tpc").mkdir(parents=True)
    (folder / ".tpc/static.json").write_text(static_text("nodes/node.py"))
    return folder


def invoke(*words: str, **env: str | None) -> tuple[int, str, str]:
    clean: dict[str, str | None] = dict.fromkeys(("PYTHONPATH", "TPC_PYTHON", "TPC_STATIC"))
    done = CliRunner().invoke(main, ["env", *words], env={**clean, **env})
    return done.exit_code, done.stdout, done.stderr


@pytest.mark.parametrize(
    ("before", "folders"),
    [
        ({}, ON_PATH),
        ({"PYTHONPATH": ""}, ON_PATH),
        ({"PYTHONPATH": "/a:/b"}, f"{ON_PATH}:/a:/b"),
        # An empty entry is the current folder, and stays.
        ({"PYTHONPATH": "/a:"}, f"{ON_PATH}:/a:"),
        ({"PYTHONPATH": f"/a:{ON_PATH}"}, f"{ON_PATH}:/a"),
    ],
)
def test_three_variables_are_set_and_undone(before, folders):
    more = {"HOME": "/h", **before}
    on = with_python(more, Path("/ws/.tpc/static.json"))
    assert on == {
        "HOME": "/h",
        "PYTHONPATH": folders,
        "TPC_PYTHON": "1",
        "TPC_STATIC": "/ws/.tpc/static.json",
    }
    assert with_python(on, Path("/ws/.tpc/static.json")) == on
    others = folders.removeprefix(ON_PATH).removeprefix(":")
    expected = {"HOME": "/h", "PYTHONPATH": others} if others else {"HOME": "/h"}
    assert without_python(on) == expected


def test_without_python_nothing_is_set(tmp_path):
    static = tmp_path / "static.json"
    env = {"PYTHONPATH": "/a"}
    assert mission_env(env, static) == env
    static.write_text(static_text("src/node.cpp"))
    assert not has_python(static)
    assert mission_env(env, static) == env
    static.write_text(static_text("nodes/node.py"))
    assert mission_env(env, static)["TPC_STATIC"] == str(static)
    static.write_text('{"units": [\n')
    with pytest.raises(InputError, match=r"static\.json:2: not JSON"):
        mission_env(env, static)


def test_changes_as_text():
    change = EnvChange.between(
        {"SAME": "1", "OLD": "x", "GONE": "y"}, {"SAME": "1", "OLD": r"it's \n", "NEW": "a b"}
    )
    assert change.text("sh") == "export NEW='a b'\nexport OLD='it'\"'\"'s \\n'\nunset GONE\n"
    assert change.text("fish") == "set -gx NEW 'a b'\nset -gx OLD 'it\\'s \\\\n'\nset -e GONE\n"
    assert json.loads(change.json()) == {
        "set": {"NEW": "a b", "OLD": r"it's \n"},
        "unset": ["GONE"],
    }
    assert EnvChange.between({"A": "1"}, {"A": "1"}).text("sh") == ""


def test_a_shell_has_it_and_has_it_no_more(workspace):
    _, on, _ = invoke(str(workspace), PYTHONPATH="/a")
    _, off, _ = invoke("--off", PYTHONPATH=f"{ON_PATH}:/a", TPC_PYTHON="1", TPC_STATIC="x")
    show = 'echo "$PYTHONPATH|${TPC_PYTHON-none}|${TPC_STATIC-none}"'
    ran = subprocess.run(
        ["sh", "-c", f'eval "$ON"; {show}; eval "$OFF"; {show}'],
        env={"PATH": os.environ["PATH"], "PYTHONPATH": "/a", "ON": on, "OFF": off},
        capture_output=True,
        text=True,
        check=True,
    )
    assert ran.stdout.splitlines() == [
        f"{ON_PATH}:/a|1|{workspace}/.tpc/static.json",
        "/a|none|none",
    ]


def test_source_is_a_workspace_a_file_or_this_folder(workspace, tmp_path, monkeypatch):
    static = workspace / ".tpc/static.json"
    values = {"PYTHONPATH": ON_PATH, "TPC_PYTHON": "1", "TPC_STATIC": str(static)}
    expected = (0, json.dumps({"set": values, "unset": []}, indent=1) + "\n", "")
    assert invoke(str(workspace), "--json") == expected
    assert invoke(str(static), "--json") == expected
    monkeypatch.chdir(workspace)
    assert invoke("--json") == expected
    # One in this very folder comes first, as for `list`.
    (workspace / "static.json").write_text(static_text("nodes/node.py"))
    assert f"TPC_STATIC='{tmp_path}" in invoke()[1]
    assert ".tpc" not in invoke()[1]


def test_a_workspace_of_another_build_is_told_how(workspace):
    (workspace / ".tpc/static.json").unlink()
    status, out, said = invoke(str(workspace))
    assert (status, out) == (1, "")
    assert len(said.splitlines()) == 1
    assert said.startswith(f"pytpc: error: {workspace}: no .tpc/static.json here")
    # The command can be pasted.
    quoted = str(workspace).replace("'", "'\"'\"'")
    assert said.endswith(f"pytpc collect '{quoted}' -o '{quoted}/.tpc/static.json'\n")
    status, _, said = invoke(str(workspace / "none"))
    assert (status, said) == (1, f"pytpc: error: {workspace}/none: no such file or folder\n")


def test_a_workspace_without_python_sets_nothing(workspace):
    (workspace / ".tpc/static.json").write_text(static_text("src/node.cpp"))
    status, out, said = invoke(str(workspace))
    assert (status, out) == (0, "")
    assert "no comparisons in Python" in said


@pytest.mark.parametrize("place", [".tpc/install", "install", "devel"])
def test_setup_is_sourced_in_the_callers_environment(workspace, place):
    status, _, said = invoke(str(workspace), "--setup")
    assert status == 1
    assert f"{workspace}/.tpc/install: no setup.bash here; build the workspace first" in said
    (workspace / place).mkdir(parents=True)
    (workspace / place / "setup.bash").write_text(
        'export PYTHONPATH="/ws/lib:$PYTHONPATH"; export ROS_PACKAGE_PATH=/ws/share; echo said\n'
    )
    _, out, _ = invoke(str(workspace), "--setup", "--json", PYTHONPATH="/a")
    found = json.loads(out)
    assert found["set"]["PYTHONPATH"] == f"{ON_PATH}:/ws/lib:/a"
    assert found["set"]["ROS_PACKAGE_PATH"] == "/ws/share"
    assert set(found["set"]) == {"PYTHONPATH", "ROS_PACKAGE_PATH", "TPC_PYTHON", "TPC_STATIC"}
    assert found["unset"] == []


def test_the_space_of_a_workspace(tmp_path):
    """That of `pytpc build` before those of other builds; and what is told where there is none."""
    assert installed(tmp_path) == tmp_path / ".tpc/install"
    for place in ("devel", "install", ".tpc/install"):
        (tmp_path / place).mkdir(parents=True)
        (tmp_path / place / "setup.bash").touch()
        assert installed(tmp_path) == tmp_path / place


def test_off_and_setup_do_not_go_together(workspace):
    assert invoke(str(workspace), "--off", "--setup")[0] == 2


@pytest.mark.parametrize(
    ("words", "expected"),
    [((), {"PYTHONPATH": ON_PATH, "TPC_PYTHON": "1"}), (("--no-python",), {})],
)
def test_record_has_python_nodes_report_unless_it_is_told_not_to(
    workspace, tmp_path, monkeypatch, words, expected
):
    """What the mission's environment is; that its nodes report is tests/ros's."""
    seen: dict[str, str] = {}

    def run_mission(env: dict[str, str], *_: object, **__: object) -> None:
        seen.update(env)
        raise InputError("it is not run here")

    monkeypatch.setattr(record, "run_mission", run_mission)
    (workspace / ".tpc/install").mkdir()
    (workspace / ".tpc/install/setup.bash").write_text("export ROS_PACKAGE_PATH=/ws/share\n")
    launch = str(tmp_path / "x.launch")
    Path(launch).write_text("<launch/>")
    done = CliRunner().invoke(
        main, ["record", str(workspace), launch, "-o", str(tmp_path / "out"), *words]
    )
    assert "it is not run here" in done.stderr
    assert seen["ROS_PACKAGE_PATH"] == "/ws/share"
    if expected:
        expected = {**expected, "TPC_STATIC": f"{workspace}/.tpc/static.json"}
    names = ("PYTHONPATH", "TPC_PYTHON", "TPC_STATIC")
    assert {name: seen[name] for name in names if name in seen} == expected


def test_the_devel_space_of_a_build_is_set_and_undone(workspace, monkeypatch):
    static, devel = workspace / ".tpc/static.json", workspace / ".tpc/devel"
    devel.mkdir()
    (devel / ".catkin").write_text("/ws/src/robot")
    (devel / ".built_by").write_text("pytpc build\n")
    # Without Python there is something to set, too.
    static.write_text(static_text("src/node.cpp"))
    before = {"ROS_PACKAGE_PATH": "/ws/share", "PYTHONDONTWRITEBYTECODE": None}
    # Nodes run in other folders.
    monkeypatch.chdir(workspace)
    status, out, said = invoke(".", "--json", **before)
    assert (status, said) == (0, "")
    values = json.loads(out)["set"]
    assert values["ROS_PACKAGE_PATH"] == "/ws/src/robot:/ws/share"
    assert values["TPC_DEVEL"] == str(devel)
    status, out, said = invoke("--off", "--json", **values)
    assert (status, said) == (0, "")
    undone = json.loads(out)
    assert undone["set"] == {"ROS_PACKAGE_PATH": "/ws/share"}
    assert {"PYTHONDONTWRITEBYTECODE", "TPC_DEVEL"} <= {*undone["unset"]}


@pytest.mark.parametrize(
    ("env", "expected"),
    [
        ({"TPC_DEVEL": "/ws/.tpc/devel"}, ["/ws/.tpc/static.json"]),
        ({"TPC_DEVEL": "/ws/.tpc/devel", "TPC_STATIC": "/other.json"}, ["/other.json"]),
        ({}, []),
    ],
)
def test_a_recording_of_a_running_robot_knows_the_build_of_its_shell(env, expected):
    assert [str(file) for file in record._static_of_shell(env)] == expected
