"""Where values go and come from: copies through variables, fields and calls."""

from __future__ import annotations

from collections.abc import Iterator

from pytpc.python_analysis.flow.effects import CallEffects
from pytpc.python_analysis.flow.reaching import Reaching, ReachingInFunction
from pytpc.python_analysis.ir.instructions import Instr, Variable, reachable
from pytpc.python_analysis.points_to.objects import UNNAMED, Field, Obj
from pytpc.python_analysis.points_to.points_to import PointsTo

Stack = tuple[Instr, ...]
"""The calls by which a value came into a function, the innermost last; empty: nothing is known."""
_DEEPEST = 3


class Flow:
    """The flow of values in a program: forward (``users``, ``copies``), backward (``sources``)."""

    def __init__(self, points: PointsTo) -> None:
        self.points = points
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
        self.reaching = Reaching()
        effects, escaping = CallEffects(points), self._escaping()
        for function in points.program.functions:
            ReachingInFunction(function, effects, escaping, self.reaching).run()
        for load, stores in self.reaching.stores.items():
            for store in stores:
                self._seen_by.setdefault(store, []).append(load)

    def _escaping(self) -> set[Instr]:
        """Loads that are used for more than an attribute: other code may read the object."""
        return {
            load
            for loads in self.loads_of.values()
            for load in loads
            if any(
                user.op not in ("attr", "setattr") or user.args[0] is not load
                for user in self.users.get(load, ())
            )
        }

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

    def moves(self, value: Instr, stack: Stack) -> Iterator[tuple[Instr, Instr | None, Stack]]:
        """Where a value that came by ``stack`` is found again.

        Yields:
            The instruction, the store or call that brings the value there (None: neither), and the
            calls by which it is there. A field, or a variable of several functions, forgets the
            calls.
        """
        made = self._made_by(value, stack)
        for to, via in self.copies(value):
            if made is not None and not self._may_be_of(made, to):
                continue
            after = self._after(value, to, via, stack)
            if after is not None:
                yield to, via, after

    def _made_by(self, value: Instr, stack: Stack) -> Instr | None:
        """The call that makes the object in whose ``__init__`` the value is, if it is kept in it.

        None where it is stored elsewhere, too.
        """
        function = value.function
        if not stack or function.owner is None or not function.qualname.endswith(".__init__"):
            return None
        own = function.parameters[0]
        users = self.users.get(value, ())
        kept = [user for user in users if user.op == "setattr" and user.args[1] is value]
        is_own = all(user.args[0].op == "load" and user.args[0].data is own for user in kept)
        if not kept or not is_own or any(user.op == "store" for user in users):
            return None
        made = self.points.of(stack[-1])
        is_made = any(each.site is stack[-1] and each.kind == "instance" for each in made)
        return stack[-1] if is_made else None

    def _may_be_of(self, site: Instr, to: Instr) -> bool:
        """False where ``to`` is an attribute of objects that other calls than ``site`` make."""
        if to.op != "attr":
            return True
        owners = [each for each in self.points.of(to.args[0]) if each.kind == "instance"]
        if not owners:
            return True
        if not any(each.site in (site, None) for each in owners):
            return False
        receivers = self._receivers(to.args[0])
        return receivers is None or any(each.site in (site, None) for each in receivers)

    def _receivers(self, value: Instr) -> list[Obj] | None:
        """The objects on which a method is called, where ``value`` is its ``self``.

        None where it is something else, or where others than the program may call the method.
        """
        function, calls = value.function, self.points.calls
        info = function.owner
        is_self = (
            value.op == "load" and function.parameters and value.data is function.parameters[0]
        )
        if info is None or not is_self or function in calls.registered:
            return None
        if any(True for _ in self.points.outside_bases(info)):
            return None
        found: dict[Obj, None] = {}
        for call in calls.callers.get(function, ()):
            method = call.args[0] if call.op == "call" else call
            if method.op != "attr" or method.data != function.qualname.rpartition(".")[2]:
                return None
            found.update(dict.fromkeys(self.points.of(method.args[0])))
        return [each for each in found if each.kind == "instance"] or None

    def _after(self, value: Instr, to: Instr, via: Instr | None, stack: Stack) -> Stack | None:
        """``stack`` once ``value`` is at ``to``; None where it would leave by another call."""
        calls, users = self.points.calls, self.users.get(value, ())
        if to.op == "param":
            handing = [user for user in users if user in calls.callees]
            sites = [site for site in handing if value in calls.given.get((site, to), ())]
            return (*stack, sites[0])[-_DEEPEST:] if len(sites) == 1 else ()
        is_result = via is None and value.function in calls.callees.get(to, {})
        if is_result and any(user.op == "return" for user in users):
            if not stack:
                return ()
            return stack[:-1] if stack[-1] is to else None
        return stack if to.function is value.function else ()

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
            for to in self.points.succ.get(variable, ()):
                # `module.name`
                if isinstance(to, Instr) and to.op != "load":
                    yield to, store

    def _from_outside(self, value: Instr, variable: Variable) -> Iterator[tuple[Instr, Instr]]:
        """``module.name = value``."""
        for user in self.users.get(value, ()):
            if user.op == "setattr" and user.args[1] is value:
                for load in self.loads_of.get(variable, ()):
                    if load in self.reaching.open:
                        yield load, user

    def _open_writer(self, field: Field, value: Instr) -> Instr | bool | None:
        """The instruction that writes ``value`` into ``field``; False where none else sees it."""
        writers = [each for each in self.points.writers.get(field, ()) if value in each.args]
        for writer in writers:
            if writer not in self.reaching.hidden:
                return writer
        return False if writers else None

    def _found_in(self, field: Field) -> Iterator[Instr]:
        """The instructions that read a field, also through fields that are copies of it."""
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
        """What brought the value of ``instr`` there: stores, arguments, results."""
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

    def origins(self, instr: Instr) -> Iterator[Instr]:
        """The values that come to ``instr`` by one copy."""
        if instr.op == "load":
            for source in self.sources(instr):
                yield source.args[-1] if source.op in ("store", "setattr") else source
            return
        for store in self.reaching.stores.get(instr, ()):
            yield store.args[-1]
        if instr in self.reaching.stores and instr not in self.reaching.open:
            return
        seen: set[object] = {instr}
        waiting: list[object] = [instr]
        while waiting:
            here = waiting.pop()
            for before in self.points.pred.get(here, ()):
                if isinstance(before, Instr):
                    hidden = isinstance(here, tuple) and self._open_writer(here, before) is False
                    if not hidden:
                        yield before
                elif isinstance(before, Variable):
                    for store in self._visible(before):
                        yield store.args[-1]
                elif before not in seen:
                    seen.add(before)
                    waiting.append(before)

    def writers(self, field: object) -> Iterator[Instr]:
        """What writes a field, or a field that is copied into it."""
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

    def is_by_unknown_name(self, attr: Instr, writer: Instr | None) -> bool:
        """True where ``writer`` sets attributes by unknown names, but ``attr`` is also set by name.

        An attribute that is set by its name, to more than a constant default, is taken to keep that
        value.
        """
        name = str(attr.data)
        points = self.points
        for owner in points.of(attr.args[0]) if writer is not None else ():
            if owner.kind != "instance" or owner.class_info is None:
                continue
            if writer not in points.writers.get((owner, UNNAMED), ()):
                continue
            holders = [owner]
            found = points.lookup(owner.class_info, name)
            if found is not None:
                holders.append(points.heap.class_(found))
            named = [each for one in holders for each in points.writers.get((one, name), ())]
            if not all(_is_literal(each.args[-1]) for each in named):
                return True
        return False

    def is_called(self, attr: Instr) -> bool:
        """True for the method in ``value.method()``."""
        users = self.users.get(attr, ())
        return any(user.op == "call" and user.args[0] is attr for user in users)

    def objects(self, instr: Instr) -> list[Obj]:
        """The objects that a value may be; for a local variable, those that were stored before."""
        if instr.op == "load" and instr in self.reaching.stores:
            closed = instr not in self.reaching.open or not getattr(instr.data, "shared", True)
            stores = self.reaching.stores[instr]
            if closed:
                return list(
                    dict.fromkeys(
                        found for each in stores for found in self.points.of(each.args[0])
                    )
                )
        return list(self.points.of(instr))

    def _before(self, writer: Instr, owner: Obj, user: Instr) -> bool:
        """False where ``writer`` writes another object than ``user`` uses, or writes later."""
        if writer.op in ("setattr", "setitem"):
            named = writer.args[0]
            if owner in self.points.of(named) and owner not in self.objects(named):
                return False
        function = user.function
        here = owner.site is not None and owner.site.function is function
        if not here or writer.function is not function or owner.kind == "instance":
            return True
        if writer.block is user.block and writer.number < user.number:
            return True
        after = [*writer.block.successors, *(way.block for way in writer.block.handlers)]
        return user.block in reachable(after)

    def contents(self, instr: Instr, user: Instr) -> Iterator[Instr]:
        """What writes the objects that are reachable from a value: messages, lists, dicts.

        Args:
            instr: the value.
            user: the instruction that uses it.
        """
        seen: dict[Obj, None] = {}
        waiting = self.objects(instr)
        while waiting:
            found = waiting.pop()
            if found in seen or found.kind in ("class", "function", "method", "module", "external"):
                continue
            seen[found] = None
            waiting += found.parts.values()
            for slot in found.slots:
                for writer in self.writers((found, slot)):
                    if self._before(writer, found, user):
                        yield writer
                waiting += self.points.of((found, slot))


def _is_literal(value: Instr) -> bool:
    """True for a constant of the source, also ``-4.0`` and ``(1, 2)``."""
    if value.op in ("unary", "binary", "build"):
        return all(map(_is_literal, value.args))
    return value.op == "const"
