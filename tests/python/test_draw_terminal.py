"""tools/draw-terminal draws what a terminal shows, as text that moves without a script."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from pathlib import Path

import pyte
import pytest
from draw_terminal import PICTURE, Session
from terminal_film import Film, Frame, Run, Screen, Style, lines_of

SVG = "{http://www.w3.org/2000/svg}"
PLAIN = Style()
CURSOR = Style("ground", "text")


def fed(screen: Screen, text: str) -> Screen:
    pyte.Stream(screen).feed(text)
    return screen


def texts(screen: Screen) -> list[str]:
    return [line.rstrip() for line in screen.display]


def test_a_line_is_split_where_its_style_changes_and_between_columns():
    screen = fed(Screen(20, 2), "\x1b[?25l 12  \x1b[1mab c\x1b[0m  \x1b[34md\x1b[0m")
    # 012345678901
    #  12  ab c  d
    assert lines_of(screen) == (
        (
            Run(1, "12", PLAIN),
            Run(5, "ab c", Style(bold=True)),
            Run(11, "d", Style("blue")),
        ),
        (),
    )


def test_the_cursor_is_a_box_unless_it_is_hidden():
    screen = fed(Screen(10, 1), "$ ")
    assert lines_of(screen) == ((Run(0, "$", PLAIN), Run(2, " ", CURSOR)),)
    assert lines_of(fed(screen, "\x1b[?25l")) == ((Run(0, "$", PLAIN),),)


def test_a_program_that_used_the_whole_screen_leaves_what_was_there_before():
    screen = fed(Screen(10, 3), "$ run\r\n\x1b[?1049h\x1b[Hsuspects")
    assert texts(screen) == ["suspects", "", ""]
    fed(screen, "\x1b[?1049lverdict")
    assert texts(screen) == ["$ run", "verdict", ""]


def test_frames_that_are_too_short_become_one():
    film = Film()
    one, two, three = ((Run(0, text, PLAIN),) for text in ("1", "2", "3"))
    film.show(0.0, (one,))
    film.show(1.0, (two,), 0.5)
    film.show(1.2, (three,), 0.5)
    film.show(1.9, (three,), 0.5)
    film.show(2.0, (one,), 0.5)
    assert film.frames == [Frame(0.0, (one,)), Frame(1.0, (three,)), Frame(2.0, (one,))]


@pytest.fixture()
def drawing() -> str:
    """Three frames in four seconds: the upper line goes a, b, a, and the lower one stays."""
    film = Film()
    upper = {text: (Run(0, text, PLAIN),) for text in "ab"}
    lower = (Run(2, "<&>", Style("red", bold=True)),)
    for at_s, text in ((0.0, "a"), (1.0, "b"), (3.0, "a")):
        film.show(at_s, (upper[text], lower))
    return film.draw("A & B", "It <moves>", 4.0)


def test_a_line_shows_each_text_at_its_time_and_ends_with_the_last_one(drawing: str):
    # b is the second text, 18 pixels below a; 1 s of 4 s is 25 %, 3 s are 75 %.
    assert (
        "@keyframes k0 {0%{transform:translateY(0px)}25%{transform:translateY(-18px)}"
        "75%{transform:translateY(0px)}}\n" in drawing
    )
    assert ".l0 { transform:translateY(0px); animation: k0 4s step-end infinite }" in drawing
    assert "(prefers-reduced-motion: reduce) { .l0 { animation: none } }" in drawing
    assert "k1" not in drawing


def test_a_text_is_written_once_at_its_column(drawing: str):
    root = ET.fromstring(drawing)
    found = [(one.text, one.get("x"), one.get("class")) for one in root.iter(f"{SVG}text")]
    # The column 2 is at 2 * 8.4 pixels.
    assert found == [("a", "0", None), ("b", "0", None), ("<&>", "16.8", "c-red b")]


def test_a_drawing_has_words_for_those_who_cannot_see_it(drawing: str):
    root = ET.fromstring(drawing)
    names = (root.get("aria-labelledby") or "").split()
    words = {one.get("id"): one.text for one in root}
    assert [words[name] for name in names] == ["A & B", "It <moves>"]


def test_colours_differ_on_a_dark_ground(drawing: str):
    light, _, dark = drawing.partition("(prefers-color-scheme: dark)")
    assert re.findall(r"\.c-red \{ fill: (#\w+) \}", light) == ["#cf222e"]
    assert re.findall(r"\.c-red \{ fill: (#\w+) \}", dark) == ["#ff7b72"]


def test_colours_of_terminals_are_darker_on_a_light_ground():
    # Foregrounds: bright blue; 208 of 256, which is ff8700; a ground of bright magenta.
    screen = fed(Screen(9, 1), "\x1b[?25l\x1b[94ma\x1b[38;5;208mb\x1b[105mc")
    film = Film()
    film.show(0.0, lines_of(screen))
    light, _, dark = film.draw("", "", 1.0).partition("(prefers-color-scheme: dark)")
    # 5/8 of ff and 87, that is of 255 and 135, are 159 and 84: 9f and 54.
    assert re.findall(r"c-ff8700 \{ fill: (#\w+)", light) == ["#9f5400"]
    assert re.findall(r"c-ff8700 \{ fill: (#\w+)", dark) == ["#ff8700"]
    assert re.findall(r"c-brightblue \{ fill: (#\w+)", dark) == ["#58a6ff"]
    assert re.findall(r"c-\w+magenta \{ fill: (#\w+)", dark) == ["#bc8cff"]


def test_what_is_typed_into_the_shell_is_in_the_film(tmp_path: Path):
    env = {"PS1": "$ ", "TERM": "xterm-256color", "PATH": "/usr/bin:/bin"}
    with Session(tmp_path, env) as session:
        session.type("echo $((6 * 7))")
        session.wait_for_prompt()
        session.hold(2.0)
    shown = [[run.text for line in frame.lines for run in line] for frame in session.film.frames]
    assert shown[0] == ["$", " "]
    assert shown[-1] == ["$ echo $((6 * 7))", "42", "$", " "]
    assert session.now_s >= session.film.frames[-1].at_s + 2.0


@pytest.mark.parametrize("picture", [PICTURE], ids=["run.svg"])
def test_the_readmes_picture_runs_where_scripts_and_other_files_do_not(picture: Path):
    text = picture.read_text(encoding="utf-8")
    assert len(text) < 250_000
    assert {one.tag.removeprefix(SVG) for one in ET.fromstring(text).iter()} <= {
        *("svg", "title", "desc", "style", "rect", "g", "text")
    }
    assert not re.search(r"href|url\(|@import|<!DOCTYPE|<\?xml-stylesheet|\son\w+=", text)
    shown = "".join(ET.fromstring(text).itertext())
    assert "pytpc run ws" in shown
    assert "pytpc apply" in shown
