"""Commands of pytpc on a ROS 2 graph, in a process of their own."""

from __future__ import annotations

import contextlib
import json
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

from patience import PATIENCE_S, wait_for
from pytpc.base.paths import project_root

Running = AbstractContextManager[subprocess.Popen[str]]
SOME_REPORTS = r" [1-9][\d,]* reports"
"""What `record` says once a node has been heard."""


def pytpc(*words: object) -> list[str]:
    """The command line of pytpc; nodes that it starts find nothing of this project."""
    code = (
        "import sys; sys.path.insert(0, sys.argv.pop(1)); from pytpc.cli.main import main; main()"
    )
    return [sys.executable, "-c", code, str(project_root()), *map(str, words)]


def told(env: dict[str, str], folder: Path, *words: object, status: int = 0) -> str:
    """What a command says, which ends with this status."""
    ran = _ran(env, folder, *words)
    assert ran.returncode == status, (ran.stdout, ran.stderr)
    return ran.stdout + ran.stderr


def answer(env: dict[str, str], folder: Path, *words: object) -> Any:
    """What a command answers with ``--json``; what it says beside that depends on the time."""
    ran = _ran(env, folder, *words, "--json")
    assert ran.returncode == 0, (ran.stdout, ran.stderr)
    return json.loads(ran.stdout)


def _ran(env: dict[str, str], folder: Path, *words: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        pytpc(*words),
        env=env,
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )


@contextlib.contextmanager
def running(
    command: list[str], env: dict[str, str], folder: Path
) -> Iterator[subprocess.Popen[str]]:
    """A program that is killed in the end, unless it has ended."""
    with subprocess.Popen(
        command,
        env=env,
        cwd=folder,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def interrupted(process: subprocess.Popen[str]) -> str:
    """What a command says that Ctrl-C ends well."""
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 0, err
    return out + err


def read_until(process: subprocess.Popen[str], pattern: str) -> list[str]:
    """The lines on standard error up to the one in which this pattern is."""
    assert process.stderr is not None
    said = []
    for line in process.stderr:
        said.append(line)
        if re.search(pattern, line):
            return said
    raise AssertionError(said)


@contextlib.contextmanager
def recorder(env: dict[str, str], folder: Path, *words: str) -> Iterator[subprocess.Popen[str]]:
    """`pytpc record` into ``mission``, once other commands find it."""
    with running(pytpc("record", "-o", "mission", *words), env, folder) as process:
        read_until(process, "press Ctrl-C to stop")
        entries = Path(env["XDG_RUNTIME_DIR"]) / "pytpc"

        def is_found() -> bool:
            assert process.poll() is None, process.stderr.read()
            return entries.is_dir() and any(entries.iterdir())

        wait_for(is_found)
        yield process
