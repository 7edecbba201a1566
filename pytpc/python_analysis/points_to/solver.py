"""The solver of the points-to analysis: objects spread over copies until nothing changes."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Hashable, Iterable

from pytpc.python_analysis.ir.instructions import ANY, Instr
from pytpc.python_analysis.points_to.objects import (
    ATTRIBUTES,
    EVERY,
    SOME,
    UNNAMED,
    Field,
    Obj,
    element,
)

Node = Hashable
"""An Instr, a Variable, or a Field."""
_MOST = 32
"""With more objects than this, a value's containers and library objects are ignored."""
_MOST_OWN = 128
"""No value has more objects than this, nor than the above once the steps are used up."""


class Solver:
    """The objects of each value, and the copies between values.

    ``succ`` and ``pred``: from an Instr, Variable or Field to those that may have its value.
    ``writers``: the instructions that write a field. ``given_up``: values with unknown objects,
    because there were too many objects or steps. ``spread``: a value, and the call that makes its
    entries those of another dict, or attributes.
    """

    def __init__(self, steps: int) -> None:
        """After ``steps`` follow only own objects and functions, after twice as many nothing."""
        self.given_up: set[Node] = set()
        self.succ: dict[Node, dict[Node, None]] = {}
        self.pred: dict[Node, dict[Node, None]] = {}
        self.writers: dict[Field, dict[Instr, None]] = {}
        self.spread: set[tuple[Node, Instr]] = set()
        self._readers: dict[Obj, dict[Instr, None]] = {}
        self._unbound: set[tuple[Node, Node]] = set()
        self._objects: dict[Node, dict[Obj, None]] = {}
        self._waiting: deque[Node] = deque()
        self._new: dict[Node, list[Obj]] = {}
        self._when: dict[Node, list[Callable[[Obj], None]]] = {}
        self._left = self._left_late = steps

    def of(self, node: Node) -> Iterable[Obj]:
        """The objects that a value may be, in a fixed order."""
        return self._objects.get(node, {}).keys()

    def add(self, node: Node, found: Iterable[Obj]) -> None:
        """``node`` may be each of ``found``."""
        known = self._objects.setdefault(node, {})
        new = [each for each in found if each not in known]
        self._left -= 1
        if new and (len(known) > _MOST or self._left < 0):
            # Too many: from now on ignore objects that only hold or return others.
            self.given_up.add(node)
            kept = () if self._left < -self._left_late else ("instance", "function", "method")
            new = [each for each in new if each.kind in kept]
        room = (_MOST_OWN if self._left >= 0 else _MOST) - len(known)
        if len(new) > room:
            self.given_up.add(node)
            new = new[: max(room, 0)]
        if new:
            known.update(dict.fromkeys(new))
            if node in self._new:
                self._new[node] += new
            else:
                self._new[node] = new
                self._waiting.append(node)

    def copy(self, source: Node, to: Node) -> None:
        """``to`` may be what ``source`` is."""
        known = self.succ.setdefault(source, {})
        if source is to or to in known:
            return
        known[to] = None
        self._left -= 1
        self.pred.setdefault(to, {})[source] = None
        if source in self._objects and (source, to) not in self._unbound:
            self.add(to, list(self._objects[source]))

    def when(self, node: Node, action: Callable[[Obj], None]) -> None:
        """Call ``action`` for each object that ``node`` may be, now and later."""
        self._when.setdefault(node, []).append(action)
        for found in list(self._objects.get(node, {})):
            action(found)

    def write(self, owner: Obj, slot: str, value: Node, writer: Instr) -> None:
        """``writer`` stores ``value``."""
        target = self.slot(owner, slot)
        self.writers.setdefault(target, {})[writer] = None
        self.copy(value, target)

    def slot(self, owner: Obj, name: str) -> Field:
        """The field, which is registered."""
        if owner.kind == "namespace" and owner.parent is not None:
            owner = owner.parent
            name = {EVERY: ATTRIBUTES, SOME: UNNAMED}.get(name) or name[1:-1].strip("'")
        if name not in owner.slots and len(owner.slots) > _MOST and name.startswith("["):
            name = EVERY if name == EVERY else SOME
        target = (owner, name)
        if name not in owner.slots:
            owner.slots[name] = None
            if owner.kind == "instance" and not name.startswith("["):
                self._attribute_slot(owner, name)
            elif name.startswith("[") and name != EVERY:
                self.copy(target, self.slot(owner, EVERY))
        return target

    def _attribute_slot(self, owner: Obj, name: str) -> None:
        """Keep up the slots of all and of unknown attributes, where an object has them."""
        if name == ATTRIBUTES:
            for slot in list(owner.slots):
                if slot != ATTRIBUTES and not slot.startswith("["):
                    self.copy((owner, slot), (owner, ATTRIBUTES))
        elif ATTRIBUTES in owner.slots:
            self.copy((owner, name), (owner, ATTRIBUTES))
        if name == UNNAMED:
            for reader in self._readers.get(owner, ()):
                self.copy((owner, UNNAMED), reader)

    def read_attribute(self, owner: Obj, name: str, to: Instr) -> None:
        """``to`` may be an attribute of an object, or one that was set by an unknown name."""
        self._readers.setdefault(owner, {})[to] = None
        self.copy(self.slot(owner, name), to)
        if UNNAMED in owner.slots:
            self.copy((owner, UNNAMED), to)

    def put_all(self, owner: Obj, value: Instr, writer: Instr) -> None:
        """The entries of ``value``, with unknown names, become those of ``owner``."""
        self.spread.add((value, writer))
        self.write(owner, UNNAMED if owner.kind == "instance" else SOME, value, writer)

    def read_element(self, owner: Obj, key: object, to: Node) -> None:
        """``to`` may be an element of ``owner``."""
        if key is ANY:
            self.copy(self.slot(owner, EVERY), to)
            return
        self.copy(self.slot(owner, element(key)), to)
        self.copy(self.slot(owner, SOME), to)

    def _solve(self) -> None:
        while self._waiting:
            node = self._waiting.popleft()
            new = self._new.pop(node)
            for to in list(self.succ.get(node, ())):
                if (node, to) not in self._unbound:
                    self.add(to, new)
            for action in list(self._when.get(node, ())):
                for found in new:
                    action(found)
