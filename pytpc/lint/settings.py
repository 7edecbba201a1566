"""Values that are set more than once, that are missing, or that have an old name."""

from __future__ import annotations

import re
from collections.abc import Iterator

from pytpc.base.wording import plain, shown_value
from pytpc.lint.facts import Earlier, Facts, NodeRead, Renamed, Setting, last_part
from pytpc.lint.finding import Evidence, Finding, Severity
from pytpc.lint.values import declared_for, spot_of
from pytpc.recording.declaration import Declared

_OLD = re.compile(r"\b(?:deprecated|obsolete)\b", re.IGNORECASE)


def set_twice(facts: Facts) -> Iterator[Finding]:
    """Values that replace others; a key that one YAML map has twice is a warning."""
    for setting in facts.settings:
        if not setting.earlier:
            continue
        twice = any(one.is_same_map for one in setting.earlier)
        same = [one for one in setting.earlier if one.is_known and one.value == setting.value]
        equal = len(same) == len(setting.earlier)
        what = "to the same value" if equal else f"and {shown_value(setting.value)} wins"
        where = " in one map" if twice else ""
        text = f"{plain(setting.name)} is set {_times(setting)}{where}, {what}"
        yield Finding(
            "set-twice",
            "warning" if twice else "note",
            setting.spot,
            setting.name,
            text,
            tuple(Evidence(_earlier_words(one), one.spot) for one in setting.earlier),
        )


def _times(setting: Setting) -> str:
    count = len(setting.earlier) + 1
    return "twice" if count == 2 else f"{count} times"


def _earlier_words(one: Earlier) -> str:
    return f"set to {shown_value(one.value)} before" if one.is_known else "set before"


def unset(facts: Facts) -> Iterator[Finding]:
    """Parameters that a node needs, has no default for, and that nothing sets."""
    seen = set()
    for node in facts.nodes:
        for read in node.reads:
            if not read.needed or not read.is_exact or facts.is_set(read.name):
                continue
            end = read.name.rpartition("/")[2]
            if end in facts.set_by_code or (read.name, read.spot) in seen:
                continue
            # Another read of the same name may have a default.
            if any(not other.needed for other in node.reads if other.name == read.name):
                continue
            seen.add((read.name, read.spot))
            what = "fails without it" if read.needed == "fails" else "reports an error without it"
            text = f"nothing sets {plain(read.name)}, and {plain(node.name)} {what}"
            severity: Severity = "error" if read.needed == "fails" else "warning"
            yield Finding("unset", severity, read.spot, read.name, text)


def deprecated(facts: Facts) -> Iterator[Finding]:
    """Values of parameters that the code, or their declaration, calls deprecated."""
    for setting in facts.settings:
        reads = [read for _, read in facts.readers(setting.name)]
        renamed = _renamed(facts, setting, reads)
        if renamed is not None:
            text = f"{plain(setting.name)} is deprecated; its new name is {plain(renamed.new)}"
            places = (Evidence("the node says so", renamed.spot),)
            yield Finding("deprecated", "warning", setting.spot, setting.name, text, places)
            continue
        declared = _called_old(facts, setting, reads)
        if declared is not None:
            text = f"the declaration of {plain(setting.name)} calls it deprecated"
            places = (Evidence("declared", spot_of(declared.place)),)
            yield Finding("deprecated", "warning", setting.spot, setting.name, text, places)
            continue
        known = [read for read in reads if read.deprecation is not None]
        if known and len(known) == len(reads):
            read = known[0]
            assert read.deprecation is not None
            text = f"the node calls {plain(setting.name)} deprecated"
            both = (Evidence("it says so", read.deprecation), Evidence("read", read.spot))
            yield Finding("deprecated", "warning", setting.spot, setting.name, text, both)


def _renamed(facts: Facts, setting: Setting, reads: list[NodeRead]) -> Renamed | None:
    """The new name of a parameter, if no code but that of old names reads it."""
    end = last_part(setting.name)
    for node in facts.owners(setting.name):
        found = node.renamed.get(end)
        folder = last_part(setting.name.rpartition("/")[0])
        if found is not None and found.namespace not in ("", folder):
            # It is the old name of another plugin's parameter.
            return None
        if found is not None:
            others = [one for one in reads if one.is_exact and one.spot.path != found.reader]
            return None if others else found
    return None


def _called_old(facts: Facts, setting: Setting, reads: list[NodeRead]) -> Declared | None:
    """The declaration of a value that calls it deprecated, if all that could be meant do."""
    fitting = declared_for(facts, setting, reads)
    old = [one for one in fitting if _OLD.search(one.description)]
    return old[0] if old and len(old) == len(fitting) else None
