"""Which lines of a page are commands, and that each of them is run or listed with a reason.

tests/ros/test_docs_commands.py and test_docs_graphs.py run them.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from docs_commands import (
    NOT_RUN,
    WATCH_A_GRAPH,
    Command,
    Unclear,
    commands,
    not_run,
    pages,
    run_of,
)
from docs_world import NAMES, check_output, spelt

PAGE = """# A page

`pytpc nothing` in a line of text.

```
pytpc build ~/ws      # all of it
A=1 B=2 pytpc record ws robot.launch \\
  -o "out/to  day"    # until Ctrl-C

# a comment
eval "$(pytpc env --setup ws)"; roslaunch x y.launch
```

    $ pytpc rank today
    All 5 marks
    pytpc says no more

    $ pytpc rank today --each

```console
$ pytpc diff monday today
2 parameters differ
```

```
pytpc list ws

3 comparisons

pytpc show ws
```

```
All 5 marks together: 1 of type I
```

```json
pytpc = 1
```

```sh
frobnicate now
```
"""


def of(tmp_path: Path, text: str) -> list[Command | Unclear]:
    path = tmp_path / "page.md"
    path.write_text(text)
    return commands("docs/page.md", path)


def test_commands_are_told_from_output_comments_and_files(tmp_path: Path):
    found = [
        (each.line, each.text, each.output)
        for each in of(tmp_path, PAGE)
        if isinstance(each, Command)
    ]
    rank = ("All 5 marks", "pytpc says no more")
    assert found == [
        (6, "pytpc build ~/ws", ()),
        (7, 'A=1 B=2 pytpc record ws robot.launch -o "out/to  day"', ()),
        (11, 'eval "$(pytpc env --setup ws)"; roslaunch x y.launch', ()),
        (14, "pytpc rank today", rank),
        (18, "pytpc rank today --each", rank),
        (21, "pytpc diff monday today", ("2 parameters differ",)),
        (26, "pytpc list ws", ("3 comparisons",)),
        (30, "pytpc show ws", ("3 comparisons",)),
    ]


def test_a_block_of_a_shell_with_an_unknown_program_is_not_passed_over(tmp_path: Path):
    unclear = [each for each in of(tmp_path, PAGE) if isinstance(each, Unclear)]
    assert unclear == [Unclear("docs/page.md:42", "frobnicate now")]


@pytest.mark.parametrize("page", pages())
def test_every_line_of_a_shell_on_the_pages_is_a_command(page: str):
    unclear = [each for each in commands(page) if isinstance(each, Unclear)]
    assert unclear == [], (
        "neither a command nor an output: add the program to PROGRAMS in tests/docs_commands.py,"
        " put an empty line before what is output, or give the block a language"
    )


def test_what_no_test_runs_still_stands_on_its_page_and_has_a_reason():
    for page, reasons in not_run().items():
        there = {each.text for each in commands(page) if isinstance(each, Command)}
        assert set(reasons) <= there, f"take it out of {NOT_RUN}: it is not on {page} any more"
        assert all(reason.strip() for reason in reasons.values())


def test_most_commands_are_run():
    everything = [each for page in pages() for each in commands(page) if isinstance(each, Command)]
    listed = [each for each in everything if each.text in not_run().get(each.page, {})]
    assert len(everything) > 100
    assert 3 * len(listed) < len(everything)


def test_pages_that_watch_a_graph_are_there():
    assert set(WATCH_A_GRAPH) <= set(pages())
    assert all(run_of(page) for page in WATCH_A_GRAPH)


def test_names_of_the_reader_take_the_place_of_words():
    assert spelt("pytpc record WS robot.launch") == "pytpc record ws robot.launch"
    assert spelt("pytpc stats missions/ --static WORKSPACE") == (
        "pytpc stats missions/ --static uav.json"
    )
    assert spelt("colcon mixin add tpc file://<prefix>/x") == (
        f"colcon mixin add tpc file://{NAMES['<prefix>']}/x"
    )


OUTPUT = "All 3 marks together: 3 of type I\n  blame ~x: 81 %\n  #  Parameter   Probability\n"


@pytest.mark.parametrize(
    "shown",
    [
        (),
        ("All 5 marks together: 1 of type I, 4 of type II", "blame ~x: .. %; none: .. %"),
        ("#  Parameter            Probability  Type", "1  ~gone  .. %"),
        ("...", "blame ~x: 94 %"),
    ],
    ids=["nothing", "other numbers", "half of it", "dots"],
)
def test_an_output_fits_whose_lines_begin_alike(shown: tuple[str, ...]):
    check_output(shown, OUTPUT)


@pytest.mark.parametrize(
    "shown",
    [
        ("All 5 observers together", "blame ~x: 94 %", "#  Parameter"),
        ("All 5 marks together", "not sure: ~x", "~y"),
    ],
    ids=["the first line", "most others"],
)
def test_an_output_does_not_fit(shown: tuple[str, ...]):
    with pytest.raises(AssertionError, match="no line begins like"):
        check_output(shown, OUTPUT)
