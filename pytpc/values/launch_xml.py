"""Reads the tags, attributes and texts of a launch file with their exact places.

Bytes go in and byte offsets come out, whatever the file's encoding. expat says where a tag begins;
what is inside its angle brackets is read here, because no XML parser keeps where an attribute's
value stands.
"""

from __future__ import annotations

import codecs
import re
from dataclasses import dataclass, field
from xml.parsers import expat

_DECLARED = re.compile(rb"""<\?xml[^>]*?encoding\s*=\s*["']([A-Za-z0-9._-]+)["']""")
_ATTRIBUTE = re.compile(r"""\s+[^\s=/>]+\s*=\s*("[^"]*"|'[^']*')""")
_TAG_HEAD = re.compile(r"<[^\s/>]+")


@dataclass(frozen=True, slots=True)
class Attribute:
    """An attribute: its value as XML means it, and the offsets of what is between the quotes."""

    name: str
    value: str
    start: int
    end: int
    quote: str


@dataclass(slots=True)
class Tag:
    """An element of a launch file.

    ``offset`` is the byte of its ``<``, ``head_end`` the one behind the start tag's ``>``,
    ``closed`` says that it is ``<tag/>``, ``end`` is the byte of ``</tag>`` (``head_end`` if
    closed). Lines are counted from 1.
    """

    name: str
    offset: int
    lineno: int
    head_end: int = 0
    closed: bool = False
    end: int = 0
    attributes: dict[str, Attribute] = field(default_factory=dict)
    children: list[Tag] = field(default_factory=list)
    parent: Tag | None = None


def encoding_of(data: bytes) -> str:
    """The encoding of an XML file: its byte order mark, its declaration, else UTF-8.

    Raises:
        ValueError: one that Python does not know.
    """
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        raise ValueError("UTF-16 is not handled; save the file as UTF-8")
    declared = _DECLARED.match(data.removeprefix(codecs.BOM_UTF8))
    name = "utf-8" if declared is None else declared[1].decode("ascii")
    try:
        return codecs.lookup(name).name
    except LookupError:
        raise ValueError(f"unknown encoding {name}") from None


def read_tags(data: bytes) -> list[Tag]:
    """All elements of an XML file, in the order in which they begin.

    Raises:
        ValueError: it is not XML; the message has the line.
    """
    tags: list[Tag] = []
    values: list[dict[str, str]] = []
    stack: list[Tag] = []
    parser = expat.ParserCreate()

    def begin(name: str, attributes: dict[str, str]) -> None:
        tag = Tag(name, parser.CurrentByteIndex, parser.CurrentLineNumber)
        values.append(attributes)
        if stack:
            tag.parent = stack[-1]
            stack[-1].children.append(tag)
        tags.append(tag)
        stack.append(tag)

    def end(_name: str) -> None:
        stack.pop().end = parser.CurrentByteIndex

    parser.StartElementHandler = begin
    parser.EndElementHandler = end
    # In the parser, an encoding that Python does not know would be a LookupError.
    encoding_of(data)
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        what = expat.ErrorString(error.code)
        raise ValueError(f"not XML in line {error.lineno}: {what}") from error
    bounds = [tag.offset for tag in tags[1:]]
    for tag, bound, given in zip(tags, [*bounds, len(data)], values, strict=True):
        _read_head(tag, data[tag.offset : bound], given)
    return tags


def _read_head(tag: Tag, data: bytes, values: dict[str, str]) -> None:
    """Find where the attributes of a start tag stand, whose values expat has read."""
    # All encodings here have one byte for each character of the markup.
    text = data.decode("latin-1")
    head = _TAG_HEAD.match(text)
    if head is None:
        raise ValueError(f"line {tag.lineno}: <{tag.name}> comes out of an entity")
    at = head.end()
    for name, value in values.items():
        found = _ATTRIBUTE.match(text, at)
        if found is None:
            break  # the others have defaults in the DTD
        start, end = (tag.offset + place for place in found.span(1))
        tag.attributes[name] = Attribute(name, value, start + 1, end - 1, found[1][0])
        at = found.end()
    close = text.index(">", at)
    tag.closed = text[at:close].strip() == "/"
    tag.head_end = tag.offset + close + 1
    if tag.closed:
        tag.end = tag.head_end


def written(value: str, quote: str) -> str:
    """A value as written in an attribute between these quotes."""
    text = value.replace("&", "&amp;").replace("<", "&lt;")
    return text.replace(quote, "&quot;" if quote == '"' else "&apos;")


def inner_text(tag: Tag, data: bytes) -> tuple[int, int] | None:
    """Start and end of a tag's text, without the marks of a CDATA section.

    None where it is not one piece of text without entities, so that offsets in it are exact.
    """
    if tag.closed or tag.children:
        return None
    start, end = tag.head_end, tag.end
    piece = data[start:end]
    sections = piece.count(b"<![CDATA[")
    if sections == 1:
        before, _, rest = piece.partition(b"<![CDATA[")
        inside, _, after = rest.partition(b"]]>")
        if before.strip() or after.strip():
            return None
        start += len(before) + len(b"<![CDATA[")
        return start, start + len(inside)
    if sections or b"&" in piece or b"<!--" in piece or b"<?" in piece:
        return None
    return start, end
