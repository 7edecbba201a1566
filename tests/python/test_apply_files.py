"""``pytpc apply``: installed copies and their sources, and the notes for undo."""

from __future__ import annotations

import base64
import json
import threading
import time
from pathlib import Path

import pytest
from launch_samples import MANIFEST, MISSION_PARAMS, needs_roslaunch

from pytpc.base.atomic import replace_file
from pytpc.base.errors import RunError, TpcError
from pytpc.ros.graphs import set_live
from pytpc.ros.live_change import LiveChange
from pytpc.ros.ros1.live_values import Robot
from pytpc.values import apply
from pytpc.values.apply import FileChange, apply_change
from pytpc.values.installed import is_installed, of_the_system, source_of
from pytpc.values.journal import Journal, folder_of

# --- installed copies


def workspace(tmp_path: Path) -> tuple[Path, Path]:
    """A workspace with a source and its installed copy; returns both parameter files."""
    source = tmp_path / "ws/src/group/robot"
    share = tmp_path / "ws/install/robot/share/robot"
    for folder in (source, share):
        (folder / "config").mkdir(parents=True)
        (folder / "package.xml").write_text(MANIFEST)
        (folder / "config/p.yaml").write_text("limit: 0.5\n")
    return source / "config/p.yaml", share / "config/p.yaml"


@needs_roslaunch
def test_the_source_of_an_installed_copy_is_changed(apply, tmp_path: Path) -> None:
    source, copy = workspace(tmp_path)
    launch = tmp_path / "a.launch"
    launch.write_text(f'<launch><rosparam file="{copy}"/></launch>')
    done = apply(launch, "limit", "0.25")
    assert (source.read_text(), copy.read_text()) == ("limit: 0.25\n", "limit: 0.5\n")
    assert f"the robot reads the installed copy {copy}" in done.stderr
    assert "build the workspace again" in done.stderr
    again = apply(launch, "limit", "0.75")
    assert "older or newer" in again.stderr
    assert "the robot had 0.5; the file was changed since" in again.stderr


@needs_roslaunch
def test_an_installed_launch_file(apply, tmp_path: Path) -> None:
    source, copy = workspace(tmp_path)
    text = '<launch>\n  <param name="limit" value="0.5"/>\n</launch>\n'
    files = [folder.parent.parent / "launch/a.launch" for folder in (source, copy)]
    for file in files:
        file.parent.mkdir()
        file.write_text(text)
    apply(files[1], "limit", "0.25")
    assert [file.read_text() for file in files] == [text.replace("0.5", "0.25"), text]


def test_sources(tmp_path: Path) -> None:
    source, copy = workspace(tmp_path)
    assert source_of(copy) == source
    assert source_of(source) is None
    assert (is_installed(copy), is_installed(source)) == (True, False)
    # As `colcon build --symlink-install` leaves it.
    copy.unlink()
    copy.symlink_to(source)
    assert source_of(copy) == source
    # The package puts its files elsewhere than they stand.
    moved = copy.parent.parent / "p.yaml"
    moved.write_text("limit: 0.5\n")
    assert source_of(moved) == source
    # Without the sources.
    alone = tmp_path / "alone/share/robot"
    alone.mkdir(parents=True)
    (alone / "package.xml").write_text(MANIFEST)
    (alone / "p.yaml").write_text("a: 1\n")
    assert source_of(alone / "p.yaml") is None
    assert of_the_system(Path("/usr/share/robot/p.yaml"))
    assert not of_the_system(Path("/usr/local/share/robot/p.yaml"))


# --- the journal


def test_a_change_that_somebody_was_faster_with(params: Path, tmp_path: Path) -> None:
    journal = Journal(tmp_path / "journal")
    change = FileChange("/a", params, b"older", b"newer", 1, 2, 1)
    with pytest.raises(TpcError, match="the file has changed meanwhile"):
        apply_change(change, journal)
    assert journal.entries() == []


