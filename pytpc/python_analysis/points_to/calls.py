"""The effect of calls: arguments to parameters, results to calls, callbacks to their callers."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

from pytpc.python_analysis.ir.instructions import ANY, ClassInfo, Function, Instr, Shape
from pytpc.python_analysis.points_to.by_name import by_name
from pytpc.python_analysis.points_to.call_table import CallTable, Given, argument
from pytpc.python_analysis.points_to.named_tuples import named_tuple
from pytpc.python_analysis.points_to.objects import EVERY, SOME, Obj

if TYPE_CHECKING:
    from pytpc.python_analysis.points_to.points_to import PointsTo

_SYNCHRONOUS = ("builtins.", "functools.", "itertools.", "numpy.")
_PUTTING = {"append", "appendleft", "add", "insert", "put", "put_nowait", "setdefault", "push"}
_MERGING = {"extend", "update", "extendleft"}
_TAKING = {"pop", "popleft", "get", "get_nowait", "setdefault", "popitem", "__getitem__"}
# Keywords that say how a call waits: their values are neither kept nor returned.
_PATIENCE = ("block", "timeout")
_COPYING = {
    f"builtins.{name}"
    for name in ("list", "tuple", "set", "sorted", "reversed", "iter", "dict", "frozenset")
} | {"copy.copy", "copy.deepcopy", "collections.deque", "collections.OrderedDict"}
_CHOOSING = {f"builtins.{name}" for name in ("any", "all", "sum", "min", "max", "next")}
_FEW = 16
_HOLDING = ("container", "namespace")


class Calls(CallTable):
    """Adds calls to the table."""

    def __init__(self, flow: PointsTo) -> None:
        super().__init__()
        self.flow = flow
        self._done: set[tuple[Instr, Obj]] = set()
        self._results: dict[Function, list[Instr]] = {}

    def call(self, instr: Instr, callee: Obj) -> None:
        """``instr`` calls ``callee``."""
        if (instr, callee) in self._done:
            return
        self._done.add((instr, callee))
        self._dispatch(instr, callee, self.arguments(instr))

    def _dispatch(self, instr: Instr, callee: Obj, given: list[Given]) -> None:
        match callee.kind:
            case "function" | "method" if callee.function is not None:
                self._link(instr, callee.function, callee.parent, given)
            case "partial" if callee.parent is not None and callee.site is not None:
                before = self.arguments(callee.site)[1:]
                self._dispatch(instr, callee.parent, [*before, *given])
            case "class" if callee.class_info is not None:
                self._construct(instr, callee.class_info, given)
            case "instance":
                self.run_method(instr, callee, "__call__", given)
            case "external":
                self._outside(instr, callee.path, None, given)
            case "part":
                self._outside(instr, callee.path, callee.parent, given)
            case "made" if isinstance(instr.data, Shape) and instr.data.decorates:
                self.flow.copy(instr.args[1], instr)
            case "made" if callee.path == "collections.namedtuple" and callee.site is not None:
                named_tuple(self.flow, instr, callee.site, given)
            case "made":
                path = self.flow.rules.class_of(callee.path)
                self._outside(instr, f"{path}.__call__", callee, given)
            case _:
                pass

    def bound(self, instr: Instr, found: Obj, owner: Obj, given: list[Given]) -> None:
        """``instr`` runs the method ``found`` of ``owner`` (a property, an operator)."""
        if found.function is not None and found.kind == "function":
            self._link(instr, found.function, owner, given)

    def run_method(self, instr: Instr, owner: Obj, name: str, given: list[Given]) -> None:
        """``instr`` runs the method ``name`` of an object of an own class, if there is one."""
        info = owner.class_info
        found = self.flow.lookup(info, name) if info is not None else None
        if found is not None:
            field = self.flow.slot(self.flow.heap.class_(found), name)
            self.flow.when(field, lambda each: self.bound(instr, each, owner, given))

    def _construct(self, instr: Instr, info: ClassInfo, given: list[Given]) -> None:
        made = self.flow.instantiate(info, instr)
        self.flow.add(instr, [made])
        if self.flow.lookup(info, "__init__") is not None:
            self.run_method(instr, made, "__init__", given)
            return
        order = [each for each in self.flow.mro(info) if isinstance(each, ClassInfo)]
        names = [name for each in reversed(order) if each.is_record for name in each.fields]
        for place, (keyword, value) in enumerate(given):
            if keyword == "**" and names:
                self.flow.put_all(made, value, instr)
            name = keyword or (names[place] if place < len(names) else None)
            if name in names and name is not None:
                self.flow.write(made, name, value, instr)
                self.flow.write(made, f"[{names.index(name)}]", value, instr)
        if self.flow.lookup(info, "__post_init__") is not None:
            self.run_method(instr, made, "__post_init__", [])

    # Calls of functions of the sources

    def _link(
        self, instr: Instr, function: Function, owner: Obj | None, given: list[Given]
    ) -> None:
        self.callees.setdefault(instr, {})[function] = None
        self.callers.setdefault(function, {})[instr] = None
        self._bind(instr, function, owner, given)
        self._return(instr, function, instr)

    def _return(self, instr: Instr, function: Function, to: Instr) -> None:
        """The results and yielded values of ``function`` come to ``to``."""
        flow = self.flow
        if to.op == "setattr":
            return
        if function.is_generator:
            made = flow.heap.container("list", instr)
            flow.add(to, [made])
        for each in self._results_of(function):
            if each.op == "return":
                flow.copy(each.args[0], to)
            else:
                flow.write(made, SOME, each.args[0], each)

    def _results_of(self, function: Function) -> list[Instr]:
        """The instructions that return or yield, searched once for each function."""
        if function not in self._results:
            self._results[function] = [
                each for each in function.instructions() if each.op in ("return", "yield")
            ]
        return self._results[function]

    def _bind(
        self, instr: Instr, function: Function, owner: Obj | None, given: list[Given]
    ) -> None:
        flow, params = self.flow, function.param_instrs
        first = 0
        if owner is not None and params:
            flow.add(params[0], [owner])
            first = 1
        names = {variable.name: place for place, variable in enumerate(function.parameters)}
        last = function.vararg if function.vararg is not None else function.keyword_only
        last = len(params) if last is None else last
        place = first
        for keyword, value in given:
            if keyword is None and place < last:
                flow.copy(value, params[place])
                self.give(instr, params[place], value)
                place += 1
            elif keyword is None:
                self._collect(function.vararg, function, value, instr, SOME)
            elif keyword == "*":
                self._unpack(value, params[place:last])
                if function.vararg is not None:
                    flow.copy(value, params[function.vararg])
            elif keyword == "**":
                self._unpack_names(value, function, place, {each for each, _ in given})
            elif keyword in names:
                flow.copy(value, params[names[keyword]])
                self.give(instr, params[names[keyword]], value)
            else:
                self._collect(function.kwarg, function, value, instr, f"[{keyword!r}]")
        unpacked = any(keyword in ("*", "**") for keyword, _ in given)
        for number, param in enumerate(params):
            if (instr, param) in self.given or number < first:
                continue
            # Its default, or an unpacked value, which all calls share.
            if unpacked or instr.op != "call":
                self.give(instr, param, param)
            for default in flow.defaults.get(param, ()):
                self.give(instr, param, default)

    def _collect(
        self, place: int | None, function: Function, value: Instr, instr: Instr, slot: str
    ) -> None:
        """An argument that goes into ``*args`` or ``**kwargs``."""
        if place is None:
            return
        kind = "dict" if place == function.kwarg else "tuple"
        made = self.flow.heap.container(kind, function.param_instrs[place])
        self.flow.add(function.param_instrs[place], [made])
        self.flow.write(made, slot, value, instr)

    def _unpack(self, value: Instr, params: list[Instr]) -> None:
        for offset, param in enumerate(params):
            self.flow.when(value, partial(self.flow.read_element, key=offset, to=param))

    def _unpack_names(
        self, value: Instr, function: Function, first: int, taken: set[str | None]
    ) -> None:
        """Entries of ``**value`` come to the parameters from ``first`` on that are not taken."""
        if function.kwarg is not None:
            self.flow.copy(value, function.param_instrs[function.kwarg])
        for place, variable in enumerate(function.parameters):
            if place < first or variable.name in taken:
                continue
            if place in (function.vararg, function.kwarg):
                continue
            param = function.param_instrs[place]
            self.flow.when(value, partial(self.flow.read_element, key=variable.name, to=param))

    # Calls of what is outside the sources

    def _outside(self, instr: Instr, path: str, owner: Obj | None, given: list[Given]) -> None:
        self.outside.setdefault(instr, {})[(path, owner)] = None
        flow = self.flow
        name = path.rsplit(".", 1)[-1]
        if isinstance(instr.data, Shape) and instr.data.decorates:
            flow.copy(instr.args[1], instr)
        elif path == "builtins.super":
            self._super(instr)
            return
        elif path in ("functools.partial", "functools.partialmethod") and given:
            get = partial(flow.heap.get, "partial", site=instr)
            flow.when(given[0][1], lambda found: flow.add(instr, [get(parent=found)]))
            return
        elif path in ("builtins.getattr", "builtins.setattr"):
            by_name(flow, instr, path, given)
            return
        elif path == "builtins.vars" and given:
            flow.when(given[0][1], lambda found: flow.load_attribute(found, "__dict__", instr))
            return
        elif path in _COPYING:
            self._copied(instr, given)
        elif path in _CHOOSING:
            for _, value in given:
                flow.when(value, lambda found: flow.read_element(found, ANY, instr))
        elif name == "__enter__" and owner is not None:
            flow.add(instr, [owner])
            # `contextmanager` made it of a generator: what that yields.
            if owner.kind == "container":
                flow.read_element(owner, ANY, instr)
        elif owner is not None:
            self._on_object(instr, path, owner, given)
        if path not in _COPYING and not (owner is not None and owner.kind in _HOLDING):
            made = flow.heap.made(flow.rules.class_of(path), instr)
            flow.add(instr, [made])
            for keyword, value in given:
                if keyword not in (None, "*", "**"):
                    flow.write(made, keyword, value, instr)
        for _, value in given:
            self._hand(instr, path, owner, value, given)

    def _super(self, instr: Instr) -> None:
        info = instr.function.owner
        arguments = self.arguments(instr)
        if info is None or not arguments:
            return
        flow = self.flow
        owner = arguments[-1][1]
        get = partial(flow.heap.get, "super", ref=info)
        flow.when(owner, lambda found: flow.add(instr, [get(parent=found)]))

    def _copied(self, instr: Instr, given: list[Given]) -> None:
        """A new container with the elements of another."""
        flow = self.flow
        made = flow.heap.container("list", instr)
        flow.add(instr, [made])
        for keyword, value in given:
            if keyword not in (None, "*", "**"):
                flow.write(made, f"[{keyword!r}]", value, instr)
                continue
            flow.when(value, lambda found: self._merge(found, made, instr))

    def joined(self, instr: Instr, found: Obj, *, is_left: bool) -> None:
        """A container becomes part of a new one: ``left + right``, ``left | right``."""
        if found.kind != "container":
            return
        flow = self.flow
        made = flow.heap.container("list", instr)
        flow.add(instr, [made])
        if is_left or instr.data != "Add":
            self._merge(found, made, instr)
        else:
            flow.write(made, SOME, flow.slot(found, EVERY), instr)

    def _merge(self, source: Obj, to: Obj, instr: Instr) -> None:
        if source is to:
            return
        flow = self.flow
        for slot in [*source.slots] if len(source.slots) < _FEW else ():
            if slot != EVERY:
                flow.write(to, slot, (source, slot), instr)
        if source.kind in ("instance", "made"):
            flow.add(instr, [source])
        flow.write(to, SOME, flow.slot(source, EVERY), instr)

    def _on_object(self, instr: Instr, path: str, owner: Obj, given: list[Given]) -> None:
        """A method of a container or of an outside object, which may keep its arguments."""
        flow = self.flow
        kind, _, name = path.rpartition(".")
        is_tidy, waits = kind in flow.rules.tidy, flow.rules.waits(name)
        values = [value for keyword, value in given if keyword not in ("*", "**", *_PATIENCE)]
        if values and name == "get" and isinstance(values[0].data, bool):
            # A queue's `get(True, 0.5)`.
            values = []
        if name in _MERGING:
            for keyword, value in given:
                if keyword in (None, "*", "**"):
                    flow.when(value, lambda found: self._merge(found, owner, instr))
                    if owner.kind in _HOLDING:
                        flow.put_all(owner, value, instr)
                else:
                    flow.write(owner, f"[{keyword!r}]", value, instr)
        elif name in _PUTTING:
            stored = values[1:] if name in ("insert", "setdefault") else values
            for value in stored:
                flow.write(owner, SOME, value, instr)
        elif owner.kind != "container" and name not in _TAKING and not (is_tidy or waits):
            for value in values:
                flow.write(owner, SOME, value, instr)
        if name in _TAKING:
            key = values[0].data if values and values[0].op == "const" else ANY
            flow.read_element(owner, key if name == "get" or isinstance(key, str) else ANY, instr)
            for value in values[1:]:
                flow.copy(value, instr)
        elif name in ("values", "copy", "keys", "items"):
            self._view(instr, name, owner)
        elif owner.kind != "container" and not is_tidy:
            flow.copy(flow.slot(owner, EVERY), instr)

    def _view(self, instr: Instr, name: str, owner: Obj) -> None:
        flow = self.flow
        made = flow.heap.container("list", instr)
        flow.add(instr, [made])
        if name == "copy":
            self._merge(owner, made, instr)
        elif name == "values":
            flow.write(made, SOME, flow.slot(owner, EVERY), instr)
        elif name == "items":
            pair = flow.heap.container("tuple", instr)
            flow.write(pair, "[1]", flow.slot(owner, EVERY), instr)
            flow.add((made, SOME), [pair])
            flow.slot(made, SOME)

    def _hand(
        self, instr: Instr, path: str, owner: Obj | None, value: Instr, given: list[Given]
    ) -> None:
        """Code outside the sources may run the functions that it gets."""
        others = [each for each in given if each[1] is not value]
        rows = self.flow.rules.hands.get(path, ())
        kinds = [kind for row, kind in rows if argument(given, row) is value]
        kind = kinds[0] if kinds else "<argument>"
        # A future passes itself.
        first = owner if path.endswith(".add_done_callback") else None

        def register(found: Obj) -> None:
            made = partial(self.flow.heap.made, kind)
            self._register(instr, path, found, others, lambda at: first or made(at))

        self.flow.when(value, register)

    def _register(
        self, instr: Instr, path: str, found: Obj, others: list[Given], made: Callable[[Instr], Obj]
    ) -> None:
        owner = found.parent
        given: list[Given] = []
        while found.kind == "partial" and found.parent is not None and found.site is not None:
            given = [*self.arguments(found.site)[1:], *given]
            found = found.parent
            owner = found.parent
        function = found.function
        if function is None or (instr, found) in self._done:
            return
        self._done.add((instr, found))
        self.registered.setdefault(function, {})[instr] = None
        self.callbacks.setdefault(instr, {})[function] = None
        self._bind(instr, function, owner, given)
        first = len(given) + (1 if owner is not None else 0)
        for param in function.param_instrs[first:]:
            self.flow.add(param, [made(param)])
        if path.startswith(_SYNCHRONOUS):
            self._run_now(instr, function, others, first)
            return
        for keyword, value in others:
            for offset, param in enumerate(function.param_instrs[first:]):
                self._started_with(keyword, value, param, offset)

    def _started_with(self, keyword: str | None, value: Instr, param: Instr, offset: int) -> None:
        if keyword == "callback_args" and offset == 1:
            self.flow.copy(value, param)
        elif keyword == "args":
            self.flow.when(value, lambda found: self.flow.read_element(found, offset, param))

    def _run_now(self, instr: Instr, function: Function, others: list[Given], first: int) -> None:
        """``map``, ``filter``, ``sorted`` and the like: elements in, results out."""
        flow = self.flow
        for _, value in others:
            for param in function.param_instrs[first:]:
                flow.when(value, partial(flow.read_element, key=ANY, to=param))
        made = flow.heap.container("list", instr)
        flow.add(instr, [made])
        for each in self._results_of(function):
            if each.op == "return":
                flow.write(made, SOME, each.args[0], each)
