"""Changes one value in a YAML text; all other characters stay."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from pytpc.values.new_value import Refused, degrees_text, guessed, read_value, yaml_text
from pytpc.values.scalars import number_text, same_value, type_of
from pytpc.values.yaml_tree import YamlNode, YamlSetting, read_yaml, settings, value_of

Keys = tuple[str, ...]
_DEGREES = re.compile(r"\s*deg\(.*\)\s*")
_RADIANS = re.compile(r"\s*rad\(.*\)\s*")
_LISTED = 5


@dataclass(frozen=True, slots=True)
class Edit:
    """A change of one value: the file after it, what it was and is, its line, what else to know."""

    data: bytes
    old: object
    new: object
    lineno: int
    notes: tuple[str, ...] = ()


def all_settings(text: str) -> list[Mapping[Keys, YamlSetting]]:
    """The values that each document of a YAML text sets.

    Raises:
        Refused: it is not YAML.
    """
    try:
        return [settings(document) for document in read_yaml(text)]
    except ValueError as error:
        raise Refused(str(error)) from error


def edit_yaml(text: str, keys: Keys, given: str, *, force: bool = False) -> Edit:
    """Replace one value by another.

    Args:
        text: of a YAML file.
        keys: from the top of the document.
        given: the new value as typed.
        force: change the type, or a value that other parameters have, too (an anchor).

    Raises:
        Refused: see docs/how-to/change-a-parameter.md; the message says what to do.
    """
    documents = all_settings(text)
    having = [document for document in documents if keys in document]
    if len(having) != 1:
        where = f"in {len(having)} documents of the file" if having else "not in the file"
        raise Refused(f"{'/'.join(keys)} is {where}")
    setting = having[0][keys]
    node, spot = setting.node, setting.written
    if spot.kind != "alias" or node.kind == "list":
        spot = node
    old = _read(node)
    if "$(" in node.text and not force:
        raise Refused(
            f"roslaunch substitutes a part of it: {node.text}; --force replaces it", node.lineno
        )
    notes = _notes(having[0], setting, spot, force)
    pieces: list[tuple[YamlNode, str]]
    new: object
    if isinstance(old, list):
        pieces, new = _list_pieces(node, given, force)
    else:
        # The type of what roslaunch substitutes is not known.
        worked_out = "$(" in node.text
        new = guessed(given) if worked_out else read_value(given, type_of(old), force=force)
        piece, more = _piece(node, new, given)
        pieces = [(spot, piece)]
        notes += more
    for one, piece in sorted(pieces, key=lambda pair: -pair[0].start):
        text = _put(text, one, piece)
    changed = _changed_with(having[0], spot)
    _check(documents, text, {(documents.index(having[0]), keys): new for keys in changed})
    return Edit(text.encode(), old, new, spot.lineno, tuple(notes))


def _changed_with(document: Mapping[Keys, YamlSetting], spot: YamlNode) -> list[Keys]:
    """The keys of all values that change when the text of this node does."""
    return [one.keys for one in document.values() if one.written is spot or one.node is spot]


def _notes(
    document: Mapping[Keys, YamlSetting], setting: YamlSetting, spot: YamlNode, force: bool
) -> list[str]:
    """Notes on a change.

    Raises:
        Refused: other parameters share the text of the value, and ``force`` is not given.
    """
    others = [keys for keys in _changed_with(document, spot) if keys != setting.keys]
    if others:
        names = ", ".join("/".join(keys) for keys in others[:_LISTED])
        if not force:
            raise Refused(f"it is the value of {names}, too; --force changes all", spot.lineno)
        return [f"{names} changes with it"]
    notes = []
    if spot.kind == "alias":
        notes.append(f"it stood for &{spot.text} of line {setting.node.lineno}, which stays")
    if setting.earlier:
        lines = ", ".join(map(str, setting.earlier[:_LISTED]))
        notes.append(f"line {lines} sets it, too, and does not count")
    return notes


def _read(node: YamlNode) -> object:
    if node.kind == "scalar" and node.style in ("|", ">"):
        raise Refused("it is a block of text, which cannot be changed", node.lineno)
    try:
        return value_of(node)
    except ValueError as error:
        raise Refused(str(error), node.lineno) from error


def _piece(node: YamlNode, new: object, given: str) -> tuple[str, list[str]]:
    """The text for a scalar; angles stay angles."""
    tag = (node.tag or "").lstrip("!")
    degrees = tag == "degrees" or (node.is_plain and _DEGREES.fullmatch(node.text))
    if degrees and isinstance(new, float):
        exact = degrees_text(new)
        if exact is None:
            if tag:
                raise Refused(f"no number of degrees is {number_text(new)} rad", node.lineno)
            return number_text(new), ["no number of degrees is this angle; it is in rad now"]
        return (exact if tag and "(" not in node.text else f"deg({exact})"), []
    if isinstance(new, float) and node.is_plain and _RADIANS.fullmatch(node.text):
        return f"rad({yaml_text(new, given)})", []
    style = node.style if isinstance(new, str) else ""
    if isinstance(new, str) and node.is_plain and node.tag:
        # A tag makes a text of anything.
        return yaml_text(new, given, style="'"), []
    return yaml_text(new, given, node.text, style), []


def _list_pieces(
    node: YamlNode, given: str, force: bool
) -> tuple[list[tuple[YamlNode, str]], list[object]]:
    try:
        documents = read_yaml(given)
        wanted = documents[0].items if documents and documents[0].kind == "list" else None
    except ValueError:
        wanted = None
    if wanted is None or any(item.kind != "scalar" for item in wanted):
        raise Refused("the parameter is a list: give all of it, as in '[1.0, 2.0]'", node.lineno)
    if len(wanted) != len(node.items):
        had = len(node.items)
        raise Refused(f"the list has {had} values, but {len(wanted)} were given", node.lineno)
    pieces: list[tuple[YamlNode, str]] = []
    new: list[object] = []
    for item, one in zip(node.items, wanted, strict=True):
        if item.kind != "scalar":
            raise Refused("lists in lists, maps in lists and aliases are not changed", item.lineno)
        old = _read(item)
        value = read_value(one.text, type_of(old), force=force)
        new.append(value)
        if not same_value(value, old):
            piece, _ = _piece(item, value, one.text)
            pieces.append((item, piece))
    return pieces, new


def _put(text: str, node: YamlNode, piece: str) -> str:
    start, end = node.start, node.end
    if start == end:
        raise Refused("it has no value yet; write one into the file", node.lineno)
    return text[:start] + piece + text[end:]


def _check(
    before: list[Mapping[Keys, YamlSetting]], text: str, changed: Mapping[tuple[int, Keys], object]
) -> None:
    """Check that the edited text has these new values and no other changes.

    ``changed`` has them by the number of the document and the keys.
    """
    wanted, found = _all_values(before), _all_values(all_settings(text))
    for place, value in changed.items():
        wanted[place] = (repr(value), wanted[place][1])
    if found != wanted:
        raise Refused("it cannot be written without changing other values")


def _all_values(
    documents: list[Mapping[Keys, YamlSetting]],
) -> dict[tuple[int, Keys], tuple[str, int]]:
    """The values of all documents, each with the number of earlier uses of its keys.

    As text, which tells 1 from 1.0 and takes NaN for NaN.
    """
    return {
        (number, keys): (repr(_value(setting.node)), len(setting.earlier))
        for number, document in enumerate(documents)
        for keys, setting in document.items()
    }


def _value(node: YamlNode) -> object:
    try:
        return value_of(node)
    except ValueError:
        return (node.tag, node.text)
