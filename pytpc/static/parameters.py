"""Names of parameters, as the static analysis knows them and as users give them."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Iterable
from typing import Generic, TypeVar

from pytpc.static.link_unit import Comparison

Named = TypeVar("Named")

DYNAMIC = "<dynamic>"
"""Replaces the part of a name that only the running node knows."""

INSTANCE = "#"
"""Stands between a key and the number of an instance: one of several objects of a class."""

_NUMBER = re.compile(rf"{INSTANCE}([0-9]{{1,9}})\Z")
_OBJECT = re.compile(r" \((?:object [0-9]+|further objects)\)$")


def base_key(key: str) -> str:
    """The key of a comparison in the source, whichever object evaluated it."""
    return _NUMBER.sub("", key)


def instance_number(key: str) -> int | None:
    """The number of the instance with this key; None for the key of the source.

    >>> instance_number("6f1e#2"), instance_number("6f1e"), instance_number("6f1e#b")
    (2, None, None)
    """
    found = _NUMBER.search(key)
    return int(found[1]) if found else None


def of_instance(source: str, key: str) -> str:
    """The name of a parameter that the instance of ``key`` has read, if no node has said it.

    >>> of_instance("<dynamic>/radius", "6f1e#2"), of_instance("~radius", "6f1e#2")
    ('<dynamic>/radius (object 2)', '~radius')
    """
    number = instance_number(key)
    if number is None or DYNAMIC not in source:
        return source
    which = f"object {number}" if number else "further objects"
    return f"{without_object(source)} ({which})"


def without_object(name: str) -> str:
    """The name of a parameter in the source, whichever object has read it.

    >>> without_object("<dynamic>/radius (object 2)")
    '<dynamic>/radius'
    """
    return _OBJECT.sub("", name)


def same_parameter(given: str, source: str) -> bool:
    """Whether the name ``given`` by a person means the parameter ``source`` of the program.

    The namespace of the node may be left out: ``limit``, ``~limit`` and ``/node/limit`` all mean
    ``~limit``, and ``limit`` means ``/node/arm/limit``. A part that the analysis does not know
    matches anything; a name that is wholly unknown matches only itself.
    """
    if given != source:
        source = without_object(source)
    known = _relative(source.removeprefix(f"{DYNAMIC}/"))
    if given == source or DYNAMIC in (known, given):
        return given == source
    if source.startswith("/") and not given.startswith("/") and DYNAMIC not in source:
        return f"/{known}".endswith(f"/{_relative(given)}")
    pattern = ".+".join(re.escape(part) for part in known.split(DYNAMIC))
    before = "(?:.*/)?" if given.startswith("/") and not source.startswith("/") else ""
    return re.fullmatch(before + pattern, _relative(given)) is not None


def meant_by(given: str, names: Iterable[str]) -> list[str]:
    """The names in the source that a person may mean: `same_parameter`, else those that end so.

    >>> meant_by("limit", ["~limit", "~arm/limit"]), meant_by("limit", ["~arm/limit", "~rate"])
    (['~limit'], ['~arm/limit'])
    """
    known = list(names)
    same = [name for name in known if same_parameter(given, name)]
    if same or given.startswith("/"):
        return same
    end = f"/{_relative(given)}"
    return [name for name in known if without_object(name).endswith(end)]


class ByParameter(Generic[Named]):
    """Finds the items whose parameter a name means, in a time that does not grow with all of them.

    A robot has thousands of parameters, and each may mean any of hundreds in the source.
    """

    def __init__(self, items: Iterable[Named], source_of: Callable[[Named], str]) -> None:
        self._source_of = source_of
        self._found: dict[str, list[Named]] = {}
        self._by_end: defaultdict[str, list[tuple[int, Named]]] = defaultdict(list)
        for place, item in enumerate(items):
            end = _end(source_of(item))
            self._by_end["" if DYNAMIC in end else end].append((place, item))

    def meant(self, given: str) -> list[Named]:
        """Those for which `same_parameter` holds, in their order."""
        if given not in self._found:
            # Below "" are those whose last part only the running node knows.
            ends = {_end(given), ""}
            near = sorted((one for end in ends for one in self._by_end.get(end, ())), key=_place)
            self._found[given] = [
                item for _, item in near if same_parameter(given, self._source_of(item))
            ]
        return self._found[given]


def _place(one: tuple[int, object]) -> int:
    return one[0]


def _end(name: str) -> str:
    return without_object(name).rpartition("/")[2].lstrip("~")


def resolved(source: str, node: str) -> str:
    """The full name of a parameter that a node calls ``source``.

    >>> resolved("~limit", "/ns/mission"), resolved("limit", "/ns/mission"), resolved("/a", "/m")
    ('/ns/mission/limit', '/ns/limit', '/a')
    """
    if source.startswith("/"):
        return source
    if source.startswith("~"):
        return f"{node}/{source.lstrip('~/')}"
    return f"{node.rpartition('/')[0]}/{source}"


def parameter_name(comparison: Comparison) -> str:
    """The parameter's name in the source, or where it is read, if only the running node knows.

    A constant has its own name, and its place.
    """
    if comparison.source is None or comparison.read_at is None:
        return f"constant {comparison.name} at {comparison.file}:{comparison.lineno}"
    source = comparison.source
    if without_object(source) != DYNAMIC:
        return source
    read = comparison.read_at
    return f"{DYNAMIC} at {read.file}:{read.lineno}{source.removeprefix(DYNAMIC)}"


def _relative(name: str) -> str:
    return name.lstrip("~/")
