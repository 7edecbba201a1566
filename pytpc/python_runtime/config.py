"""What a process reports, and where to (docs/reference/runtime.md#settings).

The settings are those of the C++ runtime. An invalid value logs a warning, and the previous setting
stays; it never stops a node.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, NamedTuple

from pytpc.python_runtime.errors import warn

SINKS = ("auto", "rosout", "topic", "file", "off")
POLICIES = ("every", "edges", "light")
# Everybody who reaches the ROS master can set a parameter: where files go and how large they grow
# is for the environment alone.
PARAMETERS = ("sink", "policy", "period", "site_cap", "process_cap")
NAMES = (*PARAMETERS, "folder", "file_limit", "file_reserve", "ring", "ring_budget")
if TYPE_CHECKING:
    Value = Any

_LARGEST = 1 << 40
# Period, reports per second of a comparison, and of the process.
_OF_LIGHT = (1_000_000_000, 10, 50)
_OF_OTHERS = (100_000_000, 0, 0)


class Config(NamedTuple):
    """All settings. Caps are in reports a second, limits in MiB; 0 means no cap and no limit.

    ``ring_ns``: what a ring of files keeps, 0: there is no ring; ``ring_budget`` is in MiB.

    ``policy`` is empty, and the three numbers after it are -1, if they were not chosen.
    """

    sink: str = "auto"
    policy: str = ""
    period_ns: int = -1
    site_cap: int = -1
    process_cap: int = -1
    folder: str = ""
    file_limit: int = 4096
    file_reserve: int = 256
    ring_ns: int = 0
    ring_budget: int = 64

    @property
    def segment_bytes(self) -> int:
        """The share of one file in the budget of the ring, at least 1 MiB and the header."""
        return max((self.ring_budget << 20) // 8, (1 << 20) + 4096)

    def filled_in(self) -> Config:
        """The settings with the usual values for what was not chosen."""
        policy = self.policy or ("light" if self.sink == "auto" else "every")
        usual = _OF_LIGHT if policy == "light" else _OF_OTHERS
        chosen = (self.period_ns, self.site_cap, self.process_cap)
        period, site, process = (b if a < 0 else a for a, b in zip(chosen, usual))
        return self._replace(policy=policy, period_ns=period, site_cap=site, process_cap=process)


def parsed(name: str, text: str) -> tuple[dict[str, Value] | None, str]:
    """The fields of a `Config` that setting ``name`` to ``text`` changes; else None and why."""
    choices = {"sink": SINKS, "policy": POLICIES}.get(name)
    if choices is not None:
        why = f"it must be one of {', '.join(choices)}"
        return ({name: text}, "") if text in choices else (None, why)
    special = {"period": _period, "ring": _ring, "ring_budget": _ring_budget}.get(name)
    if special is not None:
        return special(text)
    if name == "folder":
        return {name: text}, ""
    if name in NAMES:
        is_count = text.isascii() and text.isdigit() and int(text) <= _LARGEST
        return ({name: int(text)}, "") if is_count else (None, "it must be a whole number")
    return None, "there is no such setting"


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return -1.0


def _period(text: str) -> tuple[dict[str, Value] | None, str]:
    seconds = _number(text)
    if not 1e-3 <= seconds <= 3600:
        return None, "it must be a number of seconds from 0.001 to 3600"
    return {"period_ns": int(seconds * 1e9)}, ""


def _ring(text: str) -> tuple[dict[str, Value] | None, str]:
    minutes = _number(text)
    if minutes and not 0.05 <= minutes <= 10080:
        return None, "it must be a number of minutes, 0 or from 0.05 to 10080"
    return {"ring_ns": int(minutes * 60e9)}, ""


def _ring_budget(text: str) -> tuple[dict[str, Value] | None, str]:
    is_budget = text.isascii() and text.isdigit() and 4 <= int(text) <= 1 << 24
    why = "it must be a whole number of MiB from 4"
    return ({"ring_budget": int(text)}, "") if is_budget else (None, why)


def variable_of(name: str) -> str:
    """The variable of the environment for a setting."""
    return f"TPC_{name.upper()}"


def of_environment() -> Config:
    """The defaults, changed by ``TPC_SINK`` and the other variables."""
    config = Config()
    for name in NAMES:
        variable = variable_of(name)
        text = os.environ.get(variable, "")
        if not text:
            continue
        change, why = parsed(name, text)
        if change is None:
            warn(f"{variable}={text} is ignored: {why}")
        else:
            config = config._replace(**change)
    return config


def text_of(name: str, value: object) -> str | None:
    """The value of a ROS parameter as text; None if no setting has its type.

    YAML reads `off` as false.
    """
    if isinstance(value, bool):
        return "off" if name == "sink" and not value else None
    if isinstance(value, (str, int)):
        return str(value)
    return repr(value) if isinstance(value, float) else None
