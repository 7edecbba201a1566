"""Recordings that run are found by other terminals, and which graph a command then uses."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import asdict, replace
from pathlib import Path

import click
import pytest

from pytpc.base.errors import RunError
from pytpc.base.signals import Stop, end_group, signals_end
from pytpc.cli import running_graph
from pytpc.cli.launch_words import LaunchWords, folder_for
from pytpc.cli.run_commands import _is_mission
from pytpc.cli.running_graph import use_graph
from pytpc.ros import running
from pytpc.ros.caller_env import with_callers
from pytpc.ros.ros1 import launch_files
from pytpc.ros.ros1.launch_files import find_launch
from pytpc.ros.running import RunningRecording, announced, process_start, running_recordings
from terminals import pytpc


@pytest.fixture(autouse=True)
def runtime(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "run"
    folder.mkdir(mode=0o700)
    (tmp_path / "tmp").mkdir()
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(folder))
    monkeypatch.setattr(running.tempfile, "gettempdir", lambda: str(tmp_path / "tmp"))
    for name in ("ROS_MASTER_URI", "ROS_IP", "ROS_HOSTNAME"):
        # So that what a test sets is taken back.
        monkeypatch.setenv(name, "")
    return folder / "pytpc"


def entry(folder: str = "/out/a", port: int = 1234, pid: int | None = None) -> RunningRecording:
    number = os.getpid() if pid is None else pid
    return RunningRecording(
        number, process_start(number) or 0, f"http://127.0.0.1:{port}", "127.0.0.1", folder
    )


def test_an_entry_is_private_and_gone_at_the_end(runtime):
    with announced(entry()):
        assert running_recordings() == [entry()]
        assert runtime.stat().st_mode & 0o777 == 0o700
        assert [path.stat().st_mode & 0o777 for path in runtime.iterdir()] == [0o600]
    assert running_recordings() == []
    assert list(runtime.iterdir()) == []


def test_a_folder_that_others_can_read_or_that_is_a_link_is_not_used(runtime, tmp_path):
    runtime.mkdir(mode=0o755)
    ours = tmp_path / f"tmp/pytpc-{os.getuid()}"
    with announced(entry()):
        assert running_recordings() == [entry()]
        assert list(runtime.iterdir()) == []
        assert len(list(ours.iterdir())) == 1
    runtime.rmdir()
    (tmp_path / "other").mkdir(mode=0o700)
    runtime.symlink_to(tmp_path / "other")
    with announced(entry()):
        assert running_recordings() == [entry()]
        assert list((tmp_path / "other").iterdir()) == []
    # Somebody else was first in /tmp, too: then nothing is written.
    ours.chmod(0o755)
    with announced(entry()):
        assert running_recordings() == []
        assert list(ours.iterdir()) == []


# As after `su`, whose shell keeps the variable.
@pytest.mark.skipif(os.getuid() != 0, reason="only root can give a folder away")
def test_the_runtime_folder_of_another_user_is_not_used(runtime, tmp_path, monkeypatch):
    os.chown(runtime.parent, 54321, 54321)
    with announced(entry()):
        assert running_recordings() == [entry()]
        assert not runtime.exists()


def test_stale_and_broken_entries_are_removed(runtime):
    child = subprocess.Popen([sys.executable, "-c", "pass"])
    child.wait(20)
    gone = entry(pid=child.pid)
    # The number of this process, as if it had been used by another one before.
    reused = replace(entry(), process_start=(process_start(os.getpid()) or 0) - 1)
    with announced(entry()):
        for name, text in {
            "1": json.dumps(asdict(gone)),
            "2": json.dumps(asdict(reused)),
            "3": "{",
            "4": json.dumps({**asdict(entry()), "folder": 7}),
            "5": json.dumps({"pid": 1}),
        }.items():
            (runtime / f"{name}.recording.json").write_text(text)
        assert running_recordings() == [entry()]
        assert len(list(runtime.iterdir())) == 1


def test_without_a_runtime_folder_it_is_a_private_one_of_ours(tmp_path, monkeypatch):
    monkeypatch.delenv("XDG_RUNTIME_DIR")
    monkeypatch.setattr(running, "_USERS", tmp_path / "none")
    with announced(entry()):
        assert (tmp_path / f"tmp/pytpc-{os.getuid()}").stat().st_mode & 0o777 == 0o700
        assert running_recordings() == [entry()]


# --- which graph


@pytest.fixture
def answering(monkeypatch: pytest.MonkeyPatch) -> set[str]:
    """The masters that answer."""
    found: set[str] = set()
    monkeypatch.setattr(running_graph, "_answers", found.__contains__)
    return found


ROBOT = "http://robot:11311"


def choose(monkeypatch: pytest.MonkeyPatch, *there: RunningRecording, folder: Path | None = None):
    monkeypatch.setattr(running_graph, "running_recordings", lambda: list(there))
    return use_graph(folder)


def test_the_only_recording_is_used_and_named(monkeypatch, answering, capsys):
    os.environ["ROS_HOSTNAME"] = "laptop"
    chosen = choose(monkeypatch, entry())
    assert chosen.master == "http://127.0.0.1:1234"
    assert os.environ["ROS_MASTER_URI"] == chosen.master
    assert os.environ["ROS_IP"] == "127.0.0.1"
    assert "ROS_HOSTNAME" not in os.environ
    assert capsys.readouterr().err == (
        "pytpc: using the recording that runs: /out/a (a running graph, master"
        " http://127.0.0.1:1234)\n"
    )


def test_a_master_that_answers_is_the_users_choice(monkeypatch, answering, capsys):
    os.environ["ROS_MASTER_URI"] = ROBOT
    answering.add(ROBOT)
    assert choose(monkeypatch, entry()) == (ROBOT, None)
    assert "--recording /out/a" in capsys.readouterr().err
    # Its own recording is known by it.
    same = replace(entry(), master=ROBOT)
    assert choose(monkeypatch, same).recording == same


def test_a_master_in_bashrc_that_does_not_answer(monkeypatch, answering, capsys):
    os.environ["ROS_MASTER_URI"] = ROBOT
    assert choose(monkeypatch, entry()).recording == entry()
    assert f"nothing answers at ROS_MASTER_URI ({ROBOT})" in capsys.readouterr().err
    # Without a recording, whoever uses it waits for it.
    os.environ["ROS_MASTER_URI"] = ROBOT
    assert choose(monkeypatch) == (ROBOT, None)


def test_several_recordings_have_to_be_named(monkeypatch, answering):
    two = entry("/out/a"), entry("/out/b", 4321)
    with pytest.raises(RunError, match=r"2 recordings run here; .*--recording.*/out/a.*/out/b"):
        choose(monkeypatch, *two)
    assert choose(monkeypatch, *two, folder=Path("/out/b")).recording == two[1]
    with pytest.raises(RunError, match=r"/out/c: no recording runs in this folder; there is /out"):
        choose(monkeypatch, *two, folder=Path("/out/c"))
    # Two of one graph both get the marks.
    assert choose(monkeypatch, entry("/out/a"), entry("/out/b")).recording == entry("/out/b")


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ("http://localhost:11311", "http://127.0.0.1:11311/", True),
        ("http://localhost:11311", "http://localhost:11312", False),
        ("http://robot:11311", "http://localhost:11311", False),
        ("http://robot:11311", "http://robot:11311/", True),
    ],
)
def test_two_names_of_one_master(one, other, same):
    assert running_graph._is_same(one, other) is same


# --- the words


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ([], (None, "", None, {})),
        (["a:=1"], (None, "", None, {"a": "1"})),
        (
            ["ws", "x.launch", "a:=1", "b:="],
            (Path("ws"), "", Path("x.launch"), {"a": "1", "b": ""}),
        ),
        (
            ["a:=1", "ws", "b:=2", "pkg", "x.launch"],
            (Path("ws"), "pkg", Path("x.launch"), {"a": "1", "b": "2"}),
        ),
        (
            ["ws", "pkg", "guard", "arm/driver"],
            (Path("ws"), "pkg", Path("guard"), {}, False, ("arm/driver",)),
        ),
    ],
)
def test_words_in_any_order(words, expected):
    assert LaunchWords.of(words) == LaunchWords(*expected)


@pytest.mark.parametrize(
    ("words", "wrong"),
    [
        (["ws"], "give both WORKSPACE and LAUNCH"),
        (["ws"], "a robot that runs already: pytpc record --static WORKSPACE"),
        (["ws", "x.launch", "seed=1"], "'seed=1' is not NAME:=VALUE"),
        (["ws", "x.launch", ":=1"], "':=1' is not NAME:=VALUE"),
    ],
)
def test_wrong_words(words, wrong):
    with pytest.raises(click.UsageError) as caught:
        LaunchWords.of(words)
    assert wrong in caught.value.format_message()


def test_the_default_folder_has_the_name_and_the_time():
    assert folder_for(Path("x.launch"), Path("mine")) == Path("mine")
    made = folder_for(Path("a/my robot.launch"), None)
    assert made.parent == Path("out")
    assert made.name.startswith("my-robot-2")


@pytest.mark.parametrize(
    ("words", "is_mission"),
    [
        (["ws", "x.launch"], True),
        (["-o", "out", "ws", "x.launch"], True),
        (["node.py", "-o", "out"], False),
        (["--static", "ws", "node.py"], False),
        (["--static=ws", "--verbose", "node.py", "ws"], False),
    ],
)
def test_what_is_run_is_a_mission_or_a_node(words, is_mission, tmp_path, monkeypatch):
    (tmp_path / "ws").mkdir()
    monkeypatch.chdir(tmp_path)
    assert _is_mission(words) is is_mission


def test_options_behind_a_node_are_its_own(tmp_path):
    (tmp_path / "node.py").write_text("import sys\nprint(sys.argv[1:])\n")
    done = subprocess.run(
        pytpc("run", "node.py", "-o", "x", "--no-keys", "a:=1"),
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(Path(__file__).parents[2])},
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.stdout.strip().endswith("['-o', 'x', '--no-keys', 'a:=1']"), done.stderr


# --- the environment


# Of the caller's lists, those of sourced workspaces come behind; a virtual environment does not.
def test_what_the_caller_sourced_comes_behind_the_workspace():
    env = {
        "PATH": "/usr/bin",
        "ROS_PACKAGE_PATH": "/ws/share",
        "ROBOT": "ws",
        "PYTHONPATH": "/ws/py",
    }
    caller = {
        "PATH": "/venv/bin:/under/bin:/usr/bin",
        "ROS_PACKAGE_PATH": "/under/share:/ws/share",
        "CMAKE_PREFIX_PATH": "/under",
        "PYTHONPATH": "/venv/lib:/under/lib/python3:",
        "ROBOT": "shell",
        "DISPLAY": ":0",
        "ROS_MASTER_URI": "http://robot:11311",
        "ROS_NAMESPACE": "/n",
        "TPC_POLICY": "every",
        "VIRTUAL_ENV": "/venv",
        "LD_PRELOAD": "x.so",
        "PWD": "/",
    }
    assert with_callers(env, caller) == {
        "PATH": "/usr/bin:/under/bin",
        "ROS_PACKAGE_PATH": "/ws/share:/under/share",
        "CMAKE_PREFIX_PATH": "/under",
        "PYTHONPATH": "/ws/py:/under/lib/python3",
        "ROBOT": "ws",
        "DISPLAY": ":0",
    }


# A Ctrl-C reaches all processes of the terminal's session, also the one that looks for the file.
def test_the_search_for_a_launch_file_is_out_of_reach_of_ctrl_c(tmp_path, monkeypatch):
    roslaunch = tmp_path / "roslaunch"
    roslaunch.write_text("#!/usr/bin/python3\n")
    roslaunch.chmod(0o755)
    ask = "import os, sys; print(sys.argv[2] if os.getsid(0) == os.getpid() else 'reached')"
    monkeypatch.setattr(launch_files, "_ASK", ask)
    assert find_launch({"PATH": str(tmp_path)}, "package", str(roslaunch)) == roslaunch


# --- signals


def test_the_second_signal_is_a_hurry_and_a_lost_terminal_is_none():
    stop = Stop()
    with stop.on_signals():
        os.kill(os.getpid(), signal.SIGHUP)
        os.kill(os.getpid(), signal.SIGHUP)
        assert (stop.is_set(), stop.in_a_hurry) == (True, False)
        os.kill(os.getpid(), signal.SIGINT)
        assert stop.in_a_hurry
    assert signal.getsignal(signal.SIGHUP) == signal.SIG_DFL


# nohup has it ignored, so that what runs outlives the terminal.
@pytest.mark.parametrize("taking", [Stop().on_signals, signals_end])
def test_a_hang_up_that_is_ignored_stays_ignored(taking):
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)
    try:
        with taking():
            assert signal.getsignal(signal.SIGHUP) == signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)


# It ignores SIGINT, and would have ten minutes to end.
def test_a_hurry_ends_what_does_not_end():
    script = (
        "import signal, time; signal.signal(signal.SIGINT, signal.SIG_IGN); print(1, flush=True)"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", f"{script}; time.sleep(600)"],
        stdout=subprocess.PIPE,
        start_new_session=True,
    )
    with process:
        assert process.stdout is not None
        process.stdout.readline()
        asked = time.monotonic()
        status = end_group(process, 600.0, 600.0, lambda: time.monotonic() > asked + 0.2)
    assert status == -signal.SIGTERM
