"""Changes one value in a launch file; all other bytes stay."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from pytpc.values.launch_xml import Attribute, Tag, encoding_of, inner_text, read_tags, written
from pytpc.values.new_value import Refused, launch_text, launch_value, read_value
from pytpc.values.scalars import type_of
from pytpc.values.yaml_edit import Edit, all_settings, edit_yaml

_LISTED = 5
_GIVE = "the file was changed since, or has several; give the launch file instead of the mission"


def tags_of(data: bytes) -> list[Tag]:
    """The tags of a launch file.

    Raises:
        Refused: it is not XML, or in an encoding that is not handled.
    """
    try:
        return read_tags(data)
    except ValueError as error:
        raise Refused(str(error)) from error


class NewText(NamedTuple):
    """A new value as typed, and the ``type`` of the parameter's tag.

    ``force`` changes the type, replaces what roslaunch computes, and changes other uses with it.
    """

    text: str
    kind: str = "auto"
    force: bool = False


def edit_param(data: bytes, name: str, lineno: int, given: str, *, force: bool = False) -> Edit:
    """Put a value into a ``<param value=...>``.

    Args:
        data: the launch file.
        name: the parameter's full name.
        lineno: the line of the tag; 0 where it is not known.
        given: the new value as typed.
        force: change the type, or replace what roslaunch computes.

    Raises:
        Refused: see docs/how-to/change-a-parameter.md.
    """
    tags = tags_of(data)
    found = [tag for tag in tags if tag.name == "param" and _names(tag, name)]
    tag = _only(found, lineno, f"the <param> for {name}")
    value = tag.attributes.get("value")
    if value is None:
        raise Refused("its value is the text of a file, or the output of a command", tag.lineno)
    kind = _attribute(tag, "type", "auto").lower().strip()
    return _edit_attribute(data, tag, value, NewText(given, kind, force))


def edit_argument(
    data: bytes,
    name: str,
    lineno: int,
    given: NewText,
    via: Sequence[int] = (),
) -> Edit:
    """Put a value into the ``<arg>`` whose value a parameter has.

    Args:
        data: the launch file.
        name: of the argument.
        lineno: of its tag.
        given: the new value; ``force`` changes other uses with it.
        via: lines in this file through which the parameter gets it.

    Raises:
        Refused: see docs/how-to/change-a-parameter.md.
    """
    tags = tags_of(data)
    found = [tag for tag in tags if tag.name == "arg" and _attribute(tag, "name") == name]
    tag = _only(found, lineno, f"the <arg> {name}")
    value = tag.attributes.get("value") or tag.attributes.get("default")
    if value is None:
        raise Refused(f"<arg> {name} has no value here", tag.lineno)
    others = sorted({t.lineno for t in tags if _uses(t, data, name)} - set(via))
    notes = []
    if others:
        lines = ", ".join(map(str, others[:_LISTED]))
        if not given.force:
            raise Refused(f"<arg> {name} is used in line {lines}, too; --force changes all")
        notes = [f"line {lines} uses <arg> {name}, too, and changes with it"]
    edit = _edit_attribute(data, tag, value, given)
    return replace(edit, notes=(*edit.notes, *notes))


def _only(found: list[Tag], lineno: int, what: str) -> Tag:
    """The tag in this line, else the only one."""
    here = [tag for tag in found if tag.lineno == lineno] or found
    if len(here) != 1:
        raise Refused(f"{what} is gone; {_GIVE}", lineno or None)
    return here[0]


def edit_inline(
    data: bytes, keys: tuple[str, ...], lineno: int, given: str, *, force: bool = False
) -> Edit:
    """Put a value into the YAML inside a ``<rosparam>``.

    ``lineno`` is that of the value, or 0: the only one that sets it is meant.

    Raises:
        Refused: see docs/how-to/change-a-parameter.md.
    """
    encoding = encoding_of(data)
    spans = [
        span
        for tag in tags_of(data)
        if tag.name == "rosparam"
        and (span := inner_text(tag, data)) is not None
        and (
            tag.lineno <= lineno <= _line_at(data, span[1])
            if lineno
            else _sets(data[span[0] : span[1]].decode(encoding, "replace"), keys)
        )
    ]
    if spans and (lineno or len(spans) == 1):
        start, end = spans[0]
        first = data[:start].count(b"\n")
        edit = edit_yaml(data[start:end].decode(encoding), keys, given, force=force)
        in_section = data[:start].endswith(b"<![CDATA[")
        if b"]]>" in edit.data if in_section else b"<" in edit.data or b"&" in edit.data:
            raise Refused("the value has characters that are special in XML", lineno)
        result = data[:start] + _encoded(edit.data.decode(), encoding) + data[end:]
        return replace(edit, data=result, lineno=first + edit.lineno)
    raise Refused(f"the <rosparam> with it is gone; {_GIVE}", lineno or None)


def _sets(text: str, keys: tuple[str, ...]) -> bool:
    try:
        return any(keys in document for document in all_settings(text))
    except Refused:
        return False


def add_param(data: bytes, offset: int | None, name: str, value: object, given: str) -> Edit:
    """Add a ``<param>`` to the tag of a node, or before the end of the launch file.

    Args:
        data: the launch file.
        offset: of the node's tag; None: at the end of the file, with a full name.
        name: below the node, or full.
        value: bool, int, float or text.
        given: what was typed.

    Raises:
        Refused: the node's tag is no longer there.
    """
    tags = tags_of(data)
    wanted = "launch" if offset is None else "node"
    found = [t for t in tags if t.name == wanted and (offset is None or t.offset == offset)]
    if not found:
        raise Refused("the tag of the node is no longer there; give the launch file")
    tag = found[0]
    kind = {"bool": "bool", "int": "int", "double": "double"}.get(type_of(value), "str")
    text = launch_text(value, given, kind, "")
    newline = "\r\n" if b"\r\n" in data else "\n"
    indent = _indent(data, tag.offset)
    step = _indent(data, tag.children[0].offset) if tag.children else indent + "  "
    shown = written(name, '"')
    line = f'<param name="{shown}" value="{written(text, chr(34))}" type="{kind}"/>'
    if tag.closed:
        slash = data.rindex(b"/", tag.offset, tag.head_end)
        head = data[:slash].rstrip() + b">"
        tail, more = data[tag.head_end :], f"{newline}{indent}</{tag.name}>"
    else:
        # The closing tag is on a line of its own, or follows something.
        head, tail = data[: tag.end].rstrip(), data[tag.end :]
        more = newline + indent
    added = _encoded(f"{newline}{step}{line}{more}", encoding_of(data))
    result = head + added + tail
    tags_of(result)
    return Edit(result, None, value, _line_at(result, len(head)) + 1)


def _edit_attribute(data: bytes, tag: Tag, attribute: Attribute, given: NewText) -> Edit:
    text, kind, force = given
    old_text = attribute.value
    notes = []
    if "$(" in old_text:
        if not force:
            raise Refused(
                f"roslaunch computes its value: {old_text}; --force replaces it", tag.lineno
            )
        notes.append(f"{old_text} is replaced by a value")
        old: object = old_text
        try:
            new = launch_value(text, kind)
        except ValueError as error:
            raise Refused(f"{text!r} does not fit the parameter's type: {error}") from error
    else:
        try:
            old = launch_value(old_text, kind)
        except ValueError as error:
            raise Refused(str(error), tag.lineno) from error
        new = read_value(text, type_of(old), force=force)
    put = launch_text(new, text, kind, old_text)
    piece = _encoded(written(put, attribute.quote), encoding_of(data))
    result = data[: attribute.start] + piece + data[attribute.end :]
    _check(data, result, (tag.offset, attribute.name), put)
    return Edit(result, old, new, _line_at(data, attribute.start), tuple(notes))


def _check(data: bytes, result: bytes, place: tuple[int, str], text: str) -> None:
    """Check that the new file differs in this attribute only."""
    before, after = tags_of(data), tags_of(result)
    wanted = [
        {
            name: text if (tag.offset, name) == place else attribute.value
            for name, attribute in tag.attributes.items()
        }
        for tag in before
    ]
    found = [{name: one.value for name, one in tag.attributes.items()} for tag in after]
    if found != wanted or [tag.name for tag in before] != [tag.name for tag in after]:
        raise Refused("it cannot be written without changing other values")


def _names(tag: Tag, name: str) -> bool:
    """Whether a tag may set a parameter of this full name."""
    raw = _attribute(tag, "name").strip()
    if name == raw:
        return True
    parts, above = [raw.lstrip("~/")], tag.parent
    if raw.startswith("/") and "$(" not in raw:
        return False
    if above is not None and above.name in ("node", "test"):
        parts.insert(0, _attribute(above, "name").strip())
    elif raw.startswith("~"):
        # It is for the nodes that come after it, wherever they are.
        above = None
    while above is not None:
        parts.insert(0, _attribute(above, "ns").strip() if above.name != "launch" else "")
        above = None if parts[0].startswith("/") else above.parent
    full = "/".join(part.strip("/") for part in parts if part.strip("/"))
    pattern = ".*".join(re.escape(part) for part in re.split(r"\$\([^)]*\)", full))
    return re.search(f"/{pattern}$", name) is not None


def _uses(tag: Tag, data: bytes, name: str) -> bool:
    """Whether an attribute, or the text of a ``<rosparam>``, has an argument in it.

    An include that passes all arguments has every one.
    """
    if _attribute(tag, "pass_all_args").strip().lower() in ("true", "1"):
        return True
    texts = [attribute.value for attribute in tag.attributes.values()]
    if tag.name == "rosparam" and not tag.closed:
        texts.append(data[tag.head_end : tag.end].decode("utf-8", "replace"))
    word = re.compile(rf"\$\(arg\s+{re.escape(name)}\s*\)|\$\(eval\b.*?\b{re.escape(name)}\b")
    return any(word.search(text) for text in texts)


def _attribute(tag: Tag, name: str, default: str = "") -> str:
    found = tag.attributes.get(name)
    return default if found is None else found.value


def _indent(data: bytes, offset: int) -> str:
    """The white space before a tag that begins its line."""
    before = data[:offset].rpartition(b"\n")[2]
    return before.decode("latin-1") if not before.strip() else ""


def _line_at(data: bytes, offset: int) -> int:
    return data[:offset].count(b"\n") + 1


def _encoded(text: str, encoding: str) -> bytes:
    try:
        return text.encode(encoding)
    except UnicodeEncodeError as error:
        raise Refused(f"the file is in {encoding}, which has no {text[error.start]!r}") from error
