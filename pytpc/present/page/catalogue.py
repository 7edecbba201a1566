"""The page with all TPCs of a workspace, by package and file, as one HTML file.

It needs no network, and is readable without its script, which only filters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.conditions.tpc_details import Details
from pytpc.present.page.environment import environment, page_script, script_hash
from pytpc.present.page.source import LONGEST_LINE, StepView, source_file_lines, way_of
from pytpc.static.static_info import StaticInfo

_CONTEXT = 2


@dataclass(frozen=True)
class CodeLine:
    """A line of source: its text before, in and behind the condition."""

    number: int
    before: str
    inside: str
    behind: str


@dataclass(frozen=True)
class TpcView:
    """A TPC as plain texts; ``words`` is what the filter looks into."""

    ident: str
    name: str
    place: str
    kind: str
    relation: str
    compared: str
    origin: str
    code: list[CodeLine]
    distance: int
    facts: list[tuple[str, str]]
    macro: str
    keys: list[tuple[str, str]]
    units: int
    way: list[StepView]
    words: str


@dataclass(frozen=True)
class FileView:
    """A source file with its TPCs."""

    name: str
    tpcs: list[TpcView]


@dataclass(frozen=True)
class PackageView:
    """A package with its files."""

    ident: str
    name: str
    files: list[FileView]
    count: int


def write_catalogue(path: Path, static: StaticInfo, found: Sequence[Details], title: str) -> None:
    """Write the page, atomically. The same static information makes the same bytes.

    Raises:
        TpcError: the file cannot be written; what stood there before is untouched.
    """
    write_atomic(path, render(static, found, title).encode("utf-8", "replace"))


def render(static: StaticInfo, found: Sequence[Details], title: str) -> str:
    """The page as text, with everything from the sources escaped."""
    script = page_script("cards.js") + page_script("tpcs.js")
    packages = _packages(found)
    return (
        environment()
        .get_template("tpcs.html.j2")
        .render(
            title=title,
            packages=packages,
            script=script,
            script_hash=script_hash(script),
            facts=_summary(static, found),
            warnings=list(static.troubles),
        )
    )


def _packages(found: Sequence[Details]) -> list[PackageView]:
    numbered = enumerate(sorted(found, key=_order), start=1)
    views = [(each, _view(each, f"t{number}")) for number, each in numbered]
    packages: list[PackageView] = []
    for package, in_package in groupby(views, key=lambda pair: pair[0].tpc.package):
        by_file = [
            FileView(file, [view for _, view in in_file])
            for file, in_file in groupby(in_package, key=lambda pair: pair[0].tpc.place)
        ]
        count = sum(len(file.tpcs) for file in by_file)
        packages.append(PackageView(f"p{len(packages) + 1}", package, by_file, count))
    return packages


def _order(each: Details) -> tuple[str, str, int, int, str]:
    tpc = each.tpc
    return tpc.package, tpc.place, tpc.lineno, tpc.column, each.title


def _view(each: Details, ident: str) -> TpcView:
    tpc = each.tpc
    way = way_of(each.nearest)
    keys = [
        (key.key, f"{key.package}/{key.link_unit}, distance {key.distance}") for key in tpc.keys
    ]
    facts = [
        ("Compared", f"{tpc.relation} {each.nearest.name or each.title}, {each.meaning}"),
        ("Default", ", ".join(each.shown_defaults)),
        ("Read at", ", ".join(each.reads)),
        (
            "Exposed at",
            ", ".join(f"{at.place} ({at.topic or 'unknown topic'})" for at in each.exposed),
        ),
        ("Function", each.nearest.function),
        ("Across", each.across),
        ("Found in", ", ".join(each.processes)),
    ]
    topics = [at.topic for at in each.exposed if at.topic]
    told = (each.title, tpc.type, tpc.package, tpc.place, each.source_text, each.nearest.function)
    words = " ".join(
        [*told, *topics, *tpc.link_units, *each.processes, *(key.key for key in tpc.keys)]
    )
    macro = each.condition.macro if each.condition is not None else None
    return TpcView(
        ident=ident,
        name=each.title,
        place=f"{tpc.place}:{tpc.lineno}",
        kind=tpc.type,
        relation=tpc.relation,
        compared=" ".join(each.source_text.split())[:LONGEST_LINE],
        origin=_origin(each),
        code=_code(each),
        distance=tpc.distance,
        facts=[(name, text) for name, text in facts if text],
        macro=macro.text if macro is not None else "",
        keys=keys,
        units=len(tpc.link_units),
        way=way,
        words=" ".join(words.lower().split()),
    )


def _origin(each: Details) -> str:
    found = each.condition
    if found is None:
        return f"only the line is known: {each.note}"
    text = "an expression" if found.kind == "expression" else f"condition of {found.kind}"
    if found.macro is not None:
        macro = found.macro
        text += f", expanded from macro {macro.name} ({macro.file}:{macro.lineno})"
    return f"{text}; {each.note}" if each.note else text


def _code(each: Details) -> list[CodeLine]:
    """The condition's lines with two before and after; else the line that the analysis kept."""
    found, nearest = each.condition, each.nearest
    lines = source_file_lines(Path(each.tpc.file)) if found is not None else None
    if found is None or lines is None or found.end_lineno > len(lines):
        text = (nearest.source_code or "")[:LONGEST_LINE]
        return [CodeLine(nearest.lineno, "", text, "")] if text else []
    first = max(1, found.lineno - _CONTEXT)
    shown = lines[first - 1 : found.end_lineno + _CONTEXT]
    texts = [line.decode("utf-8", "replace") for line in shown]
    indent = min((len(s) - len(s.lstrip()) for s in texts if s.strip()), default=0)
    code = []
    for number, line in enumerate(shown, start=first):
        start = found.column - 1 if number == found.lineno else 0
        end = found.end_column - 1 if number == found.end_lineno else len(line)
        if not found.lineno <= number <= found.end_lineno:
            start = end = len(line)
        parts = [line[:start], line[start:end], line[end:]]
        before, inside, behind = (part.decode("utf-8", "replace") for part in parts)
        if number != found.lineno and inside.strip():
            # The indentation of a condition's further lines is not marked.
            blank = len(inside) - len(inside.lstrip())
            before, inside = inside[:blank], inside[blank:]
        code.append(CodeLine(number, before[indent:], inside, behind.rstrip()))
    return code


def _summary(static: StaticInfo, found: Sequence[Details]) -> list[tuple[str, str]]:
    parameters = {each.tpc.parameter for each in found if each.tpc.parameter}
    keys = sum(len(each.tpc.keys) for each in found)
    return [
        ("Comparisons", f"{len(found):,}" + (f" ({keys:,} keys)" if keys != len(found) else "")),
        ("Parameters", f"{len(parameters):,}"),
        ("Source files", f"{len({each.tpc.file for each in found}):,}"),
        ("Link units", f"{len(static.units):,}"),
        ("Packages", f"{len({unit.package for unit in static.units}):,}"),
    ]
