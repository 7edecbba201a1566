"""Where values go and where they come from: copies, through variables, fields and calls."""

from __future__ import annotations

from collections.abc import Iterator

from pytpc.pynodes.effects import effects_of_calls
from pytpc.pynodes.ir import Instr, Variable
from pytpc.pynodes.objects import Field, Obj
from pytpc.pynodes.pointsto import PointsTo
from pytpc.pynodes.reaching import Reaching, reaching_definitions


class Flow:
    """Ways of values in a program, forward (``users``, ``copies``) and backward (``sources``)."""

    def __init__(self, points: PointsTo) -> None:
        """Work out which loads see which stores."""
        self.points = points
        effects = effects_of_calls(points)
        self.reaching: Reaching = reaching_definitions(points.program.functions, effects)
        self.users: dict[Instr, list[Instr]] = {}
        self.stores_of: dict[Variable, list[Instr]] = {}
        self.loads_of: dict[Variable, list[Instr]] = {}
        self._seen_by: dict[Instr, list[Instr]] = {}
        for instr in points.program.instructions():
            for arg in instr.args:
                self.users.setdefault(arg, []).append(instr)
            if isinstance(instr.data, Variable) and instr.op in ("store", "load"):
                table = self.stores_of if instr.op == "store" else self.loads_of
                table.setdefault(instr.data, []).append(instr)
        for load, stores in self.reaching.stores.items():
            for store in stores:
                self._seen_by.setdefault(store, []).append(load)

    # Forward

    def copies(self, value: Instr) -> Iterator[tuple[Instr, Instr | None]]:
        """Where the value is found again: (instruction, the store or call that brings it)."""
        for user in self.users.get(value, ()):
            if user.op == "store":
                yield from self._loads(user)
            elif user.op == "setattr" and user.args[1] is value:
                for load in self._seen_by.get(user, ()):
                    yield load, user
        for to in self.points.succ.get(value, ()):
            if isinstance(to, Instr):
                yield to, None
            elif isinstance(to, tuple):
                writer = self._open_writer(to, value)
                if not isinstance(writer, bool):
                    for load in self._found_in(to):
                        yield load, writer
            elif isinstance(to, Variable):
                yield from self._from_outside(value, to)

    def _loads(self, store: Instr) -> Iterator[tuple[Instr, Instr]]:
        direct = self._seen_by.get(store, ())
        for load in direct:
            yield load, store
        variable = store.data
        assert isinstance(variable, Variable)
        if variable.shared and store not in self.reaching.hidden:
            for load in self.loads_of.get(variable, ()):
                if load in self.reaching.open and load not in direct:
                    yield load, store
            for load in self._module_loads(variable):
                yield load, store

    def _module_loads(self, variable: Variable) -> Iterator[Instr]:
        """Accesses ``module.name``."""
        for to in self.points.succ.get(variable, ()):
            if isinstance(to, Instr) and to.op != "load":
                yield to

    def _from_outside(self, value: Instr, variable: Variable) -> Iterator[tuple[Instr, Instr]]:
        """``module.name = value``."""
        for user in self.users.get(value, ()):
            if user.op == "setattr" and user.args[1] is value:
                for load in self.loads_of.get(variable, ()):
                    if load in self.reaching.open:
                        yield load, user

    def _open_writer(self, field: Field, value: Instr) -> Instr | bool | None:
        """What writes ``value`` into ``field``; False where nobody else sees it."""
        writers = [each for each in self.points.writers.get(field, ()) if value in each.args]
        for writer in writers:
            if writer not in self.reaching.hidden:
                return writer
        return False if writers else None

    def _found_in(self, field: Field) -> Iterator[Instr]:
        """The instructions that read a field, through fields that are copies of it."""
        seen = {field}
        waiting = [field]
        while waiting:
            for to in self.points.succ.get(waiting.pop(), ()):
                if isinstance(to, Instr):
                    if to not in self.reaching.stores or to in self.reaching.open:
                        yield to
                elif isinstance(to, tuple) and to not in seen:
                    seen.add(to)
                    waiting.append(to)

    # Backward

    def sources(self, instr: Instr) -> Iterator[Instr]:
        """What brought the value of ``instr`` there: stores, arguments, what was returned."""
        if instr.op == "load" and isinstance(instr.data, Variable):
            yield from self._stores(instr, instr.data)
            return
        yield from self.reaching.stores.get(instr, ())
        if instr in self.reaching.stores and instr not in self.reaching.open:
            return
        for before in self.points.pred.get(instr, ()):
            if isinstance(before, Instr):
                yield before
            elif isinstance(before, Variable):
                yield from self._visible(before)
            elif isinstance(before, tuple):
                yield from self.writers(before)

    def _stores(self, load: Instr, variable: Variable) -> Iterator[Instr]:
        direct = self.reaching.stores.get(load, ())
        yield from direct
        if variable.shared and load in self.reaching.open:
            for store in self._visible(variable):
                if store not in direct:
                    yield store

    def _visible(self, variable: Variable) -> Iterator[Instr]:
        for store in self.stores_of.get(variable, ()):
            if store not in self.reaching.hidden:
                yield store
        for before in self.points.pred.get(variable, ()):
            if isinstance(before, Instr):
                for user in self.users.get(before, ()):
                    if user.op == "setattr" and user.args[1] is before:
                        yield user

    def writers(self, field: object) -> Iterator[Instr]:
        """What writes a field, and the fields that are copied into it."""
        seen = {field}
        waiting = [field]
        while waiting:
            here = waiting.pop()
            for writer in self.points.writers.get(here, ()):  # type: ignore[call-overload]
                if writer not in self.reaching.hidden:
                    yield writer
            for before in self.points.pred.get(here, ()):
                if isinstance(before, tuple) and before not in seen:
                    seen.add(before)
                    waiting.append(before)

    def contents(self, instr: Instr) -> Iterator[Instr]:
        """What writes the objects that are reachable from a value: messages, lists, dicts."""
        seen: dict[Obj, None] = {}
        waiting = list(self.points.of(instr))
        while waiting:
            found = waiting.pop()
            if found in seen or found.kind in ("class", "function", "method", "module", "external"):
                continue
            seen[found] = None
            waiting += found.parts.values()
            for slot in found.slots:
                yield from self.writers((found, slot))
                waiting += self.points.of((found, slot))
