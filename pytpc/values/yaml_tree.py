"""Reads YAML with the exact place of each value in the text.

Loading YAML forgets where a value stood and how it was written; writing it anew changes quotes,
indentation and comments. Here a text is read into nodes with spans, so that one scalar can be
replaced and all else stays as it is. Values are those that rosparam reads: YAML 1.1 as PyYAML
resolves it, with ``deg()`` and ``rad()``.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Literal

import yaml

from pytpc.values.scalars import plain_value

# PyYAML's classes of events, which differ in their fields.
_Event = Any
_MERGE = "<<"
_MOST_VALUES = 1_000_000
_DEEPEST = 200
_MERGE_TAG = "tag:yaml.org,2002:merge"


@dataclass(slots=True)
class YamlNode:
    """A value, or a key.

    ``start`` and ``end`` are offsets into the text, without the anchor and the tag; ``lineno`` is
    counted from 1. ``style`` of a scalar is ``"`` or ``'`` or ``|`` or ``>``, empty where plain.
    ``tag`` is one that is written. ``target`` is where an alias points. ``size`` is the number of
    values in it, each alias with all that it stands for.
    """

    kind: Literal["scalar", "map", "list", "alias"]
    start: int
    end: int
    lineno: int
    text: str = ""
    style: str = ""
    tag: str | None = None
    anchor: str | None = None
    flow: bool = False
    pairs: list[tuple[YamlNode, YamlNode]] = field(default_factory=list)
    items: list[YamlNode] = field(default_factory=list)
    target: YamlNode | None = None
    size: int = 1

    @property
    def behind(self) -> YamlNode:
        """The node itself, or the one that the alias refers to."""
        return self if self.target is None else self.target

    @property
    def is_plain(self) -> bool:
        """A scalar without quotes."""
        return self.kind == "scalar" and not self.style


@dataclass(frozen=True, slots=True)
class YamlSetting:
    """A value in a tree of maps: its keys from the top and its node.

    ``key`` is the node of the last key. ``written`` is the text after it: the node itself, or
    an alias of it. ``shared`` says how the value is written for more than this
    place: ``alias`` (``*x``), ``merge`` (``<<``) or empty. ``earlier`` are lines with the same
    keys, which this one overrides.
    """

    keys: tuple[str, ...]
    key: YamlNode
    node: YamlNode
    written: YamlNode
    shared: str = ""
    earlier: tuple[int, ...] = ()


def read_yaml(text: str) -> list[YamlNode]:
    """The documents of a text; an empty document is an empty plain scalar.

    Raises:
        ValueError: the text is not YAML, or has more values than any robot; the message has the
            line.
    """
    try:
        return list(_documents(yaml.parse(text, yaml.SafeLoader), text))
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        where = f" in line {mark.line + 1}" if mark is not None else ""
        raise ValueError(f"not YAML{where}: {error.problem or error.context}") from error
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        raise ValueError(f"not YAML: {' '.join(str(error).split())}") from error


def _documents(events: Iterator[_Event], text: str) -> Iterator[YamlNode]:
    anchors: dict[str, YamlNode] = {}
    for event in events:
        if type(event).__name__ == "DocumentStartEvent":
            anchors = {}
            yield _node(next(events), events, anchors, text)


def _counted(node: YamlNode, below: YamlNode) -> YamlNode:
    """``below`` itself, after its values are added to those of the node that it is in.

    Raises:
        ValueError: they are too many; a kilobyte of aliases can stand for billions.
    """
    node.size += below.size
    if node.size > _MOST_VALUES:
        raise ValueError(f"line {below.lineno}: more than {_MOST_VALUES:,} values, with aliases")
    return below


def _node(
    event: _Event,
    events: Iterator[_Event],
    anchors: dict[str, YamlNode],
    text: str,
    depth: int = 0,
) -> YamlNode:
    kind = type(event).__name__
    start, end = event.start_mark.index, event.end_mark.index
    lineno = event.start_mark.line + 1
    if depth > _DEEPEST:
        raise ValueError(f"line {lineno}: more than {_DEEPEST} levels")
    if kind == "AliasEvent":
        target = anchors.get(event.anchor)
        if target is None:
            raise ValueError(f"line {lineno}: *{event.anchor} has no anchor")
        return YamlNode(
            "alias", start, end, lineno, text=event.anchor, target=target, size=target.size
        )
    tag = None if event.tag is None else str(event.tag)
    node = YamlNode("scalar", start, end, lineno, tag=tag, anchor=event.anchor)
    if node.anchor is not None:
        anchors[node.anchor] = node
    if kind == "ScalarEvent":
        node.text = event.value
        node.style = event.style or ""
        _skip_properties(node, text)
        return node
    node.flow = bool(event.flow_style)
    if kind == "SequenceStartEvent":
        node.kind = "list"
        while type(event := next(events)).__name__ != "SequenceEndEvent":
            node.items.append(_counted(node, _node(event, events, anchors, text, depth + 1)))
    else:
        node.kind = "map"
        while type(event := next(events)).__name__ != "MappingEndEvent":
            key = _counted(node, _node(event, events, anchors, text, depth + 1))
            value = _counted(node, _node(next(events), events, anchors, text, depth + 1))
            node.pairs.append((key, value))
    node.end = event.end_mark.index
    return node


def _skip_properties(node: YamlNode, text: str) -> None:
    """Move the start past ``&anchor`` and ``!tag``."""
    while node.start < node.end and text[node.start] in "&!" and (node.anchor or node.tag):
        while node.start < node.end and not text[node.start].isspace():
            node.start += 1
        while node.start < node.end and text[node.start].isspace():
            if text[node.start] == "\n":
                node.lineno += 1
            node.start += 1


def settings(document: YamlNode) -> dict[tuple[str, ...], YamlSetting]:
    """All values below the maps of a document, by their keys; the last of equal keys holds.

    A list is one value, as on the parameter server. Keys that are no texts are left out.
    """
    found: dict[tuple[str, ...], YamlSetting] = {}
    if document.kind == "map":
        _gather(document, (), "", found, ())
    elif document.text or document.kind == "list":
        # The whole document is one value: <rosparam param="x">5</rosparam>.
        found[()] = YamlSetting((), document, document.behind, document)
    return found


def _gather(
    node: YamlNode,
    keys: tuple[str, ...],
    shared: str,
    found: dict[tuple[str, ...], YamlSetting],
    open_maps: tuple[int, ...],
) -> None:
    if id(node) in open_maps:
        return
    for name, pair in _last_pairs(node).items():
        place = (*keys, name)
        how = pair.shared or shared or ("alias" if pair.value.kind == "alias" else "")
        below = pair.value.behind
        if below.kind == "map":
            _gather(below, place, how, found, (*open_maps, id(node)))
        else:
            found[place] = YamlSetting(place, pair.key, below, pair.value, how, pair.earlier)


@dataclass(frozen=True, slots=True)
class _Pair:
    """A pair of a map; ``earlier`` are the lines of equal keys that are written before it."""

    key: YamlNode
    value: YamlNode
    shared: str = ""
    earlier: tuple[int, ...] = ()


def _last_pairs(node: YamlNode, open_maps: tuple[int, ...] = ()) -> dict[str, _Pair]:
    """The pairs of a map that count: own ones before merged ones, of equal keys the last.

    A value that does not count is replaced as a whole: maps are not merged into one another.
    """
    own: dict[str, _Pair] = {}
    merged: list[YamlNode] = []
    for key, value in node.pairs:
        if _is_merge(key):
            behind = value.behind
            merged += [behind] if behind.kind == "map" else [item.behind for item in behind.items]
        elif key.behind.kind == "scalar":
            before = own.pop(key.behind.text, None)
            earlier = () if before is None else (*before.earlier, before.key.lineno)
            own[key.behind.text] = _Pair(key, value, earlier=earlier)
    pairs: dict[str, _Pair] = {}
    # The first of several merged maps holds.
    for below in reversed(merged):
        if id(below) not in open_maps:
            for name, pair in _last_pairs(below, (*open_maps, id(node))).items():
                pairs[name] = _Pair(pair.key, pair.value, "merge")
    return {**pairs, **own}


def _is_merge(key: YamlNode) -> bool:
    return key.kind == "scalar" and (
        key.tag == _MERGE_TAG or (key.text == _MERGE and key.is_plain and key.tag is None)
    )


def value_of(node: YamlNode) -> object:
    """The value that rosparam reads from a node.

    Raises:
        ValueError: a tag that rosparam does not know, a value that does not fit it, or a list that
            contains itself.
    """
    try:
        return _value_of(node.behind)
    except RecursionError:
        raise ValueError(f"line {node.lineno}: it contains itself") from None


def _value_of(node: YamlNode) -> object:
    if node.kind == "map":
        return {name: _value_of(pair.value.behind) for name, pair in _last_pairs(node).items()}
    if node.kind == "list":
        return [_value_of(item.behind) for item in node.items]
    return plain_value(node.text, node.tag, quoted=bool(node.style))
