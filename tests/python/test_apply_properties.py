"""Any YAML or launch file: after a change one value differs, and undo gives the bytes back."""

from __future__ import annotations

import copy
import tempfile
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from pytpc.base.atomic import replace_file
from pytpc.values.apply import FileChange, apply_change, undo_change
from pytpc.values.journal import Journal
from pytpc.values.launch_edit import edit_param
from pytpc.values.new_value import launch_value
from pytpc.values.yaml_edit import edit_yaml

NAMES = st.sampled_from(["a", "b", "limit", "rate_2", "größe", "x-y", "Null_", "on_off"])
WORDS = st.text(st.sampled_from("abcXYZ 01_-:#'\"{}[],&*!|>%@`~äß=<"), max_size=8)
FLOATS = st.floats(allow_nan=False, allow_infinity=False)
NUMBERS = st.one_of(st.integers(-(2**31), 2**31 - 1), FLOATS)
VALUES = st.one_of(NUMBERS, st.booleans(), WORDS)
COMMENTS = st.sampled_from(["", "  # a: 1", " # \"x\" 'y' {"])
ENDS = st.sampled_from(["\n", "\r\n"])


@dataclass
class Written:
    """A YAML text with the span of one of its values."""

    text: str
    keys: tuple[str, ...]
    start: int
    end: int


def scalar(draw: st.DrawFn, value: object) -> str:
    """One of the ways in which YAML writes a value."""
    if isinstance(value, bool):
        return draw(st.sampled_from(["true", "True", "yes", "ON"] if value else ["no", "false"]))
    if isinstance(value, str):
        if draw(st.booleans()):
            return "'" + value.replace("'", "''") + "'"
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    return yaml.safe_dump(value).removesuffix("\n...\n").strip()


@st.composite
def documents(draw: st.DrawFn) -> Written:
    """Maps in block and flow style, lists, comments, empty lines; one scalar is chosen."""
    pieces: list[str] = []
    spans: list[tuple[tuple[str, ...], int, int]] = []
    end = draw(ENDS)

    def put(text: str) -> None:
        pieces.append(text)

    def put_scalar(keys: tuple[str, ...] | None) -> None:
        text = scalar(draw, draw(VALUES))
        start = sum(map(len, pieces))
        put(text)
        if keys is not None:
            spans.append((keys, start, start + len(text)))

    def flow(keys: tuple[str, ...] | None, depth: int) -> None:
        kind = draw(st.sampled_from(["map", "list", "scalar"])) if depth else "scalar"
        if kind == "map":
            put("{")
            for name in draw(st.lists(NAMES, min_size=1, max_size=3, unique=True)):
                put(f"{name}: ")
                flow(None if keys is None else (*keys, name), depth - 1)
                put(", ")
            put("}")
        elif kind == "list":
            put("[")
            for _ in range(draw(st.integers(0, 3))):
                flow(None, depth - 1)
                put(", ")
            put("]")
        else:
            put_scalar(keys)

    def block(keys: tuple[str, ...], indent: str, depth: int) -> None:
        for name in draw(st.lists(NAMES, min_size=1, max_size=3, unique=True)):
            if draw(st.booleans()):
                put(f"{indent}# {name}: 3{end}")
            put(f"{indent}{name}:")
            if depth and draw(st.booleans()):
                put(draw(COMMENTS) + end)
                block((*keys, name), indent + draw(st.sampled_from([" ", "    "])), depth - 1)
            else:
                put(draw(st.sampled_from([" ", "   "])))
                flow((*keys, name), 2)
                put(draw(COMMENTS) + end)

    put(draw(st.sampled_from(["", "---" + end, "# top" + end])))
    block((), "", 2)
    if not spans:
        put("last: ")
        put_scalar(("last",))
        put(end)
    keys, start, stop = draw(st.sampled_from(spans))
    return Written("".join(pieces), keys, start, stop)


def changed(tree: object, keys: tuple[str, ...], value: object) -> object:
    tree = copy.deepcopy(tree)
    below = tree
    for key in keys[:-1]:
        below = below[key]  # type: ignore[index]
    below[keys[-1]] = value  # type: ignore[index]
    return tree


