"""Whether the reports of a node say what its list says: that there are some, values and results."""

from __future__ import annotations

import json
import operator
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from pytpc.recording.events import Events
from pytpc.static.link_unit import LinkUnit
from suite.expectations import differences, load

RELATIONS = {
    **{"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge},
    **{"==": operator.eq, "!=": operator.ne},
}


def raw(node: str, package: Path) -> dict[str, Any]:
    """A node's list as it stands in its file."""
    data: dict[str, Any] = json.loads((package / f"nodes/{node}.json").read_text("utf-8"))
    return data


def not_as_listed(events: Events, unit: LinkUnit, package: Path) -> Iterator[str]:
    """What the reports of a node's comparisons are not as its list says.

    Comparisons that the analysis does not find are left out: that is the verdict's to say.
    """
    rows = defaultdict(list)
    for at, key in enumerate(events.key):
        rows[events.keys[key]].append(at)
    items = raw(unit.link_unit, package)["expect"]
    for entry, item in zip(load(unit.link_unit, package).expect, items, strict=True):
        found = next((each for each in unit.comparisons if not differences(entry, each)), None)
        if found is None or not item.get("evaluated", True):
            continue
        mine = rows[found.key]
        if not mine:
            yield f"{entry} reports nothing"
        if "threshold" not in item:
            continue
        holds = RELATIONS[found.relation]
        for at in mine:
            sample, threshold = float(events.cmp[at]), float(events.thresh[at])
            if threshold != pytest.approx(item["threshold"], rel=1e-12):
                yield f"{entry} reports {threshold}"
            if bool(events.result[at]) != holds(sample, threshold):
                yield f"{entry}: {sample} with {threshold} is {events.result[at]}"
