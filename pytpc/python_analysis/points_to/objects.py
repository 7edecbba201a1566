"""The abstract objects of the points-to analysis."""

from __future__ import annotations

from collections.abc import Hashable, Iterable
from dataclasses import dataclass, field

from pytpc.python_analysis.ir.instructions import ClassInfo, Function, Instr

EVERY = "[+]"
"""The slot that stands for all elements of a container, for reads by an unknown key."""
SOME = "[*]"
"""The slot of the elements at unknown keys."""
UNNAMED = "<unnamed>"
"""The slot of an object's attributes that are set by unknown names."""
ATTRIBUTES = "<attributes>"
"""The slot that stands for all attributes, for reads by an unknown name."""
OTHER = "<other>"
"""The dotted name of everything without a rule."""
_DEEPEST = 2


@dataclass(eq=False, slots=True)
class Obj:
    """An abstract object.

    ``kind``, and the meaning of ``ref`` and ``parent``: ``function`` (Function), ``method``
    (Function, the object), ``class`` (ClassInfo), ``instance`` (ClassInfo), ``module`` (Module),
    ``external`` (by ``path``), ``made`` (by a call of ``path`` outside the sources), ``part`` (an
    attribute of something made: ``path``, the object), ``container``, ``partial`` (the function),
    ``super`` (the ClassInfo after which it looks attributes up, the object), ``namespace`` (an
    object's ``__dict__``: the object). ``site`` is the instruction that makes it.
    """

    kind: str
    number: int
    path: str = ""
    ref: object = None
    parent: Obj | None = None
    site: Instr | None = None
    parts: dict[str, Obj] = field(default_factory=dict)
    slots: dict[str, None] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"<{self.kind} {self.path or self.ref}>"

    @property
    def function(self) -> Function | None:
        """The function that it is or is bound to."""
        return self.ref if isinstance(self.ref, Function) else None

    @property
    def class_info(self) -> ClassInfo | None:
        """The class that it is, or is an instance of."""
        return self.ref if isinstance(self.ref, ClassInfo) else None


Field = tuple[Obj, str]
"""A slot of an object: an attribute by its name, an element by ``[key]``."""


class Heap:
    """Makes each abstract object once."""

    def __init__(self, paths: Iterable[str], tidy: Iterable[str]) -> None:
        """``paths`` are the dotted names that the rules are about, ``tidy`` some of the classes."""
        self._tidy = frozenset(tidy)
        self._known: dict[Hashable, Obj] = {}
        self._about = {"collections.namedtuple"}
        for path in paths:
            parts = path.split(".")
            self._about.update(".".join(parts[:end]) for end in range(1, len(parts) + 1))

    def get(
        self,
        kind: str,
        path: str = "",
        ref: object = None,
        parent: Obj | None = None,
        site: Instr | None = None,
    ) -> Obj:
        """The object with these fields (see `Obj`)."""
        key = (kind, path, id(ref), parent, site)
        if key not in self._known:
            self._known[key] = Obj(kind, len(self._known), path, ref, parent, site)
        return self._known[key]

    def class_(self, info: ClassInfo) -> Obj:
        """A class of the sources."""
        return self.get("class", ref=info)

    def made(self, path: str, site: Instr) -> Obj:
        """The object that a call outside the sources returns at ``site``."""
        return self.get("made", path if path in self._about else OTHER, site=site)

    def container(self, kind: str, site: Instr) -> Obj:
        """A list, tuple, set or dict."""
        return self.get("container", kind, site=site)

    def part(self, owner: Obj, name: str, path: str) -> Obj:
        """The attribute ``name`` of something made outside the sources."""
        depth, above = 0, owner
        while above.kind == "part" and above.parent is not None:
            depth, above = depth + 1, above.parent
        if depth >= _DEEPEST:
            return owner
        full = f"{path}.{name}"
        known = full in self._about or path in self._tidy
        if not known and owner.kind not in ("container", "namespace"):
            full = f"{OTHER}.{name}"
        found = self.get("part", full, parent=owner)
        owner.parts[name] = found
        return found


def element(key: object) -> str:
    """The slot of the element at a constant key."""
    return f"[{key!r}]"
