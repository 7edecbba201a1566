"""How well TPC finds the wrong parameter: study, survey, the tables of the thesis, demo flights.

What a notebook needs is here, and documented in `pytpc_evaluation.stats.notebook_tables`; it is
imported when it is asked for.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pytpc_evaluation.stats.notebook_tables import StudyTable, study_tables

__all__ = ["StudyTable", "study_tables"]


def __getattr__(name: str) -> object:
    """What ``__all__`` names, from `pytpc_evaluation.stats.notebook_tables`."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    found: object = getattr(import_module("pytpc_evaluation.stats.notebook_tables"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    """For completion in a notebook."""
    return sorted({*globals(), *__all__})
