"""Limits that contradict each other: a minimum above the maximum of the same name."""

from __future__ import annotations

import re
from collections.abc import Iterator

from pytpc.base.wording import plain, show
from pytpc.lint.facts import Facts, Node, NodeRead, Setting, namespace, own_part
from pytpc.lint.finding import Evidence, Finding, Spot

_PAIRS = {
    "min": "max",
    "minimum": "maximum",
    "low": "high",
    "lower": "upper",
    "lowest": "highest",
    "smallest": "largest",
    "floor": "ceiling",
}
_WORDS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|[0-9]+")
# Words behind which a lower number is the stricter one, so that either order makes sense.
_NEITHER = frozenset({"threshold", "priority", "level", "frequency", "pass"})
_Limit = tuple[float, Spot | None]


def contradicting(facts: Facts) -> Iterator[Finding]:
    """Pairs of limits in one namespace of which both are known and the lower one is higher."""
    for setting in facts.settings:
        for lower, upper in _names(own_part(setting.name)):
            yield from _checked(facts, setting, lower, upper)


def _names(name: str) -> Iterator[tuple[str, str]]:
    """The names of a lower limit and its upper one, of which ``name`` is one.

    >>> list(_names("min_vel_x")), list(_names("rangeMax")), list(_names("minutes"))
    ([('min_vel_x', 'max_vel_x')], [('rangeMin', 'rangeMax')], [])
    """
    words = list(_WORDS.finditer(name))
    if any(word[0].lower() in _NEITHER for word in words):
        return
    for word in words:
        text = word[0].lower()
        for low, high in _PAIRS.items():
            if text in (low, high):
                other = high if text == low else low
                changed = name[: word.start()] + _as(other, word[0]) + name[word.end() :]
                yield (name, changed) if text == low else (changed, name)


def _as(word: str, model: str) -> str:
    """A word in capitals as another one is.

    >>> _as("max", "Min"), _as("max", "MIN")
    ('Max', 'MAX')
    """
    if model.isupper() and len(model) > 1:
        return word.upper()
    return word.capitalize() if model[0].isupper() else word


def _checked(facts: Facts, setting: Setting, lower: str, upper: str) -> Iterator[Finding]:
    whole = setting.name[: len(setting.name) - len(own_part(setting.name))]
    names = whole + lower, whole + upper
    low, high = (_limit(facts, name) for name in names)
    if low is None or high is None or not low[0] > high[0] or _is_none(low[0], high[0]):
        return
    # Where both are set, the lower one has the finding.
    other = names[1] if setting.name == names[0] else names[0]
    if setting.name == names[1] and names[0] in facts.by_name:
        return
    text = (
        f"{plain(names[0])} is {show(low[0])}, above {plain(own_part(names[1]))},"
        f" which is {show(high[0])}"
    )
    spot = (high if other == names[1] else low)[1]
    what = "set" if other in facts.by_name else "default"
    places = () if spot is None else (Evidence(f"{plain(own_part(other))}: {what}", spot),)
    yield Finding("limits", "warning", setting.spot, setting.name, text, places)


def _is_none(low: float, high: float) -> bool:
    """Whether an upper limit means that there is none: -1, or 0 where all is above it."""
    return high <= 0 <= low


def _limit(facts: Facts, name: str) -> _Limit | None:
    """The value that is set, or else the default of the only read; with its place."""
    setting = facts.by_name.get(name)
    if setting is not None:
        value = setting.value
        is_number = isinstance(value, int | float) and _is_number(value)
        return (float(str(value)), setting.spot) if is_number else None
    reads = [read for node in _near(facts, name) for read in node.reads_of(name)]
    return _default(reads)


def _near(facts: Facts, name: str) -> list[Node]:
    owners = facts.owners(name)
    return owners or [node for node in facts.nodes if node.name.startswith(f"{namespace(name)}/")]


def _default(reads: list[NodeRead]) -> _Limit | None:
    """The default that all reads agree on; a name that is known in part may be another one's."""
    defaults = [read.default for read in reads]
    numbers = [float(one) for one in defaults if isinstance(one, int | float) and _is_number(one)]
    if not numbers or len(numbers) != len(defaults) or len(set(numbers)) != 1:
        return None
    return numbers[0], reads[0].spot


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)
