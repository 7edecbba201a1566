"""The words of `record` and `run`: a workspace, what is launched, and the output folder."""

from __future__ import annotations

import os
import re
import time
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import click

_NOT_IN_NAMES = re.compile(r"[^\w.-]+")
_OUT = Path("out")
_MOST_WORDS = 3
_NODE_ARGS = "pytpc.node_args"


class MissionCommand(click.Command):
    """A command whose words behind ``--`` are arguments of nodes: ``node_args`` of the context."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Take these words apart, which click would put behind the others."""
        at = args.index("--") if "--" in args else len(args)
        ctx.meta[_NODE_ARGS] = tuple(args[at + 1 :])
        return super().parse_args(ctx, args[:at])


def node_args() -> tuple[str, ...]:
    """The words behind ``--`` of the command that runs."""
    found: tuple[str, ...] = click.get_current_context().meta.get(_NODE_ARGS, ())
    return found


class LaunchWords(NamedTuple):
    """What the user gave: ``package`` is empty where ``launch`` is a path.

    ``is_path``: the user's word says in which folder the launch file is, if only by ``./``.
    ``programs`` are words behind the third one, executables of ROS 2 as ``launch`` then is, and
    ``node_args`` what stands behind ``--``.
    """

    workspace: Path | None
    package: str
    launch: Path | None
    args: dict[str, str]
    is_path: bool = False
    programs: tuple[str, ...] = ()
    node_args: tuple[str, ...] = ()

    @classmethod
    def of(cls, words: Sequence[str], node_args: Sequence[str] = ()) -> LaunchWords:
        """Sort the words; NAME:=VALUE may stand anywhere before ``--``.

        Args:
            words: before ``--``.
            node_args: behind it.

        Raises:
            UsageError: they are too few or too many.
        """
        args: dict[str, str] = {}
        paths: list[str] = []
        for word in words:
            name, separator, value = word.partition(":=")
            if separator and name:
                args[name] = value
            elif separator or (len(paths) > 1 and "=" in word and not Path(word).exists()):
                raise click.BadParameter(f"{word!r} is not NAME:=VALUE", param_hint="ARGS")
            else:
                paths.append(word)
        if len(paths) == 1:
            raise click.UsageError(
                "give both WORKSPACE and LAUNCH (a file, or PACKAGE and FILE); for a robot that"
                " runs already: pytpc record --static WORKSPACE"
            )
        if len(paths) >= _MOST_WORDS and Path(paths[1]).is_file():
            raise click.BadParameter(f"{paths[-1]!r} is not NAME:=VALUE", param_hint="ARGS")
        if not paths:
            return cls(None, "", None, args)
        if len(paths) < _MOST_WORDS:
            is_path = os.sep in paths[-1]
            return cls(Path(paths[0]), "", Path(paths[-1]), args, is_path, (), tuple(node_args))
        folder, package, launch, *programs = paths
        is_path = os.sep in launch
        more = (tuple(programs), tuple(node_args))
        return cls(Path(folder), package, Path(launch), args, is_path, *more)


def folder_for(launch: Path | None, output: Path | None) -> Path:
    """The folder of the recording: the user's choice, or a new one below ``out``."""
    if output is not None:
        return output
    name = "recording" if launch is None else _NOT_IN_NAMES.sub("-", launch.stem)
    return _OUT / f"{name}-{time.strftime('%Y%m%d-%H%M%S')}"
