"""The picture of `pytpc watch` in the docs is what it shows today; what it lacks, it says."""

from __future__ import annotations

import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[2]
WATCH = ROOT / "docs/images/watch.svg"


def draw(*words: object) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [ROOT / "tools/draw-pictures", *map(str, words)],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )


def test_the_picture_of_watch_is_drawn_again_if_watch_changes(tmp_path: Path):
    done = draw("watch.svg", "-o", tmp_path)
    assert (done.returncode, done.stdout) == (0, f"{tmp_path / 'watch.svg'}\n"), done.stderr
    drawn = (tmp_path / "watch.svg").read_text()
    assert "w where" in drawn
    assert "b when it began" in drawn
    assert drawn == WATCH.read_text(), "watch looks otherwise; type: tools/draw-pictures watch.svg"


def test_the_report_needs_a_demonstration(tmp_path: Path):
    done = draw("report.png", "--demo", tmp_path, "-o", tmp_path)
    assert done.returncode == 1
    assert done.stderr == f"draw-pictures: {tmp_path}: no demonstration; type: make demo\n"


def test_a_picture_that_is_none(tmp_path: Path):
    done = draw("nothing.png", "-o", tmp_path)
    assert done.returncode == 2
    assert "no picture nothing.png; there are architecture.svg, watch.svg" in done.stderr
