"""Lines for the person at the terminal."""

from __future__ import annotations

import ast
import sys
from pathlib import Path

from screens import Screen
from terminals import Terminal

# The progress stays until a key comes, so that the line is seen beside it.
PROGRAM = """
from pytpc.cli.console import waiting
from pytpc.cli.lines import progress_console, say
with waiting(progress_console(), "at work"):
    say("a line [b]")
    say("another: " + "pytpc rank --reference out/monday " * 4)
    input()
"""


def running(folder: Path) -> Terminal:
    root = str(Path(__file__).parents[2])
    return Terminal([sys.executable, "-c", PROGRAM], folder, env={"PYTHONPATH": root})


def test_a_line_beside_a_progress_stands_alone(tmp_path: Path) -> None:
    with Screen(running(tmp_path)) as screen:
        screen.wait_for("another", "at work")
        assert screen.lines[0] == "a line [b]"
        assert screen.lines[3].endswith(" at work")


def test_a_long_line_beside_a_progress_can_be_copied(tmp_path: Path) -> None:
    with running(tmp_path) as terminal:
        terminal.wait_for("another: " + "pytpc rank --reference out/monday " * 4)


def test_every_command_uses_it() -> None:
    """``click.echo(err=True)`` writes into the line of a progress."""
    root = Path(__file__).parents[2]
    folders = ("pytpc/cli", "evaluation/pytpc_evaluation")
    files = [path for folder in folders for path in (root / folder).rglob("*.py")]
    assert len(files) > 40
    found = [
        f"{path.name}:{node.lineno}"
        for path in files
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "click.echo"
        if any(each.arg == "err" for each in node.keywords)
    ]
    assert found == []
