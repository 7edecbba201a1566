"""Single values as rcl reads them from a params file of ROS 2, and as they are written there.

rcl has rules of its own (rcl_yaml_param_parser), which are neither those of YAML 1.1 nor those of
PyYAML: ``1e3`` and ``nan`` are doubles, ``010`` is 8, ``y`` is true, and ``~`` is a text.
"""

from __future__ import annotations

import math
import re
import sys

import yaml

from pytpc.values.new_value import Refused, bool_text, read_value, yaml_text
from pytpc.values.scalars import number_text, plain_value, same_value, type_of

_TRUE = frozenset(("Y", "y", "yes", "Yes", "YES", "true", "True", "TRUE", "on", "On", "ON"))
_FALSE = frozenset(("N", "n", "no", "No", "NO", "false", "False", "FALSE", "off", "Off", "OFF"))
_STRING_TAG = "tag:yaml.org,2002:str"
_SPACE = r"[ \t\n\v\f\r]*"
_INT = re.compile(rf"{_SPACE}([-+]?)(0[xX][0-9a-fA-F]+|0[0-7]*|[1-9][0-9]*)", re.ASCII)
_FLOAT = re.compile(rf"{_SPACE}[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?", re.ASCII)
_HEX_FLOAT = re.compile(
    rf"{_SPACE}[-+]?0[xX]([0-9a-fA-F]+\.?[0-9a-fA-F]*|\.[0-9a-fA-F]+)([pP][-+]?\d+)?", re.ASCII
)
_WORD = re.compile(rf"{_SPACE}([-+]?)(inf|infinity|nan|nan\(\w*\))", re.ASCII | re.IGNORECASE)
_DOTTED = re.compile(r"\.(?:nan|NaN|NAN)|[-+]?\.(?:inf|Inf|INF)")
_LEAST, _MOST = -(1 << 63), (1 << 63) - 1
_LONGEST_NUMBER = 1000


def rcl_value(
    text: str, tag: str | None = None, *, quoted: bool = False
) -> bool | int | float | str:
    """The value of a scalar of YAML as rcl reads it.

    Args:
        text: without quotes.
        tag: one that is written before it; rcl knows ``!!str`` alone and ignores all others.
        quoted: a text in single or double quotes is a text.

    >>> rcl_value("1e3"), rcl_value("010"), rcl_value("on"), rcl_value("~")
    (1000.0, 8, True, '~')
    """
    if quoted or tag == _STRING_TAG:
        return text
    if text in _TRUE or text in _FALSE:
        return text in _TRUE
    if len(text) > _LONGEST_NUMBER:
        return text
    whole = _INT.fullmatch(text)
    if whole is not None:
        digits = whole[2]
        base = 16 if digits[1:2] in ("x", "X") else 8 if digits[0] == "0" else 10
        number = int(digits, base) * (-1 if whole[1] == "-" else 1)
        if _LEAST <= number <= _MOST:
            return number
    found = _double(text)
    return text if found is None else found


def _double(text: str) -> float | None:
    """What C's strtod makes of all of the text; None where it stops before its end."""
    if _DOTTED.fullmatch(text):
        word = text.replace(".", "")
        return float(word)
    if word_match := _WORD.fullmatch(text):
        return float(f"{word_match[1]}{word_match[2].partition('(')[0]}")
    if _FLOAT.fullmatch(text):
        value = float(text)
    elif _HEX_FLOAT.fullmatch(text):
        try:
            value = float.fromhex(text.strip())
        except OverflowError:
            return None
    else:
        return None
    # rcl takes for a text what strtod reports as too large or too small.
    if math.isinf(value):
        return None
    tiny = abs(value) < sys.float_info.min
    mantissa = re.split("[pP]" if "x" in text.lower() else "[eE]", text)[0]
    is_zero = not re.search("[1-9a-fA-F]", mantissa.lower().replace("0x", ""))
    return None if tiny and not is_zero else value


def rcl_text(value: object, given: str, old: str = "", style: str = "") -> str:
    """A scalar that rcl and PyYAML read as this value: launch reads some params files itself.

    Args:
        value: bool, int, float, text.
        given: what was typed; it is kept where both read it as ``value``.
        old: the text that stood there; a bool keeps its kind of words.
        style: quotes that stood there; a text keeps them.

    Raises:
        Refused: a value that cannot be written as one scalar.
    """
    if isinstance(value, bool):
        if old in ("y", "n", "Y", "N"):
            word = "y" if value else "n"
            return word.upper() if old.isupper() else word
        return bool_text(value, old)
    if isinstance(value, str):
        plain = yaml_text(value, given, style=style)
        if style not in ('"', "'") and plain == value and not isinstance(rcl_value(value), str):
            return yaml_text(value, given, style="'")
        return plain
    if not isinstance(value, int | float):
        raise Refused(f"{type_of(value)} values cannot be written here")
    texts = [given.strip(), number_text(value) if isinstance(value, float) else str(value)]
    for text in texts:
        if same_value(rcl_value(text), value) and same_value(_by_pyyaml(text), value):
            return text
    if isinstance(value, int):
        raise Refused(f"{given!r} is more than 64 bits")
    return texts[-1]


def _by_pyyaml(text: str) -> object:
    try:
        return plain_value(text)
    except (ValueError, yaml.YAMLError):
        return None


def typed_value(given: str, old: object, *, force: bool = False) -> bool | int | float | str:
    """``given`` as a value of the type of ``old``; with ``force`` of the type that it looks like.

    Raises:
        Refused: it does not fit: the node refuses a value of another type than it has declared.
    """
    looks = rcl_value(given.strip())
    if force and isinstance(looks, float) and type(old) is int:
        return looks
    try:
        value = read_value(given, type_of(old))
    except Refused as error:
        if force:
            return looks
        raise Refused(f"{error}, which a node of ROS 2 that declares it refuses") from error
    if not isinstance(value, bool | int | float | str):
        raise Refused(f"{type_of(value)} values cannot be written here")
    if isinstance(value, int) and not _LEAST <= value <= _MOST:
        raise Refused(f"{given} is more than 64 bits")
    return value
