"""Which comparison of one build is which of another: the same, moved, or changed.

``pytpc.static.other_builds`` finds the keys of the same comparison for a recording, one link unit
at a time, and leaves out what is not clear. Here each place in the source counts once, and a person
reads the answer: what was edited is paired with what became of it.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass
from difflib import SequenceMatcher

from pytpc.static.compared_text import without_name, without_space
from pytpc.static.link_unit import Comparison, Default, LinkUnit
from pytpc.static.places import Tpc
from pytpc.static.static_info import StaticInfo

# Two lines that have less in common are not one line that was edited. Where another parameter is
# compared, or in another function, more must be the same.
_ALIKE, _MORE_ALIKE = 0.5, 0.7
_LONGEST = 300
_MOST_PAIRS, _FEW = 20_000, 100
_PARAMETERS = re.compile(r"\)[^()]*$")


@dataclass(frozen=True)
class Site:
    """A comparison in the source of one build.

    ``nearest`` is that of the link unit in which its exposing statement is nearest, ``unit`` this
    link unit. ``defaults``, ``topics`` and ``transforms`` are those of all its link units that both
    builds have, each once.
    """

    tpc: Tpc
    nearest: Comparison
    unit: LinkUnit
    defaults: tuple[Default, ...]
    topics: tuple[str, ...]
    transforms: tuple[str, ...]

    @property
    def threshold(self) -> str:
        """The parameter, or the constant."""
        return self.tpc.parameter or self.tpc.name or "?"

    @property
    def distance(self) -> int:
        """The distance in the nearest link unit that both builds have."""
        return self.nearest.distance

    @property
    def text(self) -> str:
        """The source line, as it is compared."""
        return without_space(self.nearest.source_code)

    @property
    def shape(self) -> str:
        """The source line without the name of the threshold."""
        return without_name(self.text, self.nearest.name)

    @property
    def function(self) -> str:
        """The qualified name of the function, without its parameters."""
        return function_name(self.nearest.function)

    @property
    def source_line(self) -> str:
        """The source line, else what is compared."""
        found = self.nearest
        return found.source_code or f"{found.relation} {found.name or self.threshold}"


def function_name(signature: str) -> str:
    """A function without its parameters.

    >>> function_name("a::B<int (*)()>::f(int, g(x)) const"), function_name("a.b")
    ('a::B<int (*)()>::f', 'a.b')
    """
    end = _PARAMETERS.search(signature)
    if end is None:
        return signature
    depth = 0
    for place in range(end.start(), -1, -1):
        depth += (signature[place] == ")") - (signature[place] == "(")
        if depth == 0:
            return signature[:place]
    return signature


def sites_of(
    static: StaticInfo, *, constants: bool = False, shared: Collection[str] = ()
) -> list[Site]:
    """The comparisons of a build in the order of their places.

    Args:
        static: the build.
        constants: whether those with constants count.
        shared: the link units (``package/name``) that the other build has, too. Of a place that is
            in one of them, only these say what it is: what other units add is no change of it.
    """
    wanted = (tpc for tpc in static.tpcs if constants or tpc.type != "constant")
    return [_site(static, tpc, shared) for tpc in wanted]


def _site(static: StaticInfo, tpc: Tpc, shared: Collection[str]) -> Site:
    keys = [key for key in tpc.keys if f"{key.package}/{key.link_unit}" in shared] or tpc.keys
    every = [static.comparisons[key.key] for key in keys]
    return Site(
        tpc=tpc,
        nearest=every[0],
        unit=static.unit_of(keys[0].key),
        # 1, 1.0 and True are equal and not the same.
        defaults=tuple(sorted({repr(o.default): o.default for o in every}.values(), key=repr)),
        topics=tuple(sorted({one.topic for one in every if one.topic is not None})),
        transforms=tuple(sorted({o.transform.text for o in every if o.transform is not None})),
    )


def matched(old: Sequence[Site], new: Sequence[Site]) -> list[tuple[Site, Site]]:
    """Pairs of an old and a new site that are one comparison; each site is in one pair at most.

    First those that say the same, wherever they are now: in the same function, then in the same
    file, then in another one. Then those that were edited, by how much their lines have in common.
    """
    found: list[tuple[Site, Site]] = []
    left, free = list(old), list(new)
    for place in _SAME:
        pairs = list(_in_order(left, free, place))
        found += pairs
        left, free = _rest(left, free, pairs)
    for place, alike in _EDITED:
        pairs = _by_text(left, free, place, alike)
        found += pairs
        left, free = _rest(left, free, pairs)
    return sorted(found, key=lambda pair: _order(pair[1]))


_Place = Callable[[Site], tuple[object, ...]]


def _says(one: Site) -> tuple[object, ...]:
    return one.threshold, one.tpc.type, one.tpc.relation, one.text


def _file(one: Site) -> tuple[object, ...]:
    return one.tpc.package, one.tpc.place


_SAME: tuple[_Place, ...] = (
    lambda one: (*_file(one), one.function, *_says(one), one.tpc.lineno, one.tpc.column),
    lambda one: (*_file(one), one.function, *_says(one)),
    lambda one: (*_file(one), *_says(one)),
    lambda one: (one.tpc.package, one.function, *_says(one)),
    lambda one: (one.function, *_says(one)),
    lambda one: (one.tpc.package, *_says(one)) if one.nearest.source_code else (id(one),),
)
_EDITED: tuple[tuple[_Place, float], ...] = (
    (lambda one: (*_file(one), one.function, one.threshold, one.tpc.relation), _ALIKE),
    (lambda one: (*_file(one), one.function, one.threshold), _ALIKE),
    (lambda one: (*_file(one), one.threshold), _MORE_ALIKE),
    (lambda one: (*_file(one), one.function), _MORE_ALIKE),
    (lambda one: (one.tpc.package, one.function, one.threshold), _MORE_ALIKE),
)


def _order(one: Site) -> tuple[object, ...]:
    tpc = one.tpc
    return tpc.package, tpc.place, tpc.lineno, tpc.column, one.threshold, tpc.type, tpc.relation


def _grouped(every: Iterable[Site], place: _Place) -> dict[tuple[object, ...], list[Site]]:
    groups = defaultdict(list)
    for one in sorted(every, key=_order):
        groups[place(one)].append(one)
    return groups


def _in_order(
    old: Sequence[Site], new: Sequence[Site], place: _Place
) -> Iterator[tuple[Site, Site]]:
    """Those that are equal, the first with the first; of too many, the last stay alone."""
    free = _grouped(new, place)
    for alike, left in _grouped(old, place).items():
        yield from zip(left, free.get(alike, ()), strict=False)


def _by_text(
    old: Sequence[Site], new: Sequence[Site], place: _Place, least: float
) -> list[tuple[Site, Site]]:
    """Those whose lines have most in common, and at least ``least``; equal ones in their order."""
    free, found = _grouped(new, place), []
    for where, every in _grouped(old, place).items():
        left, others = every, free.get(where, [])
        if len(left) * len(others) > _MOST_PAIRS:
            # Generated code: to compare each with each would take minutes.
            left, others = left[:_FEW], others[:_FEW]
        scored = [
            (-alike, abs(n - m), n, m)
            for n, one in enumerate(left)
            for m, other in enumerate(others)
            if (alike := _alike(one, other)) >= least
        ]
        taken_old, taken_new = set[int](), set[int]()
        for _, _, n, m in sorted(scored):
            if n not in taken_old and m not in taken_new:
                taken_old.add(n)
                taken_new.add(m)
                found.append((left[n], others[m]))
    return found


def _alike(one: Site, other: Site) -> float:
    """How much two lines have in common: 1 of equal ones, 0 if either is not known.

    If the operator or the parameter differs, the threshold's name does not count: any line with it
    would be alike. Of a flag it is all there is.
    """
    by_shape = one.tpc.relation != other.tpc.relation or one.threshold != other.threshold
    if "flag" in (one.tpc.relation, other.tpc.relation):
        by_shape = False
    texts = [site.shape if by_shape else site.text for site in (one, other)]
    if not all(texts):
        return 0.0
    first, second = (text[:_LONGEST] for text in texts)
    return SequenceMatcher(None, first, second, autojunk=False).ratio()


def _rest(
    old: Sequence[Site], new: Sequence[Site], pairs: Iterable[tuple[Site, Site]]
) -> tuple[list[Site], list[Site]]:
    taken = {id(one) for pair in pairs for one in pair}
    return [one for one in old if id(one) not in taken], [o for o in new if id(o) not in taken]
