"""Every Python from 3.8 on that is on this machine: the hook must run under each of them."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path

VERSIONS = tuple(f"3.{minor}" for minor in range(8, 15))


@cache
def interpreters() -> dict[str, str]:
    """Path of one interpreter for each version (``3.8``), from PATH, pyenv and the usual folders.

    Shims of pyenv do not count: they exist for versions that they do not start.
    """
    folders = [
        *map(Path, os.environ.get("PATH", "").split(os.pathsep)),
        *map(Path, ("/usr/bin", "/usr/local/bin")),
        *sorted(Path.home().glob(".pyenv/versions/*/bin")),
    ]
    found: dict[str, str] = {}
    for version in VERSIONS:
        for folder in folders:
            path = folder / f"python{version}"
            if version not in found and folder.name != "shims" and os.access(path, os.X_OK):
                found[version] = str(path)
    return found


def tested_and_absent(test_ids: Iterable[str]) -> tuple[list[str], list[str]]:
    """The versions under which the tests of these names ran, and those that are not here."""
    ran = {version for test in test_ids for version in re.findall(r"\[python(3\.\d+)", test)}
    found = interpreters()
    return [one for one in VERSIONS if one in ran], [one for one in VERSIONS if one not in found]
