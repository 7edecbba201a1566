"""The words of `record` and `run`: a workspace, what roslaunch is given, and the output folder."""

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


class LaunchWords(NamedTuple):
    """What the user gave: ``package`` is empty where ``launch`` is a path.

    ``is_path``: the user's word says in which folder the launch file is, if only by ``./``.
    """

    workspace: Path | None
    package: str
    launch: Path | None
    args: dict[str, str]
    is_path: bool = False

    @classmethod
    def of(cls, words: Sequence[str]) -> LaunchWords:
        """Sort the words; NAME:=VALUE may stand anywhere.

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
        if len(paths) > _MOST_WORDS or (len(paths) == _MOST_WORDS and Path(paths[1]).is_file()):
            raise click.BadParameter(f"{paths[-1]!r} is not NAME:=VALUE", param_hint="ARGS")
        if not paths:
            return cls(None, "", None, args)
        package = paths[1] if len(paths) == _MOST_WORDS else ""
        return cls(Path(paths[0]), package, Path(paths[-1]), args, os.sep in paths[-1])


def folder_for(launch: Path | None, output: Path | None) -> Path:
    """The folder of the recording: the user's choice, or a new one below ``out``."""
    if output is not None:
        return output
    name = "recording" if launch is None else _NOT_IN_NAMES.sub("-", launch.stem)
    return _OUT / f"{name}-{time.strftime('%Y%m%d-%H%M%S')}"
