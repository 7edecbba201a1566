"""The findings of `lint` as lines, as JSON and as SARIF."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Any

from pytpc.base.wording import listed, many, plain
from pytpc.conditions.sarif import ROOT, SCHEMA, Places, file_uri
from pytpc.lint.check import Checked
from pytpc.lint.facts import Unjudged
from pytpc.lint.finding import KINDS, SEVERITIES, Finding, Spot

_MOST_NAMES = 3
_LEVELS = {"unset": "error", "set-twice": "note", "never-crossed": "note"}


def finding_lines(one: Finding, below: Path) -> Iterator[str]:
    """A finding as lines: its place, severity, kind and text; then each further place.

    Args:
        one: the finding.
        below: paths in this folder are shown relative to it.
    """
    yield f"{_place(one.spot, below)}: {one.severity}: {plain(one.text)} [{one.kind}]"
    for what, spot in one.evidence:
        yield f"    {_place(spot, below)}: {plain(what)}"


def _place(spot: Spot, below: Path) -> str:
    path = Path(spot.path)
    shown = path.relative_to(below) if path.is_relative_to(below) else path
    return plain(str(Spot(str(shown), spot.lineno)))


def summary_line(checked: Checked) -> str:
    """How many findings there are, by severity, and how much was checked."""
    counts = Counter(one.severity for one in checked.findings)
    found = [many(counts[severity], severity) for severity in SEVERITIES if counts[severity]]
    what = ", ".join(found) or "nothing found"
    ignored = f", {checked.ignored} ignored" if checked.ignored else ""
    values, nodes = many(checked.settings, "value"), many(checked.nodes, "node")
    return f"{what}{ignored}: {values} of {nodes}"


def unjudged_line(unjudged: Unjudged) -> str:
    """Of how many parameters it is not known whether a node reads them, and why; may be empty."""
    count = len(frozenset[str]().union(*unjudged.reasons.values()))
    if not count:
        return ""
    ordered = sorted(unjudged.reasons.items(), key=lambda one: (-len(one[1]), one[0]))
    why = [f"{plain(reason)} ({len(names)})" for reason, names in ordered]
    return f"not known whether a node reads {many(count, 'parameter')}: {listed(why, _MOST_NAMES)}"


def findings_as_json(checked: Checked) -> dict[str, Any]:
    """What was found, for programs (docs/reference/command-line.md)."""
    return {
        "findings": [_as_json(one) for one in checked.findings],
        "settings": checked.settings,
        "nodes": checked.nodes,
        "ignored": checked.ignored,
        "unjudged": {
            reason: sorted(names) for reason, names in sorted(checked.unjudged.reasons.items())
        },
    }


def _as_json(one: Finding) -> dict[str, Any]:
    return {
        "kind": one.kind,
        "severity": one.severity,
        "file": one.spot.path,
        "lineno": one.spot.lineno,
        "parameter": one.parameter,
        "text": one.text,
        "evidence": [
            {"what": what, "file": spot.path, "lineno": spot.lineno} for what, spot in one.evidence
        ],
    }


def findings_as_sarif(checked: Checked, root: Path) -> dict[str, Any]:
    """The findings as SARIF 2.1.0 (OASIS); paths are relative to ``root`` where they are below."""
    folder = os.path.normpath(root.absolute())
    places = Places(folder, {})
    kinds = list(KINDS)
    driver = {
        "name": "TPC lint",
        "version": version("pytpc"),
        "rules": [
            {
                "id": f"tpc-lint/{kind}",
                "shortDescription": {"text": f"{what[0].upper()}{what[1:]}."},
                "defaultConfiguration": {"level": _LEVELS.get(kind, "warning")},
            }
            for kind, what in KINDS.items()
        ],
    }
    results = []
    for one in checked.findings:
        result: dict[str, Any] = {
            "ruleId": f"tpc-lint/{one.kind}",
            "ruleIndex": kinds.index(one.kind),
            "level": one.severity,
            "message": {"text": one.text},
            "locations": [{"physicalLocation": places.location(one.spot.path, one.spot.lineno, 0)}],
            "properties": {"parameter": one.parameter},
        }
        if one.evidence:
            result["relatedLocations"] = [
                {
                    "id": number,
                    "message": {"text": what},
                    "physicalLocation": places.location(spot.path, spot.lineno, 0),
                }
                for number, (what, spot) in enumerate(one.evidence, start=1)
            ]
        results.append(result)
    run = {
        "tool": {"driver": driver},
        "originalUriBaseIds": {ROOT: {"uri": file_uri(folder.rstrip("/") + "/")}},
        "columnKind": "unicodeCodePoints",
        "results": results,
    }
    return {"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}
