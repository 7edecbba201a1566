"""Single values as YAML 1.1 and roslaunch write and read them.

The rules are PyYAML's, which rosparam uses: ``1e5`` is a text there (a number needs a dot and a
sign: ``1.0e+5``), ``on`` a bool, ``0x1F`` and ``012`` whole numbers.
"""

from __future__ import annotations

import math
import re
from typing import Literal

ValueType = Literal["bool", "int", "double", "string", "list", "map", "null", "binary"]

_BOOLS = {
    **dict.fromkeys(("yes", "true", "on"), True),
    **dict.fromkeys(("no", "false", "off"), False),
}
_BOOL = re.compile(
    r"yes|Yes|YES|no|No|NO|true|True|TRUE|false|False|FALSE|on|On|ON|off|Off|OFF", re.ASCII
)
_INT = re.compile(
    r"[-+]?0b[0-1_]+|[-+]?0[0-7_]+|[-+]?(?:0|[1-9][0-9_]*)|[-+]?0x[0-9a-fA-F_]+"
    r"|[-+]?[1-9][0-9_]*(?::[0-5]?[0-9])+",
    re.ASCII,
)
_FLOAT = re.compile(
    r"[-+]?(?:[0-9][0-9_]*)\.[0-9_]*(?:[eE][-+][0-9]+)?|\.[0-9][0-9_]*(?:[eE][-+][0-9]+)?"
    r"|[-+]?[0-9][0-9_]*(?::[0-5]?[0-9])+\.[0-9_]*|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)",
    re.ASCII,
)
_NULL = re.compile(r"~|null|Null|NULL|")
_ANGLE = re.compile(r"(?:deg|rad)\([^)]*\)")
_SEXAGESIMAL = 60
_TAG = "tag:yaml.org,2002:"


def type_of(value: object) -> ValueType:
    """The name that rosparam has for the type of a value.

    >>> type_of(True), type_of(2), type_of(0.5)
    ('bool', 'int', 'double')
    """
    if value is None:
        return "null"
    for kind, name in ((bool, "bool"), (int, "int"), (float, "double"), (str, "string")):
        if isinstance(value, kind):
            return name  # type: ignore[return-value]
    if isinstance(value, list | tuple):
        return "list"
    return "map" if isinstance(value, dict) else "binary"


def plain_value(text: str, tag: str | None = None, *, quoted: bool = False) -> object:
    """The value of a scalar of YAML as rosparam reads it.

    Args:
        text: without quotes.
        tag: one that is written before it.
        quoted: a text in quotes is a text.

    Raises:
        ValueError: a tag that rosparam does not know, or a text that does not fit it.
    """
    if tag is not None and tag != "!":
        return _tagged(text, tag)
    if quoted or tag == "!":
        return text
    for kind in ("null", "bool", "int", "float", "angle"):
        if _PATTERNS[kind].fullmatch(text):
            return _READERS[kind](text)
    return text


def _tagged(text: str, tag: str) -> object:
    name = tag.removeprefix("!!").removeprefix(_TAG).removeprefix("!")
    if name == "str":
        return text
    reader = _READERS.get({"degrees": "angle", "radians": "angle"}.get(name, name))
    if reader is None:
        raise ValueError(f"the tag {tag} is not supported")
    if name in ("degrees", "radians") and not _ANGLE.fullmatch(text.strip()):
        return reader(f"{name[:3]}({text})")
    return reader(text)


def _int(text: str) -> int:
    digits = text.replace("_", "")
    sign = -1 if digits.startswith("-") else 1
    digits = digits.lstrip("+-")
    if digits.startswith("0b"):
        return sign * int(digits[2:], 2)
    if digits.startswith("0x"):
        return sign * int(digits[2:], 16)
    if ":" in digits:
        return sign * round(_base_60(digits))
    return sign * int(digits, 8 if digits.startswith("0") and digits != "0" else 10)


def _float(text: str) -> float:
    digits = text.replace("_", "").lower()
    sign = -1.0 if digits.startswith("-") else 1.0
    digits = digits.lstrip("+-")
    if digits == ".inf":
        return sign * math.inf
    if digits == ".nan":
        return math.nan
    return sign * (_base_60(digits) if ":" in digits else float(digits))


def _base_60(digits: str) -> float:
    total = 0.0
    for part in digits.split(":"):
        total = total * _SEXAGESIMAL + float(part)
    return total


def _bool(text: str) -> bool:
    return _BOOLS[text.lower()]


def _angle(text: str) -> float:
    """``deg(90)`` and ``rad(pi/2)`` in rad.

    rosparam evaluates what is in ``rad()`` as Python. Here only products, quotients, sums and
    differences of numbers and ``pi`` are read, and a file cannot run anything.
    """
    inner = text.strip()[4:-1]
    if text.strip().startswith("deg("):
        return float(inner) * math.pi / 180.0
    return _sum_of(inner)


def _sum_of(text: str) -> float:
    total = 0.0
    terms = re.findall(r"([-+]?)\s*((?:[^-+eE]|[eE][-+]?)+)", text)
    if not terms or "".join("".join(term) for term in terms).replace(" ", "") != text.replace(
        " ", ""
    ):
        raise ValueError(f"rad({text}) is not supported")
    for sign, term in terms:
        value = 1.0
        factors = re.split(r"\s*([*/])\s*", term.strip())
        for index in range(0, len(factors), 2):
            factor = math.pi if factors[index] in ("pi", "math.pi") else float(factors[index])
            divides = index and factors[index - 1] == "/"
            value = value / factor if divides else value * factor
        total += -value if sign == "-" else value
    return total


def _null(_text: str) -> None:
    return None


_PATTERNS = {"null": _NULL, "bool": _BOOL, "int": _INT, "float": _FLOAT, "angle": _ANGLE}
_READERS = {"null": _null, "bool": _bool, "int": _int, "float": _float, "angle": _angle}


def number_text(value: float) -> str:
    """A float in the shortest form that PyYAML, roslaunch and Python read as this float.

    >>> number_text(1e-7), number_text(100.0), number_text(float("inf"))
    ('1.0e-07', '100.0', '.inf')
    """
    if math.isnan(value):
        return ".nan"
    if math.isinf(value):
        return ".inf" if value > 0 else "-.inf"
    text = repr(value)
    mantissa, exponent, power = text.partition("e")
    if exponent and "." not in mantissa:
        mantissa += ".0"
    return mantissa + exponent + power
