"""`pytpc watch` in a real terminal, on a mission that is already recorded."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import termios
from pathlib import Path

import pytest

from pytpc.recording.marks import Mark, read_marks
from screens import Screen
from terminals import Terminal, pytpc

EXAMPLE = Path(__file__).parents[2] / "examples/recorded_mission"
BEGIN_NS = 10_000_000
"""When the recording begins."""
S = 10**9


@pytest.fixture
def mission(tmp_path: Path) -> Path:
    """A copy of the example; marks go into it."""
    return shutil.copytree(EXAMPLE, tmp_path / "mission")


def watch(mission: Path, *options: str, columns: int = 120, lines: int = 36, **env: str) -> Screen:
    command = pytpc("watch", str(mission), "--static", str(mission / "static.json"), *options)
    environment = {"PYTHONPATH": str(EXAMPLE.parents[1]), **env}
    terminal = Terminal(command, mission.parent, env=environment, columns=columns, lines=lines)
    return Screen(terminal, columns, lines)


def end(screen: Screen) -> None:
    screen.press("q")
    assert screen.terminal.wait() == 0


# The recording begins at 10 ms; Up is a minute. What is first at 60 s is what `rank` names first at
# the marks around it.
def test_the_ranking_goes_with_the_clock_and_is_kept_at_marks(mission: Path, tmp_path: Path):
    with watch(mission) as screen:
        screen.wait_for("0:00.0 of 1:28.1, stopped", "Type I: what changed last")
        screen.press("\x1b[A")
        screen.wait_for("1:00.0 of", "1 ~min_coverage_limit", "8,816 evaluations of 3 nodes")
        screen.press("2")
        screen.wait_for("marked: type II", "1:00.0  II  1 ~min_coverage_limit, 2 ")
        screen.press("n")
        screen.wait_for("note: _")
        # While a note is written, v and m are letters.
        screen.press("vm stuck\r")
        screen.wait_for("noted", '"vm stuck"')
        # Five seconds before the end of the mission another parameter is first.
        screen.press("\x1b[C\x1b[C\x1b[C\x1b[C")
        screen.wait_for("1:20.0 of")
        screen.press("m")
        screen.wait_for("At the mark of 1:00.0 (type II)", "1 ~min_coverage_limit")
        assert "Type I: what changed last" not in screen.text
        screen.press("m")
        screen.wait_for("Type I: what changed last")
        screen.press("u")
        screen.wait_for("taken back: type II")
        assert "1 mark:" not in screen.text
        screen.press("1")
        screen.wait_for("marked: type I", "1:20.0  I ")
        before = screen.terminal.before
        end(screen)
        assert termios.tcgetattr(screen.terminal.child) == before
    assert read_marks(mission / "marks.csv") == (Mark(80 * S + BEGIN_NS, "I"),)


def test_headings_are_bold_and_stand_above_their_columns(mission: Path):
    with watch(mission) as screen:
        screen.press("\x1b[A")
        screen.wait_for("1 ~min_coverage_limit")
        lines = screen.lines
        (title,) = [n for n, line in enumerate(lines) if line.startswith("Type I:")]
        assert screen.bold(title).split() == lines[title].split()
        assert screen.bold(title + 1).split() == lines[title + 1].split()
        heads = lines[title + 1]
        for line in lines[title + 2 : title + 7]:
            assert line[heads.index("Parameter")] == "~"
            assert line[heads.rindex("Parameter")] == "~"
        assert screen.colours() > {"default"}
        end(screen)


def test_v_goes_through_the_views(mission: Path):
    with watch(mission) as screen:
        screen.press("\x1b[A")
        screen.wait_for("Type I:", "Type II:", "1:00.0 of")
        for wanted, gone in [
            ("Both types combined", "Type I:"),
            ("Type I:", "Both types"),
            ("Type II:", "what changed last"),
        ]:
            screen.press("v")
            screen.wait_for(wanted)
            screen.wait_without(gone)
        screen.press("v")
        screen.wait_for("Type I:", "Type II:")
        end(screen)


def test_the_terminal_changes_its_size(mission: Path):
    with watch(mission) as screen:
        screen.press("\x1b[A")
        screen.wait_for("1:00.0 of", "Trend of the window")
        screen.resize(60, 12)
        screen.wait_for("1:00.0 of", "~min_coverage_limit", "q quit")
        assert all(len(line) <= 60 for line in screen.lines)
        screen.resize(10, 3)
        screen.press("2")
        screen.wait_for("marked: t~")
        screen.resize(120, 36)
        screen.wait_for("Trend of the window", "1:00.0  II")
        end(screen)


@pytest.mark.parametrize("encoding", ["ascii", "latin-1"])
def test_a_terminal_without_utf8(mission: Path, encoding: str):
    with watch(mission, PYTHONIOENCODING=encoding) as screen:
        screen.press("\x1b[A")
        screen.wait_for("1:00.0 of", "~min_coverage_limit  ")
        assert screen.text.isascii()
        end(screen)


# Without a cursor that can be moved: what is new is said, line by line.
def test_a_dumb_terminal(mission: Path):
    with watch(mission, TERM="dumb") as screen:
        terminal = screen.terminal
        terminal.wait_for("Type II: what is near its threshold")
        terminal.press("\x1b[A2")
        terminal.wait_for("marked: type II: 1 ~min_coverage_limit, 2 ~")
        terminal.press("u")
        terminal.wait_for("taken back: type II")
        end(screen)


def test_no_color(mission: Path):
    with watch(mission, NO_COLOR="1") as screen:
        screen.press("\x1b[A")
        screen.wait_for("1:00.0 of", "1 ~min_coverage_limit")
        assert screen.colours() == {"default"}
        end(screen)


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGHUP])
def test_a_signal_leaves_the_terminal_as_it_was(mission: Path, number: signal.Signals):
    with watch(mission) as screen:
        screen.press("2")
        screen.wait_for("marked: type II")
        screen.terminal.output = b""
        assert screen.terminal.end(number) == 128 + number
        # The other screen is left, and the cursor is seen again.
        assert b"\x1b[?1049l" in screen.terminal.output
        assert b"\x1b[?25h" in screen.terminal.output
        assert termios.tcgetattr(screen.terminal.child) == screen.terminal.before
    assert len(read_marks(mission / "marks.csv")) == 1


def once(mission: Path, *options: str) -> subprocess.CompletedProcess[str]:
    command = pytpc("watch", str(mission), "--static", str(mission / "static.json"), *options)
    environment = {**os.environ, "PYTHONPATH": str(EXAMPLE.parents[1])}
    return subprocess.run(
        command, env=environment, capture_output=True, text=True, timeout=60, check=False
    )


def test_once_prints_a_table(mission: Path):
    done = once(mission, "--once", "--seconds", "60", "--top", "2")
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    assert lines[0] == "at 1:00.0: 8,816 evaluations of 3 nodes"
    assert [line.split()[1] for line in lines if line.startswith("  1 ")][1] == (
        "~min_coverage_limit"
    )
    assert not any(line.startswith("  3 ") for line in lines)
    assert not (mission / "marks.csv").exists()


# The table of `rank` at the second mark (57.3 s), to the last digit.
def test_json_has_the_numbers_of_rank(mission: Path):
    mark = json.loads((mission / "marks.json").read_text())["marks"][1]["time_ns"]
    seconds = f"{(mark - BEGIN_NS) / 1e9:.9f}"
    watched = json.loads(once(mission, "--json", "--seconds", seconds).stdout)
    command = pytpc("rank", str(mission), "--static", str(mission / "static.json"), "--json")
    ranked = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)[1]
    assert watched["time_ns"] == ranked["time_ns"] == mark
    assert watched["unknown_keys"] == 0
    ours, theirs = watched["rankings"]["II"]["suspects"], ranked["suspects"]
    for name in ("position", "parameter", "key", "score", "rank"):
        assert [one[name] for one in ours[:5]] == [one[name] for one in theirs[:5]]
    assert (ours[0]["relation"], ours[0]["thresh"], ours[0]["node"]) == (">", 0.058, "/mission")


def test_what_is_wrong_is_said_in_one_line(mission: Path, tmp_path: Path):
    done = once(mission)
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert "so no keys can be read; see --once" in done.stderr
    done = once(tmp_path / "gone.bag", "--once")
    assert (done.returncode, done.stderr.count("\n")) == (1, 1)
    done = once(mission, "--observer", "a b", "--once")
    assert done.returncode == 2
