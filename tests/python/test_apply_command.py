"""``pytpc apply``: where a value is written, what is shown, and how it is taken back."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from click.testing import CliRunner
from launch_samples import MISSION_PARAMS, environment, make_package, needs_roslaunch

from pytpc.cli.main import main
from pytpc.values.origins import ORIGINS_FILE
from pytpc.values.recording import save_origins, try_trace

DIFF = """--- a{path}
+++ b{path}
@@ -1,4 +1,4 @@
 # mine
 mission:
-  limit: 0.058  # too high
+  limit: 0.035  # too high
   other: 3
"""


def test_a_yaml_file(apply, params: Path) -> None:
    done = apply(params, "/mission/limit", "0.035")
    assert params.read_text() == MISSION_PARAMS.replace("0.058", "0.035")
    assert done.stdout == (
        DIFF.format(path=params) + f"{params}:3: /mission/limit 0.058 -> 0.035\n"
    )
    assert done.stderr == "to take it back: pytpc apply --undo 1\n"
    apply("--undo")
    assert params.read_text() == MISSION_PARAMS
    assert "nothing to undo" in apply("--undo", status=1).output


def test_a_dry_run(apply, params: Path) -> None:
    done = apply(params, "limit", "0.035", "--dry-run")
    assert done.stdout == (
        DIFF.format(path=params)
        + f"{params}:3: /mission/limit 0.058 -> 0.035 (not written: --dry-run)\n"
    )
    assert params.read_text() == MISSION_PARAMS
    assert json.loads(apply("--list", "--json").output) == []


def test_a_negative_value_is_no_option(apply, params: Path) -> None:
    apply(params, "limit", "-0.5")
    assert params.read_text() == MISSION_PARAMS.replace("0.058", "-0.5")
    dry = apply("--undo", "--dry-run")
    assert "(not written: --dry-run)" in dry.output
    assert params.read_text() == MISSION_PARAMS.replace("0.058", "-0.5")


def test_what_it_is_already(apply, params: Path) -> None:
    done = apply(params, "limit", "0.058")
    assert done.stdout == f"{params}:3: /mission/limit is 0.058 already\n"
    assert json.loads(apply("--list", "--json").output) == []


def test_json(apply, params: Path) -> None:
    answer = json.loads(apply(params, "limit", "0.035", "--json").output)["file"]
    assert answer["diff"] == DIFF.format(path=params)
    del answer["diff"]
    assert answer == {
        "parameter": "/mission/limit",
        "parameters": ["/mission/limit"],
        "path": str(params),
        "lineno": 3,
        "old": 0.058,
        "new": 0.035,
        "changed": True,
        "notes": [],
        "written": True,
        "undo": 1,
    }
    (entry,) = json.loads(apply("--list", "--json").output)
    assert (entry["number"], entry["old"], entry["path"]) == (1, "0.058", str(params))
    undone = json.loads(apply("--undo", "--json").output)
    assert (undone["undone"], undone["written"]) == (1, True)


def test_undo_refuses_a_file_that_was_changed(apply, params: Path) -> None:
    apply(params, "limit", "0.035")
    mine = params.read_text() + "# and mine\n"
    params.write_text(mine)
    refused = apply("--undo", status=1)
    assert f"{params}: has changed since: change 1 is not undone" in refused.output
    assert params.read_text() == mine


def test_undo_of_one_of_several(apply, params: Path, tmp_path: Path) -> None:
    second = tmp_path / "second.yaml"
    second.write_text("a: 1\n")
    apply(params, "limit", "0.035")
    apply(params, "other", "4")
    apply(second, "a", "2")
    listed = apply("--list").output
    assert all(text in listed for text in ("/mission/limit", "/mission/other", "second.yaml"))
    # The first change of this file stands below the second.
    assert "change 2 came later" in apply("--undo", "1", status=1).output
    apply("--undo", params)
    assert params.read_text() == MISSION_PARAMS.replace("0.058", "0.035")
    assert second.read_text() == "a: 2\n"
    apply("--undo", "1")
    apply("--undo")
    assert (params.read_text(), second.read_text()) == (MISSION_PARAMS, "a: 1\n")
    assert "no change of 7 is recorded" in apply("--undo", "7", status=1).output


def test_symbolic_links_and_permissions_stay(apply, params: Path, tmp_path: Path) -> None:
    params.chmod(0o640)
    link = tmp_path / "link.yaml"
    link.symlink_to(params.name)
    apply(link, "limit", "0.035")
    assert link.is_symlink()
    assert params.read_text() == MISSION_PARAMS.replace("0.058", "0.035")
    assert params.stat().st_mode & 0o777 == 0o640
    apply("--undo", link)
    assert params.read_text() == MISSION_PARAMS


@pytest.mark.parametrize(
    ("text", "words", "said"),
    [
        (MISSION_PARAMS, ("gone", "1"), "params.yaml: gone is not in the file"),
        ("a: {x: 1}\nb: {x: 2}\n", ("x", "3"), "several values end with x: a/x, b/x"),
        (MISSION_PARAMS, ("other", "3.5"), "params.yaml: the parameter is a whole number"),
        ("a: [\n", ("a", "1"), "not YAML"),
        ("a: caf\xe9\n", ("a", "1"), "params.yaml:1: not UTF-8"),
        ("", ("a", "1"), "a is not in the file"),
    ],
)
def test_one_line_and_nothing_written(
    apply, params: Path, text: str, words: tuple[str, str], said: str
) -> None:
    params.write_bytes(text.encode("latin-1"))
    done = apply(params, *words, status=1)
    assert done.stderr.count("\n") == 1
    assert said in done.stderr
    assert params.read_bytes() == text.encode("latin-1")


def test_bad_words(apply, params: Path, tmp_path: Path) -> None:
    assert "give TARGET PARAMETER VALUE" in apply(params, "limit", status=2).output
    assert "--add is for launch files" in apply(params, "a", "1", "--add", status=2).output
    assert "give one FILE or number" in apply("--undo", "1", "2", status=2).output
    assert "no such file" in apply(tmp_path / "none.launch", "a", "1", status=1).output
    assert f"no {ORIGINS_FILE}" in apply(tmp_path, "a", "1", status=1).output


def test_a_file_that_cannot_be_written(apply, params: Path, monkeypatch) -> None:
    monkeypatch.setattr(os, "access", lambda *_: False)
    assert f"{params}: cannot be written" in apply(params, "limit", "0.035", status=1).output
    assert params.read_text() == MISSION_PARAMS
    assert json.loads(apply("--list", "--json").output) == []


def test_hostile_text_is_shown_harmless(apply, params: Path) -> None:
    params.write_text("mission:\n  # \x1b[2J\n  limit: 0.5\n", newline="")
    # YAML does not take control characters; a launch file's comment may have none either.
    assert "\x1b" not in apply(params, "limit", "0.6", status=1).output


# --- by origin


@needs_roslaunch
def test_a_launch_file_leads_to_the_yaml_that_set_it(apply, tmp_path: Path) -> None:
    launch = make_package(tmp_path)
    extra = tmp_path / "robot/config/extra.yaml"
    done = apply(launch, "/mission/limit", "0.04")
    assert extra.read_text() == "mission:\n  limit: 0.04\n"
    assert f"{extra}:2: /mission/limit 0.058 -> 0.04" in done.output
    apply("--undo")
    assert extra.read_text() == "mission:\n  limit: 0.058\n"


# What is asked for, and how main.launch or inner.launch (launch_samples.py) differ afterwards.
BY_ORIGIN = [
    ("/left/arm/limit", "0.5", "main", 'value="0.25"', 'value="0.5"'),
    ("/left/arm/torque", "4", "main", "torque: 3.5", "torque: 4.0"),
    ("/left/arm/joints/wrist", "2.5", "main", "wrist: 2.0", "wrist: 2.5"),
    ("/right/width", "8", "inner", 'default="9"', 'default="8"'),
    ("/alone", "6", "main", ">5<", ">6<"),
    ("/again", "3", "main", 'name="again" value="2"', 'name="again" value="3"'),
    ("/left/gain", "3", "main", 'name="rate" default="4.0"', 'name="rate" default="3"'),
]


@needs_roslaunch
@pytest.mark.parametrize("case", BY_ORIGIN, ids=[case[0] for case in BY_ORIGIN])
def test_each_kind_of_place(apply, tmp_path: Path, case: tuple[str, str, str, str, str]) -> None:
    name, value, file, old, new = case
    make_package(tmp_path)
    folder = tmp_path / "robot/launch"
    before = {path.stem: path.read_text() for path in folder.iterdir()}
    apply(folder / "main.launch", name, value)
    after = {path.stem: path.read_text() for path in folder.iterdir()}
    before[file] = before[file].replace(old, new)
    assert after == before


@needs_roslaunch
def test_what_is_refused_by_origin(apply, tmp_path: Path) -> None:
    launch = make_package(tmp_path)
    # speed goes to the arm and, through the include, to depth.
    assert (
        "<arg> speed is used in line 22, too"
        in apply(launch, "/left/arm/speed", "2", status=1).output
    )
    given = apply(launch, "/left/gain", "3", "rate:=8", status=1).output
    assert "rate:=8 on roslaunch's command line; give rate:=VALUE there instead" in given
    assert (
        "<arg> speed is used in line 12, too" in apply(launch, "/right/depth", "2", status=1).output
    )
    assert (
        "main.launch:29: /leg/step stands in the args of the node: _step:=0.5"
        in apply(launch, "/leg/step", "2", status=1).output
    )
    assert "roslaunch computes its value" in apply(launch, "/computed", "2", status=1).output
    assert "the output of a command" in apply(launch, "/text", "2", status=1).output
    merged = apply(launch, "/other/mass", "5", status=1).output
    assert "config/params.yaml:6: it is the value of arm/mass, too" in merged
    refused = apply(launch, "left/arm/nothing", "2", status=1)
    assert "left/arm/nothing is not set anywhere" in refused.output
    assert "--add puts it" in apply(launch, "/left/arm/nothing", "2", status=1).output
    assert "is not NAME:=VALUE" in apply(launch, "/alone", "2", "rate", status=2).output


@needs_roslaunch
def test_add(apply, tmp_path: Path) -> None:
    launch = make_package(tmp_path)
    before = launch.read_text()
    apply(launch, "/left/arm/reach", "0.75", "--add")
    added = '      <param name="reach" value="0.75" type="double"/>\n    </node>'
    assert launch.read_text() == before.replace("    </node>", added)
    # It is read back by roslaunch.
    done = CliRunner().invoke(main, ["origin", str(launch), "/left/arm/reach"])
    assert f"/left/arm/reach = 0.75: {launch}:19" in done.output
    apply(launch, "/elsewhere", "text", "--add")
    assert '  <param name="/elsewhere" value="text" type="str"/>\n</launch>' in launch.read_text()
    apply("--undo")
    apply("--undo")
    assert launch.read_text() == before


def mission_of(tmp_path: Path, launch: Path, params: str) -> Path:
    mission = tmp_path / "mission"
    mission.mkdir()
    (mission / "params.yaml").write_text(params)
    env = environment(tmp_path)
    trace, reason = try_trace(env, launch, {})
    save_origins(mission, mission / "params.yaml", trace, reason, env)
    return mission


@needs_roslaunch
def test_a_mission(apply, tmp_path: Path) -> None:
    launch = make_package(tmp_path)
    mission = mission_of(tmp_path, launch, "mission: {limit: 0.058}\nleft: {arm: {limit: 0.9}}\n")
    extra = tmp_path / "robot/config/extra.yaml"
    # The file was changed since the mission: the line is another, and the value, too.
    extra.write_text("# new\nmission:\n  limit: 0.05\n")
    changed = apply(mission, "/mission/limit", "0.04", status=1).output
    assert f"{extra}:2: differs from the file that was recorded" in changed
    done = apply(mission, "/mission/limit", "0.04", "--force")
    assert extra.read_text() == "# new\nmission:\n  limit: 0.04\n"
    assert f"{extra}:3: /mission/limit 0.05 -> 0.04" in done.output
    assert "the robot had 0.058; the file was changed since" in done.output
    runtime = apply(mission, "/left/arm/limit", "0.5", status=1).output
    assert "/left/arm/limit was set at runtime" in runtime
    assert f"{launch}:13 set it to 0.25" in runtime
    extra.unlink()
    assert f"{extra}: cannot be read" in apply(mission, "/mission/limit", "1", status=1).output


@needs_roslaunch
@pytest.mark.parametrize(
    "setting", ['<param name="limit" value="1.0"/>', "<rosparam>limit: 1.0</rosparam>"]
)
@pytest.mark.parametrize("names", [("a", "b"), ("$(arg one)", "$(arg two)")])
def test_lines_of_a_launch_file_that_moved_since(tmp_path, monkeypatch, setting, names):
    """Where /b/limit stood there is /a/limit now: that one is never changed."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))
    nodes = "".join(
        f'<node name="{name}" pkg="p" type="t">\n{setting}\n</node>\n' for name in names
    )
    arguments = '<launch><arg name="one" default="a"/><arg name="two" default="b"/>\n'
    mission, launch = tmp_path / "mission", tmp_path / "two.launch"
    mission.mkdir()
    launch.write_text(f"{arguments}{nodes}</launch>\n")
    (mission / "params.yaml").write_text("a: {limit: 1.0}\nb: {limit: 1.0}\n")
    trace, reason = try_trace(os.environ, launch, {})
    save_origins(mission, mission / "params.yaml", trace, reason, os.environ)
    # Each node has three lines.
    moved = f"{arguments}<!-- 1 -->\n<!-- 2 -->\n<!-- 3 -->\n{nodes}</launch>\n"
    launch.write_text(moved)
    done = CliRunner().invoke(main, ["apply", str(mission), "/b/limit", "9.0"])
    assert "differs from the file that was recorded" in done.output
    done = CliRunner().invoke(main, ["apply", str(mission), "/b/limit", "9.0", "--force"])
    other = setting.replace("1.0", "9.0").join(moved.rsplit(setting, 1))
    if done.exit_code:
        assert "changed since" in done.output
        assert launch.read_text() == moved
    else:
        assert launch.read_text() == other
    named = names[0] == "a" and "<param" in setting
    assert done.exit_code == (0 if named else 1)
