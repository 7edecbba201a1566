"""What a script runs: itself, or the module of an entry point (``console_scripts``).

An entry point's script is written by setuptools, or pip, when a package is installed. It has the
name of the entry point and imports a module whose function it calls.
"""

from __future__ import annotations

import os
import re
from typing import NamedTuple

# What is written for an entry point is below a kilobyte and a half.
_LONGEST = 4096
_BY_SETUPTOOLS = re.compile(
    r"^# EASY-INSTALL-ENTRY-SCRIPT: '([^'=]+)[^']*','console_scripts','([^']+)'", re.MULTILINE
)
_BY_PIP = re.compile(r"^from ([\w.]+) import \w+$", re.MULTILINE)


class EntryPoint(NamedTuple):
    """A script's name without ``.py``, and the module that it runs where it is an entry point's."""

    stem: str
    module: str | None

    @property
    def files(self) -> tuple[str, ...]:
        """How the path of the module may end."""
        if self.module is None:
            return ()
        path = "/" + self.module.replace(".", "/")
        return (f"{path}.py", f"{path}/__init__.py")


def program_of(script: str) -> EntryPoint:
    """What the script is called, and what it runs; a script that cannot be read runs itself."""
    return EntryPoint(stem_of(script), _module(script))


def stem_of(script: str) -> str:
    """The name of a script without ``.py``."""
    name = os.path.basename(script)
    return name[:-3] if name.endswith(".py") else name


def _module(script: str) -> str | None:
    try:
        with open(script, "rb") as stream:
            data = stream.read(_LONGEST + 1)
    except OSError:
        return None
    if len(data) > _LONGEST or not data.startswith(b"#!") or b"sys.exit(" not in data:
        return None
    text = data.decode("utf-8", "replace")
    by_setuptools = _BY_SETUPTOOLS.search(text)
    if by_setuptools:
        return _declared(*by_setuptools.groups())
    by_pip = _BY_PIP.search(text)
    return by_pip.group(1) if by_pip else None


def _declared(distribution: str, name: str) -> str | None:
    """The module of an entry point, as its installed package declares it."""
    from importlib import metadata  # noqa: PLC0415

    try:
        points = metadata.distribution(distribution).entry_points
    except metadata.PackageNotFoundError:
        return None
    for point in points:
        if point.group == "console_scripts" and point.name == name:
            return point.value.partition(":")[0].strip()
    return None
