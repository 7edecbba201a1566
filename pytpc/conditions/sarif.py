"""The TPCs as SARIF 2.1.0 (OASIS), for code review tools.

Each TPC is a note: nothing is wrong with it, but a reviewer should know that a parameter decides.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path, PurePosixPath
from typing import Any, Literal
from urllib.parse import quote

from pytpc.base.source_bytes import source_bytes
from pytpc.conditions.tpc_details import Details
from pytpc.static.link_unit import LinkUnit, PathStep
from pytpc.static.static_info import StaticInfo

SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)
ROOT = "%SRCROOT%"
_RULES = {
    "parameter": (
        "ComparisonWithParameter",
        "A value is compared with a configuration parameter.",
        "What the robot can see of this node depends on the outcome of a comparison with a"
        " configuration parameter.",
    ),
    "flag": (
        "DecisionByParameter",
        "A configuration parameter decides by itself.",
        "What the robot can see of this node depends on a configuration parameter that is the"
        " condition itself.",
    ),
    "derived": (
        "ComparisonWithDerivedParameter",
        "A value is compared with what is computed from a configuration parameter.",
        "What the robot can see of this node depends on the outcome of a comparison with a"
        " threshold that comes from a configuration parameter through arithmetic.",
    ),
    "constant": (
        "ComparisonWithConstant",
        "A value is compared with a constant of the source.",
        "What the robot can see of this node depends on the outcome of a comparison with a number"
        " that stands in the source.",
    ),
}
State = Literal["new", "unchanged", "updated", "absent"]


@dataclass(frozen=True, slots=True)
class Compared:
    """A TPC of one of two builds: its baseline state, what became of it, and what changed."""

    details: Details
    state: State
    status: str
    changes: tuple[str, ...] = ()


# The steps that are shown of a folded path.
_ESSENTIAL = frozenset({"read", "compare", "expose"})


def sarif_log(
    static: StaticInfo, found: Sequence[Details], srcroot: Path | None = None
) -> dict[str, Any]:
    """A SARIF log with one run.

    Args:
        static: where ``found`` is from; its failed link units become notifications.
        found: the results, in this order.
        srcroot: folder that paths are relative to; by default what the folders of all packages have
            in common. Files elsewhere have absolute URIs.
    """
    places = Places(_root(static, srcroot), dict(static.copies))
    return _log(static.troubles, places, [_result(each, places) for each in found])


def compared_log(
    new: StaticInfo,
    old: StaticInfo,
    found: Iterable[Compared],
    srcroot: Path | None = None,
) -> dict[str, Any]:
    """A SARIF log of a newer build, in which each result says how it was in an older one.

    Args:
        new: the newer build; its failed link units become notifications.
        old: the older one.
        found: the results, in this order; those that are gone, too.
        srcroot: folder that paths are relative to; by default as in ``sarif_log``. Files of the
            older build are at the same relative paths.
    """
    root = _root(new, srcroot)
    here, there = Places(root, dict(new.copies)), Places(_same_root(old, new, root), {})
    results = []
    for each in found:
        result = _result(each.details, there if each.state == "absent" else here)
        result["baselineState"] = each.state
        result["properties"] |= {"status": each.status, "changes": list(each.changes)}
        if each.changes:
            result["message"]["text"] += f" Changed: {'; '.join(each.changes)}."
        results.append(result)
    return _log(new.troubles, here, results)


def _log(troubles: Iterable[str], places: Places, results: list[dict[str, Any]]) -> dict[str, Any]:
    return {
        "$schema": SCHEMA,
        "version": "2.1.0",
        "runs": [
            {
                "tool": {"driver": _driver()},
                "invocations": [
                    {
                        "executionSuccessful": True,
                        "toolExecutionNotifications": [_warning(text) for text in troubles],
                    }
                ],
                "originalUriBaseIds": {ROOT: {"uri": file_uri(places.root.rstrip("/") + "/")}},
                "columnKind": "unicodeCodePoints",
                "results": results,
            }
        ],
    }


def _root(static: StaticInfo, srcroot: Path | None) -> str:
    if srcroot is not None:
        return os.path.normpath(srcroot.absolute())
    return _common([unit.source_root for unit in static.units])


def _same_root(old: StaticInfo, new: StaticInfo, root: str) -> str:
    """The folder of an older build that stands for ``root`` of the newer one."""
    theirs = {unit.package: unit.source_root.rstrip("/") for unit in old.units}
    for unit in new.units:
        below = os.path.relpath(unit.source_root, root)
        folder = theirs.get(unit.package, "")
        if folder and below == ".":
            return folder
        if folder.endswith(f"/{below}"):
            return folder.removesuffix(f"/{below}") or "/"
    return _root(old, None)


class Places:
    """Places in files as SARIF has them."""

    def __init__(self, root: str, copies: Mapping[str, str]) -> None:
        """Paths are relative to ``root``; ``copies`` are installed headers and their originals."""
        self.root = root
        self._root = PurePosixPath(root)
        self._copies = copies
        self._lines = lru_cache(maxsize=256)(_read_lines)

    def location(
        self, file: str, lineno: int, column: int, snippet: str | None = None
    ) -> dict[str, Any]:
        """A physical location; ``column`` counts bytes, and 0 stands for an unknown one.

        An installed header is the file that it is a copy of.
        """
        file = self._copies.get(file, file)
        place: dict[str, Any] = {"artifactLocation": self._artifact(file)}
        if lineno > 0:
            place["region"] = {"startLine": lineno}
            if column > 0:
                place["region"]["startColumn"] = self.column(file, lineno, column)
            if snippet:
                place["region"]["snippet"] = {"text": snippet}
        return place

    def column(self, file: str, lineno: int, column: int) -> int:
        """A byte's column as that of a character, where the file is there."""
        lines = self._lines(file)
        line = lines[lineno - 1] if lineno <= len(lines) else b""
        return len(line[: column - 1].decode("utf-8", "replace")) + 1 if line else column

    def _artifact(self, file: str) -> dict[str, str]:
        path = PurePosixPath(file)
        if path.is_relative_to(self._root):
            return {"uri": quote(str(path.relative_to(self._root))), "uriBaseId": ROOT}
        return {"uri": file_uri(file)}


