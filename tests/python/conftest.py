"""Fixtures that several files of tests share."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from launch_samples import MISSION_PARAMS

from pytpc.cli.main import main


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
