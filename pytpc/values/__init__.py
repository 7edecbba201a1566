"""Where the values of parameters come from, and how they are changed."""

from __future__ import annotations

from pathlib import Path


def launch_tracer_path() -> Path:
    """The program that reads launch files with roslaunch's own loader."""
    return Path(__file__).with_name("tracer") / "launch_tracer.py"
