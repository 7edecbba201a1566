"""YAML with the places of its values: what is read is what PyYAML, and so rosparam, reads."""

from __future__ import annotations

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from pytpc.values import yaml_tree
from pytpc.values.yaml_tree import read_yaml, value_of

# Not of one letter: PyYAML 6.0.4 takes equal keys of a merged map for one if they are one object of
# Python, as such names are, and keeps the first of them.
NAMES = st.sampled_from(["aa", "bb", "cc", "dd"])


@st.composite
def documents(draw: st.DrawFn) -> str:
    """Maps in flow style with anchors, aliases, merges (also of lists of maps) and equal keys."""
    maps: list[str] = []
    scalars: list[str] = []

    def value(depth: int) -> str:
        kind = draw(st.sampled_from(["scalar", "anchored", "alias", "map", "list", "copy"]))
        if kind == "alias" and scalars:
            return f"*{draw(st.sampled_from(scalars))} "
        if kind == "copy" and maps:
            return f"*{draw(st.sampled_from(maps))} "
        if kind == "map" and depth:
            return some_map(depth - 1)
        if kind == "list" and depth:
            items = [value(0) for _ in range(draw(st.integers(0, 2)))]
            return "[" + ", ".join(items) + "]"
        text = str(draw(st.integers(-9, 9)))
        if kind == "anchored":
            name = f"s{len(scalars)}"
            scalars.append(name)
            return f"&{name} {text}"
        return text

    def some_map(depth: int) -> str:
        pairs = []
        names = draw(st.lists(st.one_of(NAMES, st.just("<<")), max_size=4))
        if names.count("<<") > 1:
            names = [name for name in names if name != "<<"]
        for name in names:
            if name != "<<":
                pairs.append(f"{name}: {value(depth)}")
            elif maps:
                merged = draw(st.lists(st.sampled_from(maps), min_size=1, max_size=2))
                one = f"*{merged[0]} "
                several = ", ".join(f"*{anchor} " for anchor in merged)
                pairs.append(f"<<: {one if len(merged) == 1 else f'[{several}]'}")
        body = "{" + ", ".join(pairs) + "}"
        if draw(st.booleans()):
            # An anchor counts from its end on: a map has no alias of itself.
            name = f"m{len(maps)}"
            maps.append(name)
            return f"&{name} {body}"
        return body

    lines = []
    for name in draw(st.lists(NAMES, min_size=1, max_size=4)):
        lines.append(f"{name}: {value(3)}\n")
    return "".join(lines)


def flat(tree: object, keys: tuple[str, ...] = ()) -> dict[tuple[str, ...], object]:
    """The values below the maps of a tree; an empty map has none."""
    if not isinstance(tree, dict):
        return {keys: tree}
    found: dict[tuple[str, ...], object] = {}
    for name, below in tree.items():
        found.update(flat(below, (*keys, name)))
    return found


@settings(max_examples=500, deadline=None)
@given(text=documents())
def test_pyyaml_reads_the_same(text: str) -> None:
    wanted = flat(yaml.safe_load(text))
    (document,) = read_yaml(text)
    found = {keys: one.node for keys, one in yaml_tree.settings(document).items()}
    assert {keys: value_of(node) for keys, node in found.items()} == wanted
    # Each scalar stands where it is said to stand.
    for node in found.values():
        if node.kind == "scalar":
            assert text[node.start : node.end] == node.text
            assert text[: node.start].count("\n") + 1 == node.lineno


# Offsets are counted from 0, lines from 1.
@pytest.mark.parametrize(
    ("text", "written", "lineno"),
    [
        ("a: &x !!int 5 # c\n", "5", 1),
        ("a: !!str\n  &x\n  'b'\n", "'b'", 3),
        ("a:\n\n  text of\n  two lines\n", "text of\n  two lines", 3),
        ('a: "x\\\n  y"\n', '"x\\\n  y"', 1),
        ("\ufeffa: ü\r\n", "ü", 1),
        ("{a: 5}", "5", 1),
    ],
)
def test_where_a_scalar_stands(text: str, written: str, lineno: int) -> None:
    (document,) = read_yaml(text)
    node = yaml_tree.settings(document)["a",].node
    assert text[node.start : node.end] == written
    assert node.lineno == lineno


def test_documents() -> None:
    assert [one.kind for one in read_yaml("a: 1\n---\n- 2\n---\n3\n")] == ["map", "list", "scalar"]
    assert read_yaml("# nothing\n") == []
    assert yaml_tree.settings(read_yaml("5")[0])[()].node.text == "5"


@pytest.mark.parametrize(
    "text", ["a: [", "a: *b", "a: b: c", "\x00", "a: 'x", "%YAML 9.9 x\na", "[" * 1500]
)
def test_what_is_no_yaml(text: str) -> None:
    with pytest.raises(ValueError, match="not YAML"):
        read_yaml(text)


def test_a_list_that_contains_itself() -> None:
    (document,) = read_yaml("a: &x [1, *x]\n")
    with pytest.raises(ValueError, match="line 1: it contains itself"):
        value_of(yaml_tree.settings(document)["a",].node)
    assert yaml_tree.settings(read_yaml("a: &x {b: *x, c: 1}\n")[0]).keys() == {("a", "c")}
