"""Types of messages: their classes, and their definitions as text."""

import importlib
import re
from typing import Any

PRIMITIVES = {
    "boolean": "bool",
    "octet": "byte",
    "float": "float32",
    "double": "float64",
    "wstring": "wstring",
}


def definition_of(kind: Any) -> Any:
    """The text of a message's type with those below it, as MCAP files have it."""
    texts: Any = []
    wanted, known = [kind], set()
    while wanted:
        one = wanted.pop(0)
        if one in known:
            continue
        known.add(one)
        lines = []
        for name, of in class_of(one).get_fields_and_field_types().items():
            text, below = field_of(of)
            lines.append("%s %s" % (text, name))
            if below:
                wanted.append(below)
        body = "\n".join(lines) + "\n"
        package, _, name = one.rpartition("/")
        short = package.partition("/")[0] + "/" + name
        texts.append(body if one == kind else "%s\nMSG: %s\n%s" % ("=" * 80, short, body))
    return "".join(texts)


def field_of(of: Any) -> Any:
    """A field's type as .msg files write it, and the type of message in it, empty if none."""
    sequence = re.match(r"sequence<(.*?)(?:, (\d+))?>$", of)
    fixed = re.match(r"(.*)\[(\d+)\]$", of)
    if sequence:
        text, below = field_of(sequence.group(1))
        return text + ("[<=%s]" % sequence.group(2) if sequence.group(2) else "[]"), below
    if fixed:
        text, below = field_of(fixed.group(1))
        return "%s[%s]" % (text, fixed.group(2)), below
    bounded = re.match(r"(w?string)<(\d+)>$", of)
    if bounded:
        return "%s<=%s" % bounded.groups(), ""
    if "/" in of:
        package, _, name = of.rpartition("/")
        return of, package.partition("/")[0] + "/msg/" + name
    return PRIMITIVES.get(of, of), ""


def class_of(kind: Any) -> Any:
    """The Python class of a type of message."""
    package, _, name = kind.rpartition("/")
    return getattr(importlib.import_module(package.replace("/", ".")), name)
