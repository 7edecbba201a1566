"""What is said before a mission begins: nodes that are not there, copies that are old."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner

from pytpc.cli.launch_words import LaunchWords
from pytpc.cli.main import main
from pytpc.cli.mission_commands import with_package
from pytpc.values.doubts import doubts
from pytpc.values.trace import Trace

MANIFEST = """<package format="2"><name>robot</name><version>0.1.0</version>
<description>d</description><maintainer email="a@b.org">a</maintainer><license>x</license></package>
"""


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    """A workspace with a file that was changed since it was installed, and one that was not."""
    folder = tmp_path / "a robot"
    files = {"package.xml": MANIFEST, "config/new.yaml": "a: 2\n", "config/same.yaml": "b: 1\n"}
    for base in (folder / "src/robot", folder / ".tpc/install/robot/share/robot"):
        for name, text in files.items():
            path = base / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text)
    (folder / ".tpc/install/robot/share/robot/config/new.yaml").write_text("a: 1\n")
    return folder


def said(folder: Path, *absent: tuple[str, str]) -> list[str]:
    files = {str(path): "" for path in sorted(folder.rglob("*.yaml"))}
    return list(doubts(Trace(Path("x.launch"), {}, {}, [], files, absent)))


def test_a_copy_that_differs_from_its_source_is_named(workspace: Path) -> None:
    installed = workspace / ".tpc/install"
    assert said(installed) == [
        f"{installed}/robot/share/robot/config/new.yaml is read, an installed copy that differs"
        f" from {workspace}/src/robot/config/new.yaml; for the change to reach the robot, run:"
        f" pytpc build '{workspace}'"
    ]
    assert said(workspace / "src") == []
    # A workspace that the user builds is built as ever.
    installed.rename(workspace / "install")
    (doubt,) = said(workspace / "install")
    assert doubt.endswith("for the change to reach the robot, build the workspace again")


def test_a_node_without_a_program_is_named() -> None:
    (doubt,) = said(Path("/none"), ("robot", "driver"))
    assert doubt == (
        "package robot has no program driver, so this node will not start: build the workspace"
        " with `pytpc build`, or make the script executable with `chmod +x`"
    )


def test_what_launch_of_ros_2_could_not_follow_is_told() -> None:
    trace = Trace(Path("x.launch.py"), {}, {}, [], {}, unknown=("/p.yaml is no file",))
    assert list(doubts(trace)) == [
        "what the launch file sets is not known as a whole: /p.yaml is no file"
    ]


def test_a_launch_file_that_is_not_there_is_looked_for_in_the_workspace(workspace: Path) -> None:
    (workspace / ".tpc/install/setup.bash").write_text("export ROS_PACKAGE_PATH=/none\n")

    def error(name: str) -> str:
        out = str(workspace.parent / "out")
        done = CliRunner().invoke(main, ["record", str(workspace), name, "-o", out])
        assert done.exit_code == 1
        return done.stderr

    where = "give its path, or its package and its name"
    assert error("a.launch") == f"pytpc: error: a.launch: no such launch file; {where}\n"
    for package in ("arm", "robot"):
        launch = workspace / "src" / package / "launch/a.launch"
        launch.parent.mkdir(parents=True)
        launch.write_text("<launch/>\n")
    arm = MANIFEST.replace("robot", "arm")
    (workspace / "src/arm/package.xml").write_text(arm)
    where = "give its path, or package and name: arm a.launch, robot a.launch"
    assert error("a.launch") == f"pytpc: error: a.launch: no such launch file; {where}\n"
    # A folder says which one is meant.
    shutil.rmtree(workspace / "src/arm")
    where = "give its path, or package and name: robot a.launch"
    assert error("x/a.launch") == f"pytpc: error: x/a.launch: no such launch file; {where}\n"
    # Its name is no pattern, and a folder has none.
    for word in ("*.launch", "**a", "."):
        said = error(word)
        assert said.startswith(f"pytpc: error: {word}: no such launch file; give its path, or")
        assert "robot" not in said


def test_the_only_launch_file_of_that_name_is_taken(
    workspace: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    launch = workspace / "src/robot/launch/a.launch"
    launch.parent.mkdir()
    launch.write_text("<launch/>\n")
    given = LaunchWords.of([str(workspace), "a.launch", "speed:=1"])
    assert with_package(given) == given._replace(package="robot")
    said = "pytpc: a.launch is not in this folder; taking that of package robot\n"
    assert capsys.readouterr().err == said
    here = LaunchWords.of([str(workspace), "./a.launch"])
    assert with_package(here) == here
    # One of this folder comes first, and one that a package has twice is nobody's.
    (launch.parent / "b").mkdir()
    launch.with_name("b").joinpath("a.launch").touch()
    assert with_package(given) == given
    launch.with_name("b").joinpath("a.launch").unlink()
    monkeypatch.chdir(launch.parent)
    assert with_package(given) == given
    assert capsys.readouterr().err == ""
