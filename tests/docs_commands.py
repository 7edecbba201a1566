"""The command lines that the pages show, and which of them no test can run.

``python tests/docs_commands.py`` counts them, page by page.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

import tomllib

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tools"))

from check_docs import SHELLS, Page  # noqa: E402

NOT_RUN = ROOT / "tests/docs/not_run.toml"
PATTERNS = ["README.md", "CONTRIBUTING.md", "docs/*.md"]
# A block without a language is a shell's if its first line begins with one of these; else it shows
# a file, a message or an output.
PROGRAMS = re.compile(
    r"\.|\.venv/bin/\w+|tools/[\w-]+|cat|cd|chmod|colcon|cp|curl|docker|eval|export|git|ls|make"
    r"|mkdir|ninja|opt(-\d+)?|pip|pytpc|python3|ros2|rosbag|roscore|roslaunch|rosparam|rosrun"
    r"|rostopic|scp|source|ssh|sudo"
)
COMMENT = re.compile(r"\s+#( .*)?$")
WATCH_A_GRAPH = (
    "README.md",
    "docs/how-to/live.md",
    "docs/how-to/mark.md",
    "docs/how-to/record.md",
    "docs/how-to/view-elsewhere.md",
)
"""Half of the work: these pages wait for robots; tests/ros/test_docs_graphs.py reads them, while
another worker reads the others in tests/ros/test_docs_commands.py."""


class Command(NamedTuple):
    """A command line of a page.

    ``block`` counts the blocks of the page. ``output`` has the lines that the page shows below the
    commands of the block: they are those of one of them.
    """

    page: str
    line: int
    block: int
    text: str
    output: tuple[str, ...] = ()

    @property
    def place(self) -> str:
        return f"{self.page}:{self.line}"


class Unclear(NamedTuple):
    """A line of a shell's block that is neither a command nor an output."""

    place: str
    text: str


def pages() -> list[str]:
    """The pages whose commands are run, relative to ROOT."""
    words = ["git", "ls-files", "--cached", "--others", "--exclude-standard", *PATTERNS]
    names = subprocess.check_output(words, cwd=ROOT, text=True).splitlines()
    return sorted(name for name in names if (ROOT / name).is_file())


def commands(name: str, path: Path | None = None) -> list[Command | Unclear]:
    """The command lines of a page in their order; ``path`` is where it is if not below ROOT."""
    found: list[Command | Unclear] = []
    for number, token in enumerate(Page(path or ROOT / name).tokens):
        if token.type in {"fence", "code_block"} and token.map:
            first = token.map[0] + 1 + (token.type == "fence")
            language = token.info.strip()
            if language in SHELLS:
                found += _of_block(name, number, first, language, token.content)
    return found


def _of_block(
    name: str, block: int, first: int, language: str, content: str
) -> Iterator[Command | Unclear]:
    lines = content.splitlines()
    prompted = any(line.lstrip().startswith("$ ") for line in lines)
    if not prompted and language == "" and not _is_command(lines[0] if lines else ""):
        return
    found: list[Command | Unclear] = []
    output: list[str] = []
    joined, begin, after_gap = "", first, False
    for number, line in enumerate(lines, first):
        text = line.strip()
        begin = begin if joined else number
        if not joined:
            after_gap = after_gap or not text
            if not text or text.startswith("#"):
                continue
            if prompted and not text.startswith("$ "):
                output.append(text)
                continue
            if not prompted and not _is_command(text):
                if after_gap:
                    output.append(text)
                else:
                    found.append(Unclear(f"{name}:{number}", text))
                continue
        joined += text.removeprefix("$ ")
        if joined.endswith("\\"):
            joined = joined[:-1]
            continue
        found.append(Command(name, begin, block, COMMENT.sub("", joined).strip()))
        joined = ""
    for each in found:
        yield each._replace(output=tuple(output)) if isinstance(each, Command) else each


def _is_command(line: str) -> bool:
    """Whether a line begins with a program that is known, after variables that are set for it."""
    words = line.strip().removeprefix("$ ").split()
    while words and re.fullmatch(r"[A-Z_]+=\S*", words[0]):
        words = words[1:]
    return bool(words) and PROGRAMS.fullmatch(words[0]) is not None


def not_run() -> dict[str, dict[str, str]]:
    """Of each page the commands that no test runs, with the reason."""
    with NOT_RUN.open("rb") as stream:
        return tomllib.load(stream)


def run_of(page: str) -> list[Command]:
    """The commands of a page that are run."""
    left_out = not_run().get(page, {})
    found = [each for each in commands(page) if isinstance(each, Command)]
    if find_spec("rerun") is None:  # It needs Python 3.11.
        found = [each for each in found if "--rerun" not in each.text]
    return [each for each in found if each.text not in left_out]


def main() -> None:
    """Print of each page how many commands are run, and how many are listed."""
    run_all = listed_all = 0
    for page in pages():
        reasons = not_run().get(page, {})
        found = [each.text for each in commands(page) if isinstance(each, Command)]
        listed = sum(text in reasons for text in found)
        if found:
            print(f"{page}: {len(found) - listed} run, {listed} listed")
        run_all, listed_all = run_all + len(found) - listed, listed_all + listed
    print(f"FIGURE docs commands: {run_all} run, {listed_all} listed in {NOT_RUN.name}")


if __name__ == "__main__":
    main()
