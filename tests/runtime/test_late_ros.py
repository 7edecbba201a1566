"""ROS 2 is loaded while a program reports, and the library has no part for it."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from compiling import compile_program

from pytpc.base.paths import prefix

HERE = Path(__file__).parent


@pytest.fixture(scope="module")
def late(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The program, in a folder with the log library alone and a librcl.so that does nothing."""
    folder = tmp_path_factory.mktemp("late")
    shutil.copy(prefix() / "lib/libtpc_log.so.0", folder)
    empty = folder / "rcl.c"
    empty.write_text("int rcl_init(void) { return 0; }\n")
    words = ["clang-19", "-shared", "-fPIC", str(empty), "-o", str(folder / "librcl.so")]
    subprocess.run(words, check=True, timeout=120)
    return compile_program(HERE / "late_ros.cpp", folder / "late_ros", "-ldl")


def run(
    late: Path, settings: dict[str, str], policy: str, **more: str
) -> subprocess.CompletedProcess[str]:
    chosen = {"TPC_SINK": "topic", "TPC_POLICY": policy, "TPC_PERIOD": "0.02"}
    no_caps = {"TPC_SITE_CAP": "0", "TPC_PROCESS_CAP": "0"}
    env = {**settings, **chosen, **no_caps, **more, "LD_LIBRARY_PATH": str(late.parent)}
    words = [str(late), str(late.parent / "librcl.so")]
    return subprocess.run(words, env=env, capture_output=True, text=True, timeout=60, check=False)


POLICIES = pytest.mark.parametrize("policy", ["every", "edges", "light"])


@POLICIES
def test_reports_go_to_the_file_from_then_on(
    late: Path, settings: dict[str, str], files, policy: str
):
    ran = run(late, settings, policy)
    assert ran.returncode == 0
    (line,) = ran.stderr.splitlines()
    assert line.startswith("tpc: no reports are sent on a topic (")
    assert len(files()) == 1


# The folder is below a file, so it cannot be created. That is tried and told once.
@POLICIES
def test_a_file_that_cannot_be_created_is_told_once(
    late: Path, settings: dict[str, str], tmp_path: Path, policy: str
):
    (tmp_path / "file").touch()
    folder = str(tmp_path / "file/log")
    ran = run(late, settings, policy, TPC_FOLDER=folder)
    assert ran.returncode == 0
    why, lost = ran.stderr.splitlines()
    assert why.endswith("; no reports are written to a file")
    assert re.match(r"tpc: \d+ evaluations were not sent on ", lost)
