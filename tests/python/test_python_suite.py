"""The lists of the suite of Python nodes name existing places; the judge checks columns."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest
from static_units import comparison, unit

from pytpc.static.link_unit import Comparison, LinkUnit
from suite.expectations import PYTHON_PACKAGE, Entry, Expectation, judge, load, nodes
from suite.lists import wrong_with
from suite.places import comparisons
from suite.python_run import missing_modules, script

TYPES = {"parameter", "flag", "derived"}
KEYS = {"about", "expect", "absent", "limits", "constants", "imprecise", "nan", "params", "timed"}
ENTRY = Entry("nodes/a.py", 12, "x > limit", "~limit", "parameter", ">", 1, None, "", 8)


@pytest.mark.parametrize("node", nodes(PYTHON_PACKAGE))
def test_list_stands_on_its_places(node: str) -> None:
    for entry in load(node, PYTHON_PACKAGE).entries:
        assert wrong_with(entry, PYTHON_PACKAGE) is None, entry


@pytest.mark.parametrize("node", nodes(PYTHON_PACKAGE))
def test_list_is_complete_in_itself(node: str) -> None:
    data = json.loads((PYTHON_PACKAGE / f"nodes/{node}.json").read_text("utf-8"))
    assert set(data) <= KEYS
    expectation = load(node, PYTHON_PACKAGE)
    assert expectation.expect or expectation.absent or expectation.constants
    for entry in (*expectation.expect, *expectation.limits):
        assert entry.parameter, entry
        assert entry.type in TYPES, entry
        assert (entry.type == "flag") == (entry.relation == "flag"), entry
        assert entry.transform is None or entry.type == "derived", entry
    assert all(entry.why for entry in expectation.entries)
    places = Counter(
        (entry.file, entry.line, entry.column, entry.parameter, entry.relation)
        for entry in expectation.entries
    )
    assert [place for place, times in places.items() if times > 1] == []


@pytest.mark.parametrize("node", nodes(PYTHON_PACKAGE))
def test_program_is_complete(node: str) -> None:
    path = script(node)
    source = path.read_text("utf-8")
    compile(source, str(path), "exec")
    assert path.stat().st_mode & 0o111 == 0o111
    assert f'init_node("{node}"' in source
    assert 20 <= len(source.splitlines()) <= 100


def test_every_program_has_a_list() -> None:
    folder = PYTHON_PACKAGE / "nodes"
    programs = {path.stem for path in folder.glob("*.py")}
    programs |= {path.name for path in folder.iterdir() if path.is_dir() and path.name[0] != "_"}
    assert programs == set(nodes(PYTHON_PACKAGE))


def test_suite_is_large_and_has_both_kinds() -> None:
    lists = [load(node, PYTHON_PACKAGE) for node in nodes(PYTHON_PACKAGE)]
    assert len(lists) >= 100
    assert sum(len(one.absent) for one in lists) >= 110
    assert sum(not one.expect for one in lists) >= 16


def test_wrong_entries_are_seen() -> None:
    # Line 14 of ctl_direct_if.py is `        if msg.data > self.limit:`; it begins at column 12.
    (right,) = load("ctl_direct_if", PYTHON_PACKAGE).expect
    assert (right.line, right.column, right.relation) == (14, 12, ">")
    assert wrong_with(right, PYTHON_PACKAGE) is None
    assert (
        wrong_with(replace(right, column=11), PYTHON_PACKAGE)
        == "no expression of this text begins here"
    )
    assert (
        wrong_with(replace(right, line=13), PYTHON_PACKAGE)
        == "no expression of this text begins here"
    )
    assert wrong_with(replace(right, text="msg.data"), PYTHON_PACKAGE) is None
    assert wrong_with(replace(right, relation=">="), PYTHON_PACKAGE) == "the operator is >"


def test_text_over_several_lines() -> None:
    source = "if (a <\n        b\n        < c):\n    pass\n"
    assert list(comparisons(source)) == [
        ((1, 5), "a <\n        b", "<"),
        ((2, 9), "b\n        < c", "<"),
    ]


def test_modules_that_are_not_there_are_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "nodes").mkdir()
    (tmp_path / "nodes/a.py").write_text(
        "import json\nimport no_such.thing\nfrom nor_this import x\n"
    )
    monkeypatch.setattr("suite.python_run.PYTHON_PACKAGE", tmp_path)
    assert missing_modules("a") == ["no_such", "nor_this"]


def found(column: int) -> Comparison:
    """``x > limit`` on line 12 of nodes/a.py."""
    here = {"file": "nodes/a.py", "lineno": 12, "source": "~limit", "relation": ">"}
    data = unit(comparisons=[comparison(**{**here, "distance": 1, "column": column})])
    return LinkUnit.from_json(data, Path("unit.json")).comparisons[0]


@pytest.mark.parametrize(("column", "is_right"), [(8, True), (9, False)])
def test_column_counts_where_the_list_has_it(column: int, is_right: bool) -> None:
    wanted = Expectation("a", (ENTRY,), None, (), (), False, False)
    verdict = judge(wanted, [found(column)])
    assert verdict.is_right is is_right
    assert is_right or "column 9" in verdict.missing[0]
    limits = replace(wanted, expect=(), limits=(ENTRY,))
    assert judge(limits, [found(column)]).limits_found == is_right
