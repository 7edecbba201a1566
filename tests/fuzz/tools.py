"""The programs that fuzzing runs, all of one LLVM release, each with limits of time and memory."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pytpc.base.paths import defer_plugin, plugin

ROOT = Path(__file__).parents[2]
LIT_INPUTS = ROOT / "tests/lit/Inputs"
BIN = Path("/usr/lib/llvm-19/bin")
SECONDS = 60
MEMORY_BYTES = 4 << 30


@dataclass(frozen=True, slots=True)
class Ran:
    """How a program ended; ``status`` is None where its time was up."""

    status: int | None
    output: bytes
    errors: str


def run(
    argv: Sequence[str | Path],
    *,
    seconds: int = SECONDS,
    env: Mapping[str, str] | None = None,
    folder: Path | None = None,
) -> Ran:
    """Run a program with a limit of processor time and memory.

    Real time is limited too, but loosely, because the machine may be busy.
    """

    def limit() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds + 1))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    try:
        ran = subprocess.run(
            [str(word) for word in argv],
            cwd=folder,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=30 * seconds,
            check=False,
            env={**os.environ, **(env or {})},
            preexec_fn=limit,
        )
    except subprocess.TimeoutExpired:
        return Ran(None, b"", "")
    if ran.returncode == -signal.SIGXCPU:
        return Ran(None, b"", "")
    return Ran(ran.returncode, ran.stdout, ran.stderr.decode(errors="replace"))


def compile_unit(source: Path, output: Path, flags: Sequence[str | Path]) -> Ran:
    """Compile C or C++ to a module as tpc.cmake has it compiled."""
    compiler = BIN / ("clang" if source.suffix == ".c" else "clang++")
    own = ["-w", "-g", "-flto=full", f"-fpass-plugin={defer_plugin()}", "-grecord-command-line"]
    return run([compiler, *own, "-c", *flags, source, "-o", output])


def opt(*arguments: str | Path) -> Ran:
    """LLVM's optimiser with the passes loaded."""
    return run([BIN / "opt", f"-load={plugin()}", f"-load-pass-plugin={plugin()}", *arguments])


def plugin_link_flags(*options: str) -> list[str]:
    """What clang is told to link with the passes."""
    flags = [f"-Wl,--load-pass-plugin={plugin()}", f"-Wl,-mllvm,-load={plugin()}"]
    return flags + [f"-Wl,-mllvm,{option}" for option in options]