def _driver() -> dict[str, Any]:
    return {
        "name": "TPC",
        "version": version("pytpc"),
        "rules": [
            {
                "id": f"tpc/{kind}",
                "name": name,
                "shortDescription": {"text": short},
                "fullDescription": {"text": full},
                "help": {
                    "text": "Ask `pytpc show KEY` for all that is known, with the key of the"
                    " result's fingerprints."
                },
                "defaultConfiguration": {"level": "note"},
            }
            for kind, (name, short, full) in _RULES.items()
        ],
    }


def _result(each: Details, places: Places) -> dict[str, Any]:
    tpc, nearest = each.tpc, each.nearest
    location: dict[str, Any] = {
        "physicalLocation": places.location(tpc.file, tpc.lineno, tpc.column, nearest.source_code),
    }
    if nearest.function:
        location["logicalLocations"] = [
            {"fullyQualifiedName": nearest.function, "kind": "function"}
        ]
    if each.condition is not None:
        context = each.condition
        location["physicalLocation"]["contextRegion"] = {
            "startLine": context.lineno,
            "startColumn": places.column(tpc.file, context.lineno, context.column),
            "endLine": context.end_lineno,
            "endColumn": places.column(tpc.file, context.end_lineno, context.end_column),
            "snippet": {"text": context.text},
        }
    result: dict[str, Any] = {
        "ruleId": f"tpc/{tpc.type}",
        "ruleIndex": list(_RULES).index(tpc.type),
        "level": "note",
        "message": {"text": _message(each)},
        "locations": [location],
        "partialFingerprints": {
            f"tpcKey/{key.package}/{key.link_unit}/v1": key.key for key in tpc.keys
        },
        "properties": {
            "parameter": tpc.parameter,
            "constant": tpc.name,
            "type": tpc.type,
            "relation": tpc.relation,
            "distance": tpc.distance,
            "transform": None if nearest.transform is None else nearest.transform.text,
            "defaults": list(each.defaults),
            "topics": sorted({at.topic for at in each.exposed if at.topic}),
            "keys": [key.key for key in tpc.keys],
            "linkUnits": list(tpc.link_units),
            "processes": list(each.processes),
        },
    }
    if nearest.path:
        steps = [_step(step, each.unit, places) for step in nearest.path]
        result["codeFlows"] = [{"threadFlows": [{"locations": steps}]}]
    return result


def _message(each: Details) -> str:
    topics = list(dict.fromkeys(at.topic for at in each.exposed if at.topic))
    what = f"what is sent on {', '.join(topics)}" if topics else "what the robot sees of this node"
    by = f"on constant {each.title}" if each.tpc.type == "constant" else f"on {each.title}"
    pairs = zip(each.defaults, each.shown_defaults, strict=True)
    defaults = [shown for default, shown in pairs if default is not None]
    default = f" (default {', '.join(defaults)})" if defaults else ""
    text = " ".join(each.source_text.split())
    return f"{text}: {what} depends {by}{default}."


def _step(step: PathStep, unit: LinkUnit, places: Places) -> dict[str, Any]:
    location: dict[str, Any] = {"message": {"text": step.what or step.step}}
    if step.file:
        location["physicalLocation"] = places.location(
            unit.absolute(step.file), step.lineno, step.column, step.source_code
        )
        if step.function:
            location["logicalLocations"] = [
                {"fullyQualifiedName": step.function, "kind": "function"}
            ]
    found: dict[str, Any] = {
        "location": location,
        "kinds": [step.step],
        "importance": "essential" if step.step in _ESSENTIAL else "important",
    }
    if step.unit is not None:
        found["module"] = step.unit
        module = {"fullyQualifiedName": step.unit, "kind": "module"}
        location.setdefault("logicalLocations", []).append(module)
    return found


def _warning(text: str) -> dict[str, Any]:
    return {"level": "warning", "message": {"text": text}}


def _common(roots: Sequence[str]) -> str:
    return os.path.commonpath(roots) if roots else "/"


def file_uri(path: str) -> str:
    """The URI of an absolute path."""
    return "file://" + quote(path)


def _read_lines(file: str) -> list[bytes]:
    try:
        return source_bytes(Path(file)).split(b"\n")
    except OSError:
        return []
