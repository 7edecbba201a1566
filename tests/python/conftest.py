"""Fixtures that several files of tests share."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from launch_samples import MISSION_PARAMS
from study_samples import make_study

from interpreters import interpreters
from pytpc.cli.main import main
from pytpc_evaluation.study.report.making import WrittenReport, make_report


@pytest.fixture(
    params=[pytest.param(path, id=f"python{version}") for version, path in interpreters().items()]
)
def python(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> str:
    """Each Python of this machine in turn, as the one that programs are started with."""
    monkeypatch.setattr(sys, "executable", request.param)
    return request.param


@pytest.fixture
def apply(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """`pytpc apply` with a state folder and packages of its own."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path))

    def invoke(*words: object, status: int = 0) -> Result:
        done = CliRunner().invoke(main, ["apply", *map(str, words)])
        assert done.exit_code == status, done.output
        return done

    return invoke


@pytest.fixture
def params(tmp_path: Path) -> Path:
    """A YAML file of parameters."""
    path = tmp_path / "params.yaml"
    path.write_text(MISSION_PARAMS)
    return path


@pytest.fixture(scope="session")
def study(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A small study's folder, which no test changes."""
    return make_study(tmp_path_factory.mktemp("study"))


@pytest.fixture
def own_study(study: Path, tmp_path: Path) -> Path:
    """A copy of it that a test may spoil."""
    return Path(shutil.copytree(study, tmp_path / "own"))


@pytest.fixture(scope="session")
def made_study(study: Path, tmp_path_factory: pytest.TempPathFactory) -> WrittenReport:
    """Its page with all that belongs to it."""
    return make_report(study, tmp_path_factory.mktemp("docs") / "study.md")


@pytest.fixture(scope="session")
def study_text(made_study: WrittenReport) -> str:
    """The text of its page, and behind it that of the page with all tables."""
    tables = made_study.page.parent / "study/tables.md"
    return made_study.page.read_text() + tables.read_text()
