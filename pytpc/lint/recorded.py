"""What recordings of the robot say of its parameters: changes without effect, idle thresholds."""

from __future__ import annotations

import math
from collections.abc import Iterator

from pytpc.base.wording import many, plain, show, shown_value
from pytpc.lint.facts import Facts
from pytpc.lint.finding import Evidence, Finding, Spot


def without_effect(facts: Facts) -> Iterator[Finding]:
    """Changes of values that nodes read only while they start."""
    seen = set()
    for change in facts.changes:
        readers = facts.readers(change.name)
        if change.name in seen or not readers or change.old is None or change.new is None:
            continue
        if any(not read.at_start or not read.is_exact for _, read in readers):
            continue
        seen.add(change.name)
        node, read = readers[0]
        setting = facts.by_name.get(change.name)
        text = (
            f"{plain(change.name)} was changed from {shown_value(change.old)} to"
            f" {shown_value(change.new)} while the robot ran; {plain(node.name)} reads it only when"
            " it starts"
        )
        spot = read.spot if setting is None else setting.spot
        places = () if setting is None else (Evidence("read", read.spot),)
        yield Finding("no-effect", "warning", spot, change.name, text, places)


def never_crossed(facts: Facts) -> Iterator[Finding]:
    """Thresholds on one side of which all recordings stayed."""
    for one in facts.crossings:
        setting = facts.by_name.get(one.parameter)
        outcome = "true" if one.result else "false"
        near = "" if math.isnan(one.nearest) else f", at least {show(one.nearest)} away"
        runs = f" in {many(one.recordings, 'recording')}" if one.recordings > 1 else ""
        text = (
            f"{plain(one.parameter)} ({show(one.threshold)}) was never crossed:"
            f" {plain(' '.join(one.source_code.split()))} was {outcome} in all"
            f" {many(one.evaluations, 'evaluation')} over {one.seconds:.0f} s{runs}{near}"
        )
        spot: Spot = one.spot if setting is None else setting.spot
        places = () if setting is None else (Evidence("compared", one.spot),)
        yield Finding("never-crossed", "note", spot, one.parameter, text, places)
