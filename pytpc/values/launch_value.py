"""The value of a ``<param>`` as roslaunch reads it, by its ``type`` or by how it looks."""

from __future__ import annotations

from pytpc.values.new_value import Refused, bool_text, yaml_text
from pytpc.values.scalars import number_text, plain_value, same_value

_BOOLS = {"true": True, "1": True, "false": False, "0": False}


def launch_value(text: str, kind: str) -> object:
    """What roslaunch makes of the text of a ``<param value=...>``.

    Args:
        text: after substitution.
        kind: the attribute ``type``; ``auto`` where there is none.

    Raises:
        ValueError: it does not fit the type.
    """
    text = text.strip()
    if kind == "auto":
        return _looks_like(text)
    if kind in ("str", "string"):
        return text
    if kind == "int":
        return int(text)
    if kind == "double":
        return float(text)
    if kind in ("bool", "boolean"):
        if text.lower() not in _BOOLS:
            raise ValueError(f"{text} is not a bool")
        return _BOOLS[text.lower()]
    if kind == "yaml":
        return plain_value(text)
    raise ValueError(f"unknown type {kind}")


def _looks_like(text: str) -> object:
    try:
        if "." in text:
            return float(text)
        if "_" not in text:
            return int(text)
    except ValueError:
        pass
    return _BOOLS[text.lower()] if text.lower() in ("true", "false") else text


def launch_text(value: object, given: str, kind: str, old: str) -> str:
    """A value as written in a ``<param>`` of this type, so that roslaunch reads it.

    Args:
        value: bool, int, float or text.
        given: what was typed; it is kept where it reads as ``value``.
        kind: the attribute ``type``; ``auto`` where there is none.
        old: what stands there; of a bool its words are kept.

    Raises:
        Refused: no text of this type reads as the value.
    """
    texts = [given.strip()]
    if isinstance(value, bool):
        texts = ["1" if value else "0"] if old.strip() in ("0", "1") else []
        texts += [bool_text(value, old), "true" if value else "false"]
    elif isinstance(value, float):
        texts += [number_text(value), repr(value)]
    elif isinstance(value, int):
        texts.append(str(value))
    if kind == "yaml":
        texts = [yaml_text(value, given, old)]
    for text in texts:
        try:
            read = launch_value(text, kind)
        except ValueError:
            continue
        if same_value(read, value):
            return text
    if kind == "auto":
        raise Refused(f"roslaunch would read {given!r} as another type; give the tag a type")
    raise Refused(f'{given!r} does not fit type="{kind}"')
