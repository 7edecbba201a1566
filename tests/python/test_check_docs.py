"""tools/check-docs finds each kind of fault, with file and line, and nothing else."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from check_docs import Page, dead_citations, long_lines

ROOT = Path(__file__).parents[2]

CLEAN = """# A page: `code` in its title

Text with a [link](other.md#a-second-heading), one to [this page](#a-page-code-in-its-title),
one to a [folder](folder) and one [elsewhere](https://example.org/nowhere#at-all).

| a row of a table of 160 characters | WIDER |
| --- | --- |

https://example.org/WIDE

```sh
.venv/bin/pytpc build ~/ws --package mission -- --cmake-args -DX=1   # WIDE
pytpc suggest out --static ws --value=-1 && pytpc COMMAND --help
eval "$(pytpc env ~/ws)"; make test -j2
python3 -m pytpc.python_runtime node.py --its-own-option
```

```console
$ pytpc rank out \\
    --top 3 --static ws
make nonsense is what it printed
```

```python
make = "pytpc nonsense"
```

`pytpc watch --once`, `make demo` and `pytpc`.
""".replace("WIDER", "r" * 119).replace("WIDE", "wide" * 40)

OTHER = "# One\n\n## A second heading\n\n## A second heading\n"


def check(page: Path) -> list[str]:
    """The faults of a page, each without the path, which they all begin with."""
    done = subprocess.run(
        [sys.executable, ROOT / "tools/check_docs.py", page.name],
        cwd=page.parent,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert done.stderr == ""
    lines = done.stdout.splitlines()
    assert done.returncode == (1 if lines else 0)
    assert all(line.startswith(f"{page.name}:") for line in lines)
    return [line.removeprefix(f"{page.name}:") for line in lines]


def test_the_pages_that_are_opened_first_have_no_fault():
    pages = ["README.md", "docs/README.md", "docs/reference/command-line.md"]
    pages += ["docs/tutorial/diagnose-a-mission.md", "docs/explanation/architecture.md"]
    done = subprocess.run(
        [sys.executable, "tools/check_docs.py", *pages],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert (done.stdout, done.returncode) == ("", 0)


@pytest.fixture()
def page(tmp_path: Path) -> Path:
    (tmp_path / "other.md").write_text(OTHER)
    (tmp_path / "folder").mkdir()
    return tmp_path / "page.md"


def test_a_clean_page_has_no_fault(page: Path):
    page.write_text(CLEAN)
    assert check(page) == []


# Each line is wrong in one way. The page is checked once, for all of them.
FAULTS = [
    (f"word {'x' * 116}", "121 characters, at most 120"),
    ("[gone](gone.md)", "link to gone.md: no such file"),
    ("![gone](images/gone.png)", "link to images/gone.png: no such file"),
    ("[gone](other.md#a-third-heading)", "link to other.md#a-third-heading: no such heading"),
    ("[gone](#nowhere)", "link to #nowhere: no such heading"),
    ("this is teh word", "teh ==> the"),
    ("`pytpc diagnoze out`", "pytpc has no command diagnoze"),
    ("`pytpc rank out --statik ws`", "pytpc rank has no option --statik"),
    ("`pytpc study rum`", "pytpc study has no command rum"),
    ("`pytpc record -q`", "pytpc record has no option -q"),
    ("`python -m pytpc.nonsense ws`", "there is no module pytpc.nonsense"),
    ("`python3 -m pytpc nonsense`", "pytpc has no command nonsense"),
    ("`make nonsense`", "the Makefile has no target nonsense"),
    ('`eval "$(pytpc enw ws)"`', "pytpc has no command enw"),
]


def test_each_fault_is_found_at_its_line(page: Path):
    page.write_text("# Page\n\n" + "\n\n".join(line for line, _ in FAULTS) + "\n")
    expected = [f"{3 + 2 * number}: {fault}" for number, (_, fault) in enumerate(FAULTS)]
    assert check(page) == expected


@pytest.mark.parametrize(
    ("block", "expected"),
    [
        ("```sh\nls\npytpc nonsense\n```", ["5: pytpc has no command nonsense"]),
        ("    pytpc list\n    pytpc nonsense", ["4: pytpc has no command nonsense"]),
        ("```console\n$ ls\n$ make nonsense\n```", ["5: the Makefile has no target nonsense"]),
        ("```\npytpc list \\\n  --nonsense\n```", ["4: pytpc list has no option --nonsense"]),
        ("```\nls; make nonsense\n```", ["4: the Makefile has no target nonsense"]),
    ],
)
def test_commands_in_blocks_are_found(page: Path, block: str, expected: list[str]):
    page.write_text(f"# Page\n\n{block}\n")
    assert check(page) == expected


@pytest.mark.parametrize(
    ("width", "expected"), [(160, []), (161, ["5: row of 161 characters, at most 160"])]
)
def test_a_row_of_a_table_has_at_most_160_characters(page: Path, width: int, expected: list[str]):
    row = f"| a | {'x' * (width - 8)} |"
    page.write_text(f"| one | two |\n| --- | --- |\n| a | b |\n| a | c |\n{row}\n")
    assert (len(row), check(page)) == (width, expected)


def test_rows_that_a_program_writes_may_be_longer():
    study = Page(ROOT / "docs/study.md")
    rows = study.line_numbers("table_open")
    assert any(len(study.lines[number - 1]) > 160 for number in rows)
    assert list(long_lines(study)) == []


def test_a_changelog_may_name_what_was(page: Path):
    changelog = page.with_name("CHANGELOG.md")
    changelog.write_text("`pytpc nonsense` was teh old name\n")
    assert check(changelog) == ["1: teh ==> the"]


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("# docs/reference/formats.md has it, docs/reference/formats.md#events, too.", None),
        ("# ../docs/reference/formats.md is another folder's.", None),
        ("# docs/study/tables.md is written by a program.", None),
        ("# See docs/nonsense.md.", "docs/nonsense.md: no such page"),
        ("# docs/README.md#nonsense", "docs/README.md#nonsense: no such heading"),
    ],
)
def test_pages_that_sources_cite_exist(tmp_path: Path, line: str, expected: str | None):
    source = tmp_path / "source.py"
    source.write_text(f"x = 1\n{line}\n")
    found = [(fault.line, fault.text) for fault in dead_citations([str(source)])]
    assert found == ([(2, expected)] if expected else [])


def test_the_second_of_two_equal_headings_has_a_number(page: Path):
    page.write_text("[a](other.md#a-second-heading-1) [b](other.md#a-second-heading-2)\n")
    assert check(page) == ["1: link to other.md#a-second-heading-2: no such heading"]
