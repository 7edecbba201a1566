"""The program that reports (drive.cpp), built once against the installed log library."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from compiling import compile_program

HERE = Path(__file__).parent
Drive = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="session")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return compile_program(HERE / "drive.cpp", tmp_path_factory.mktemp("drive") / "drive")


@pytest.fixture
def settings(tmp_path: Path) -> dict[str, str]:
    """The environment of a program that reports to a file below ``tmp_path``."""
    kept = {name: text for name, text in os.environ.items() if not name.startswith("TPC_")}
    return {**kept, "TPC_SINK": "file", "TPC_FOLDER": str(tmp_path / "log")}


@pytest.fixture
def drive(program: Path, settings: dict[str, str]) -> Drive:
    """Run the driver: words, then settings by keyword (``site_cap=5``)."""

    def run(*words: object, **more: object) -> subprocess.CompletedProcess[str]:
        changed = {f"TPC_{name.upper()}": str(value) for name, value in more.items()}
        return subprocess.run(
            [str(program), *map(str, words)],
            env={**settings, **changed},
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )

    return run


@pytest.fixture
def files(tmp_path: Path) -> Callable[[], list[Path]]:
    """The files that were written, in the order of their names."""
    return lambda: sorted((tmp_path / "log").glob("*.tpc"))
