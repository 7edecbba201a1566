"""What was edited about a comparison, of which an older and a newer build have a version each."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from pytpc.base.wording import listed
from pytpc.static.compared_text import MIRRORED, is_negated, only_comparison, sides
from pytpc.static.matching import Site
from pytpc.static.parameter_changes import other_defaults

What = Literal[
    "parameter", "operator", "side", "compared value", "condition", "type", "arithmetic",
    "default", "topic",
]  # fmt: skip
_NAMED = 4


@dataclass(frozen=True, slots=True)
class Edit:
    """One thing that is different about a comparison, and how it was and is."""

    what: What
    old: str
    new: str


def edits_of(old: Site, new: Site) -> Iterator[Edit]:
    """What differs between two versions of a comparison, but for its place and what exposes it."""
    if old.threshold != new.threshold:
        yield Edit("parameter", old.threshold, new.threshold)
    if old.tpc.relation == new.tpc.relation:
        yield from _text_edits(old, new)
    else:
        yield _relation_edit(old, new)
    if old.tpc.type != new.tpc.type and "flag" not in (old.tpc.type, new.tpc.type):
        yield Edit("type", old.tpc.type, new.tpc.type)
    if old.transforms != new.transforms:
        told = [listed(one.transforms, _NAMED) or "as it is" for one in (old, new)]
        yield Edit("arithmetic", *told)
    defaults = other_defaults(old.defaults, new.defaults)
    if defaults is not None:
        yield Edit("default", *defaults)


def topic_edit(old: Site, new: Site) -> tuple[Edit, ...]:
    """The topics on which the outcome shows first, if they differ.

    By itself that is no edit: a publish that somebody adds elsewhere may be nearer.
    """
    if old.topics == new.topics:
        return ()
    told = [listed(one.topics, _NAMED) or "unknown" for one in (old, new)]
    return (Edit("topic", *told),)


def _relation_edit(old: Site, new: Site) -> Edit:
    """The operator, with the parameter on its right-hand side; or that the sides are exchanged."""
    before, after = old.tpc.relation, new.tpc.relation
    if MIRRORED.get(before) == after and before != after:
        both = [sides(o.nearest.source_code, o.nearest.name, o.tpc.relation) for o in (old, new)]
        one, other = both
        if one is not None and other is not None and one.written == other.written:
            texts = [
                f"{s.compared} {o.tpc.relation} {s.threshold}"
                for s, o in ((one, old), (other, new))
            ]
            return Edit("side", *texts)
    return Edit("operator", before, after)


def _text_edits(old: Site, new: Site) -> Iterator[Edit]:
    """What the lines say of the other side of the comparison.

    The threshold's own side does not count: its parameter, default and arithmetic do. If the line
    does not tell the sides, both do; if it does not tell the comparison, the whole of it does.
    """
    if old.text == new.text:
        return
    lines = [(one.nearest.source_code, one.nearest.name) for one in (old, new)]
    if old.tpc.relation == "flag":
        negated = [is_negated(*line) for line in lines]
        if None not in negated:
            if negated[0] != negated[1]:
                words = ["not the parameter" if one else "the parameter" for one in negated]
                yield Edit("operator", *words)
            return
    one, other = (sides(*line, old.tpc.relation) for line in lines)
    if one is None or other is None:
        whole = [only_comparison(line, old.tpc.relation) for line, _ in lines]
        if whole[0] is None or whole[0] != whole[1]:
            yield Edit("condition", old.source_line.strip(), new.source_line.strip())
    elif one.compared != other.compared:
        yield Edit("compared value", one.compared, other.compared)
