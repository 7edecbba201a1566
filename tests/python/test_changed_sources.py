"""Source files that changed since the build are said, and old files of static information, too."""

from __future__ import annotations

import json
import os
import shutil
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from mission_samples import BagFile, comparison, line, static_info

from pytpc.cli.main import main
from pytpc.static.sources import changed_sources, with_source_digests
from pytpc.static.static_info import StaticInfo

CODE = "// 1\n" * 10 + "if (value > limit_) {\n"


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    """A workspace whose one comparison is in line 11 of its source."""
    source = tmp_path / "ws/src/robot/src/node.cpp"
    source.parent.mkdir(parents=True)
    source.write_text(CODE)
    save(tmp_path / "ws", digests=True)
    return tmp_path / "ws"


def static_of(workspace: Path) -> StaticInfo:
    found = comparison(0, "limit", lineno=11, source_code="  if (value > limit_) {")
    return static_info(found, source_root=str(workspace / "src/robot"))


def save(workspace: Path, *, digests: bool) -> None:
    static = static_of(workspace)
    if digests:
        static = with_source_digests(static)
    static.save(workspace / ".tpc/static.json")


def source_of(workspace: Path) -> Path:
    return workspace / "src/robot/src/node.cpp"


def call(*words: object) -> Result:
    return CliRunner().invoke(main, list(map(str, words)))


def test_by_digest(workspace: Path):
    static = StaticInfo.load(workspace / ".tpc/static.json")
    source = source_of(workspace)
    assert [path for path, _ in static.sources] == [str(source)]
    os.utime(source, (2**33, 2**33))  # touched, as a checkout does
    assert changed_sources(static, 0) == []
    # An edit below the last comparison moves no line, and may have added one.
    source.write_text(CODE + "// more\n")
    os.utime(source, (1, 1))
    assert changed_sources(static, 2**62) == [str(source)]
    source.unlink()
    assert changed_sources(static, 0) == []


@pytest.mark.parametrize(
    ("text", "changed"),
    [(CODE, False), (CODE + "// more\n", False), ("//\n" + CODE, True), ("", True)],
)
def test_without_digests_the_lines_are_compared(workspace: Path, text: str, changed: bool):
    static, source = static_of(workspace), source_of(workspace)
    source.write_text(text)
    written_ns = source.stat().st_mtime_ns
    assert changed_sources(static, written_ns - 1) == ([str(source)] if changed else [])
    assert changed_sources(static, written_ns) == []


def test_show_says_it_once(workspace: Path):
    assert call("show", workspace, "limit").stderr == ""
    source_of(workspace).write_text("//\n" + CODE)
    result = call("show", workspace, "limit")
    assert result.exit_code == 0
    assert result.stderr == (
        f"pytpc: warning: {source_of(workspace)} has changed since the build: lines may have moved;"
        f" run `pytpc build {workspace}`\n"
    )


def test_rank_says_it_once_for_all_missions(workspace: Path, tmp_path: Path):
    bag = tmp_path / "today/mission.bag"
    bag.parent.mkdir()
    with BagFile(bag) as file:
        for at, value in ((100, 1), (104, 9)):
            file.log(at, "/node", line(0, int(value > 4), value, 4))
        file.mark(106, "/mark_action")
    source_of(workspace).write_text("//\n" + CODE)
    said = f"{source_of(workspace)} has changed since "
    result = call("rank", bag, bag, "--static", workspace)
    assert (result.exit_code, result.stderr.count(said)) == (0, 1)
    assert f"`pytpc build {workspace}`" in result.stderr
    # To build again changes nothing about what was recorded.
    (bag.parent / "run.json").write_text("{}")
    shutil.copy(workspace / ".tpc/static.json", bag.parent)
    result = call("rank", bag.parent)
    assert f"{said}this mission's build: lines are those of then" in result.stderr
    assert "pytpc build" not in result.stderr


def test_a_mission_is_no_reference_for_itself(workspace: Path, tmp_path: Path):
    bag = tmp_path / "today/mission.bag"
    bag.parent.mkdir()
    with BagFile(bag) as file:
        for at, value in ((100, 1), (104, 9)):
            file.log(at, "/node", line(0, int(value > 4), value, 4))
        file.mark(106, "/mark_action")
    with BagFile(tmp_path / "good.bag") as file:
        for at, value in ((100, 1), (104, 2)):
            file.log(at, "/node", line(0, int(value > 4), value, 4))
    copy = tmp_path / "copy.bag"
    shutil.copy(bag, copy)
    link = tmp_path / "link.bag"
    link.symlink_to(bag)
    assert call("convert", bag, "-o", tmp_path / "converted").exit_code == 0
    for command in ("rank", "suggest"):
        for same in (bag, bag.parent, copy, link, tmp_path / "converted"):
            result = call(command, bag, "--static", workspace, "--reference", same)
            assert result.exit_code == 1, (command, same)
            assert result.stderr.splitlines()[-1] == (
                f"pytpc: error: {same}: has the same reports as the mission"
                " mission itself; give a recording of a good run"
            )
        good = call(command, bag, "--static", workspace, "--reference", tmp_path / "good.bag")
        assert good.exit_code == 0, good.stderr


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            {"schema": 0},
            "written by an older TPC (format 0; this one reads 1); rebuild the",
        ),
        ({"units": [{}]}, "if another version of TPC wrote it, rebuild with `pytpc build`"),
    ],
)
def test_old_static_information_says_rebuild(workspace: Path, change: dict[str, object], said: str):
    path = workspace / ".tpc/static.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), **change}))
    result = call("list", workspace)
    assert result.exit_code == 1
    assert said in result.stderr
    assert "pytpc build" in result.stderr
