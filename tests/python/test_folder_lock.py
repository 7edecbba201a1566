"""One recording at a time writes to a folder."""

from __future__ import annotations

import subprocess

import pytest
from click.testing import CliRunner

from pytpc.base.errors import RunError
from pytpc.base.folder_lock import alone_in
from pytpc.base.signals import Stop
from pytpc.cli.main import main
from pytpc.ros.mission_run import RecordOptions
from pytpc.ros.ros1.record_mission import record_graph


def test_a_folder_takes_one_recording_at_a_time(tmp_path):
    folder = tmp_path / "out"
    folder.mkdir()
    with (
        alone_in(folder),
        pytest.raises(RunError, match=f"{folder}: another recording is being written"),
        alone_in(folder),
    ):
        pass
    with alone_in(folder):
        pass
    assert list(folder.iterdir()) == []


# The recorder outlives a killed `pytpc record` by a moment.
def test_a_process_that_inherits_the_lock_holds_the_folder(tmp_path):
    with alone_in(tmp_path) as lock:
        child = subprocess.Popen(["cat"], stdin=subprocess.PIPE, pass_fds=[lock])
        name = (tmp_path / ".recording.lock").rename(tmp_path / "kept")
    name.rename(tmp_path / ".recording.lock")
    with child:
        with pytest.raises(RunError, match="another recording"), alone_in(tmp_path):
            pass
        child.communicate()
    with alone_in(tmp_path):
        pass


def test_a_running_graph_is_not_recorded_into_a_folder_in_use(tmp_path):
    with alone_in(tmp_path), pytest.raises(RunError, match="another recording is being written"):
        record_graph(RecordOptions(tmp_path), Stop(), {"ROS_MASTER_URI": "http://127.0.0.1:9"})


# The bag of a recording that goes on is not one to reindex.
def test_the_command_says_that_another_recording_goes_on(tmp_path):
    (tmp_path / "mission.bag.active").touch()
    with alone_in(tmp_path):
        done = CliRunner().invoke(main, ["record", "-o", str(tmp_path)])
    assert done.exit_code == 1
    assert f"{tmp_path}: another recording is being written in this folder" in done.stderr
    done = CliRunner().invoke(main, ["record", "-o", str(tmp_path)])
    assert f"{tmp_path}/mission.bag.active: is an unfinished recording; recover it" in done.stderr
