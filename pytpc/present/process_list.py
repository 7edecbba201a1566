"""Processes in words, as JSON, and as a file of corrections."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import yaml

from pytpc.base.wording import many
from pytpc.processes.process import Choice, Outcome, Process, Processes, Unit

_WHY = {
    "launch": "loaded by the launch file",
    "parameters": "named by parameters",
    "code": "named in the code",
    "all": "nothing names one: all",
    "corrected": "corrected",
}


def words_of(process: Process) -> list[tuple[str, str]]:
    """What there is to say of a process: a label and words for each line."""
    lines = [("units", ", ".join(map(_unit, process.units)))]
    lines += [("plugins", _choice(choice)) for choice in process.choices]
    files = dict.fromkeys(start.path.name for start in process.starts)
    if process.outcome is not None:
        lines.append(("found", _found(process.outcome)))
    return [*lines, *([("started", f"by {', '.join(files)}")] if files else [])]


def _unit(unit: Unit) -> str:
    return unit.name if unit.is_known else f"{unit.name} (not analysed)"


def _found(outcome: Outcome) -> str:
    if outcome.failure is not None:
        return f"nothing as a whole, so its units were analysed alone: {outcome.failure}"
    return (
        f"{many(outcome.comparisons, 'comparison')} in {many(outcome.functions, 'function')}"
        f" that it can reach; {outcome.seconds:.1f} s of processor time, {outcome.memory_mib} MiB"
    )


def _choice(choice: Choice) -> str:
    names = ", ".join(plugin.name for plugin in choice.plugins)
    return f"{names} ({choice.base}; {_WHY[choice.why]})"


def processes_as_json(found: Processes) -> dict[str, Any]:
    """Everything that is known; docs/reference/command-line.md describes it."""
    return {
        "schema": 1,
        "processes": [
            {
                "name": process.name,
                "program": process.program,
                "host": None if process.host is None else str(process.host),
                "functions": process.functions,
                "analysis": None if process.outcome is None else asdict(process.outcome),
                "units": [
                    {
                        "package": unit.package,
                        "link_unit": unit.name,
                        "path": str(unit.path),
                        "functions": unit.functions,
                    }
                    for unit in process.units
                ],
                "choices": [
                    {
                        "base": choice.base,
                        "why": choice.why,
                        "plugins": [
                            {
                                "name": plugin.name,
                                "class": plugin.kind,
                                "package": plugin.package,
                                "library": str(plugin.library),
                                "file": str(plugin.path),
                                "lineno": plugin.line,
                            }
                            for plugin in choice.plugins
                        ],
                    }
                    for choice in process.choices
                ],
                "starts": [
                    {"file": str(start.path), "lineno": start.line, "node": start.node}
                    for start in process.starts
                ],
            }
            for process in found.found
        ],
        "faults": list(found.faults),
        "unread": {str(path): why for path, why in found.unread.items()},
    }


def processes_as_yaml(found: Processes) -> str:
    """The processes with plugins, as a file of corrections that changes nothing."""
    programs: dict[str, list[dict[str, Any]]] = {}
    for process in found.found:
        if process.plugins:
            names = [plugin.name for plugin in process.plugins]
            entry = {"name": process.name, "plugins": names}
            programs.setdefault(process.program, []).append(entry)
    text: str = yaml.safe_dump({"processes": programs}, sort_keys=False, allow_unicode=True)
    return (
        f"# What `pytpc processes` found. Programs that are not here are left as they are.\n{text}"
    )
