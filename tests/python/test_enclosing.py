"""A folder inside a workspace, such as its ``src``, is not built as a workspace."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from packages import add_package

from pytpc.base.errors import WorkspaceError
from pytpc.build.build import build_workspace
from pytpc.workspace.colcon import Bases, BuildOptions
from pytpc.workspace.enclosing import refuse_inside


@pytest.fixture
def root(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with the workspace ``ws``, which is not built, and the packages arm and face."""
    for name in ("arm", "face"):
        add_package(tmp_path / "ws/src" / name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def built(folder: Path) -> None:
    (folder / ".tpc").mkdir()
    (folder / ".tpc/static.json").write_text("{}")


def test_a_build_of_src_names_the_command_and_writes_nothing(root: Path) -> None:
    with pytest.raises(WorkspaceError) as caught:
        build_workspace(Path("ws/src"))
    assert str(caught.value) == (
        "ws/src: is inside the workspace ws; type: pytpc build ws (or, to build this folder as a"
        " workspace of its own: pytpc build ws/src --base ws/src/.tpc)"
    )
    assert sorted(path.name for path in (root / "ws/src").iterdir()) == ["arm", "face"]


def test_with_a_base_the_folder_is_the_users_choice(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(_: object) -> None:
        raise AssertionError

    monkeypatch.setattr("pytpc.build.build.refuse_inside", refuse)
    # It goes on, to the name that no package has.
    options = BuildOptions(packages=("none",), bases=Bases(root / "ws/src/.tpc"))
    with pytest.raises(WorkspaceError, match="no package none"):
        build_workspace(Path("ws/src"), options)


def test_inside_a_built_workspace_the_package_is_named(root: Path) -> None:
    built(root / "ws")
    add_package(root / "ws/src/arm tools/grip")
    with pytest.raises(WorkspaceError, match=r"type: pytpc build ws --package arm \(or"):
        refuse_inside(Path("ws/src/arm"))
    with pytest.raises(
        WorkspaceError, match=r"type: pytpc build ws \(or.*'ws/src/arm tools' --base"
    ):
        refuse_inside(Path("ws/src/arm tools"))


def test_the_folder_one_stands_in(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(root / "ws/src")
    with pytest.raises(WorkspaceError, match=f"type: pytpc build {root}/ws "):
        refuse_inside(Path())


def test_an_src_that_was_built_by_mistake_beside_the_workspace(root: Path) -> None:
    built(root / "ws")
    built(root / "ws/src")
    with pytest.raises(WorkspaceError):
        refuse_inside(root / "ws/src")


def own_build(root: Path) -> Path:
    built(root / "ws/src")
    return root / "ws/src"


def package_above(root: Path) -> Path:
    add_package(root / "ws")
    return root / "ws/src"


def hidden_from_the_other(root: Path) -> Path:
    built(root)
    (root / "ws/COLCON_IGNORE").touch()
    return root / "ws"


def product_of_the_other(root: Path) -> Path:
    built(root)
    add_package(root / "build/deep/arm")
    return root / "build/deep"


def another_own_build(root: Path) -> Path:
    built(root)
    built(root / "ws")
    return root / "ws"


@pytest.mark.parametrize(
    "folder_of",
    [
        lambda root: root / "ws",
        lambda root: root / "ws/src/arm",
        own_build,
        another_own_build,
        package_above,
        hidden_from_the_other,
        product_of_the_other,
    ],
)
def test_what_is_a_workspace_of_its_own(root: Path, folder_of: Callable[[Path], Path]) -> None:
    refuse_inside(folder_of(root))


# Somebody typed `pytpc build ~` once.
def test_a_build_in_a_home_is_no_workspace_around_all_others(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    built(root)
    with pytest.raises(WorkspaceError):
        refuse_inside(root / "ws")
    monkeypatch.setenv("HOME", str(root))
    refuse_inside(root / "ws")


def test_src_in_a_home_is_no_workspaces(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HOME", str(root / "ws"))
    refuse_inside(root / "ws/src")
    (root / "ws/.catkin_workspace").touch()
    with pytest.raises(WorkspaceError):
        refuse_inside(root / "ws/src")
