"""Single values as YAML 1.1 and roslaunch write and read them.

PyYAML reads them, as it does for rosparam: ``1e5`` is a text (a number needs a dot and a sign:
``1.0e+5``), ``on`` is a bool, ``0x1F`` and ``012`` are whole numbers. rosparam adds the angles
``deg()`` and ``rad()``.
"""

from __future__ import annotations

import math
import re
from typing import Literal

import yaml

ValueType = Literal["bool", "int", "double", "string", "list", "map", "null", "binary"]

_ANGLE = re.compile(r"(?:deg|rad)\([^)]*\)")
_TAG = "tag:yaml.org,2002:"
# Other types, as dates, are texts here: the parameter server has none of them.
_TYPES = ("null", "bool", "int", "float")
_LONGEST_NUMBER = 1000
_RULES = yaml.SafeLoader("")


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


def same_value(one: object, other: object) -> bool:
    """Whether two values are equal and of one type; NaN is NaN."""
    if isinstance(one, float) and isinstance(other, float) and math.isnan(one):
        return math.isnan(other)
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(same_value, one, other))
    return type(one) is type(other) and one == other


def plain_value(text: str, tag: str | None = None, *, quoted: bool = False) -> object:
    """The value of a scalar of YAML as rosparam reads it.

    Args:
        text: without quotes.
        tag: one that is written before it, as PyYAML gives it.
        quoted: a text in quotes is a text.

    Raises:
        ValueError: a tag that rosparam does not know, or a text that does not fit it.
    """
    if tag == "!" or (tag is None and quoted):
        return text
    if tag is not None:
        return _tagged(text, tag)
    if _ANGLE.fullmatch(text):
        return _angle(text)
    found = _RULES.resolve(yaml.ScalarNode, text, (True, False))
    return _tagged(text, found) if found.removeprefix(_TAG) in _TYPES else text


def _tagged(text: str, tag: str) -> object:
    kind = tag.removeprefix(_TAG).removeprefix("!")
    if kind == "str":
        return text
    if kind in ("degrees", "radians"):
        return _angle(text if _ANGLE.fullmatch(text.strip()) else f"{kind[:3]}({text})")
    if kind not in _TYPES:
        raise ValueError(f"the tag {tag} is not supported")
    if kind in ("int", "float") and len(text) > _LONGEST_NUMBER:
        raise ValueError(f"a number of {len(text):,} characters")
    try:
        return _RULES.yaml_constructors[_TAG + kind](_RULES, yaml.ScalarNode(_TAG + kind, text))
    except LookupError as error:
        raise ValueError(f"{text!r} is no {kind}") from error


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
