"""Inputs that must not break the analysis: odd files, internal errors, endless loops."""

from __future__ import annotations

import re
import subprocess
import sys
import time
from pathlib import Path

import pytest
from click.testing import CliRunner
from python_analysis_samples import PRELUDE, analysed, only

from pytpc.base.errors import InputError
from pytpc.cli.main import main
from pytpc.python_analysis import analysis
from pytpc.python_analysis.analysis import analyse_entry
from pytpc.python_analysis.budget import Budget, BudgetSpentError
from pytpc.python_analysis.comparisons.reads import find_reads
from pytpc.python_analysis.flow.constants import Constants
from pytpc.python_analysis.rules_file import load_rules
from pytpc.python_analysis.sources.packages import entry_of
from pytpc.python_analysis.sources.source_files import parse
from pytpc.static.link_unit import LinkUnit
from pytpc.static.static_info import StaticInfo

NODE = """limit = rospy.get_param('~limit')
def cb(m):
    if m.data > limit:
        pub.publish(m)
rospy.Subscriber('in', Float64, cb)
"""
TEXT = PRELUDE + NODE
# Line 6 of TEXT is `    if m.data > limit:`; the comparison begins at column 8.


def analyse_bytes(data: bytes, folder: Path) -> LinkUnit:
    script = folder / "node.py"
    script.write_bytes(data)
    return analyse_entry(entry_of(script), load_rules())


ODD = {
    "byte order mark": (b"\xef\xbb\xbf" + TEXT.encode(), 6, 8),
    "carriage returns": (TEXT.replace("\n", "\r\n").encode(), 6, 8),
    "carriage returns alone": (TEXT.replace("\n", "\r").encode(), 6, 8),
    "mixed ends": (TEXT.replace("\n", "\r\n", 3).encode(), 6, 8),
    "tabs": (TEXT.replace("    ", "\t").encode(), 6, 5),
    # Neither ends a line for Python; both do for str.splitlines().
    "form feed": (b"\f" + TEXT.encode().replace(b"pub =", b"\x0cpub ="), 6, 8),
    "line separators in texts": ("x = '\u2028\x85\x1c'\n".encode() + TEXT.encode(), 7, 8),
    "latin-1": ("# coding: latin-1\nx = '\xe4\xf6'\n".encode("latin-1") + TEXT.encode(), 8, 8),
    "a very long line": (f"x = '{'y' * 300_000}'\n".encode() + TEXT.encode(), 7, 8),
    "no end of the last line": (TEXT.encode().rstrip(), 6, 8),
}


@pytest.mark.parametrize("kind", ODD)
def test_odd_files(kind: str, tmp_path: Path) -> None:
    data, line, column = ODD[kind]
    found = only(analyse_bytes(data, tmp_path))
    assert (found.source, found.lineno, found.column) == ("~limit", line, column)
    assert found.source_code == "if m.data > limit:"


def test_columns_of_latin_1_count_bytes_of_utf_8(tmp_path: Path) -> None:
    text = TEXT.replace("if m.data > limit", "if '\xe4' and m.data > limit")
    found = only(analyse_bytes(("# coding: latin-1\n" + text).encode("latin-1"), tmp_path))
    # Four blanks, and the text of one letter: two quotes and two bytes.
    assert found.column == 4 + len("if ") + 4 + len(" and ") + 1


OLD = {
    "print 'x'": "print without parentheses",
    "if x: print y, z": "print without parentheses",
    "try:\n    pass\nexcept ValueError, e:\n    pass": "except with a comma",
    "raise ValueError, 'x'": "raise with a comma",
    "exec 'x'": "exec without parentheses",
    "if a <> b: pass": "<>",
    "x = `y`": "backquotes",
    "x = 0777": "an octal number",
    "x = 10L": "a long integer",
    "x = ur'y'": "a string literal of Python 2",
}