def test_without_a_note_nothing_is_written(apply, params: Path, tmp_path: Path) -> None:
    (tmp_path / "state").write_text("a file where the folder should be")
    assert "cannot be recorded for --undo" in apply(params, "limit", "0.035", status=1).output
    assert params.read_text() == MISSION_PARAMS


def test_a_note(apply, params: Path, tmp_path: Path) -> None:
    apply(params, "limit", "0.035")
    (note,) = (tmp_path / "state/tpc/applied").glob("*.json")
    document = json.loads(note.read_text())
    assert base64.b64decode(document["before"]) == MISSION_PARAMS.encode()
    # What stood in the file may be nobody else's business.
    assert note.stat().st_mode & 0o777 == 0o600
    note.write_text('{"schema": 9}')
    assert f"{note}: not a recorded change" in apply("--list").output


def test_where_the_notes_are(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    home = tmp_path / ".local/state/tpc/applied"
    assert folder_of({}) == home
    # The standard says that a relative one does not count.
    assert folder_of({"XDG_STATE_HOME": "relative"}) == home
    assert folder_of({"XDG_STATE_HOME": "/x"}) == Path("/x/tpc/applied")


def test_a_full_disk_leaves_the_file_as_it_was(params: Path, monkeypatch) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pytpc.base.atomic.os.fsync", full)
    with pytest.raises(TpcError, match="No space left"):
        replace_file(params, b"new")
    assert params.read_text() == MISSION_PARAMS
    assert [path.name for path in params.parent.glob(".params*")] == []


def test_of_two_changes_at_once_none_is_lost(params: Path, tmp_path: Path, monkeypatch) -> None:
    """The second waits, sees that the file is another one, and does not overwrite the first."""
    journal = Journal(tmp_path / "state")
    before = params.read_bytes()

    def change(old: bytes, new: bytes) -> FileChange:
        return FileChange("/x", params, before, before.replace(old, new), 0, 1, 1)

    writing, errors = threading.Event(), list[TpcError]()

    def second() -> None:
        assert writing.wait(5.0)
        try:
            apply_change(change(b"other: 3", b"other: 4"), journal)
        except TpcError as error:
            errors.append(error)

    def slow_replace(path: Path, data: bytes) -> None:
        writing.set()
        if data == change(b"0.058", b"0.035").after:
            time.sleep(0.3)
        replace_file(path, data)

    monkeypatch.setattr(apply, "replace_file", slow_replace)
    other = threading.Thread(target=second)
    other.start()
    apply_change(change(b"0.058", b"0.035"), journal)
    other.join()
    assert params.read_bytes() == before.replace(b"0.058", b"0.035")
    assert len(errors) == 1
    assert len(journal.entries()) == 1


def test_hard_links_are_said(apply, params: Path, tmp_path: Path) -> None:
    other = tmp_path / "other.yaml"
    other.hardlink_to(params)
    assert "1 other names (hard links)" in apply(params, "mission/limit", "0.035").output
    assert other.read_text() == MISSION_PARAMS


def test_a_note_that_is_broken_keeps_no_other_from_being_taken_back(
    apply, params: Path, tmp_path: Path
) -> None:
    before = params.read_bytes()
    apply(params, "mission/limit", "0.035")
    broken = tmp_path / "state/tpc/applied/000009.json"
    broken.write_text("{")
    assert "000009.json: not a recorded change" in apply("--list").output
    assert "000009.json: not a recorded change" in apply("--undo").output
    assert params.read_bytes() == before
    assert broken.read_text() == "{"


@pytest.mark.parametrize(("now", "kept"), [(0.5, 0), (0.7, 1)])
def test_the_robot_took_it_and_its_answer_was_lost(tmp_path: Path, now: float, kept: int) -> None:
    class Lost(Robot):
        def put(self, name: str, value: object, service: str) -> tuple[object, bool]:
            raise RunError("no answer")

        def value(self, name: str) -> object:
            return now

    journal = Journal(tmp_path / "state")
    with pytest.raises(RunError, match="no answer"):
        set_live(Lost("http://x:1"), LiveChange("http://x:1", "/a", 0.5, 0.7, "", ()), journal)
    assert len(journal.entries()) == kept
