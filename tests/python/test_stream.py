"""`pytpc stream` of a recording, and what it does when a viewer goes."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import click
import pytest

from patience import PATIENCE_S, wait_for
from pytpc.cli import stream_commands
from pytpc.diagnosis.question import PLAIN
from terminals import pytpc

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples/recorded_mission"


# Its five marks come later: a verdict by them at its beginning would be of the future.
def test_a_recording_begins_without_its_marks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stream_commands, "_viewer", lambda *_: None)
    given = stream_commands._StreamArguments(
        EXAMPLE, None, None, None, False, (), "doubt", 12.0, None, 0.01
    )
    with click.Context(stream_commands.stream_command), ExitStack() as stack:
        stream: Any = stream_commands._recorded(given, PLAIN, stack)._stream
        wait_for(lambda: stream._judged.found is not None)
        stream.tick()
        assert stream._judged.found.run.recording.marks == ()
        assert stream.is_judged


def test_a_viewer_that_is_slow_is_not_gone() -> None:
    rerun_export = pytest.importorskip("pytpc.present.viewers.rerun_export")
    rr = pytest.importorskip("rerun", reason="rerun-sdk needs Python 3.11")
    viewer = rerun_export.RerunViewer(rr, None)
    viewer.stream.memory_recording()
    assert viewer.reaches(0.1)


def test_the_first_time_tells_a_simulators_clock() -> None:
    np = pytest.importorskip("numpy")
    rerun_export = pytest.importorskip("pytpc.present.viewers.rerun_export")
    rr = pytest.importorskip("rerun", reason="rerun-sdk needs Python 3.11")
    kinds = []
    for first_ns in (5 * 10**9, 1_700_000_000 * 10**9):
        column = rerun_export.RerunViewer(rr, None)._times(np.array([first_ns], np.int64))
        kinds.append(str(column.as_arrow_array().type))
    assert kinds == ["duration[ns]", "timestamp[ns]"]


@contextmanager
def viewer_at(folder: Path) -> Iterator[tuple[subprocess.Popen[bytes], int]]:
    """Rerun's server, and its port."""
    pytest.importorskip("rerun", reason="rerun-sdk needs Python 3.11")
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        port = int(one.getsockname()[1])
    words = ["--save", str(folder / "kept.rrd"), "--port", str(port), "--bind", "127.0.0.1"]
    rerun = Path(sys.executable).with_name("rerun")
    env = {**os.environ, "HOME": str(folder)}
    # The command starts the viewer itself as a process of its own.
    process = subprocess.Popen(
        [rerun, *words], env=env, stderr=subprocess.DEVNULL, start_new_session=True
    )
    try:
        wait_for(lambda: is_open(port))
        yield process, port
    finally:
        end(process)


def end(viewer: subprocess.Popen[bytes]) -> None:
    with suppress(ProcessLookupError):
        os.killpg(viewer.pid, signal.SIGKILL)
    viewer.wait(PATIENCE_S)


def is_open(port: int) -> bool:
    with socket.socket() as one:
        return one.connect_ex(("127.0.0.1", port)) == 0


def streaming(folder: Path, port: int) -> subprocess.Popen[str]:
    mission = shutil.copytree(EXAMPLE, folder / "mission")
    return subprocess.Popen(
        pytpc("stream", str(mission), "--rerun", f"127.0.0.1:{port}"),
        env={**os.environ, "HOME": str(folder), "PYTHONPATH": str(ROOT)},
        stderr=subprocess.PIPE,
        text=True,
    )


def has_grown(path: Path) -> bool:
    return path.exists() and path.stat().st_size > 2000


# Rerun's own flush waits without an end.
def test_it_ends_with_one_line_when_the_viewer_goes(tmp_path: Path) -> None:
    with viewer_at(tmp_path) as (viewer, port), streaming(tmp_path, port) as process:
        wait_for(lambda: has_grown(tmp_path / "kept.rrd"))
        end(viewer)
        _, said = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 1
    assert "pytpc: error: the viewer of Rerun's is gone; start one" in said
    assert "Traceback" not in said


# It would have ended by itself.
def test_ctrl_c_interrupts_a_recording(tmp_path: Path) -> None:
    with viewer_at(tmp_path) as (_, port), streaming(tmp_path, port) as process:
        wait_for(lambda: has_grown(tmp_path / "kept.rrd"))
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130
    assert "pytpc: passed on" in said
