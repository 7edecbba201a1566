"""What nodes write can be read by their user alone, in C++ and in Python."""

from __future__ import annotations

import fcntl
import os
import stat
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# Opens the log of this process, as the first report of a node does.
PYTHON = (
    "from pytpc.python_runtime.config import Config\n"
    "from pytpc.python_runtime.mapped_file import _created\n"
    "import os, sys\n"
    "os.umask(0)\n"
    "try:\n"
    "    path, descriptor = _created(Config(folder=os.environ.get('TPC_FOLDER', '')), '/n')\n"
    "    os.rename(path + '.new', path)\n"
    "except OSError as error:\n"
    "    sys.exit(f'{error.filename}: {error.strerror}')\n"
)
Node = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(params=["C++", "Python"])
def node(request: pytest.FixtureRequest, settings: dict[str, str]) -> Node:
    """Run a node that reports to a file, with these variables changed or (None) taken away."""
    if request.param == "C++":
        program = request.getfixturevalue("program")
        words = ["sh", "-c", 'umask 0; exec "$0" threads 1 1 10', str(program)]
    else:
        words = [sys.executable, "-c", PYTHON]

    def run(**changes: str | None) -> subprocess.CompletedProcess[str]:
        env = {**settings, "PYTHONPATH": str(ROOT), **changes}
        given = {name: value for name, value in env.items() if value is not None}
        return subprocess.run(
            words, env=given, capture_output=True, text=True, timeout=60, check=False
        )

    return run


def modes(*paths: Path) -> list[str]:
    return [stat.filemode(path.stat().st_mode) for path in paths]


def test_modes(node: Node, tmp_path: Path) -> None:
    """The folder that was there keeps its mode."""
    tmp_path.chmod(0o755)
    assert node(TPC_FOLDER=str(tmp_path / "a/b")).stderr == ""
    (file,) = (tmp_path / "a/b").glob("*.tpc")
    assert modes(tmp_path, tmp_path / "a", tmp_path / "a/b", file) == [
        "drwxr-xr-x",
        "drwx------",
        "drwx------",
        "-rw-------",
    ]


@pytest.fixture
def private() -> Iterator[Path]:
    """The folder that is used without a home; one test at a time has it."""
    folder = Path(f"/tmp/tpc-{os.geteuid()}")
    with Path(f"{folder}-of-tests.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if folder.exists() or folder.is_symlink():
            pytest.skip(f"{folder} is there")
        yield folder
        if folder.is_symlink():
            folder.unlink()
        elif folder.exists():
            for path in folder.iterdir():
                path.unlink()
            folder.rmdir()


def test_without_a_home(node: Node, private: Path) -> None:
    for _ in range(2):
        assert node(HOME=None, ROS_HOME=None, TPC_FOLDER=None).stderr == ""
    files = list(private.glob("*.tpc"))
    assert files
    assert modes(private, files[0]) == ["drwx------", "-rw-------"]


@pytest.mark.parametrize("kind", ["link", "open to others"])
def test_a_folder_that_is_not_ones_own(
    node: Node, private: Path, tmp_path: Path, kind: str
) -> None:
    if kind == "link":
        private.symlink_to(tmp_path)
    else:
        private.mkdir()
        private.chmod(0o777)
    said = node(HOME=None, ROS_HOME=None, TPC_FOLDER=None).stderr
    assert f"{private}: not a folder of this user alone; set TPC_FOLDER or HOME" in said
    assert list(private.glob("*.tpc*")) == []
