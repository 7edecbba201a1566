"""What the passes cost a build: CPU time of image_capture with them and without, in one run.

Without them the same clang, level and full link-time optimisation are used. Builds alternate, and
the medians are compared.
"""

from __future__ import annotations

import os
import resource
import shutil
import statistics
import subprocess
import tempfile
from pathlib import Path

from figures import figure

from pytpc.paths import cmake_file

PACKAGE = Path(__file__).resolve().parents[1] / "examples" / "image_capture"
ROUNDS = 3
PLAIN = (
    "-DCMAKE_C_COMPILER=clang-19",
    "-DCMAKE_CXX_COMPILER=clang++-19",
    "-DCMAKE_AR=/usr/bin/llvm-ar-19",
    "-DCMAKE_RANLIB=/usr/bin/llvm-ranlib-19",
    "-DCMAKE_CXX_FLAGS=-g -flto=full",
    "-DCMAKE_EXE_LINKER_FLAGS=-flto=full -fuse-ld=lld-19",
    "-DCMAKE_SHARED_LINKER_FLAGS=-flto=full -fuse-ld=lld-19",
)


def cpu_of_build(folder: Path, options: tuple[str, ...]) -> float:
    """CPU seconds, of all processes, that building the package's link units takes."""
    environment = {**os.environ, "PATH": "/usr/bin:/bin"}
    shutil.rmtree(folder, ignore_errors=True)
    configure = ["cmake", "-S", str(PACKAGE), "-B", str(folder), "-G", "Ninja"]
    configure += ["-DCMAKE_BUILD_TYPE=RelWithDebInfo", "-DPYTHON_EXECUTABLE=/usr/bin/python3"]
    subprocess.run([*configure, *options], env=environment, check=True, capture_output=True)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(["ninja", "-C", str(folder)], env=environment, check=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    """Prints the ratio of the medians."""
    with_passes, without = [], []
    with tempfile.TemporaryDirectory() as scratch:
        for _ in range(ROUNDS):
            options = (f"-DCMAKE_TOOLCHAIN_FILE={cmake_file()}",)
            with_passes.append(cpu_of_build(Path(scratch) / "with", options))
            without.append(cpu_of_build(Path(scratch) / "without", PLAIN))
    ratio = statistics.median(with_passes) / statistics.median(without)
    figure(
        "analysis-cost",
        "build_cpu_with_over_without",
        ratio,
        unit="ratio",
        target="<=1.05",
        hit=ratio <= 1.05,
    )


if __name__ == "__main__":
    main()
