"""Builds small programs against the installed log library."""

from __future__ import annotations

import subprocess
from pathlib import Path

from pytpc.base.paths import prefix


def compile_program(source: Path, output: Path, *flags: str) -> Path:
    """Build one C++ file with the log library and its header."""
    folder = prefix()
    subprocess.run(
        [
            "clang++-19",
            *["-std=c++17", "-O2", "-Wall", "-Werror", "-pthread"],
            *[f"-I{folder}/include/tpc", str(source), "-o", str(output)],
            *[f"-L{folder}/lib", "-ltpc_log", f"-Wl,-rpath,{folder}/lib", *flags],
        ],
        check=True,
        timeout=120,
    )
    return output
