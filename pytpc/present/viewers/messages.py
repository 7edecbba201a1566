"""The messages of an exported mission: their types as ROS 2 defines types, and as CDR.

All viewers read such messages without having the types installed, because MCAP holds their
definitions.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
import numpy.typing as npt
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from pytpc.base.columns import Floats
from pytpc.diagnosis.results.exported import ExportedRows

EVALUATION = "tpc_msgs/msg/Evaluation"
PARAMETER = "tpc_msgs/msg/ParameterValue"
RANK = "tpc_msgs/msg/Rank"
PROBABILITY = "tpc_msgs/msg/Probability"
MARK = "tpc_msgs/msg/Mark"
SUSPECT = "tpc_msgs/msg/Suspect"
SUSPECTS = "tpc_msgs/msg/Suspects"
LOG = "rcl_interfaces/msg/Log"

_FIELDS = {
    EVALUATION: """\
# One evaluation of a comparison, or the last one of a summary of several evaluations.
float64 value          # what was compared
float64 threshold      # what it was compared with
float64 margin         # above 0: the comparison holds; in the unit that the metadata says
uint32 evaluations     # 1; 0 if a summary counts it; or how many the summary has
bool result            # the result of the whole condition
bool holds             # the result of this comparison
bool flop              # the result changed; of a summary: changes that no other message tells
""",
    PARAMETER: """\
# From now on the parameter has this value.
float64 value          # NaN if it is no number
string text
""",
    RANK: """\
# How suspicious a parameter is now, without any mark: 1 most, 0 not at all.
float64 type1          # the robot did something wrong
float64 type2          # the robot does not do something
float64 combined
""",
    PROBABILITY: """\
# The probability that the parameter is the cause, by all marks so far.
float64 probability
""",
    MARK: """\
# An observer said that the robot is wrong.
uint8 type             # 1, 2, or 0 without a type
string observer
string note
""",
    SUSPECT: """\
uint32 position
string parameter
float64 probability
string type
string place
string value_to_try
""",
    SUSPECTS: """\
# What all marks so far say together.
uint32 mark            # number of the last mark
string verdict
string action
float64 none           # the probability that it is none of the parameters
tpc_msgs/Suspect[] suspects
""",
}
_HEAD = np.frombuffer(b"\0\1\0\0", np.uint8)
_ROW = np.dtype(
    [
        ("head", np.uint8, 4),
        ("value", "<f8"),
        ("threshold", "<f8"),
        ("margin", "<f8"),
        ("evaluations", "<u4"),
        ("result", "u1"),
        ("holds", "u1"),
        ("flop", "u1"),
    ]
)
_RANK_ROW = np.dtype([("head", np.uint8, 4), ("ranks", "<f8", 3)])
_MOST = 2**32 - 1


@cache
def store() -> Typestore:
    """The types of ROS 2 and ours."""
    found = get_typestore(Stores.ROS2_HUMBLE)
    for name, text in _FIELDS.items():
        found.register(get_types_from_msg(text, name))
    return found


def definition(name: str) -> str:
    """A type as MCAP's schema encoding ``ros2msg`` has it, with the types that it needs."""
    if name == LOG:
        return str(store().generate_msgdef(name, ros_version=2)[0])
    needed = [other for other in (SUSPECT,) if name == SUSPECTS]
    parts = [_FIELDS[name], *(f"MSG: {_short(one)}\n{_FIELDS[one]}" for one in needed)]
    return f"{'=' * 80}\n".join(parts)


def encode(name: str, fields: Mapping[str, Any]) -> bytes:
    """A message of one of the types as CDR; objects in lists are given by their fields."""
    return bytes(store().serialize_cdr(_made(name, fields), name))


def encode_rows(rows: ExportedRows) -> list[bytes]:
    """Each evaluation as CDR, in their order."""
    found = np.zeros(rows.time_ns.size, _ROW)
    found["head"] = _HEAD
    for name in ("value", "threshold", "margin", "result", "holds", "flop"):
        found[name] = getattr(rows, name)
    found["evaluations"] = np.minimum(rows.evaluations, _MOST)
    return _each(found)


def encode_ranks(type1: Floats, type2: Floats, combined: Floats) -> list[bytes]:
    """Each of some ranks (float64[n] each) as CDR, in their order."""
    found = np.zeros(type1.size, _RANK_ROW)
    found["head"] = _HEAD
    found["ranks"] = np.stack([type1, type2, combined], axis=-1)
    return _each(found)


def _each(found: npt.NDArray[np.void]) -> list[bytes]:
    data, size = found.tobytes(), found.itemsize
    return [data[at : at + size] for at in range(0, len(data), size)]


def _made(name: str, fields: Mapping[str, Any]) -> Any:  # noqa: ANN401
    given: dict[str, Any] = {
        field: [_made(SUSPECT, one) for one in value] if field == "suspects" else value
        for field, value in fields.items()
    }
    made: Any = store().types[name]
    return made(**given)


def _short(name: str) -> str:
    return name.replace("/msg/", "/")
