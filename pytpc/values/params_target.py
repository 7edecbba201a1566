"""Finds the value that a user means in a params file of ROS 2."""

from __future__ import annotations

from pytpc.base.closest import did_you_mean
from pytpc.base.wording import listed
from pytpc.values.new_value import Refused
from pytpc.values.origins import split_name
from pytpc.values.rcl_edit import add_to_params, edit_params, store_of
from pytpc.values.rcl_params import ANY_NODE, PARAMS_KEY, Held, ParamsStore, Slot
from pytpc.values.yaml_edit import Edit

_LISTED = 8
_KEY = f"/{PARAMS_KEY}/"


def plan_params(
    text: str, parameter: str, given: str, *, add: bool = False, force: bool = False
) -> tuple[str, Edit]:
    """Work out a change of a params file.

    Args:
        text: of the file.
        parameter: ``/robot1/guard/limits.min``, ``guard/limits.min``, ``limits.min`` or ``min``.
            ``/**/limits.min`` is that of the entry for all nodes.
        given: the new value as typed.
        add: add it where the file does not set it; ``parameter`` has the full name of the node.
        force: change its type, too.

    Returns:
        The full name of what changes, and the edit with its notes.

    Raises:
        Refused: no value or several are meant, or the change is refused.
    """
    store = store_of(text)
    node, name = split_given(parameter)
    names = sorted({f"{e.pattern}/{slot.name}" for e, slot, _ in store.all_written()})
    node, held = _held(store, node, name, names, parameter)
    if held is None:
        if add and node.startswith("/") and "*" not in node:
            return f"{node}/{name}", add_to_params(text, node, name, given)
        hint = did_you_mean(parameter, names)
        more = "; --add adds it for the node whose full name you give, as in /NODE/NAME"
        raise Refused(f"{parameter} is not in the file{hint or more}")
    written = held.slot.holds
    if written is None:
        raise Refused(f"{parameter} is an empty list, which has no type; write it by hand")
    edit = edit_params(text, written.keys, given, lineno=written.lineno, force=force)
    shown = f"{held.entry.pattern}/{held.slot.name}"
    return shown, Edit(
        edit.data, edit.old, edit.new, edit.lineno, (*edit.notes, *_notes(store, held))
    )


def split_given(parameter: str) -> tuple[str, str]:
    """``split_name`` of what a user gives, who may also name the keys of the file.

    >>> split_given("/guard/ros__parameters/limits/min")
    ('/guard', 'limits.min')
    """
    if _KEY in parameter:
        node, _, name = parameter.partition(_KEY)
        return node, name.replace("/", ".")
    return split_name(parameter)


def _held(
    store: ParamsStore, node: str, name: str, names: list[str], parameter: str
) -> tuple[str, Held | None]:
    """The node that is meant, and what it gets for the parameter.

    Raises:
        Refused: several are meant.
    """
    if node.startswith("/"):
        if "*" in node:
            return node, _of_pattern(store, node, name)
        return node, store.of_node(node).get(name)
    pairs = sorted({(entry.pattern, slot.name) for entry, slot, _ in store.all_written()})
    if node:
        pairs = [pair for pair in pairs if pair[0].endswith(f"/{node}") and pair[1] == name]
        if not pairs:
            return f"/{node}", store.of_node(f"/{node}").get(name)
    else:
        whole = [pair for pair in pairs if pair[1] == name]
        pairs = whole or [pair for pair in pairs if pair[1].endswith(f".{name}")]
    if len(pairs) > 1:
        meant = listed([f"{pattern}/{full}" for pattern, full in pairs], _LISTED)
        raise Refused(f"several values end with {parameter}: {meant}")
    if not pairs:
        return node, None
    pattern, full = pairs[0]
    if "*" in pattern:
        return pattern, _of_pattern(store, pattern, full)
    return pattern, store.of_node(pattern).get(full)


def _of_pattern(store: ParamsStore, pattern: str, name: str) -> Held | None:
    """The value of an entry for several nodes; the last one of its name counts."""
    found = None
    for entry in store.entries:
        for slot in entry.slots if entry.pattern == pattern else ():
            if slot.name == name:
                found = Held(entry, slot)
    return found


def _notes(store: ParamsStore, held: Held) -> list[str]:
    """For which other nodes an entry counts, and for which it does not."""
    entry, slot = held.entry, held.slot
    notes: list[str] = []
    if entry.is_wildcard:
        named = sorted({one.pattern for one in store.entries if not one.is_wildcard})
        of_named = {one: _slot_of(store, one, slot.name) for one in named if entry.fits(one)}
        taking = [one for one, own in of_named.items() if own is slot]
        which = "loads the file" if entry.written == ANY_NODE else "it fits and that loads the file"
        among = f"; of those that the file names, {len(taking)}: {listed(taking, _LISTED)}"
        notes.append(
            f"{entry.written} sets it for every node that {which}{among if taking else ''}"
        )
        for one, own in of_named.items():
            if own is not slot and own is not None and own.holds is not None:
                notes.append(
                    f"{one} has a value of its own in line {own.holds.lineno}, which stays"
                )
    lines = [str(one.lineno) for one in held.overridden if one not in slot.all and one.lineno]
    if lines:
        notes.append(f"line {', '.join(lines[:_LISTED])} sets it for it, too, and does not count")
    return notes


def _slot_of(store: ParamsStore, node: str, name: str) -> Slot | None:
    held = store.of_node(node).get(name)
    return None if held is None else held.slot