def at(tree: object, keys: tuple[str, ...]) -> object:
    for key in keys:
        tree = tree[key]  # type: ignore[index]
    return tree


@settings(max_examples=200, deadline=None)
@given(document=documents(), number=FLOATS, word=WORDS, flag=st.booleans())
def test_any_yaml(document: Written, number: float, word: str, flag: bool) -> None:
    before = yaml.safe_load(document.text)
    old = at(before, document.keys)
    new: object = word
    given_text = word
    if isinstance(old, bool):
        new, given_text = flag, str(flag)
    elif isinstance(old, int):
        new = round(number) if abs(number) < 2**31 else 7
        given_text = str(new)
    elif isinstance(old, float):
        new, given_text = number, repr(number)
    edit = edit_yaml(document.text, document.keys, given_text)
    after = edit.data.decode()
    # All but the scalar's own characters are as they were...
    tail = document.text[document.end :]
    assert after.startswith(document.text[: document.start])
    assert after.endswith(tail)
    assert len(after) >= document.start + len(tail)
    # ... and PyYAML, which rosparam uses, reads the new value and no other that differs.
    assert repr(yaml.safe_load(after)) == repr(changed(before, document.keys, new))


@st.composite
def launch_files(draw: st.DrawFn) -> tuple[str, int, int, int]:
    """A launch file with parameters p0, p1, ...; which is chosen, and the span of its value."""
    end = draw(ENDS)
    lines = ["<?xml version='1.0'?>", "<!-- <param name='p0' value='9'/> -->", "<launch>"]
    values = []
    for number in range(draw(st.integers(1, 5))):
        values.append(draw(st.one_of(st.just("0.5"), st.integers(-9, 9).map(str))))
        attributes = [f"name={quoteattr(f'p{number}')}", f"value='VALUE{number}'"]
        if draw(st.booleans()):
            attributes.append("if='true'")
        blank = draw(st.sampled_from([" ", f"{end}     ", "\t"]))
        closing = draw(st.sampled_from(["/>", "></param>"]))
        lines.append(f"  <param {blank.join(draw(st.permutations(attributes)))}{closing}")
        lines.append(draw(st.sampled_from(["", "  <!-- & < -->", "  <a b='>' c='&lt;'/>"])))
    lines.append("</launch>")
    chosen = draw(st.integers(0, len(values) - 1))
    text = end.join(lines)
    for number, value in enumerate(values):
        if number != chosen:
            text = text.replace(f"VALUE{number}", value)
    start = text.index(f"VALUE{chosen}")
    text = text.replace(f"VALUE{chosen}", values[chosen])
    return text, chosen, start, start + len(values[chosen])


@settings(max_examples=200, deadline=None)
@given(sample=launch_files(), number=st.integers(-(2**31), 2**31 - 1), share=FLOATS)
def test_any_launch_file(sample: tuple[str, int, int, int], number: int, share: float) -> None:
    text, chosen, start, end = sample
    name = f"p{chosen}"
    new = share if "." in text[start:end] else number
    after = edit_param(text.encode(), f"/{name}", 0, repr(new)).data.decode()
    assert after.startswith(text[:start])
    assert after.endswith(text[end:])
    assert len(after) > len(text) - (end - start)
    read = values_of(after)
    assert repr(launch_value(read.pop(name), "auto")) == repr(new)
    before = values_of(text)
    del before[name]
    assert read == before


def values_of(text: str) -> dict[str, str]:
    tags = ElementTree.fromstring(text.encode()).iter("param")
    return {tag.get("name", ""): tag.get("value", "") for tag in tags}


@settings(max_examples=25, deadline=None)
@given(
    before=st.binary(max_size=99),
    after=st.binary(max_size=99),
    mode=st.sampled_from([0o644, 0o600]),
)
def test_undo_gives_the_bytes_back(before: bytes, after: bytes, mode: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "params.yaml"
        path.write_bytes(before)
        path.chmod(mode)
        journal = Journal(Path(folder) / "journal")
        entry = apply_change(FileChange("/a", path, before, after, 1, 2, 1), journal)
        assert path.read_bytes() == after
        undone = undo_change(entry, journal)
        replace_file(undone.path, undone.after)
        assert path.read_bytes() == before
        assert path.stat().st_mode & 0o777 == mode
