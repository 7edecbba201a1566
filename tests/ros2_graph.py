"""Programs under the interpreter that has rclpy, for tests on a real ROS 2 graph."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

from patience import PATIENCE_S
from pytpc.base.paths import prefix, project_root

PYTHON = project_root() / ".venv-ros2/bin/python"
"""The interpreter with the wheels of ROS 2, which `tools/setup test` installs."""
needs_wheels = pytest.mark.skipif(
    not PYTHON.exists(), reason="the wheels of ROS 2 are not installed"
)
needs_backend = pytest.mark.skipif(
    not (prefix() / "lib/libtpc_log_ros2.so").exists(),
    reason="the log library was built without ROS 2",
)


def ros2_env(domain: dict[str, str], **more: str) -> dict[str, str]:
    """The environment of a process on that graph, without anything of ROS 1 or of the caller."""
    kept = {
        name: os.environ[name] for name in ("HOME", "LANG", "XDG_RUNTIME_DIR") if name in os.environ
    }
    return {**kept, "PATH": os.defpath, **domain, **more}


def run_python(
    program: Path, domain: dict[str, str], *words: str, **env: str
) -> subprocess.CompletedProcess[str]:
    """Run a program under the interpreter of ROS 2 until it ends."""
    return subprocess.run(
        [PYTHON, program, *words],
        env=ros2_env(domain, **env),
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )


def wheels_env() -> dict[str, str]:
    """What a program on rcl needs of the wheels: Python's own programs find this by themselves.

    The wheels' libraries for Python are not linked with it.
    """
    packages = PYTHON.parents[1] / "lib/python3.11/site-packages"
    folders = [PYTHON.parents[1] / "lib", *sorted(packages.glob("ros_*.libs"))]
    return {
        "LD_LIBRARY_PATH": ":".join(map(str, folders)),
        "LD_PRELOAD": "libpython3.11.so.1.0",
    }


def compile_on_rcl(source: Path, output: Path, *flags: str, with_log: bool = True) -> Path:
    """Build one C++ file with rcl, and with the log library before it."""
    ros = PYTHON.parents[1]
    packages = [one for one in (ros / "include").iterdir() if (one / one.name).is_dir()]
    subprocess.run(
        [
            "clang++-19",
            *["-std=c++17", "-O2", "-Wall", "-Werror", "-pthread", f"-I{prefix()}/include/tpc"],
            *[word for one in packages for word in ("-isystem", str(one))],
            *[*flags, str(source), "-o", str(output)],
            *([f"-L{prefix()}/lib", "-ltpc_log", f"-Wl,-rpath,{prefix()}/lib"] * with_log),
            *[f"-L{ros}/lib", "-lrcl", "-lrcutils", "-Wl,--allow-shlib-undefined"],
        ],
        check=True,
        timeout=PATIENCE_S,
    )
    return output
