"""Changes one value in a params file of ROS 2, or adds one; all other characters stay."""

from __future__ import annotations

from pytpc.values.new_value import Refused
from pytpc.values.rcl_params import (
    PARAMS_KEY,
    NodeEntry,
    ParamsError,
    ParamsStore,
    Slot,
    Written,
)
from pytpc.values.rcl_scalars import rcl_text, rcl_value, typed_value
from pytpc.values.scalars import same_value
from pytpc.values.yaml_edit import Edit, Keys
from pytpc.values.yaml_tree import YamlNode, read_yaml

_LISTED = 5


def store_of(text: str) -> ParamsStore:
    """What one params file sets.

    Raises:
        Refused: rcl refuses it, or it is not YAML.
    """
    store = ParamsStore()
    try:
        store.load(text)
    except ParamsError as error:
        raise Refused(str(error), error.lineno) from error
    return store


def edit_params(
    text: str, keys: Keys, given: str, *, lineno: int | None = None, force: bool = False
) -> Edit:
    """Replace one value by another.

    Args:
        text: of a params file.
        keys: from the top of the file.
        given: the new value as typed.
        lineno: of the value, where the keys are there more than once; else the one that counts.
        force: change its type, too.

    Raises:
        Refused: see docs/how-to/change-a-parameter.md; the message says what to do.
    """
    store = store_of(text)
    everything = list(store.all_written())
    having = [number for number, (_, _, one) in enumerate(everything) if one.keys == keys]
    if not having:
        raise Refused(f"{'/'.join(keys)} is not in the file")
    here = [number for number in having if everything[number][2].lineno == lineno]
    holding = [number for number in having if everything[number][1].holds is everything[number][2]]
    number = (here or holding or having)[-1]
    _, slot, written = everything[number]
    if "$(" in str(written.value) and not force:
        raise Refused(
            f"launch substitutes a part of it: {written.value}; --force replaces it", written.lineno
        )
    if written.node is None:
        raise Refused("it is not in the file")
    if written.node.style in ("|", ">"):
        raise Refused("it is a block of text, which cannot be changed", written.lineno)
    try:
        pieces, new = _pieces(written.node, written.value, given, force)
    except Refused as error:
        raise Refused(str(error), error.lineno or written.lineno) from error
    edited = text
    for node, piece in sorted(pieces, key=lambda pair: -pair[0].start):
        edited = edited[: node.start] + piece + edited[node.end :]
    _check(everything, edited, number, new)
    return Edit(edited.encode(), written.value, new, written.lineno or 0, tuple(_notes(slot, new)))


def _notes(slot: Slot, new: object) -> list[str]:
    others = [one for one in slot.all if one is not slot.holds and one.lineno]
    lines = ", ".join(str(one.lineno) for one in others[:_LISTED])
    if not others:
        return []
    if slot.is_stale:
        return [
            f"line {lines} sets it to a value of another type, which rcl does not let replace it"
        ]
    return [f"line {lines} sets it, too, and does not count"]


def _pieces(
    node: YamlNode, old: object, given: str, force: bool
) -> tuple[list[tuple[YamlNode, str]], object]:
    """The texts to put in place of nodes, and the new value.

    Raises:
        Refused: the value does not fit.
    """
    if not isinstance(old, list):
        new = typed_value(given, old, force=force)
        return [(node, _scalar_text(node, new, given))], new
    wanted = items_of(given)
    if wanted is None:
        raise Refused("the parameter is a list: give all of it, as in '[1.0, 2.0]'", node.lineno)
    if len(wanted) != len(old):
        raise Refused(f"the list has {len(old)} values, but {len(wanted)} were given", node.lineno)
    pieces, values = [], []
    for item, before, one in zip(node.items, old, wanted, strict=True):
        value = typed_value(one.text, before)
        values.append(value)
        if not same_value(value, before):
            pieces.append((item, _scalar_text(item, value, one.text)))
    return pieces, values


def items_of(given: str) -> list[YamlNode] | None:
    """The items of a list of scalars as typed; None if it is none."""
    try:
        documents = read_yaml(given)
    except ValueError:
        return None
    if len(documents) != 1 or documents[0].kind != "list":
        return None
    items = documents[0].items
    return None if any(item.kind != "scalar" for item in items) else items


