"""Changing one value in a YAML text: what changes, and what is refused."""

from __future__ import annotations

import math

import pytest
import yaml

from pytpc.values.new_value import Refused, bool_text, degrees_text, guessed, yaml_text
from pytpc.values.scalars import number_text, plain_value
from pytpc.values.yaml_edit import edit_yaml

# The text, the keys, what is given, the text afterwards. Only the value's own characters differ.
CHANGES = [
    ("a: 0.5\n", "a", "0.7", "a: 0.7\n"),
    # What was typed is kept where YAML reads it so: 0.50 is 0.5.
    ("a: 1.5\n", "a", "0.50", "a: 0.50\n"),
    # A number keeps its type; YAML 1.1 wants dot and sign, and 1e-7 would be a text.
    ("a: 1.5\n", "a", "2", "a: 2.0\n"),
    ("a: 1.5\n", "a", "1e-7", "a: 1.0e-07\n"),
    ("a: 1.5\n", "a", "inf", "a: .inf\n"),
    ("a: 25\n", "a", "26.0", "a: 26\n"),
    ("a: 0x1F\n", "a", "30", "a: 30\n"),
    # Comments, blanks, line endings, a byte order mark, no end of line.
    ("\ufeffa:   1.5   # half\r\nb: 2\r\n", "a", "2.5", "\ufeffa:   2.5   # half\r\nb: 2\r\n"),
    ("# a: 9\na: 1.5", "a", "2.5", "# a: 9\na: 2.5"),
    ("n:\n\n    a:    1.5\n    b: 2\n", "n/a", "2.5", "n:\n\n    a:    2.5\n    b: 2\n"),
    # The words and the case of a bool.
    ("a: True\n", "a", "false", "a: False\n"),
    ("a: on\n", "a", "0", "a: off\n"),
    ("a: NO\n", "a", "true", "a: YES\n"),
    # Texts keep their quotes; what would be read as something else gets some.
    ("a: 'x'\n", "a", "it's", "a: 'it''s'\n"),
    ('a: "x"\n', "a", 'a "b"', 'a: "a \\"b\\""\n'),
    ("a: map\n", "a", "base_link", "a: base_link\n"),
    ("a: map\n", "a", "true", "a: 'true'\n"),
    ("a: map\n", "a", "x: y # z", "a: 'x: y # z'\n"),
    ("a: '5'\n", "a", "6", "a: '6'\n"),
    ("a: !!str 5\n", "a", "6", "a: !!str '6'\n"),
    # Flow style, in maps and lists; several on a line.
    ("n: {a: 1.5, b: 2.5}\n", "n/b", "3.5", "n: {a: 1.5, b: 3.5}\n"),
    ("n: {a: x, b: y}\n", "n/a", "p, q", "n: {a: 'p, q', b: y}\n"),
    ('{"n": {"a": 1.5}}\n', "n/a", "3.5", '{"n": {"a": 3.5}}\n'),
    ("a: [1, 2.5,  3]\n", "a", "[1, 4.5, 3]", "a: [1, 4.5,  3]\n"),
    ("a:\n- 1.5\n# two\n- 2.5\n", "a", "[1.5, 3.5]", "a:\n- 1.5\n# two\n- 3.5\n"),
    # 180 degrees are pi; rad() keeps its word.
    ("a: deg(90)\n", "a", "3.141592653589793", "a: deg(180)\n"),
    ("a: rad(pi/2)\n", "a", "1.25", "a: rad(1.25)\n"),
    ("a: !degrees 90\n", "a", "3.141592653589793", "a: !degrees 180\n"),
    # An alias stands for a value elsewhere: here alone it becomes one.
    ("a: &x 1.5\nb: *x\n", "b", "2.5", "a: &x 1.5\nb: 2.5\n"),
    ("a: &x 1.5  # c\n", "a", "2.5", "a: &x 2.5  # c\n"),
    # Own keys beside merged ones.
    ("m: &m {z: 1}\nn:\n  <<: *m\n  z: 2\n", "n/z", "3", "m: &m {z: 1}\nn:\n  <<: *m\n  z: 3\n"),
    # Of equal keys the last holds.
    ("a: 1\nb: 2\na: 3\n", "a", "4", "a: 1\nb: 2\na: 4\n"),
    # The only document that has it.
    ("a: 1\n---\nb: 2\n", "b", "3", "a: 1\n---\nb: 3\n"),
    ("? a\n: 1.5\n", "a", "2.5", "? a\n: 2.5\n"),
    ("a/b: 1.5\n", "a/b", "2.5", "a/b: 2.5\n"),
    ("größe: 1.5\nüber: {ä: 2.5}\n", "über/ä", "3.5", "größe: 1.5\nüber: {ä: 3.5}\n"),
]


