"""When a robot of the study is built, and when what is there is taken."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from mission_samples import comparison, static_info
from study_flights import robot

from pytpc.base.errors import RunError
from pytpc.build.build import BuildResult
from pytpc.workspace.colcon import Bases
from pytpc_evaluation.study import system
from pytpc_evaluation.study.system import prepare


class Builder:
    """Builds in no time; ``tools`` is the digest of what it builds with."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.built: list[Path] = []
        self.tools = "1"
        self.fails = False
        monkeypatch.setattr(system, "build_workspace", self.build)
        monkeypatch.setattr(system, "workspace_env", lambda install: {"PATH": str(install)})
        monkeypatch.setattr(system, "tools_digest", lambda: self.tools)

    def build(self, workspace: Path, on_output: object) -> BuildResult:
        bases = Bases.of(workspace)
        # What a build before this one left is only known where it was.
        assert not (bases.root / "cache").exists() or (bases.root / "cache").read_text() == str(
            workspace.absolute()
        )
        self.built.append(workspace)
        if self.fails:
            raise RunError("it does not build", workspace)
        bases.install.mkdir(parents=True, exist_ok=True)
        (bases.install / "setup.bash").write_text("")
        (bases.root / "cache").write_text(str(workspace.absolute()))
        static = static_info(comparison(1, "~a"))
        static.save(bases.static_info)
        return BuildResult(bases, (), static, {}, 0.0)


@pytest.fixture
def builder(monkeypatch) -> Builder:
    return Builder(monkeypatch)


@pytest.fixture
def example(tmp_path, monkeypatch):
    return robot(tmp_path / "project", monkeypatch)


def test_a_robot_is_built_once(builder, example, tmp_path):
    first, was_built = prepare(example, tmp_path / "study")
    assert was_built
    again, was_built = prepare(example, tmp_path / "study")
    assert not was_built
    assert builder.built == [tmp_path / "study/systems/robot/ws"]
    assert again == first
    assert (tmp_path / "study/systems/robot/ws/src/robot").resolve() == example.folder.resolve()
    assert list(first.static.thresholds) == [comparison(1, "~a").key]
    # The nodes' reports go to files, and who looks on is no node.
    assert first.env == {"PATH": first.plain_env["PATH"], "TPC_SINK": "file"}


def test_it_is_built_again_where_sources_or_tools_are_others(builder, example, tmp_path):
    first, _ = prepare(example, tmp_path)
    (example.folder / "src" / "node.cpp").write_text("int main() { return 1; }\n")
    second, _ = prepare(example, tmp_path)
    builder.tools = "2"
    third, _ = prepare(example, tmp_path)
    assert len(builder.built) == 3
    # A mission knows of the sources alone.
    assert first.digest != second.digest == third.digest


def test_a_build_that_fails_leaves_none_that_counts(builder, example, tmp_path):
    prepare(example, tmp_path)
    builder.tools, builder.fails = "2", True
    with pytest.raises(RunError, match="it does not build"):
        prepare(example, tmp_path)
    builder.tools, builder.fails = "1", False
    assert prepare(example, tmp_path)[1]


def test_a_study_that_was_moved_is_built_where_it_is_now(builder, example, tmp_path):
    before, _ = prepare(example, tmp_path / "here")
    shutil.move(tmp_path / "here", tmp_path / "there")
    after, was_built = prepare(example, tmp_path / "there")
    assert was_built
    # Its missions are the same.
    assert after.digest == before.digest