def _scalar_text(node: YamlNode, new: object, given: str) -> str:
    return rcl_text(new, given, node.text, node.style if isinstance(new, str) else "")


def _check(
    before: list[tuple[NodeEntry, Slot, Written]], text: str, number: int, new: object
) -> None:
    """Check that rcl reads the new value from the edited text, and no other difference."""
    wanted = [(entry.written, slot.name, one.value) for entry, slot, one in before]
    wanted[number] = (*wanted[number][:2], new)
    try:
        found = [(entry.written, slot.name, one.value) for entry, slot, one in _read(text)]
    except Refused:
        found = []
    # The order of reading is that of the types, too, so compare as text: 1 is not 1.0.
    if list(map(repr, found)) != list(map(repr, wanted)):
        raise Refused("it cannot be written without changing other values")


def _read(text: str) -> list[tuple[NodeEntry, Slot, Written]]:
    return list(store_of(text).all_written())


def add_to_params(text: str, node: str, name: str, given: str) -> Edit:
    """Add a parameter that the file does not set for this node.

    It goes to the end of the node's own entry, or into a new entry at the end of the file.

    Args:
        text: of a params file.
        node: the full name of the node.
        name: of the parameter, with dots.
        given: the value as typed.

    Raises:
        Refused: the entry is not one key a line, or the new text would be read differently.
    """
    value = rcl_value(given.strip())
    written = rcl_text(value, given)
    store = store_of(text)
    own = [entry for entry in store.entries if entry.pattern == node and entry.maps]
    newline = "\r\n" if "\r\n" in text else "\n"
    if own:
        at, piece = _end_of(text, own[-1].maps[-1], name, written, newline)
    else:
        at = len(text)
        start = "" if not text or text.endswith("\n") else newline
        piece = newline.join([f"{start}{node}:", f"  {PARAMS_KEY}:", f"    {name}: {written}", ""])
    edited = text[:at] + piece + text[at:]
    _check_addition(store, edited, node, name, value)
    lines = edited[: at + len(piece)].rstrip().count("\n") + 1
    return Edit(edited.encode(), None, value, lines)


def _end_of(text: str, below: YamlNode, name: str, written: str, newline: str) -> tuple[int, str]:
    """Where a pair goes behind the last one of a map, and its text."""
    prefix, rest = _nested(below, name)
    if prefix is not None:
        return _end_of(text, prefix, rest, written, newline)
    if below.kind != "map" or below.flow or not below.pairs:
        raise Refused("its parameters are not one a line; add it by hand", below.lineno)
    first = below.pairs[0][0]
    indent = text[text.rfind("\n", 0, first.start) + 1 : first.start].lstrip("\ufeff")
    if indent.strip():
        raise Refused("its parameters are not one a line; add it by hand", first.lineno)
    last = below.pairs[-1][1]
    while last.kind == "map" and not last.flow and last.pairs:
        last = last.pairs[-1][1]
    end = max(last.end, last.start)
    while last.kind == "list" and not last.flow and last.items:
        last = last.items[-1]
        end = last.end
    line_end = text.find("\n", end)
    line = f"{indent}{name}: {written}"
    if line_end < 0:
        return len(text), f"{newline}{line}{newline}"
    return line_end + 1, f"{line}{newline}"


def _nested(below: YamlNode, name: str) -> tuple[YamlNode | None, str]:
    """The map that stands for the first part of a dotted name, and the rest of the name."""
    for key, value in below.pairs:
        if value.kind == "map" and value.pairs and name.startswith(f"{key.text}."):
            return value, name[len(key.text) + 1 :]
    return None, name


def _check_addition(before: ParamsStore, text: str, node: str, name: str, value: object) -> None:
    wanted = sorted(
        [repr((entry.pattern, slot.name, one.value)) for entry, slot, one in before.all_written()]
        + [repr((node, name, value))]
    )
    try:
        found = [repr((e.pattern, slot.name, one.value)) for e, slot, one in _read(text)]
    except Refused:
        found = []
    if sorted(found) != wanted:
        raise Refused("it cannot be added without changing other values; add it by hand")
