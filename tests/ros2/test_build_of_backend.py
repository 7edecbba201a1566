"""The backend of ROS 2 is built where its headers are, and nothing else is where they are not."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

from patience import PATIENCE_S
from pytpc.base.paths import project_root
from ros2_graph import PYTHON, needs_wheels

pytestmark = needs_wheels
WHEELS = PYTHON.parents[1]
"""A folder with all packages in one, as with `colcon build --merge-install`."""


def place(package: str, folder: Path, library: str = "") -> Path:
    """A package in a folder of its own, as colcon installs it by default."""
    own = folder / package
    for part in (f"include/{package}", f"share/{package}"):
        if (WHEELS / part).exists():
            (own / part).parent.mkdir(parents=True)
            (own / part).symlink_to(WHEELS / part)
    (own / "lib").mkdir(parents=True)
    for file in (WHEELS / "lib").glob(f"lib{library or package}*.so"):
        (own / "lib" / file.name).symlink_to(file)
    return own


def configure(build: Path, *sourced: Path) -> str:
    """Configure the log library alone; what CMake says."""
    env = {name: text for name, text in os.environ.items() if "PREFIX" not in name}
    done = subprocess.run(
        [
            *["cmake", "-S", str(project_root() / "runtime_log"), "-B", str(build), "-G", "Ninja"],
            *["-DCMAKE_CXX_COMPILER=clang++-19", "-DCMAKE_C_COMPILER=clang-19"],
            f"-DTPC_ROS2_PREFIX={sourced[0]}",
        ],
        env={**env, "AMENT_PREFIX_PATH": ":".join(map(str, sourced))},
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=True,
    )
    return done.stdout


def make(build: Path, *targets: str) -> None:
    subprocess.run(["ninja", "-C", str(build), *targets], timeout=PATIENCE_S, check=True)


def test_packages_in_folders_of_their_own(tmp_path: Path) -> None:
    here = tmp_path / "a workspace"
    names = sorted(path.name for path in (WHEELS / "include").iterdir())
    folders = [place("rcl", here), *(place(name, here) for name in names if name != "rcl")]
    assert "with rcl" in configure(tmp_path / "build", *folders)
    make(tmp_path / "build", "tpc_log_ros2")


def test_rcl_alone_is_not_enough(tmp_path: Path) -> None:
    said = configure(tmp_path / "build", place("rcl", tmp_path))
    assert "librcutils.so is not beside rcl" in said
    assert "libtpc_log_ros2.so is not built" in said
    targets = subprocess.run(
        ["ninja", "-C", str(tmp_path / "build"), "-t", "targets", "all"],
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=True,
    )
    assert "tpc_log:" in targets.stdout
    assert "tpc_log_ros2" not in targets.stdout
