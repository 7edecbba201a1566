"""The one door: a verb for each question, for the command line, notebooks and programs.

Every verb takes what another one returned, or its path: ``rank("mission.bag", "my_ws")`` is
``rank(read("mission.bag"), load_static("my_ws"))``. The answers hold typed objects, print as
tables, and are tables in a notebook (with all texts from the robot escaped).

========================  ==================================================
``read``, ``load_static``  a mission; what the analysis of its build found
``diagnose``               which parameter is to blame, with probabilities
``rank``, ``curves``       the thesis's ranking at each mark, or over time
``suggest``                which value to try
``what_if``                what a value would have changed (a replay)
``margins``                how near each comparison came to turning
``write_report``           a page with the answers and the evidence
``compare_builds``         what a change of the code does to the comparisons
``compare_decisions``      what two recordings decided differently
``build``, ``analyse``,    static information
``collect``
``record_launch``,         a mission
``record_running``,
``convert``
``origins``, ``plan``,     where values came from, and changes of them
``apply``, ``undo``
========================  ==================================================

Errors are `pytpc.base.errors.TpcError`: one line that names the file. A name is imported when it
is first used, so importing this costs nothing.
"""

from __future__ import annotations

from importlib import import_module

_PLACES = {
    "missions": ("convert", "load_static", "read"),
    "diagnosing": ("Rankings", "curves", "diagnose", "rank"),
    "measuring": ("margins",),
    "comparing_builds": ("compare_builds",),
    "comparing_decisions": ("compare_decisions",),
    "suggesting": ("suggest", "what_if"),
    "report": ("write_report",),
    "building": ("BuildOptions", "analyse", "build", "collect"),
    "record": ("RecordOptions", "record_launch", "record_running"),
    "values": ("apply", "apply_live", "origins", "plan", "undo"),
}
_MODULES = {name: f"{__name__}.{module}" for module, names in _PLACES.items() for name in names} | {
    "Advices": "pytpc.present.answers",
    "Change": "pytpc.recording.parameter_change",
    "Diagnosed": "pytpc.present.answers",
    "Question": "pytpc.diagnosis.question",
}


def __getattr__(name: str) -> object:
    """Import a verb or a type from its module."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    found: object = getattr(import_module(_MODULES[name]), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    """For completion in a notebook."""
    return sorted({*globals(), *_MODULES})
