"""``pytpc apply`` on a recording of somebody else: it writes only where it should."""

from __future__ import annotations

import hashlib
import json
import os
from pathlib import Path

import pytest
from click.testing import CliRunner
from launch_samples import MANIFEST

from pytpc.cli.main import main
from pytpc.values.recorded_files import workspaces_of

PARAMS = "mission:\n  limit: 0.5\n  other: 3\n"
LAUNCH = '<launch>\n  <param name="mission/limit" value="0.5"/>\n</launch>\n'


def sha(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def recording_of(folder: Path, origin: dict[str, object], **said: object) -> Path:
    """A recording with one parameter, ``/mission/limit``, and this origin."""
    folder.mkdir()
    entry = {"kind": "yaml", "value": 0.5, "lineno": 2, "keys": ["mission", "limit"], **origin}
    document = {"schema": 1, "launch": None, "nodes": [], "files": {}, **said}
    document["parameters"] = {"/mission/limit": entry}
    (folder / "origins.json").write_text(json.dumps(document))
    return folder


@pytest.fixture
def alone(apply, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """``apply`` without any workspace, and a home folder of its own."""
    for name in ("ROS_PACKAGE_PATH", "CMAKE_PREFIX_PATH", "AMENT_PREFIX_PATH"):
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "home").mkdir()
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    return apply


def file_of(path: Path, text: str = PARAMS) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def test_a_file_outside_of_every_workspace(alone, tmp_path: Path) -> None:
    """The recording knows the file exactly, and still it is not written unless it is named."""
    target = file_of(tmp_path / "home/service.yaml")
    mission = recording_of(
        tmp_path / "mission", {"path": str(target)}, files={str(target): sha(PARAMS)}
    )
    for more in ([], ["--force"], ["--dry-run"]):
        refused = alone(mission, "/mission/limit", "0.25", *more, status=1).output
        assert f"{target}:2: the recording names this file" in refused
        assert f"add --file {target}" in refused
    assert target.read_text() == PARAMS
    wrong = alone(mission, "/mission/limit", "1", "--file", tmp_path / "other.yaml", status=1)
    assert f"{target}:2: this file would be changed, not {tmp_path}/other.yaml" in wrong.output
    alone(mission, "/mission/limit", "0.25", "--file", target)
    assert target.read_text() == PARAMS.replace("0.5", "0.25")


@pytest.mark.usefixtures("alone")
@pytest.mark.parametrize(("answer", "limit"), [("y", "0.25"), ("n", "0.5")])
def test_a_question_on_a_terminal(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, answer: str, limit: str
) -> None:
    target = file_of(tmp_path / "home/service.yaml")
    mission = recording_of(
        tmp_path / "mission", {"path": str(target)}, files={str(target): sha(PARAMS)}
    )
    monkeypatch.setattr("pytpc.cli.value_commands.is_terminal", lambda: True)
    words = ["apply", str(mission), "/mission/limit", "0.25"]
    done = CliRunner().invoke(main, words, input=f"{answer}\n")
    assert done.exit_code == (answer == "n"), done.output
    assert f"{target}:2 is in no workspace; only the recording names it." in done.output
    assert target.read_text() == PARAMS.replace("0.5", limit)


@pytest.mark.parametrize(
    ("where", "allowed"),
    [
        ("ws/src/robot/config/p.yaml", True),
        ("ws/src/robot/.git/p.yaml", False),
        ("built/config/p.yaml", True),
        ("sourced/config/p.yaml", True),
        ("sourced/.config/p.yaml", False),
        ("plain/config/p.yaml", False),
    ],
)
def test_what_counts_as_a_workspace(
    alone, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, where: str, allowed: bool
) -> None:
    file_of(tmp_path / "ws/src/robot/package.xml", MANIFEST)
    (tmp_path / "built/.tpc").mkdir(parents=True)
    (tmp_path / "sourced/src").mkdir(parents=True)
    monkeypatch.setenv("CMAKE_PREFIX_PATH", f"{tmp_path}/sourced/install/robot:/usr")
    target = file_of(tmp_path / where)
    mission = recording_of(
        tmp_path / "mission", {"path": str(target)}, files={str(target): sha(PARAMS)}
    )
    alone(mission, "/mission/limit", "0.25", status=0 if allowed else 1)
    assert (target.read_text() != PARAMS) == allowed


def test_a_symbolic_link_out_of_the_workspace(alone, tmp_path: Path) -> None:
    outside = file_of(tmp_path / "home/secret.yaml")
    file_of(tmp_path / "ws/src/robot/package.xml", MANIFEST)
    link = tmp_path / "ws/src/robot/p.yaml"
    link.symlink_to(outside)
    mission = recording_of(
        tmp_path / "mission", {"path": str(link)}, files={str(link): sha(PARAMS)}
    )
    assert "no workspace" in alone(mission, "/mission/limit", "1", status=1).output
    assert outside.read_text() == PARAMS


def test_the_source_of_an_installed_copy_may_not_lie_elsewhere(alone, tmp_path: Path) -> None:
    outside = file_of(tmp_path / "home/secret.yaml")
    file_of(tmp_path / "ws/src/robot/package.xml", MANIFEST)
    inside = file_of(tmp_path / "ws/src/robot/p.yaml")
    origin = {"path": str(inside), "source": str(outside)}
    mission = recording_of(tmp_path / "mission", origin, files={str(inside): sha(PARAMS)})
    assert "no workspace" in alone(mission, "/mission/limit", "1", status=1).output
    assert outside.read_text() == PARAMS


@pytest.mark.parametrize("known", [True, False])
def test_beside_the_launch_file(alone, tmp_path: Path, known: bool) -> None:
    """The folder of the launch file counts only where the recording knows that file."""
    launch = file_of(tmp_path / "robot/start.launch", LAUNCH)
    target = file_of(tmp_path / "robot/config/p.yaml")
    files = {str(target): sha(PARAMS), str(launch): sha(LAUNCH if known else "<launch/>")}
    mission = recording_of(
        tmp_path / "mission", {"path": str(target)}, launch=str(launch), files=files
    )
    alone(mission, "/mission/limit", "0.25", status=0 if known else 1)
    assert (target.read_text() != PARAMS) == known


@pytest.mark.parametrize(
    ("digests", "said"),
    [(True, "differs from the file that was recorded"), (False, "no digest of this file")],
)
def test_a_file_that_is_not_as_it_was_recorded(
    alone, tmp_path: Path, digests: bool, said: str
) -> None:
    file_of(tmp_path / "ws/package.xml", MANIFEST)
    target = file_of(tmp_path / "ws/p.yaml")
    files = {str(target): sha("mission: {}\n")} if digests else {}
    mission = recording_of(tmp_path / "mission", {"path": str(target)}, files=files)
    refused = alone(mission, "/mission/limit", "0.25", status=1).output
    assert f"{target}:2: " in refused
    assert said in refused
    assert "--force" in refused
    assert target.read_text() == PARAMS
    alone(mission, "/mission/limit", "0.25", "--force")
    assert target.read_text() == PARAMS.replace("0.5", "0.25")


def test_a_second_change_from_one_recording(alone, tmp_path: Path) -> None:
    """What ``apply`` itself has changed is as it was recorded."""
    file_of(tmp_path / "ws/package.xml", MANIFEST)
    target = file_of(tmp_path / "ws/p.yaml")
    mission = recording_of(
        tmp_path / "mission", {"path": str(target)}, files={str(target): sha(PARAMS)}
    )
    alone(mission, "/mission/limit", "0.25")
    alone(mission, "/mission/limit", "0.125")
    assert target.read_text() == PARAMS.replace("0.5", "0.125")
    target.write_text(target.read_text() + "# by hand\n")
    alone(mission, "/mission/limit", "1.5", status=1)


@pytest.mark.parametrize(
    ("keys", "allowed"),
    [
        (["mission", "limit"], True),
        (["mission", "other"], False),
        (["other"], False),
        (["it"], False),
        (["mission/limit"], True),
    ],
)
def test_the_key_is_that_of_the_parameter(
    alone, tmp_path: Path, keys: list[str], allowed: bool
) -> None:
    text = "mission: {limit: 0.5, other: 0.5}\nother: 0.5\nit: 0.5\nmission/limit: 0.5\n"
    file_of(tmp_path / "ws/package.xml", MANIFEST)
    target = file_of(tmp_path / "ws/p.yaml", text)
    origin = {"path": str(target), "keys": keys}
    mission = recording_of(tmp_path / "mission", origin, files={str(target): sha(text)})
    for more in ([], ["--force"]):
        done = alone(mission, "/mission/limit", "0.5", *more, status=0 if allowed else 1)
        assert allowed or f"names the key {'/'.join(keys)}" in done.output


def test_nothing_is_added_to_a_launch_file_elsewhere(alone, tmp_path: Path) -> None:
    launch = file_of(tmp_path / "home/a.launch", LAUNCH)
    node = {"name": "/mission", "package": "p", "program": "t", "lineno": 1, "offset": 0}
    mission = recording_of(
        tmp_path / "mission",
        {"kind": "runtime"},
        launch=str(launch),
        nodes=[{**node, "path": str(launch)}],
    )
    refused = alone(mission, "/mission/limit", "0.25", "--add", status=1).output
    assert "the recording names this file" in refused
    assert launch.read_text() == LAUNCH


def test_workspaces(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "ws/src").mkdir(parents=True)
    listed = os.pathsep.join(
        [f"{tmp_path}/ws/devel", f"{tmp_path}/ws/install/robot", "/opt/ros/noetic", "/", "relative"]
    )
    environment = {"CMAKE_PREFIX_PATH": listed, "ROS_PACKAGE_PATH": f"{tmp_path}:/usr/share"}
    assert workspaces_of(environment) == (tmp_path / "ws",)
    assert workspaces_of({}, tmp_path / "other") == (tmp_path / "other",)
