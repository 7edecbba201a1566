"""Characters in the path of a workspace: each works, or is refused before a file is written."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner

from pytpc.base.errors import WorkspaceError
from pytpc.cli.main import main
from pytpc.workspace.path_characters import refuse_characters

REFUSED = [
    ("a$b", "a dollar sign"),
    ("a$HOME", "a dollar sign"),
    ('a"b', "a quotation mark"),
    ("a;b", "a semicolon"),
    ("a\\b", "a backslash"),
    ("a`b", "a backtick"),
    ("a\nb", "a line break"),
    ("a\x1bb", "a control character"),
    ("a\x7fb", "a control character"),
]
# Each of these was built with the example of tests/workspaces/others.
TAKEN = ["plain", "mit Abstand", "größe", "a#b", "a%b", "-lead", "a'b"]


@pytest.mark.parametrize(("name", "what"), REFUSED)
@pytest.mark.parametrize("place", ["workspace", "package", "base"])
def test_refused(tmp_path: Path, place: str, name: str, what: str) -> None:
    workspace = tmp_path / (name if place == "workspace" else "ws")
    package = workspace / "src" / (name if place == "package" else "robot")
    package.mkdir(parents=True)
    (package / "package.xml").write_text(
        '<package format="3"><name>robot</name><version>1.0.0</version>'
        "<description>d</description><maintainer email='a@b.cd'>a</maintainer>"
        "<license>MIT</license></package>\n"
    )
    more = ["--base", str(tmp_path / name)] if place == "base" else []
    before = sorted(tmp_path.rglob("*"))
    done = CliRunner().invoke(main, ["build", str(workspace), *more])
    assert done.exit_code == 1, done.output
    assert f": {what} in the path, which make and CMake do not take" in done.stderr
    assert done.stderr.count("\n") == 1
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("name", TAKEN)
def test_taken(tmp_path: Path, name: str) -> None:
    refuse_characters(tmp_path / name)


def test_the_whole_path_counts(tmp_path: Path) -> None:
    with pytest.raises(WorkspaceError, match="a dollar sign in the path"):
        refuse_characters(tmp_path / "a$b" / "below")
