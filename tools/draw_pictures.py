"""Draw the pictures of docs/images.

``draw_pictures.py [NAME...]`` draws all of them, or those named:

- ``architecture.svg``: the rooms of pyproject.toml (tools/draw-architecture).
- ``watch.svg``: ``pytpc watch`` on the mission of examples/recorded_mission, whose clock stands.
- ``answer.png``, ``report.png``: the report page of ``make demo``, by chromium.
- ``study.png``: ``pytpc stats --figures`` of a mission of ``make demo``.
- ``run.svg``: a session in a terminal, which flies three missions (tools/draw-terminal).

The first two are the same each time. The others are of missions that are flown, and differ a
little. Those of the study (docs/images/study) are drawn by ``pytpc study report``.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import draw_answer
import terminal_film

from screens import Screen
from terminals import Terminal, pytpc

ROOT = Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs/images"
COLUMNS, LINES = 120, 30
MISSION = "type2_min_coverage_limit"
# Where the checkout of the reader is, in the pictures of a page that shows paths.
CHECKOUT = "/home/ana/tpc"


def main() -> None:
    """Read the arguments and draw."""
    parser = argparse.ArgumentParser(
        prog="draw-pictures", description="Draw the pictures of docs/images."
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"some of: {', '.join(DRAWN)}")
    parser.add_argument(
        "--demo", type=Path, default=ROOT / "out/demo", help="what `make demo` wrote"
    )
    parser.add_argument("-o", "--output", type=Path, default=IMAGES, help="folder of the pictures")
    given = parser.parse_args()
    for name in given.names or DRAWN:
        if name not in DRAWN:
            parser.error(f"no picture {name}; there are {', '.join(DRAWN)}")
    if not (given.demo / "report.html").is_file() and OF_DEMO & {*(given.names or DRAWN)}:
        sys.exit(f"draw-pictures: {given.demo}: no demonstration; type: make demo")
    given.output.mkdir(parents=True, exist_ok=True)
    for name in given.names or DRAWN:
        DRAWN[name](given.output / name, given.demo)
        print(given.output / name)


def architecture(path: Path, _demo: Path) -> None:
    """Draw the rooms, where their picture is."""
    subprocess.run([ROOT / "tools/draw-architecture"], check=True, stdout=subprocess.DEVNULL)
    if path != IMAGES / path.name:
        shutil.copy(IMAGES / path.name, path)


def watch(path: Path, _demo: Path) -> None:
    """Draw the suspects of a recording in which the UAV hovers, after a mark with a note."""
    with tempfile.TemporaryDirectory() as folder:
        mission = Path(shutil.copytree(ROOT / "examples/recorded_mission", f"{folder}/today"))
        marks = mission / "marks.json"
        marks.write_text(json.dumps({**json.loads(marks.read_text()), "marks": []}))
        terminal = Terminal(
            pytpc("watch", "today"), mission.parent, columns=COLUMNS, lines=LINES,
            env={"TERM": "xterm-256color"},
        )  # fmt: skip
        with Screen(terminal, COLUMNS, LINES, terminal_film.Screen) as screen:
            screen.wait_for("stopped", timeout_s=60.0)
            # The clock stands: what is shown depends on the keys alone. To 57 s, by 5 s and 1 s.
            screen.press("\x1b[C" * 11 + ".." + "2")
            screen.wait_for("marked: type II")
            screen.press("n")
            screen.wait_for("note")
            screen.press("no picture\r")
            screen.wait_for('"no picture"')
            film = terminal_film.Film()
            film.show(0.0, terminal_film.lines_of(screen.screen))
            screen.press("q")
            screen.terminal.wait()
    title = "pytpc watch in a terminal"
    text = "Two tables of suspects, by each type of error; below them the mark that was set."
    by = "tools/draw-pictures from examples/recorded_mission"
    path.write_text(film.draw(title, text, 1.0, by), encoding="utf-8")


def report(path: Path, demo: Path) -> None:
    """Draw the page of the mission of type II as it opens."""
    with _page(demo) as page:
        path.write_bytes(draw_answer.page_picture(page, MISSION))


def answer(path: Path, demo: Path) -> None:
    """Draw its answer alone."""
    with _page(demo) as page:
        path.write_bytes(draw_answer.picture(page, MISSION))


@contextmanager
def _page(demo: Path) -> Iterator[Path]:
    """The page as it would be in the reader's checkout."""
    text = (demo / "report.html").read_text(encoding="utf-8")
    root = str(demo.resolve().parents[1])
    for slash in ("/", "/<wbr>"):
        text = text.replace(root.replace("/", slash), CHECKOUT.replace("/", slash))
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder, "report.html")
        page.write_text(text, encoding="utf-8")
        yield page


def study(path: Path, demo: Path) -> None:
    """Draw the figure of this mission in the thesis's manner."""
    with tempfile.TemporaryDirectory() as folder:
        words = pytpc("stats", str(demo / MISSION), "--static", str(demo / "ws"))
        words += ["--figures", folder, "--figure-format", "png", "--table", "6.15"]
        subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
        (figure,) = (each for each in Path(folder).glob("*.png") if MISSION in each.name)
        shutil.copy(figure, path)


def run(path: Path, _demo: Path) -> None:
    """Draw the film of a session."""
    subprocess.run([ROOT / "tools/draw-terminal", "--picture", path], check=True)


DRAWN: dict[str, Callable[[Path, Path], None]] = {
    "architecture.svg": architecture,
    "watch.svg": watch,
    "answer.png": answer,
    "report.png": report,
    "study.png": study,
    "run.svg": run,
}
OF_DEMO = {"answer.png", "report.png", "study.png"}


if __name__ == "__main__":
    main()
