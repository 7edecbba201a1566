"""What is wrong with a launch file's mission, and is better said before it begins."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from pathlib import Path

from pytpc.base.paths import OWN_FOLDER
from pytpc.base.regular_files import has_same_content
from pytpc.values.installed import is_installed, source_of
from pytpc.values.trace import Trace


def doubts(trace: Trace) -> Iterator[str]:
    """Sentences for the user, each with what to type.

    Nodes that roslaunch will not find, what launch of ROS 2 could not work out, and launch files
    and configuration that were changed in the sources but are read as they were installed.
    """
    for package, program in trace.absent:
        yield (
            f"package {package} has no program {program}, so this node will not start: build the"
            " workspace with `pytpc build`, or make the script executable with `chmod +x`"
        )
    for what in trace.unknown:
        yield f"what the launch file sets is not known as a whole: {what}"
    for name in trace.files:
        path = Path(name)
        source = source_of(path) if is_installed(path) else None
        if source is not None and not has_same_content(path, source):
            yield (
                f"{path} is read, an installed copy that differs from {source}; for the change to"
                f" reach the robot, {_build(path)}"
            )


def _build(copy: Path) -> str:
    """What to type so that a copy is made again."""
    for folder in copy.parents:
        if folder.name == OWN_FOLDER:
            return f"run: {shlex.join(['pytpc', 'build', str(folder.parent)])}"
    return "build the workspace again"
