"""Which tests a change reaches, in a small tree: a product, helpers, tests, data."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from affected_tests import Tree

ROOT = Path(__file__).parents[2]
# main loads its command by name; scores is imported by rank, rank by report_commands.
FILES = {
    "tinybot/__init__.py": "",
    "tinybot/scores.py": "",
    "tinybot/rank.py": "from tinybot import scores\n",
    "tinybot/schema/one.json": "{}",
    "tinybot/cli/__init__.py": "",
    "tinybot/cli/main.py": "NAMES = {'report': 'report_commands'}\n",
    "tinybot/cli/report_commands.py": "from tinybot.rank import best\n",
    "docs/page.md": "",
    "docs/other/README.md": "",
    "examples/README.md": "",
    "runtime_log/Clock.cpp": "",
    "tests/helpers.py": "import tinybot.scores\n",
    "tests/python/conftest.py": "from tinybot import rank\ndef ranking(): ...\n",
    "tests/python/test_scores.py": "from tinybot.scores import score\n",
    "tests/python/test_helped.py": "import helpers\n",
    "tests/python/test_fixture.py": "def test(ranking): ...\n",
    "tests/python/test_command.py": "from tinybot.cli.main import main\n",
    "tests/python/test_module.py": "def test():\n    run('-m', 'tinybot.rank')\n",
    "tests/python/test_page.py": "PAGE = ROOT / 'docs' / 'page.md'\nother = 'README.md'\n",
    "tests/python/test_alone.py": "import json\n",
    "tests/runtime/test_clock.py": "import os\n",
    "tests/ros/test_graph.py": "from tinybot.scores import score\n",
}


@pytest.fixture
def tree(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Tree:
    for name, text in FILES.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    for module in [name for name in sys.modules if name.partition(".")[0] == "tinybot"]:
        monkeypatch.delitem(sys.modules, module)
    return Tree(tmp_path, [*FILES, "gone.py"], ["tinybot", "absent"])


def reached(tree: Tree, *changed: str) -> list[tuple[int, str]]:
    return [(one.distance, Path(one.test).stem) for one in tree.reached(changed)]


@pytest.mark.parametrize(
    ("changed", "tests"),
    [
        (
            "tinybot/scores.py",
            # test_fixture: conftest -> rank -> scores; test_command: main -> report_commands ->
            # rank -> scores. tests/ros is not for a quick check.
            [
                (1, "test_scores"),
                (2, "test_helped"),
                (2, "test_module"),
                (3, "test_fixture"),
                (4, "test_command"),
            ],
        ),
        ("tinybot/cli/report_commands.py", [(2, "test_command")]),
        ("tests/helpers.py", [(1, "test_helped")]),
        ("tests/python/conftest.py", [(1, "test_fixture")]),
        ("tests/python/test_alone.py", [(0, "test_alone")]),
        ("docs/page.md", [(1, "test_page")]),
        # There are two of that name, and the test says neither's folder.
        ("docs/other/README.md", []),
        ("runtime_log/Clock.cpp", [(1, "test_clock")]),
        # Nobody names it: the modules of its package may read it. A package imports nothing here,
        # and scores and rank are the modules in it.
        (
            "tinybot/schema/one.json",
            [
                (2, "test_module"),
                (2, "test_scores"),
                (3, "test_fixture"),
                (3, "test_helped"),
                (4, "test_command"),
            ],
        ),
        ("gone.py", []),
    ],
)
def test_a_change_reaches(tree, changed, tests):
    assert sorted(reached(tree, changed)) == tests


def test_the_nearest_change_counts(tree):
    both = reached(tree, "tinybot/scores.py", "tinybot/cli/main.py")
    assert (1, "test_command") in both


def test_of_this_tree_the_test_of_a_module_comes_first():
    """The whole program, against the last commit: it exits with 0 and names files that exist."""
    ran = subprocess.run(
        [sys.executable, ROOT / "tools/affected_tests.py", "--base", "HEAD", "--most", "3"],
        capture_output=True,
        text=True,
        check=True,
    )
    names = ran.stdout.splitlines()
    assert len(names) <= 3
    assert all((ROOT / name).is_file() for name in names)
    assert "files differ from" in ran.stderr
