"""The whole condition around a comparison, by libclang."""

from pathlib import Path

import pytest

from pytpc.conditions.cpp_conditions import Condition, libclang, lines_of, parse_conditions

SOURCE = Path(__file__).with_name("conditions.cpp")
LINES = SOURCE.read_text(encoding="utf-8").split("\n")

pytestmark = pytest.mark.skipif(not libclang(), reason="libclang 19 is not installed")


def place(line_with: str, at: str) -> tuple[int, int]:
    """Line and column, from 1, of ``at`` in the line that has ``line_with``."""
    (number,) = (n for n, line in enumerate(LINES, start=1) if line_with in line)
    return number, LINES[number - 1].index(at) + 1


# The line, what the analysis points at in it, the kind and the text of the whole condition.
CASES = [
    ("if (v > n.low_ &&", "> n", "if", None),
    ("(v < n.high_ ||", "< n", "if", None),
    ("n.use_)) {", "n.use_", "if", None),
    # A `||` of which an operand is meant that has no place of its own points at the operator.
    ("(v < n.high_ ||", "||", "if", None),
    ("} else if (!n.use_)", "!n", "if", "!n.use_"),
    ("} else if (!n.use_)", "if", "if", "!n.use_"),
    ("while (v * 2", "> n", "while", "v * 2 > n.low_"),
    ("for (int i = 0;", "< n", "for", "i < n.most_"),
    ("for (int i = n.most_", "> 3", "?:", "n.most_ > 3"),
    ("for (int i = n.most_", "< 9", "for", "i < 9"),
    # The body of a loop without braces is not its condition.
    ("for (;;)", "== n", "expression", "v == n.low_"),
    ("} while (v > n.low_", "> n", "do", "v > n.low_ || n.use_"),
    ("double w = n.pick", "> n", "?:", "n.pick(v > n.low_)"),
    ("bool near", "< n", "expression", "v < n.high_ && w > 1"),
    ("bool near", "> 1", "expression", "v < n.high_ && w > 1"),
    ("  n.use_ = v > n.low_;", "> n", "expression", "v > n.low_"),
    ("switch (n.most_)", "n.most_", "switch", "n.most_"),
    # Of what classes have of their own, as of numbers.
    ("return larger", "> n.own_", "expression", None),
    ("return larger", "n.own_ > ", "expression", None),
    ("return larger", "near", "expression", None),
    ("if (LIMITED", "LIMITED", "if", "LIMITED(v, n.low_) && n.use_"),
    ("  RETURN_IF_OVER(v", "RETURN", "if", "RETURN_IF_OVER(v, n.high_)"),
    ("if (bool b = v > n.low_; b)", "> n", "expression", "v > n.low_"),
    ("if (bool b = v > n.low_; b)", "b)", "if", "b"),
    ("if (bool b = v > n.low_) n", "> n", "if", "bool b = v > n.low_"),
    ("if (n.use_) n.most_ =", "> n", "expression", "v > n.low_"),
    # The condition inside a lambda, and not the one that the lambda is a part of.
    ("if (n.pick([&]", "!= n", "if", "v != n.high_"),
    # What std::max and its kind compare inside stands at their call.
    ("double d = larger", "larger", "expression", "larger(v, n.low_)"),
]
LONG = {
    "if": "v > n.low_ &&\n      (v < n.high_ ||  // ) not the end\n       n.use_)",
    "expression": "larger(v, n.low_) > 2 || n.own_ > n.own_ || near",
}


@pytest.fixture(scope="module")
def found() -> list[Condition | None]:
    places = [place(line, at) for line, at, _, _ in CASES]
    parsed = parse_conditions(str(SOURCE), SOURCE.read_bytes(), ["-x", "c++", "-std=c++17"], places)
    assert parsed is not None
    return list(parsed.conditions)


@pytest.mark.parametrize("number", range(len(CASES)))
def test_the_whole_condition_is_found(found: list[Condition | None], number: int) -> None:
    _, _, kind, text = CASES[number]
    condition = found[number]
    assert condition is not None
    assert (condition.kind, condition.text) == (kind, text or LONG[kind])


def test_its_extent_is_that_of_its_text(found: list[Condition | None]) -> None:
    first = found[0]
    assert first is not None
    line, column = place("if (v > n.low_ &&", "v >")
    # Three lines; the last one is `       n.use_)` with the closing parenthesis in column 14.
    assert (first.lineno, first.column) == (line, column)
    assert (first.end_lineno, first.end_column) == (line + 2, 15)
    assert list(lines_of(first)) == [
        "v > n.low_ &&",
        "(v < n.high_ ||  // ) not the end",
        " n.use_)",
    ]


def test_a_macro_is_named_with_its_definition(found: list[Condition | None]) -> None:
    by_line = {LINES[c.lineno - 1].strip(): c.macro for c in found if c is not None}
    limited = by_line["if (LIMITED(v, n.low_) && n.use_) n.publish();"]
    assert limited is not None
    assert (limited.name, limited.file, limited.lineno) == ("LIMITED", str(SOURCE), 1)
    assert limited.text == "#define LIMITED(x, limit) ((x) > (limit))"
    whole = by_line["RETURN_IF_OVER(v, n.high_);"]
    assert whole is not None
    assert whole.text.endswith("return")
    assert by_line["while (v * 2 > n.low_) n.publish();"] is None


def test_where_nothing_is_compared_nothing_is_found() -> None:
    parsed = parse_conditions(
        str(SOURCE), SOURCE.read_bytes(), ["-x", "c++"], [(1, 1), (5, 1), (len(LINES) + 5, 1)]
    )
    assert parsed is not None
    assert parsed.conditions == (None, None, None)


def test_a_source_that_does_not_compile_has_its_conditions_still(tmp_path: Path) -> None:
    path = tmp_path / "node.cpp"
    text = (
        b"#include <not/there.h>\nvoid f(Gone &g, double v) {\n  if (v > 3 &&\n v < 9) g.x();\n}\n"
    )
    path.write_bytes(text)
    parsed = parse_conditions(str(path), text, ["-x", "c++"], [(3, 9)])
    assert parsed is not None
    assert parsed.conditions[0] is not None
    assert parsed.conditions[0].text == "v > 3 &&\n v < 9"


def test_columns_count_bytes(tmp_path: Path) -> None:
    path = tmp_path / "node.cpp"
    text = 'bool f(double v) { return "é" && v > 2.0; }\n'.encode()
    path.write_bytes(text)
    parsed = parse_conditions(str(path), text, ["-x", "c++"], [(1, text.index(b"> 2") + 1)])
    assert parsed is not None
    (condition,) = parsed.conditions
    assert condition is not None
    assert condition.text == '"é" && v > 2.0'
    assert condition.end_column == text.index(b"; }") + 1


def test_a_file_that_is_not_there_is_not_parsed(tmp_path: Path) -> None:
    parsed = parse_conditions(str(tmp_path / "none.cpp"), b"", [], [(1, 1)])
    assert parsed is None
