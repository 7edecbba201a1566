"""The lists of the suite stand on their lines; a list and what was found are compared rightly."""

from pathlib import Path

import pytest
from static_units import comparison, unit

from pytpc.static.link_unit import Comparison, LinkUnit
from suite.expectations import PACKAGE, Entry, Expectation, judge, load, nodes

ENTRY = Entry("nodes/a.cpp", 12, "x > limit", "limit", "parameter", ">", 1, None, "")


def found(**changes: object) -> Comparison:
    """``x > limit`` on line 12 of nodes/a.cpp at distance 1, with changes."""
    here = {"file": "nodes/a.cpp", "lineno": 12, "source": "limit", "relation": ">", "distance": 1}
    data = unit(comparisons=[comparison(**{**here, **changes})])
    return LinkUnit.from_json(data, Path("unit.json")).comparisons[0]


def expectation(*expect: Entry, **more: object) -> Expectation:
    given = {"constants": None, "limits": (), "absent": (), "imprecise": False, "nan": False}
    return Expectation("a", tuple(expect), **{**given, **more})


@pytest.mark.parametrize("node", nodes())
def test_text_stands_on_its_line(node: str) -> None:
    for entry in load(node).entries:
        lines = (PACKAGE / entry.file).read_text("utf-8").splitlines()
        assert entry.text in lines[entry.line - 1], entry


def test_every_node_has_a_list() -> None:
    entries = (PACKAGE / "nodes").glob("*")
    sources = {path.stem for path in entries if path.is_dir() or path.suffix == ".cpp"}
    assert sources == set(nodes())


def test_what_is_found_as_expected_is_right() -> None:
    verdict = judge(expectation(ENTRY), [found()])
    assert (verdict.expected, verdict.found, verdict.is_right) == (1, 1, True)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"relation": ">="}, "relation >="),
        ({"source": "other"}, "parameter 'other'"),
        ({"distance": 2}, "distance 2"),
        ({"type": "flag", "relation": "flag"}, "type flag, relation flag"),
    ],
)
def test_another_answer_is_missing_and_false(changes: dict[str, object], said: str) -> None:
    verdict = judge(expectation(ENTRY), [found(**changes)])
    assert (verdict.found, len(verdict.missing), len(verdict.false)) == (0, 1, 1)
    assert said in verdict.missing[0]
    assert not verdict.is_right


def test_two_alike_on_one_line_are_two() -> None:
    verdict = judge(expectation(ENTRY, ENTRY), [found()])
    assert (verdict.found, len(verdict.missing)) == (1, 1)


def test_what_nobody_expected_is_false_and_says_why() -> None:
    absent = Entry("nodes/a.cpp", 12, "x > limit", None, None, None, None, None, "only logs")
    verdict = judge(expectation(absent=(absent,)), [found()])
    assert verdict.false == ("nodes/a.cpp:12 parameter 'limit' > (only logs)",)


def test_limits_are_allowed_and_not_demanded() -> None:
    assert judge(expectation(limits=(ENTRY,)), []).is_right
    verdict = judge(expectation(limits=(ENTRY,)), [found()])
    assert (verdict.is_right, verdict.limits_found, verdict.expected) == (True, 1, 0)


def test_imprecise_node_is_right_either_way() -> None:
    assert judge(expectation(imprecise=True), [found()]).is_right


def test_constants_count_where_the_list_has_them() -> None:
    constant = Entry("nodes/a.cpp", 12, "x > 3", None, "constant", ">", None, None, "")
    hard_coded = found(type="constant", source=None, read_at=None)
    assert judge(expectation(), [hard_coded]).is_right
    assert judge(expectation(constants=(constant,)), [hard_coded]).found == 1
    assert not judge(expectation(constants=()), [hard_coded]).is_right


@pytest.mark.parametrize(
    ("wanted", "is_right"), [({"scale": 2, "offset": 1}, True), ({"scale": 2, "offset": 0}, False)]
)
def test_arithmetic_is_compared(wanted: dict[str, float], is_right: bool) -> None:
    entry = Entry("nodes/a.cpp", 12, "x > y", "limit", "derived", ">", None, wanted, "")
    how = {"kind": "affine", "scale": 2.0, "offset": 1.0, "text": "2 * x + 1"}
    assert judge(expectation(entry), [found(type="derived", transform=how)]).is_right is is_right
