"""The commands convert, rank and report: what they print, and one line for each error."""

from __future__ import annotations

import pytest
from click.testing import CliRunner
from mission_samples import BagFile, comparison, line, static_info

from pytpc.cli.main import main


@pytest.fixture
def files(tmp_path):
    """A bag with one mark of each type and the static information of its robot."""
    bag = tmp_path / "m.bag"
    with BagFile(bag) as writer:
        for step in range(200):
            t = 1 + step / 10
            writer.log(t, "/uav", line(0, int(t >= 15), 4 if t >= 15 else 1, 3))
            writer.log(t, "/uav", line(1, 0, 0.3, 0.6))
            writer.log(t, "/uav", line(1, 0, 0.5, 0.6))
        writer.mark(16, "/mark_action")
        writer.mark(20, "/mark_no_action")
    static = tmp_path / "static.json"
    static_info(comparison(0, "faces", ">=", default=3), comparison(1, "coverage")).save(static)
    return bag, static


def run(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def test_convert_then_rank_and_report(files, tmp_path):
    bag, static = files
    folder = tmp_path / "in" / "m"
    result = run("convert", bag, "-o", folder)
    assert result.stdout == (
        f"600 reports of 2 comparisons, 2 marks (1 of type I, 1 of type II) in 19.9 s: {folder}\n"
    )
    assert run("rank", folder, "--static", static).stdout == (
        run("rank", bag, "--static", static).stdout
    )
    page = tmp_path / "r.html"
    result = run("report", bag, folder, "--static", static, "-o", page)
    assert result.stdout == f"2 missions with 4 marks: {page}\n"
    assert "coverage" in page.read_text()


def one_line(result, *parts):
    assert result.exit_code == 1
    assert result.stdout == ""
    (text,) = [row for row in result.stderr.splitlines() if "warning" not in row]
    assert text.startswith("pytpc: error: ")
    for part in parts:
        assert part in text


def test_errors_are_one_line(files, tmp_path):
    bag, static = files
    one_line(run("rank", tmp_path / "no.bag", "--static", static), "no.bag: no such bag")
    one_line(run("rank", bag, "--static", tmp_path / "no.json"), "no.json")
    cut = tmp_path / "cut.bag"
    cut.write_bytes(bag.read_bytes()[:-100])
    out = tmp_path / "out"
    one_line(run("convert", cut, "-o", out), "cut.bag: truncated")
    assert not out.exists()
    page = tmp_path / "page.html"
    one_line(run("report", bag, cut, "--static", static, "-o", page), "cut.bag: truncated")
    assert not page.exists()
    other = tmp_path / "other.json"
    static_info(comparison(7, "x")).save(other)
    one_line(
        run("rank", bag, "--static", other), "the static information knows none of its reports"
    )
    quiet = tmp_path / "quiet.bag"
    with BagFile(quiet) as writer:
        writer.log(1, "/uav", line(0, 1, 2, 3))
    one_line(run("rank", quiet, "--static", static), "quiet.bag: no marks")
    with BagFile(tmp_path / "bare.bag") as writer:
        writer.mark(1, "/mark_action")
    one_line(run("rank", tmp_path / "bare.bag", "--static", static), "no threshold reports")


def test_a_log_cannot_steer_the_terminal(tmp_path):
    bag = tmp_path / "m.bag"
    with BagFile(bag) as writer:
        for t in (1, 2, 3):
            writer.log(t, "/\x1b[31mred", line(0, t % 2, t, 2))
        writer.log(3.5, "/x", "threshold_information:\x1b[2J")
        writer.mark(4, "/mark_action")
    static = tmp_path / "static.json"
    static_info(comparison(0, "[bold]\x1b[2Jname", source_code="\x07")).save(static)
    result = run("rank", bag, "--static", static)
    assert result.exit_code == 0, result.output
    assert "[bold]\N{REPLACEMENT CHARACTER}[2Jname" in result.stdout
    assert "\x1b" not in result.output
    assert "\x07" not in result.output


# It was the name of `convert` when that read bags of ROS 1 alone.
def test_the_old_name_of_convert_names_the_new_one(tmp_path):
    result = run("ingest", "a.bag", "-o", tmp_path)
    assert result.exit_code == 2
    assert "ingest is now called convert: pytpc convert" in result.stderr
