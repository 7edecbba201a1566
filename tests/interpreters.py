"""Every Python from 3.8 on that is on this machine: the hook must run under each of them."""

from __future__ import annotations

import os
import re
import subprocess
from functools import cache
from pathlib import Path

OLDEST = 8
NEWEST = 14
_VERSION = "import sys; print('.'.join(map(str, sys.version_info[:2])))"


@cache
def interpreters() -> dict[str, str]:
    """Path of one interpreter for each version (``3.8``), from PATH, pyenv and the usual folders.

    The first one that starts counts: a shim of pyenv may be for a version that is not there.
    """
    folders = [
        *map(Path, os.environ.get("PATH", "").split(os.pathsep)),
        *map(Path, ("/usr/bin", "/usr/local/bin")),
        *sorted(Path.home().glob(".pyenv/versions/*/bin")),
    ]
    found: dict[str, str] = {}
    for minor in range(OLDEST, NEWEST + 1):
        version = f"3.{minor}"
        for folder in folders:
            path = folder / f"python{version}"
            if version not in found and path.is_file() and _says(path) == version:
                found[version] = str(path)
    return found


def _says(path: Path) -> str:
    ran = subprocess.run(
        [path, "-c", _VERSION], capture_output=True, text=True, check=False, timeout=60
    )
    return ran.stdout.strip() if ran.returncode == 0 else ""


def tested_and_absent(test_ids: list[str]) -> tuple[list[str], list[str]]:
    """The versions under which the tests of these names ran, and those that are not here."""
    ran = {version for test in test_ids for version in re.findall(r"\[python(3\.\d+)", test)}
    every = [f"3.{minor}" for minor in range(OLDEST, NEWEST + 1)]
    return [one for one in every if one in ran], [one for one in every if one not in interpreters()]
