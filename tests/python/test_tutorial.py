"""The tutorial does what it says, in Python and on the command line; so do examples elsewhere."""

from __future__ import annotations

import doctest
import os
import re
import shlex
import subprocess
from pathlib import Path

import pytest

from terminals import Terminal, pytpc

ROOT = Path(__file__).parents[2]
TUTORIAL = ROOT / "docs/tutorial/diagnose-a-mission.md"
EXAMPLE = "examples/recorded_mission"
CONSOLE = re.compile(r"^```console\n\$ pytpc (.*)\n((?:.*\n)*?)```$", re.MULTILINE)
FLAGS = doctest.ELLIPSIS | doctest.IGNORE_EXCEPTION_DETAIL


@pytest.fixture(autouse=True)
def _in_the_repository(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(ROOT)


def test_the_python(tmp_path: Path):
    # To doctest the end of a fence is output; a line that is empty ends it as well.
    text = re.sub("^```.*$", "", TUTORIAL.read_text(), flags=re.MULTILINE)
    test = doctest.DocTestParser().get_doctest(
        text, {"folder": tmp_path}, TUTORIAL.name, str(TUTORIAL), 0
    )
    assert len(test.examples) > 20
    failed: list[str] = []
    runner = doctest.DocTestRunner(optionflags=FLAGS)
    runner.run(test, out=failed.append)
    assert not failed, "".join(failed)


COMMANDS = [
    command
    for page in (TUTORIAL, ROOT / "docs/explanation/how-it-works.md")
    for command in CONSOLE.findall(page.read_text())
]


def test_there_are_commands():
    assert len(COMMANDS) == 3


@pytest.mark.parametrize(("command", "shown"), COMMANDS, ids=lambda text: text.split()[0])
def test_the_command_line(command: str, shown: str):
    done = subprocess.run(
        pytpc(*shlex.split(command)),
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    said = "".join(f"{line.rstrip()}\n" for line in done.stdout.splitlines())
    assert doctest.OutputChecker().check_output(shown, said, FLAGS), said


# What hangs on the fitted weights stands there without digits, which would be old soon.
@pytest.mark.parametrize("command", ["rank --top 1", "suggest --top 1"])
def test_the_examples_of_diagnosing(command: str):
    words = pytpc(*command.split(), str(EXAMPLE), "--static", f"{EXAMPLE}/static.json")
    # Piped, a row of the table would be one line.
    with Terminal(words, ROOT, env={"PYTHONPATH": str(ROOT)}, columns=160) as terminal:
        assert terminal.wait(60) == 0
        text = terminal.text
    heading = f"## {'Ranking' if command.startswith('rank') else 'Suggestions'}\n"
    page = (ROOT / "docs/how-to/diagnose.md").read_text()
    section = page.partition(heading)[2].partition("\n## ")[0]
    begin = section.index("    All 5 marks together")
    block = re.match(r"(?:    .*\n|\n(?=    ))+", section[begin:])
    assert block is not None
    shown = [line[4:] for line in block[0].splitlines()]
    printed = text[text.index("All 5 marks together") :].splitlines()
    said = [_weightless(line.rstrip()) for line in printed]
    assert said[: len(shown)] == shown


def _weightless(line: str) -> str:
    """Without the probabilities: of the verdict, of a suspect, and in the column of the table."""
    if re.search(r"sure: |blame | II?: d|% that it is this one", line):
        return re.sub(r"(?<=  )[ \d]\d %|\b\d{1,2} %", ".. %", line)
    return line


def test_pictures_and_pages_are_there():
    targets = re.findall(r"\]\(([^)#:]+)\)", TUTORIAL.read_text())
    assert targets
    for target in targets:
        assert (TUTORIAL.parent / target).exists(), target


# Outside of a fence, what begins with > is a quotation, and a table in it is one long line.
def test_all_python_is_shown_as_code():
    text = re.sub("^```.*?^```$", "", TUTORIAL.read_text(), flags=re.MULTILINE | re.DOTALL)
    assert ">>>" not in text
