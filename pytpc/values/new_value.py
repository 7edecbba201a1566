"""Reads a new value, as typed by a user, as the parameter's type, and writes it as a file has it.

A file is YAML as rosparam reads it, or a ``<param>`` as roslaunch reads it.
"""

from __future__ import annotations

import math
import re

from pytpc.values.scalars import ValueType, number_text, plain_value, same_value, type_of

_WORDS = (("true", "false"), ("on", "off"), ("yes", "no"))
_TRUE, _FALSE = ("true", "on", "yes", "1"), ("false", "off", "no", "0")
_LAUNCH_BOOLS = {"true": True, "1": True, "false": False, "0": False}
_SAFE_PLAIN = re.compile(r"[A-Za-z_/][\w./-]*(?: [\w./-]+)*", re.ASCII)
_NAMES: dict[ValueType, str] = {
    "bool": "true or false",
    "int": "a whole number",
    "double": "a number",
    "string": "a text",
    "list": "a list",
    "map": "a map",
    "null": "nothing",
    "binary": "binary data",
}


class Refused(ValueError):
    """A change that is refused; ``lineno`` is the line in question, counted from 1."""

    def __init__(self, message: str, lineno: int | None = None) -> None:
        super().__init__(message)
        self.lineno = lineno


def read_value(given: str, kind: ValueType, *, force: bool = False) -> object:
    """``given`` as a value of a type.

    Args:
        given: as typed.
        kind: the type that the parameter has; it is kept.
        force: where ``given`` does not fit the type, it gets the type that it looks like.

    Raises:
        Refused: it does not fit.
    """
    try:
        return _read(given.strip(), kind) if kind != "string" else given
    except ValueError:
        if force:
            return guessed(given)
        what = _NAMES[kind]
        raise Refused(
            f"the parameter is {what} and {given!r} is not; --force changes its type"
        ) from None


def _read(given: str, kind: ValueType) -> object:
    if kind == "bool":
        if given.lower() in (*_TRUE, *_FALSE):
            return given.lower() in _TRUE
    elif kind == "int":
        number = _number(given)
        if isinstance(number, int) or number.is_integer():
            return int(number)
    elif kind == "double":
        return float(_number(given))
    raise ValueError(given)


def _number(given: str) -> int | float:
    value = plain_value(given)
    if isinstance(value, bool) or not isinstance(value, int | float):
        # What Python calls a number and YAML does not: 1e-3, inf.
        return float(given)
    return value


def guessed(given: str) -> object:
    """The value of a text of unknown type: 0.5, 3, true, else a text."""
    value = plain_value(given)
    if isinstance(value, str):
        try:
            return float(given)
        except ValueError:
            return value
    return value


def yaml_text(value: object, given: str, old: str = "", style: str = "") -> str:
    """A scalar as YAML that rosparam reads as this value.

    Args:
        value: bool, int, float, text.
        given: what was typed; it is kept where it reads as ``value``.
        old: the text that stood there; of words for bools its kind and case are kept.
        style: quotes that stood there; a text keeps them.

    Raises:
        Refused: a value that cannot be written as one scalar.
    """
    if isinstance(value, bool):
        return bool_text(value, old)
    if isinstance(value, str):
        return _quoted(value, style)
    if not isinstance(value, int | float):
        raise Refused(f"{type_of(value)} values cannot be written here")
    if same_value(plain_value(given.strip()), value):
        return given.strip()
    return number_text(value) if isinstance(value, float) else str(value)


def bool_text(value: bool, old: str) -> str:
    """A bool in the spelling of the one it replaces.

    >>> bool_text(False, "True"), bool_text(True, "OFF"), bool_text(True, "")
    ('False', 'ON', 'true')
    """
    for words in _WORDS:
        if old.lower() in words:
            word = words[0] if value else words[1]
            return word.upper() if old.isupper() else word.title() if old.istitle() else word
    return "true" if value else "false"


def _quoted(value: str, style: str) -> str:
    if style not in ('"', "'") and _SAFE_PLAIN.fullmatch(value):
        if isinstance(plain_value(value), str):
            return value
        style = style or "'"
    if style == '"' or not value.isprintable():
        escaped = value.replace("\\", "\\\\").replace('"', '\\"')
        return '"' + "".join(_escape(c) for c in escaped) + '"'
    return "'" + value.replace("'", "''") + "'"


def _escape(character: str) -> str:
    if character.isprintable():
        return character
    code = ord(character)
    if code < 0x100:
        return f"\\x{code:02x}"
    return f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def degrees_text(value: float) -> str | None:
    """The degrees that rosparam turns into exactly this angle in rad; None if there are none.

    rosparam multiplies by pi and divides by 180.
    """
    if not math.isfinite(value):
        return None
    guess = value * 180.0 / math.pi
    near = [guess, math.nextafter(guess, math.inf), math.nextafter(guess, -math.inf)]
    candidates = [*(round(guess, digits) for digits in range(16)), *near]
    for degrees in candidates:
        if degrees * math.pi / 180.0 == value:
            text = number_text(degrees)
            return text.removesuffix(".0")
    return None


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
        if text.lower() not in _LAUNCH_BOOLS:
            raise ValueError(f"{text} is not a bool")
        return _LAUNCH_BOOLS[text.lower()]
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
    return _LAUNCH_BOOLS[text.lower()] if text.lower() in ("true", "false") else text


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
