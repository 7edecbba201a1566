"""Values that are set more than once, that are missing, or that have an old name."""

from __future__ import annotations

from collections.abc import Iterator

from pytpc.base.wording import plain, shown_value
from pytpc.lint.facts import Earlier, Facts, Setting
from pytpc.lint.finding import Evidence, Finding, Severity


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
        known = [read for read in reads if read.deprecation is not None]
        if known and len(known) == len(reads):
            read = known[0]
            assert read.deprecation is not None
            text = f"the node calls {plain(setting.name)} deprecated"
            places = (Evidence("it says so", read.deprecation), Evidence("read", read.spot))
            yield Finding("deprecated", "warning", setting.spot, setting.name, text, places)
