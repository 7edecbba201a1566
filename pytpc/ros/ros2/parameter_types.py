"""The types of ROS 2's parameters (rcl_interfaces/ParameterType)."""

from __future__ import annotations

_SCALARS: tuple[tuple[type, int], ...] = ((bool, 1), (int, 2), (float, 3), (str, 4))
_OF_LISTS = 5
NAMES = {
    1: "bool",
    2: "integer",
    3: "double",
    4: "string",
    5: "byte array",
    6: "bool array",
    7: "integer array",
    8: "double array",
    9: "string array",
}


def type_number(value: object) -> int:
    """The number of a value's type; 0 for none. An empty list is one of texts.

    >>> type_number(2.0), type_number([1, 2])
    (3, 7)
    """
    if isinstance(value, list):
        return type_number(value[0]) + _OF_LISTS if value else 9
    return next((number for kind, number in _SCALARS if isinstance(value, kind)), 0)