@pytest.mark.parametrize("text", OLD)
def test_python_2_is_said_in_one_line(text: str, tmp_path: Path) -> None:
    script = tmp_path / "old.py"
    script.write_text(f"import rospy\n{text}\n")
    with pytest.raises(InputError) as caught:
        parse(script)
    line = 4 if "try" in text else 2
    assert str(caught.value) == (
        f"{script}:{line}: not Python 3: it looks like Python 2 ({OLD[text]}) and needs Python 3"
    )


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"x = 1\0\n", "null byte"),
        (b"x = '\xff'\n", "cannot be decoded: "),
        (b"# coding: klingon\nx = 1\n", "cannot be decoded: unknown encoding"),
        (b"if x:\n\ty = 1\n        z = 2\n", "not Python 3: inconsistent use of tabs"),
        (b"print = = 3\n", "not Python 3: invalid syntax"),
        (b"x = '# print 3'\ny = (\n", "not Python 3: '(' was never closed"),
        (b"(" * 300 + b"\n", "too many nested parentheses"),
    ],
)
def test_what_is_no_python_is_one_line(data: bytes, said: str, tmp_path: Path) -> None:
    (tmp_path / "bad.py").write_bytes(data)
    with pytest.raises(InputError, match=re.escape(said)) as caught:
        parse(tmp_path / "bad.py")
    assert "Python 2" not in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_module_that_cannot_be_parsed_is_taken_for_a_library(tmp_path: Path) -> None:
    (tmp_path / "old.py").write_text("x = 1\nprint 'y'\n")
    script = tmp_path / "node.py"
    script.write_text(f"import old\nfrom old import x\n{TEXT}")
    faults: list[InputError] = []
    unit = analyse_entry(entry_of(script), load_rules(), on_fault=faults.append)
    assert only(unit).source == "~limit"
    assert [(fault.path, fault.line) for fault in faults] == [(str(tmp_path / "old.py"), 2)]
    (spot,) = [each for each in unit.blind_spots if each.kind == "unread_module"]
    assert (spot.file, spot.lineno) == ("old.py", 2)
    assert "looks like Python 2" in spot.what
    assert LinkUnit.from_json(unit.to_json(), script) == unit


def run(folder: Path, *words: str) -> tuple[int, str, dict[str, str | None]]:
    """Status, errors, and for each unit why it failed."""
    output = folder / "out.json"
    done = CliRunner().invoke(main, ["analyse", str(folder), "-o", str(output), *words])
    units = StaticInfo.load(output).units
    return done.exit_code, done.stderr, {unit.link_unit: unit.failure for unit in units}


def two_nodes(folder: Path) -> Path:
    for name in ("bad", "good"):
        (folder / f"{name}.py").write_text(f"{TEXT}if __name__ == '__main__':\n    pass\n")
    return folder


def test_an_error_of_the_analysis_fails_one_unit(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(flow, constants, rules):
        reads = find_reads(flow, constants, rules)
        if flow.points.program.name == "bad":
            instr = reads[0].instr
            raise KeyError(f"{instr.op}\nof {instr.data!r}")
        return reads

    monkeypatch.setattr(analysis, "find_reads", broken)
    status, errors, failures = run(two_nodes(tmp_path))
    assert status == 0
    assert "Traceback" not in errors
    assert failures["good"] is None
    why = failures["bad"] or ""
    # The read is on the line behind the three of PRELUDE.
    where = "KeyError in test_python_analysis_robust.py:"
    assert why.startswith(f"bad.py:4: an error of the analysis: {where}")
    assert "\n" not in why
    assert "call" in why


def test_an_error_without_a_place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr(analysis, "find_exposing", broken)
    assert run(two_nodes(tmp_path))[2] == {"bad": "not enough memory", "good": "not enough memory"}


def test_time_without_end_fails_one_unit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    class Endless(Constants):
        def __init__(self, flow) -> None:
            super().__init__(flow)
            while flow.points.program.name == "bad":
                pass

    monkeypatch.setattr(analysis, "Constants", Endless)
    status, _, failures = run(two_nodes(tmp_path), "--max-seconds", "0.5")
    assert status == 0
    assert failures == {
        "bad": "the analysis took more than 0.5 s (--max-seconds raises the limit)",
        "good": None,
    }


def test_a_budget_that_is_not_spent_leaves_nothing_behind() -> None:
    for seconds in (0.0, 30.0):
        with Budget(seconds):
            pass
    with pytest.raises(BudgetSpentError), Budget(0.01):
        while True:
            time.sleep(0.001)
    # The next one has its own time.
    with Budget(30.0):
        time.sleep(0.05)


TRACED = """\
import sys
from pytpc.python_analysis.budget import Budget
with Budget(60.0):
    pass
sys.settrace(lambda *_: None)
exec(compile("done = True", "program.py", "exec"), names := {})
sys.settrace(None)
print(names["done"])
"""


def test_a_program_can_be_traced_after_a_budget() -> None:
    # What is raised in a thread and taken back leaves CPython 3.11 standing still there.
    command = [sys.executable, "-c", TRACED]
    ran = subprocess.run(command, capture_output=True, text=True, timeout=60, check=True)
    assert ran.stdout == "True\n"


def test_deep_lists_are_no_error(tmp_path: Path) -> None:
    deep = "[" * 90 + "]" * 90
    assert only(analysed(f"x = {deep}\n" + NODE, tmp_path)).source == "~limit"
