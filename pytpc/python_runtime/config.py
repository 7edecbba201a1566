"""What a process reports, and where to (docs/reference/runtime.md#settings).

The settings are those of the C++ runtime. An invalid value logs a warning, and the previous setting
stays; it never stops a node.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any, NamedTuple

from pytpc.python_runtime.errors import warn

SINKS = ("rosout", "topic", "file", "off")
POLICIES = ("every", "edges")
NAMES = (
    "sink",
    "policy",
    "period",
    "site_cap",
    "process_cap",
    "folder",
    "file_limit",
    "file_reserve",
)
if TYPE_CHECKING:
    Value = Any

_LARGEST = 1 << 40


class Config(NamedTuple):
    """All settings. Caps are in reports a second, limits in MiB; 0 means no cap and no limit."""

    sink: str = "rosout"
    policy: str = "every"
    period_ns: int = 100_000_000
    site_cap: int = 0
    process_cap: int = 0
    folder: str = ""
    file_limit: int = 4096
    file_reserve: int = 256


def parsed(name: str, text: str) -> tuple[dict[str, Value] | None, str]:
    """The fields of a `Config` that setting ``name`` to ``text`` changes; else None and why."""
    choices = {"sink": SINKS, "policy": POLICIES}.get(name)
    if choices is not None:
        why = f"it must be one of {', '.join(choices)}"
        return ({name: text}, "") if text in choices else (None, why)
    if name == "period":
        try:
            seconds = float(text)
        except ValueError:
            seconds = 0.0
        if not 1e-3 <= seconds <= 3600:
            return None, "it must be a number of seconds from 0.001 to 3600"
        return {"period_ns": int(seconds * 1e9)}, ""
    if name == "folder":
        return {name: text}, ""
    if name in NAMES:
        is_count = text.isascii() and text.isdigit() and int(text) <= _LARGEST
        return ({name: int(text)}, "") if is_count else (None, "it must be a whole number")
    return None, "there is no such setting"


def of_environment() -> Config:
    """The defaults, changed by ``TPC_SINK`` and the other variables."""
    config = Config()
    for name in NAMES:
        variable = f"TPC_{name.upper()}"
        text = os.environ.get(variable, "")
        if not text:
            continue
        change, why = parsed(name, text)
        if change is None:
            warn(f"{variable}={text} is ignored: {why}")
        else:
            config = config._replace(**change)
    return config