def keys_of(text: str, name: str) -> tuple[str, ...]:
    return (name,) if f"{name}:" in text else tuple(name.split("/"))


@pytest.mark.parametrize(("before", "name", "given", "after"), CHANGES)
def test_changed(before: str, name: str, given: str, after: str) -> None:
    assert edit_yaml(before, keys_of(before, name), given).data.decode() == after


def test_what_is_said_of_a_change() -> None:
    edit = edit_yaml("a: 1\nb: 2\na: 3\n", ("a",), "4")
    assert (edit.old, edit.new, edit.lineno) == (3, 4, 3)
    assert edit.notes == ("line 1 sets it, too, and does not count",)
    alias = edit_yaml("a: &x 1.5\nb: *x\n", ("b",), "2.5")
    assert alias.notes == ("it stood for &x of line 1, which stays",)


# No number of degrees gives exactly this many rad (found by trying all near ones: degrees_text
# is None), so it is written in rad, and said.
def test_an_angle_that_no_degrees_give() -> None:
    odd = next(x for x in (0.1 + n / 1000 for n in range(1000)) if degrees_text(x) is None)
    edit = edit_yaml("a: deg(90)\n", ("a",), repr(odd))
    assert edit.data.decode() == f"a: {odd!r}\n"
    assert edit.notes == ("no number of degrees is this angle; it is in rad now",)
    with pytest.raises(Refused, match="no number of degrees is"):
        edit_yaml("a: !degrees 90\n", ("a",), repr(odd))


REFUSED = [
    ("a: 1.5\n", "b", "2", "b is not in the file"),
    ("a: 1\n---\na: 2\n", "a", "3", "a is in 2 documents of the file"),
    ("a: 25\n", "a", "2.5", "the parameter is a whole number and '2.5' is not"),
    ("a: 2.5\n", "a", "high", "the parameter is a number and 'high' is not"),
    ("a: true\n", "a", "2", "the parameter is true or false and '2' is not"),
    ("a: |\n  x\n  y\n", "a", "z", "block of text"),
    ("a: >-\n  x\n", "a", "z", "block of text"),
    ("a:\nb: 1\n", "a", "2", "nothing and '2' is not"),
    ("a: &x 1.5\nb: *x\n", "a", "2.5", "it is the value of b, too; --force changes all"),
    ("m: &m {z: 1}\nn: {<<: *m}\n", "n/z", "3", "it is the value of m/z, too"),
    ("m: &m {z: 1}\nn: *m\n", "n/z", "3", "it is the value of m/z, too"),
    ("a: $(arg x)\n", "a", "2", "roslaunch substitutes a part of it"),
    ("a: !!binary aGk=\n", "a", "2", "the tag tag:yaml.org,2002:binary is not supported"),
    ("a: !!bool maybe\n", "a", "true", "'maybe' is no bool"),
    ("a: [1, 2]\n", "a", "[1]", "the list has 2 values, but 1 were given"),
    ("a: [1, 2]\n", "a", "3", "give all of it"),
    ("a: [1, [2]]\n", "a", "[1, 2]", "lists in lists"),
    ("a: &l [1, 2]\nb: *l\n", "b", "[1, 3]", "it is the value of a, too"),
    ("a: {b: 1\n", "a", "2", "not YAML in line"),
    ("a: *none\n", "a", "2", "has no anchor"),
    ("a: 1\n\tb: 2\n", "a", "2", "not YAML in line 2"),
]


@pytest.mark.parametrize(("text", "name", "given", "said"), REFUSED)
def test_refused(text: str, name: str, given: str, said: str) -> None:
    with pytest.raises(Refused) as refused:
        edit_yaml(text, keys_of(text, name), given)
    assert said in str(refused.value)


