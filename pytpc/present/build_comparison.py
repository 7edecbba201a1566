"""What differs between two builds: for a terminal, and as JSON."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rich.console import Console
from rich.text import Text

from pytpc.base.wording import listed, many, plain
from pytpc.static.budget import Verdict, place_of
from pytpc.static.build_changes import (
    BuildChanges,
    ComparisonChange,
    SpotChange,
    Status,
    spots_by_kind,
    words_of,
)
from pytpc.static.edits import Edit
from pytpc.static.matching import Site
from pytpc.static.parameter_changes import KINDS, ParameterChange

Json = dict[str, object]

_STYLES: dict[Status, str] = {"new": "green", "gone": "red", "changed": "yellow"}
_SIGNS: dict[Status, str] = {"new": "+", "gone": "-", "changed": "~", "moved": ">", "same": " "}
_TITLES: dict[Status, str] = {
    "new": "New comparisons",
    "gone": "Comparisons that are gone",
    "changed": "Changed comparisons",
    "moved": "Moved comparisons",
    "same": "Unchanged comparisons",
}
_SPOTS, _NAMED = 10, 5


def print_build_changes(out: Console, found: BuildChanges, *, everything: bool = False) -> None:
    """Print what differs between two builds.

    Args:
        out: where to.
        found: the differences.
        everything: whether moved comparisons, other distances and all blind spots are listed.
    """
    for line in _lines(found, everything):
        out.print(line, highlight=False, soft_wrap=True)


def _lines(found: BuildChanges, everything: bool) -> Iterator[Text]:
    for warning in warnings_of(found):
        yield Text(plain(warning), style="yellow")
    yield Text(plain(summary_of(found)), style="bold")
    shown: list[Status] = ["new", "gone", "changed", *(["moved"] if everything else [])]  # type: ignore[list-item]
    for status in shown:
        every = found.of(status)
        if every:
            yield Text("")
            yield Text(f"{_TITLES[status]} ({len(every):,})", style="bold")
        for one in every:
            yield from _comparison(one)
    yield from _rerouted(found)
    if found.farther and everything:
        yield Text("")
        yield Text(f"Only another distance ({len(found.farther):,})", style="bold")
        for one in found.farther:
            yield _line(" ", "", f"{one.site.threshold}  {place_of(one)}  {_distance(one)}")
    if found.parameters:
        yield Text("")
        yield Text(f"Parameters ({len(found.parameters):,})", style="bold")
        for parameter in found.parameters:
            yield from _parameter(parameter)
    yield from _spots(found, everything)


def _rerouted(found: BuildChanges) -> Iterator[Text]:
    if not found.rerouted:
        return
    yield Text("")
    yield Text("Unchanged, but what shows the outcome first is another topic", style="bold")
    for line in rerouted_texts(found):
        yield _line(" ", "", line)


def rerouted_texts(found: BuildChanges) -> list[str]:
    """For each pair of topics how many comparisons have them now, and their parameters."""
    told = []
    for edit, every in found.rerouted.items():
        names = list(dict.fromkeys(one.site.threshold for one in every))
        which = f"{many(len(every), 'comparison')} with {listed(names, _NAMED)}"
        told.append(f"{edit.old} -> {edit.new}: {which}")
    return told


def _spots(found: BuildChanges, everything: bool) -> Iterator[Text]:
    if not found.spots:
        return
    yield Text("")
    kinds = listed(spots_by_kind(found.spots), _NAMED)
    yield Text(plain(f"New blind spots ({len(found.spots):,}): {kinds}"), style="bold")
    shown = found.spots if everything else [o for o in found.spots if o.spot.parameter][:_SPOTS]
    for one in shown:
        yield _line(" ", "", spot_text(one))
    if len(shown) < len(found.spots):
        yield Text(f"  {len(found.spots) - len(shown):,} more: --all lists them", style="dim")


def _comparison(one: ComparisonChange) -> Iterator[Text]:
    site, style = one.site, _STYLES.get(one.status, "")
    was = f" (was {place_of(_older(one))})" if _is_elsewhere(one) else ""
    head = f"{site.threshold}  {place_of(one)}{was}  {' '.join(site.source_line.split())}"
    yield _line(_SIGNS[one.status], style, head)
    for line in remarks_of(one):
        yield Text(plain(f"      {line}"))


def remarks_of(one: ComparisonChange) -> list[str]:
    """What is to be said below a comparison: its edits, and what makes it special."""
    said = [edit_text(edit) for edit in one.edits]
    if one.status == "changed" and one.distances is not None:
        said.append(_distance(one))
    if one.status == "new":
        said.append(_facts(one.site))
    if one.has_new_parameter and not one.is_declared:
        said.append("nothing declares this parameter: no default, no .cfg file")
    if one.is_unbuilt:
        said.append(f"NEW does not have {listed(one.missing, _NAMED)}")
    return said


def edit_text(edit: Edit) -> str:
    """``operator: > -> >=``."""
    return f"{edit.what}: {edit.old} -> {edit.new}"


def _facts(site: Site) -> str:
    topics = listed(site.topics, _NAMED) or "unknown topic"
    return f"{site.tpc.type}, distance {site.tpc.distance}, exposed as {topics}"


def _distance(one: ComparisonChange) -> str:
    both = one.distances or (0, 0)
    return f"distance: {both[0]} -> {both[1]}"


def _older(one: ComparisonChange) -> ComparisonChange:
    return ComparisonChange("gone", one.old, None)


def _is_elsewhere(one: ComparisonChange) -> bool:
    return one.new is not None and one.old is not None and place_of(one) != place_of(_older(one))


def _parameter(one: ParameterChange) -> Iterator[Text]:
    yield _line(" ", "", f"{one.parameter}  {one.package}: {parameter_text(one)}")
    if one.places:
        what = "declared" if one.kind == "declared" else "read"
        yield Text(plain(f"      {what} at {listed(one.places, _NAMED)}"))


def parameter_text(one: ParameterChange) -> str:
    """What became of a parameter, in one phrase."""
    title = KINDS[one.kind]
    if one.kind == "renamed":
        return f"{title} from {one.old}: {one.why}"
    if one.kind == "uncompared":
        why = f": {one.why}" if one.why else ""
        return f"{title}; now {one.new}{why}"
    if one.kind in ("new", "gone"):
        unbuilt = "; its link units are missing" if one.is_unbuilt else ""
        return f"{title} ({one.new or one.old}){unbuilt}"
    if not one.old or not one.new:
        return (
            f"a .cfg file declares it {'only now' if one.new else 'no more'}: {one.new or one.old}"
        )
    return f"{title}: {one.old} -> {one.new}"


def spot_text(one: SpotChange) -> str:
    """A blind spot: its parameter, place, kind and what happens there."""
    spot = one.spot
    name = f"{spot.parameter}  " if spot.parameter else ""
    return f"{name}{spot.file}:{spot.lineno} in {one.unit}  {spot.kind}: {spot.what}"


def _line(sign: str, style: str, text: str) -> Text:
    return Text(plain(f"  {sign} {text}"), style=style)


def warnings_of(found: BuildChanges) -> list[str]:
    """What must be known before anything else: link units that are not there, other analyses."""
    said = []
    if found.missing:
        gone = sum(1 for one in found.comparisons if one.is_unbuilt)
        said.append(
            f"NEW does not have {many(len(found.missing), 'link unit')} of OLD:"
            f" {listed(found.missing, _NAMED)}; {many(gone, 'comparison')} of them"
            " may only not have been built"
        )
    said += found.unanalysed
    said += [f"{old} is now called {new}" for old, new in found.renamed]
    if found.added:
        said.append(f"only NEW has {listed(found.added, _NAMED)}")
    return [*said, *found.notes]


def summary_of(found: BuildChanges) -> str:
    """The counts, in one line."""
    if found.is_same and not found.counts["moved"]:
        return f"{many(found.counts['same'], 'comparison')}, none changed"
    farther = f"; {len(found.farther):,} only with another distance" if found.farther else ""
    return f"{words_of(found.counts)}{farther}"


def build_changes_json(found: BuildChanges, judged: Sequence[Verdict] = ()) -> Json:
    """The document of ``compare --json`` for two builds."""
    return {
        "kind": "builds",
        "missing_units": found.missing,
        "new_units": found.added,
        "renamed_units": [{"old": old, "new": new} for old, new in found.renamed],
        "unanalysed": found.unanalysed,
        "notes": found.notes,
        "counts": dict(found.counts),
        "comparisons": [
            _comparison_json(o) for o in found.comparisons if o.status != "same" or o.edits
        ],
        "parameters": [
            {
                "kind": one.kind,
                "package": one.package,
                "parameter": one.parameter,
                "old": one.old,
                "new": one.new,
                "why": one.why,
                "places": one.places,
                "is_unbuilt": one.is_unbuilt,
            }
            for one in found.parameters
        ],
        "blind_spots": [_spot_json(one) for one in found.spots],
        "closed_blind_spots": found.closed,
        "rules": [
            {
                "rule": one.rule,
                "is_asked": one.is_asked,
                "is_broken": one.is_broken,
                "most": one.most,
                "found": len(one.findings),
            }
            for one in judged
        ],
    }


def _spot_json(one: SpotChange) -> Json:
    spot = one.spot
    return {
        "unit": one.unit,
        "kind": spot.kind,
        "parameter": spot.parameter,
        "file": spot.file,
        "lineno": spot.lineno,
        "what": spot.what,
    }


def _comparison_json(one: ComparisonChange) -> Json:
    return {
        "status": one.status,
        "parameter": one.site.tpc.parameter,
        "constant": one.site.tpc.name,
        "edits": [{"what": each.what, "old": each.old, "new": each.new} for each in one.edits],
        "missing_units": one.missing,
        "is_declared": one.is_declared,
        "old": None if one.old is None else _site_json(one.old),
        "new": None if one.new is None else _site_json(one.new),
    }


def _site_json(site: Site) -> Json:
    tpc = site.tpc
    return {
        "parameter": tpc.parameter,
        "package": tpc.package,
        "place": tpc.place,
        "lineno": tpc.lineno,
        "column": tpc.column,
        "function": site.nearest.function,
        "source_code": site.nearest.source_code,
        "type": tpc.type,
        "relation": tpc.relation,
        "distance": tpc.distance,
        "defaults": site.defaults,
        "topics": site.topics,
        "keys": [key.key for key in tpc.keys],
        "units": tpc.link_units,
    }
