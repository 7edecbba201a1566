"""Values that do not fit what their nodes read: another type, or outside of the declared range."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pytpc.base.wording import Number, listed, plain, show, shown_value
from pytpc.lint.facts import Facts, NodeRead, Setting, own_part
from pytpc.lint.finding import Evidence, Finding, Severity, Spot
from pytpc.recording.declaration import Declared
from pytpc.values.scalars import type_of

_INTEGERS = frozenset(
    {"int", "long", "short", "unsigned int", "unsigned long", "unsigned short", "long long"}
    | {"unsigned long long", "unsigned char", "signed char"}
)
_FLOATS = frozenset({"float", "double", "long double"})
_STRINGS = frozenset({"std::string", "string", "str"})
_BOOLS = frozenset({"bool"})
_LISTED = 8
_HALF = 0.5


def wrong_type(facts: Facts) -> Iterator[Finding]:
    """Values that none of their reads takes, by the rules of roscpp, rospy and ROS 2."""
    for setting in facts.settings:
        reads = [read for _, read in facts.readers(setting.name)]
        # In ROS 2 the declaration decides, and other calls take what it took.
        reads = [read for read in reads if "declare_parameter" in read.api] or reads
        faults = [_fault(read, setting.value) for read in reads]
        if not faults or not all(faults):
            continue
        read, fault = reads[0], faults[0]
        text = f"{plain(setting.name)} is {_shown(setting.value)}, {fault}"
        severity: Severity = "error" if read.is_ros2 else "warning"
        places = (Evidence("read", read.spot),)
        yield Finding("type", severity, setting.spot, setting.name, text, places)


def _shown(value: object) -> str:
    """A value, with the point that makes a double of a whole number."""
    shown = shown_value(value)
    return f"{shown}.0" if isinstance(value, float) and shown.lstrip("-").isdigit() else shown


def _fault(read: NodeRead, value: object) -> str:
    """What happens where a call reads a value of a wrong type; empty where it takes it."""
    given, wanted = type_of(value), _wanted(read)
    is_taken = read.is_table or read.is_converted or not wanted
    if is_taken or given in (wanted, "null", "binary"):
        return ""
    is_compound = given in ("list", "map")
    called, needs = _a(given), _a(wanted)
    if read.is_ros2:
        return "" if is_compound else f"{called}, and the node refuses all but {needs}"
    if is_compound:
        return f"{called}, and the node reads {needs}"
    if isinstance(value, int | float) and {given, wanted} == {"int", "double"}:
        rounded = _rounded(value)
        is_other = wanted == "int" and value != rounded
        return f"a double, and the node rounds it to {rounded}" if is_other else ""
    if _is_python(read):
        # There, 0 and 1 are as good as false and true.
        is_flag = "string" not in (given, wanted) and value in (0, 1)
        return "" if is_flag else f"{called}, and the node expects {needs} as its default is"
    unset = "" if read.default is None else f" ({shown_value(read.default)})"
    return f"{called}: the node reads {needs}, so it takes its default{unset}"


def _a(kind: str) -> str:
    return f"an {kind}" if kind == "int" else f"a {kind}"


def _rounded(value: float) -> float:
    """What roscpp makes of a double for an int; infinity and NaN stay what they are.

    >>> _rounded(2.5), _rounded(2.4), _rounded(-2.5)
    (3, 2, -3)
    """
    if not math.isfinite(value):
        return value
    return math.floor(value) if math.fmod(value, 1.0) < _HALF else math.ceil(value)


def _wanted(read: NodeRead) -> str:
    """The type that a call takes: ``bool``, ``int``, ``double``, ``string``, or unknown."""
    if _is_python(read):
        # Python takes any type; a default of another one says what the code does with it.
        default = read.default
        if default is None or isinstance(default, list):
            return ""
        kind = type_of(default)
        return "double" if kind == "int" and not read.is_ros2 else kind
    for names, kind in (
        (_BOOLS, "bool"),
        (_INTEGERS, "int"),
        (_FLOATS, "double"),
        (_STRINGS, "string"),
    ):
        if read.type in names:
            return kind
    return ""


def _is_python(read: NodeRead) -> bool:
    return read.api.startswith(("rospy", "rclpy", "rosparam", "dynamic_reconfigure."))


def out_of_range(facts: Facts) -> Iterator[Finding]:
    """Values outside of what dynamic_reconfigure declares for them."""
    for setting in facts.settings:
        value = setting.value
        if isinstance(value, bool) or not isinstance(value, int | float | str):
            continue
        fitting = declared_for(facts, setting, [read for _, read in facts.readers(setting.name)])
        if not fitting or any(_holds(one, value) for one in fitting):
            continue
        one = fitting[0]
        what = f"outside of what is declared: {_range(one)}"
        text = f"{plain(setting.name)} is {shown_value(value)}, {what}{_effect(one, setting)}"
        places = (Evidence("declared", spot_of(one.place)),)
        yield Finding("range", "warning", setting.spot, setting.name, text, places)


def declared_for(facts: Facts, setting: Setting, reads: list[NodeRead]) -> list[Declared]:
    """The declarations of a value, by those of its reads that are of dynamic_reconfigure.

    None, if one of these is of a package that declares it in a way that is not known: a function of
    Python that several .cfg files call. Plugins of one node may have fields of the same name.
    """
    known = facts.declared_by_name.get(own_part(setting.name), ())
    paths = {read.spot.path for read in reads if read.is_reconfigured}
    if not all(any(_is_below(path, one.package) for one in known) for path in paths):
        return []
    return [one for one in known if any(_is_below(path, one.package) for path in paths)]


def _is_below(path: str, folder: str) -> bool:
    return path.startswith(f"{folder.rstrip('/')}/")


def _holds(one: Declared, value: Number | str) -> bool:
    """Whether a declaration allows a value; true where it says nothing."""
    if one.choices:
        return any(value == choice for _, choice in one.choices)
    if isinstance(value, str):
        return True
    low, high = one.low, one.high
    if low is not None and high is not None and low > high:
        return True
    return (low is None or low <= value) and (high is None or value <= high)


def _range(one: Declared) -> str:
    if one.choices:
        return listed([f"{choice} ({plain(name)})" for name, choice in one.choices], _LISTED)
    if one.low is None:
        return f"at most {show(one.high)}"
    return (
        f"at least {show(one.low)}" if one.high is None else f"{show(one.low)} to {show(one.high)}"
    )


def _effect(one: Declared, setting: Setting) -> str:
    """What the server of dynamic_reconfigure makes of the value."""
    if one.choices or isinstance(setting.value, str):
        return ""
    assert isinstance(setting.value, int | float)
    end = one.low if one.low is not None and setting.value < one.low else one.high
    # It compares; NaN is neither below nor above.
    is_kept = math.isnan(setting.value) or end is None
    return "" if is_kept else f"; its server makes {show(end)} of it"


def spot_of(place: str) -> Spot:
    """``file:line`` as a spot."""
    path, _, lineno = place.rpartition(":")
    return Spot(path, int(lineno)) if path and lineno.isdigit() else Spot(place)
