"""TPC: finds the parameter that makes a robot misbehave.

What a notebook needs is here. `pytpc.api` has everything, and
docs/tutorial/diagnose-a-mission.md shows it at work::

    import pytpc

    static = pytpc.load_static("my_workspace")
    mission = pytpc.read("mission.bag")
    pytpc.diagnose(mission, static)

It is imported when it is asked for, so that ``import pytpc`` costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pytpc.api.diagnosing import Rankings, curves, diagnose, rank
    from pytpc.api.missions import load_static, read
    from pytpc.api.report import write_report
    from pytpc.api.suggesting import suggest, what_if
    from pytpc.diagnosis.question import Question
    from pytpc.present.answers import Advices, Diagnosed
    from pytpc.recording.parameter_change import Change

__all__ = [
    "Advices",
    "Change",
    "Diagnosed",
    "Question",
    "Rankings",
    "curves",
    "diagnose",
    "load_static",
    "rank",
    "read",
    "suggest",
    "what_if",
    "write_report",
]


def __getattr__(name: str) -> object:
    """What ``__all__`` names, from `pytpc.api`."""
    if name not in __all__:
        raise AttributeError(f"module 'pytpc' has no attribute {name!r}")
    found: object = getattr(import_module("pytpc.api"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    """For completion in a notebook."""
    return sorted({*globals(), *__all__})