@pytest.mark.parametrize("written", ["2.5, b: 7", "2.5, c: 7", "3.5", "2.5 # ", "'2.5'"])
def test_a_text_that_would_say_something_else_is_not_written(monkeypatch, written: str) -> None:
    """The net below all else: whatever the new text is, it is read before it is written."""
    monkeypatch.setattr("pytpc.values.yaml_edit.yaml_text", lambda *_, **__: written)
    with pytest.raises(Refused, match=r"cannot be written without changing|not YAML"):
        edit_yaml("{a: 1.5, b: 2}", ("a",), "2.5")


FORCED = [
    ("a: 25\n", "a", "2.5", "a: 2.5\n"),
    ("a: 2.5\n", "a", "high", "a: high\n"),
    ("a: &x 1.5\nb: *x\n", "a", "2.5", "a: &x 2.5\nb: *x\n"),
    ("m: &m {z: 1}\nn: {<<: *m}\n", "n/z", "3", "m: &m {z: 3}\nn: {<<: *m}\n"),
    ("a: $(arg x)\n", "a", "2", "a: 2\n"),
]


@pytest.mark.parametrize(("before", "name", "given", "after"), FORCED)
def test_forced(before: str, name: str, given: str, after: str) -> None:
    assert edit_yaml(before, keys_of(before, name), given, force=True).data.decode() == after


# --- scalars, as PyYAML reads them (which rosparam uses)


@pytest.mark.parametrize(
    "text",
    [
        *("1", "-7", "+3", "0", "012", "08", "0x1F", "0b101", "1_000", "1:30", "-1:30:10"),
        *("1.5", "-.5", "1.", "1e5", "1.0e5", "1.0e+5", "1.5E-3", "1_0.5", "1:30.5", ".5e+3"),
        *(".inf", "-.INF", "+.inf", ".nan", "inf", "nan", "NaN"),
        *("true", "TRUE", "tRUE", "yes", "No", "on", "OFF", "y", "n"),
        *("~", "null", "Null", "NULL", "", "none"),
        *("text", "a b", "1.2.3", "--1", "x=1", "deg"),
    ],
)
def test_plain_scalars_are_read_as_pyyaml_does(text: str) -> None:
    assert repr(plain_value(text)) == repr(yaml.safe_load(f"a: {text}\n")["a"])


# deg(180) = 180*pi/180; rad() takes sums and products: pi/2 - 0.5 = 1.0707963267948966.
@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("deg(180)", math.pi),
        ("deg(-90)", -math.pi / 2),
        ("rad(2)", 2.0),
        ("rad(pi)", math.pi),
        ("rad(pi/2)", math.pi / 2),
        ("rad(2*pi)", 2 * math.pi),
        ("rad(-pi/4)", -math.pi / 4),
        ("rad(pi/2 - 0.5)", 1.0707963267948966),
    ],
)
def test_angles(text: str, value: float) -> None:
    assert plain_value(text) == pytest.approx(value, abs=1e-15)


@pytest.mark.parametrize("text", ["rad(exit)", "rad(2**3)", "rad()", "deg(x)", "rad(1 2)"])
def test_what_is_no_angle(text: str) -> None:
    with pytest.raises(ValueError, match=r".+"):
        plain_value(text)


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.1, "0.1"), (1e-7, "1.0e-07"), (1.5e300, "1.5e+300"), (100.0, "100.0"), (1e22, "1.0e+22"),
     (-0.0, "-0.0"), (math.inf, ".inf"), (-math.inf, "-.inf"), (math.nan, ".nan")],
)  # fmt: skip
def test_numbers_are_written_so_that_pyyaml_reads_them(value: float, text: str) -> None:
    assert number_text(value) == text
    assert repr(yaml.safe_load(text)) == repr(value)


def test_texts_with_control_characters() -> None:
    text = yaml_text("a\tb\u2028c\x07", "", style="'")
    assert text == '"a\\x09b\\u2028c\\x07"'
    assert yaml.safe_load(text) == "a\tb\u2028c\x07"


def test_words_of_bools() -> None:
    assert [bool_text(True, old) for old in ("Off", "false", "NO", "x")] == [
        "On", "true", "YES", "true",
    ]  # fmt: skip


def test_a_value_of_unknown_type() -> None:
    assert [guessed(text) for text in ("3", "0.5", "1e-3", "on", "map")] == [
        3, 0.5, 0.001, True, "map",
    ]  # fmt: skip
