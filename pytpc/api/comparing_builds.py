"""What a change of the code does to the comparisons: two builds, and what is declared in them."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from pytpc.api.missions import Source, load_static
from pytpc.conditions.lookup import Answer
from pytpc.conditions.sarif import Compared, State, compared_log
from pytpc.conditions.tpc_details import details
from pytpc.recording.declaration import Declared
from pytpc.static.budget import edits_text
from pytpc.static.build_changes import BuildChanges, ComparisonChange, Status, changes_between
from pytpc.static.parameter_changes import DeclaredAs
from pytpc.static.sources import changed_sources
from pytpc.static.static_info import StaticInfo
from pytpc.values.declared import declared_in


def compare_builds(
    old: StaticInfo | Source,
    new: StaticInfo | Source,
    *,
    constants: bool = False,
    on_skipped: Callable[[str], None] | None = None,
) -> BuildChanges:
    """Compare two builds: what is new, gone, changed or moved, and what became of the parameters.

    The ``.cfg`` files of the new build's sources say which parameters are declared. What they say
    is compared with those of the old build if its sources are there, too, in another folder and as
    they were.

    Args:
        old: static information, or where it is: a static.json, a build base or a workspace.
        new: the same of the newer build.
        constants: whether comparisons with constants count, too.
        on_skipped: called with one line for each declaration of the new build that cannot be read.

    Raises:
        InputError: there is none, or it is broken.
    """
    before, after = load_static(old), load_static(new)
    declared = declared_in(after, on_skipped=on_skipped)
    # Both builds of a CI job may have been made in one folder: then its files are the new ones.
    is_known = _roots(before).isdisjoint(_roots(after)) and not changed_sources(before)
    there = _packaged(declared_in(before), before) if is_known else []
    return changes_between(
        before,
        after,
        constants=constants,
        declared={one.parameter for one in declared},
        declarations=(there, _packaged(declared, after) if there else []),
    )


_STATES: dict[Status, State] = {
    "new": "new",
    "gone": "absent",
    "changed": "updated",
    "moved": "unchanged",
    "same": "unchanged",
}


def sarif_of_changes(
    old: StaticInfo, new: StaticInfo, changes: BuildChanges, srcroot: Path | None = None
) -> dict[str, Any]:
    """The comparisons of both builds as SARIF 2.1.0 with their baseline states.

    Args:
        old: the older build.
        new: the newer one.
        changes: between them.
        srcroot: folder that paths are relative to; by default what all packages share.
    """

    def compared(one: ComparisonChange) -> Compared:
        static = old if one.new is None else new
        # To parse all sources takes minutes, and those of the older build may be gone.
        found = details(static, one.site.tpc, Answer(None, "only its line is known"))
        text = edits_text(one) if one.status == "changed" else ""
        return Compared(found, _STATES[one.status], one.status, (text,) if text else ())

    return compared_log(new, old, map(compared, changes.comparisons), srcroot)


def _roots(static: StaticInfo) -> set[str]:
    return {unit.source_root for unit in static.units}


def _packaged(declared: Iterable[Declared], static: StaticInfo) -> list[DeclaredAs]:
    """The declarations with the names of their packages, and files relative to these."""
    names = {unit.source_root.rstrip("/"): unit.package for unit in static.units}
    return [
        DeclaredAs(
            names.get(one.package, Path(one.package).name),
            one.parameter,
            one.type,
            one.default,
            one.low,
            one.high,
            one.choices,
            one.place.removeprefix(f"{one.package}/"),
        )
        for one in declared
    ]
