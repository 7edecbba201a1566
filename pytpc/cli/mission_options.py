"""The options that `record` and `run` share.

`pytpc run` starts each node of a launch file, so that this imports nothing that takes long.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import click

from pytpc.base.wording import plain
from pytpc.cli.arguments import PATH, Command
from pytpc.cli.launch_words import LaunchWords
from pytpc.cli.lines import say

if TYPE_CHECKING:
    from pytpc.ros.mission_run import DiedNode, RecordOptions


@dataclass(frozen=True)
class MissionArguments:
    """The options of a mission that is recorded."""

    output: Path | None
    timeout_s: float | None
    until: str | None
    topics: tuple[str, ...]
    wall_time: bool
    no_python: bool

    @property
    def use_sim_time(self) -> bool | None:
        """Whether the graph runs on /clock; None: the launch file says so, or not."""
        return False if self.wall_time else None

    def options(self, output: Path, words: LaunchWords) -> RecordOptions:
        """What is recorded, where, and until when."""
        from pytpc.ros.mission_run import RecordOptions  # noqa: PLC0415

        return RecordOptions(
            output,
            words.launch,
            words.args,
            self.timeout_s,
            until=self.until,
            topics=self.topics,
            package=words.package,
            programs=words.programs,
            arguments=words.node_args,
            on_kept=_tell_kept,
            on_doubt=_tell_doubt,
            on_quiet=_tell_quiet,
            on_died=_Deaths().tell,
        )


def _tell_kept(kept: Sequence[Path]) -> None:
    names = ", ".join(plain(str(path)) for path in kept)
    say(f"marks of the earlier recording are kept: {names}")


def _tell_doubt(doubt: str) -> None:
    say(f"warning: {plain(doubt)}")


def _tell_quiet(line: str, is_fault: bool) -> None:
    # A terminal that was closed must not end the recording.
    with suppress(OSError):
        say(plain(f"pytpc: {'warning: ' if is_fault else ''}{line}"))


def tell_died(died: DiedNode) -> None:
    """Warn of a node that died, with the last lines of its output."""
    rest = "; the last lines of output are" if died.said else ", and said nothing"
    with suppress(OSError):
        say(plain(f"pytpc: warning: {died.words}{rest}"))
        for line in died.said:
            say(plain(f"    {line}"))
        say(plain(f"  in {died.log}"))


class _Deaths:
    """Tells of nodes that die; roslaunch may start one again every second."""

    def __init__(self) -> None:
        """Nobody has died yet."""
        self._counts: Counter[str] = Counter()

    def tell(self, died: DiedNode) -> None:
        """Tell of the first death in full, then of the tenth, the hundredth and so on."""
        self._counts[died.name] += 1
        count = self._counts[died.name]
        if count == 1:
            tell_died(died)
        elif str(count).strip("0") == "1":
            with suppress(OSError):
                say(plain(f"pytpc: warning: {died.words}, {count:,} times so far"))


def MISSION_OPTIONS(command: Command) -> Command:
    """Add the options of ``MissionArguments``."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


_OPTIONS = (
    click.option(
        "-o",
        "--output",
        type=PATH,
        help="Folder for the bag and what describes the run. [default: a new one in out/]",
    ),
    click.option(
        "--timeout",
        "timeout_s",
        type=click.FloatRange(min=1.0),
        metavar="SECONDS",
        help="Stop after this time. [default: at Ctrl-C, or when the mission ends]",
    ),
    click.option(
        "--until",
        metavar="TOPIC",
        help="Stop when this topic (std_msgs/Bool) says that the mission is done.",
    ),
    click.option(
        "--topic",
        "topics",
        multiple=True,
        help="Record this topic, too, besides those of reports and marks; may be repeated.",
    ),
    click.option(
        "--wall-time",
        is_flag=True,
        help="Run in real time, without a /clock. [default: as the launch file sets /use_sim_time]",
    ),
    click.option("--no-python", is_flag=True, help="Run Python nodes without reports."),
)
