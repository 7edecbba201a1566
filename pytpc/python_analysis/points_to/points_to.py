"""Which objects a value may be, and what a call calls: a points-to analysis with fields.

L. Andersen, "Program Analysis and Specialization for the C Programming Language", 1994. Constraints
are added on demand, as calls of functions and classes are found. It ignores the order of statements
(``reaching`` does not), and distinguishes objects of one class by the place that makes them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from pytpc.python_analysis.ir.instructions import ANY, ClassInfo, Function, Instr, Module, Variable
from pytpc.python_analysis.ir.program import Program
from pytpc.python_analysis.points_to.call_table import kept_as_given, unchanged_parameter
from pytpc.python_analysis.points_to.calls import Calls
from pytpc.python_analysis.points_to.objects import SOME, Heap, Obj, element
from pytpc.python_analysis.points_to.solver import Solver
from pytpc.python_analysis.rules_file import Rules

_STEPS = 5
_LEAST_STEPS = 100_000
"""The number of steps that the analysis may take: for each instruction, and at least."""
_PLACES = 64
"""Objects of one class are distinguished at this many places that make them."""


class PointsTo(Solver):
    """The solved constraints of a program. ``calls``: who calls whom."""

    def __init__(self, program: Program, rules: Rules) -> None:
        super().__init__(_LEAST_STEPS + _STEPS * len(program.instructions()))
        self.program = program
        self.rules = rules
        self.heap = Heap(rules.paths, rules.tidy)
        self.defaults: dict[Instr, list[Instr]] = {}
        self._frozen: dict[ClassInfo, list[ClassInfo | str]] = {}
        self._always: dict[ClassInfo, set[str]] = {}
        self.bases: dict[ClassInfo, dict[Obj, None]] = {}
        self.class_names: dict[ClassInfo, dict[str, None]] = {}
        self.class_instr: dict[ClassInfo, Instr] = {}
        self.instances: dict[ClassInfo, dict[Obj, None]] = {}
        self.calls = Calls(self)
        self._late: list[Callable[[], None]] | None = []
        for instr in program.instructions():
            handle = getattr(self, f"_on_{instr.op}", None)
            if handle is not None:
                handle(instr)
        self._solve()
        late, self._late = self._late, None
        for action in late or ():
            action()
        self._solve()
        self._complete()

    # What is asked

    def mro(self, info: ClassInfo) -> list[ClassInfo | str]:
        """The classes in which attributes are looked up; those outside by their dotted names."""
        if info not in self._frozen:
            self._frozen[info] = [info]
            order: dict[ClassInfo | str, None] = {info: None}
            for base in self.bases.get(info, ()):
                if base.class_info is not None:
                    order.update(dict.fromkeys(self.mro(base.class_info)))
                elif base.path:
                    order[self.rules.class_of(base.path)] = None
            self._frozen[info] = list(order)
        return self._frozen[info]

    def outside_bases(self, info: ClassInfo) -> Iterator[str]:
        """The dotted names of the classes outside the sources that a class is derived from."""
        for base in self.bases.get(info, ()):
            if base.class_info is not None:
                yield from self.outside_bases(base.class_info)
            elif base.path:
                yield base.path

    def lookup(
        self, info: ClassInfo, name: str, after: ClassInfo | None = None
    ) -> ClassInfo | None:
        """The class of the sources whose body binds ``name``, behind ``after`` if given."""
        order = self.mro(info)
        if after in order:
            order = order[order.index(after) + 1 :]
        for each in order:
            if isinstance(each, ClassInfo) and name in self.class_names.get(each, ()):
                return each
        return None

    def _complete(self) -> None:
        """Make an object of each class that no call makes."""
        for module in self.program.modules:
            for info in module.classes:
                if not self.instances.get(info):
                    self.instantiate(info, None)
        self._solve()

    def instantiate(self, info: ClassInfo, site: Instr | None) -> Obj:
        """An object of a class, all of whose methods may be called."""
        known = self.instances.setdefault(info, {})
        made = self.heap.get("instance", ref=info, site=site)
        if made not in known and len(known) >= _PLACES:
            made = self.heap.get("instance", ref=info)
        if made in known:
            return made
        known[made] = None
        hidden: set[str] = set()
        for each in self.mro(info):
            if not isinstance(each, ClassInfo):
                continue
            own = self.heap.class_(each)
            # Only `super()` runs an overridden method, and it passes the object.
            names = [name for name in self.class_names.get(each, ()) if name not in hidden]
            hidden.update(names)
            for name in names:
                self.when((own, name), lambda found: self._own_method(found, made))
        return made

    def _own_method(self, found: Obj, owner: Obj) -> None:
        function = found.function if found.kind == "function" else None
        if function is None or "staticmethod" in function.decorators:
            return
        if function.owner is not None and function.param_instrs:
            first = owner
            if "classmethod" in function.decorators and owner.class_info is not None:
                first = self.heap.class_(owner.class_info)
            self.add(function.param_instrs[0], [first])

    def _on_external(self, instr: Instr) -> None:
        self.add(instr, [self.heap.get("external", str(instr.data))])

    def _on_module(self, instr: Instr) -> None:
        assert isinstance(instr.data, Module)
        self.add(instr, [self.heap.get("module", ref=instr.data)])

    def _on_load(self, instr: Instr) -> None:
        self.copy(instr.data, instr)

    def _on_store(self, instr: Instr) -> None:
        self.copy(instr.args[0], instr.data)

    def _on_copy(self, instr: Instr) -> None:
        self.copy(instr.args[0], instr)

    def _on_function(self, instr: Instr) -> None:
        assert isinstance(instr.data, Function)
        self.add(instr, [self.heap.get("function", ref=instr.data)])
        for place, default in instr.data.defaults.items():
            if place < len(instr.data.param_instrs):
                param = instr.data.param_instrs[place]
                self.copy(instr.args[default], param)
                self.defaults.setdefault(param, []).append(instr.args[default])

    def _on_class(self, instr: Instr) -> None:
        info = instr.data
        assert isinstance(info, ClassInfo)
        self.class_instr[info] = instr
        self.add(instr, [self.heap.class_(info)])
        for base in instr.args:
            self.when(base, lambda found: self.bases.setdefault(info, {}).update({found: None}))

    def _on_setattr(self, instr: Instr) -> None:
        owner, value = instr.args
        name = str(instr.data)
        if isinstance(owner.data, ClassInfo):
            self.class_names.setdefault(owner.data, {})[name] = None
        self.when(owner, lambda found: self.store_attribute(found, name, value, instr))

    def store_attribute(self, owner: Obj, name: str, value: Instr, instr: Instr) -> None:
        """``instr`` stores ``value`` as the attribute ``name``."""
        if owner.kind == "module" and isinstance(owner.ref, Module) and owner.ref.body:
            self.copy(value, _variable_of(owner.ref.body, name))
            self.writers.setdefault((owner, name), {})[instr] = None
            return
        if owner.kind == "super" and owner.parent is not None:
            owner = owner.parent
        info = owner.class_info if owner.kind == "instance" else None
        setter = self.lookup(info, f"{name}.setter") if info is not None else None
        if setter is not None:
            field = (self.heap.class_(setter), f"{name}.setter")
            self.when(field, lambda found: self.calls.bound(instr, found, owner, [(None, value)]))
            return
        param = kept_as_given(instr)
        if param is None or owner.site is None:
            self.write(owner, name, value, instr)
            return
        self._keep(owner, param, name, instr)

    def _keep(self, owner: Obj, param: Instr, name: str, instr: Instr) -> None:
        """``self.name = param`` in ``__init__``: the arguments of each call distinguish objects.

        The ``__init__`` of a base class gets them from that of the object's own class.
        """
        info, made = param.function.owner, owner.class_info
        assert owner.site is not None
        if info is None or made is None or self.lookup(made, "__init__") is info:
            self.calls.when_given(
                owner.site, param, lambda given: self.write(owner, name, given, instr)
            )
            return

        def handed(given: Instr) -> None:
            further = unchanged_parameter(given)
            if further is None or further is param:
                self.write(owner, name, given, instr)
            else:
                self._keep(owner, further, name, instr)

        def called(site: Instr) -> None:
            if site.function.owner in self.mro(made):
                self.calls.when_given(site, param, handed)

        self.calls.when_site(param, called)

    def _on_attr(self, instr: Instr) -> None:
        name = str(instr.data)
        self.when(instr.args[0], lambda found: self.load_attribute(found, name, instr))

    def load_attribute(self, owner: Obj, name: str, instr: Instr) -> None:
        """``instr`` has the value of the attribute ``name``."""
        if owner.kind == "module" and isinstance(owner.ref, Module) and owner.ref.body:
            self.copy(_variable_of(owner.ref.body, name), instr)
        elif owner.kind == "external":
            self.add(instr, [self.heap.get("external", f"{owner.path}.{name}")])
        elif owner.kind in ("made", "part", "container"):
            self.copy(self.slot(owner, name), instr)
            path = self.rules.class_of(owner.path)
            self.add(instr, [self.heap.part(owner, name, path)])
        elif owner.kind == "class" and owner.class_info is not None:
            self.later(lambda: self._class_attribute(owner, name, instr))
        elif owner.kind == "instance" and name == "__dict__":
            self.add(instr, [self.heap.get("namespace", parent=owner)])
        elif owner.kind == "namespace":
            self.add(instr, [self.heap.part(owner, name, "builtins.dict")])
        elif owner.kind == "instance":
            self.read_attribute(owner, name, instr)
            self._looked_up(owner, owner, None, name, instr)
        elif owner.kind == "super" and owner.parent is not None:
            self._looked_up(owner.parent, owner.parent, owner.class_info, name, instr)

    def later(self, action: Callable[[], None]) -> None:
        """Call ``action`` once the bases of all classes are known."""
        if self._late is not None:
            self._late.append(action)
        else:
            action()

    def _class_attribute(self, owner: Obj, name: str, instr: Instr) -> None:
        info = owner.class_info
        assert info is not None
        self.copy(self.slot(owner, name), instr)
        found = self.lookup(info, name)
        if found is not None:
            field = self.slot(self.heap.class_(found), name)
            self.copy(field, instr)
            self.when(field, lambda each: self._class_method(each, owner, instr))
        self._outside(owner, name, instr, info)

    def _class_method(self, found: Obj, owner: Obj, instr: Instr) -> None:
        function = found.function if found.kind == "function" else None
        if function is not None and "classmethod" in function.decorators:
            self.add(instr, [self.heap.get("method", ref=function, parent=owner)])

    def _looked_up(
        self, owner: Obj, real: Obj, after: ClassInfo | None, name: str, instr: Instr
    ) -> None:
        info = real.class_info
        if info is None:
            return
        found = self.lookup(info, name, after)
        if found is None:
            self._outside(owner, name, instr, info)
            return
        field = self.slot(self.heap.class_(found), name)
        # Functions are bound to the object; other attributes are the class's, unless the object has
        # its own.
        if not self._is_hidden(info, name):
            self._unbound.add((field, instr))
            self.copy(field, instr)
        self.when(field, lambda each: self._bind(each, owner, instr))

    def _is_hidden(self, info: ClassInfo, name: str) -> bool:
        """True where ``__init__`` gives every object an attribute of its own."""
        if info not in self._always:
            maker = self.lookup(info, "__init__")
            self._always[info] = {
                str(instr.data)
                for module in self.program.modules
                for function in module.functions
                if function.owner is maker is not None and function.qualname.endswith(".__init__")
                for instr in function.blocks[0].instrs
                if instr.op == "setattr" and instr.args[0].data is function.parameters[0]
            }
        return name in self._always[info]

    def _bind(self, found: Obj, owner: Obj, instr: Instr) -> None:
        """An attribute of a class, read from an object of it."""
        function = found.function if found.kind == "function" else None
        if function is None or "staticmethod" in function.decorators:
            self.add(instr, [found])
        elif "classmethod" in function.decorators and owner.class_info is not None:
            own = self.heap.class_(owner.class_info)
            self.add(instr, [self.heap.get("method", ref=function, parent=own)])
        elif {"property", "cached_property", "getter"} & set(function.decorators):
            self.calls.bound(instr, found, owner, [])
        else:
            self.add(instr, [self.heap.get("method", ref=function, parent=owner)])

    def _outside(self, owner: Obj, name: str, instr: Instr, info: ClassInfo) -> None:
        for base in self.mro(info):
            if isinstance(base, str):
                self.add(instr, [self.heap.part(owner, name, base)])

    def _on_setitem(self, instr: Instr) -> None:
        owner, key, value = instr.args
        slot = element(key.data) if key.op == "const" and key.data is not ANY else SOME
        self.when(owner, lambda found: self.write(found, slot, value, instr))

    def _on_item(self, instr: Instr) -> None:
        owner, key = instr.args
        known = key.data if key.op == "const" else ANY
        if isinstance(known, int) and not isinstance(known, bool) and known < 0:
            known = ANY
        self.when(owner, lambda found: self.read_element(found, known, instr))
        if key.op == "build" and key.data == "slice":
            self.copy(owner, instr)

    def _on_next(self, instr: Instr) -> None:
        source = instr.args[0].args[0]
        self.when(source, lambda found: self.read_element(found, ANY, instr))

    def _on_build(self, instr: Instr) -> None:
        if instr.data in ("text", "slice"):
            return
        if instr.data == "exception":
            self.add(instr, [self.heap.made("<exception>", instr)])
            return
        made = self.heap.container(str(instr.data), instr)
        self.add(instr, [made])
        for place, value in enumerate(instr.args):
            self.write(made, element(place), value, instr)

    def _on_compare(self, instr: Instr) -> None:
        left, right = instr.args
        own, turned = _METHODS.get(str(instr.data), ("", ""))
        self._operator(instr, left, own, [right])
        self._operator(instr, right, turned, [left])

    def _on_binary(self, instr: Instr) -> None:
        left, right = instr.args
        name = str(instr.data)
        word = _WORDS.get(name, name.lower())
        self._operator(instr, left, f"__{word}__", [right])
        self._operator(instr, right, f"__r{word}__", [left])
        if name in _JOINING:
            self.when(left, lambda found: self.calls.joined(instr, found, is_left=True))
            self.when(right, lambda found: self.calls.joined(instr, found, is_left=False))

    def _on_branch(self, instr: Instr) -> None:
        self._operator(instr, instr.args[0], "__bool__", [])
        self._operator(instr, instr.args[0], "__len__", [])

    def _on_unary(self, instr: Instr) -> None:
        name = {"Not": "__bool__", "USub": "__neg__"}.get(str(instr.data), "")
        self._operator(instr, instr.args[0], name, [])

    def _operator(self, instr: Instr, value: Instr, name: str, others: list[Instr]) -> None:
        """Run the method of an own class that an operator calls."""

        def run(found: Obj) -> None:
            if found.kind == "instance" and name:
                given: list[tuple[str | None, Instr]] = [(None, other) for other in others]
                self.later(lambda: self.calls.run_method(instr, found, name, given))

        self.when(value, run)

    def _on_call(self, instr: Instr) -> None:
        self.when(instr.args[0], lambda found: self.later(lambda: self.calls.call(instr, found)))


def _variable_of(body: Function, name: str) -> Variable:
    """The variable of a module that ``module.name`` means."""
    variable = body.variables.setdefault(name, Variable(name, body))
    variable.shared = True
    return variable


_METHODS = {
    "Lt": ("__lt__", "__gt__"),
    "LtE": ("__le__", "__ge__"),
    "Gt": ("__gt__", "__lt__"),
    "GtE": ("__ge__", "__le__"),
    "Eq": ("__eq__", "__eq__"),
    "NotEq": ("__ne__", "__ne__"),
    "In": ("", "__contains__"),
    "NotIn": ("", "__contains__"),
}
_JOINING = {"Add", "Mult", "Sub", "BitAnd", "BitOr", "BitXor"}
_WORDS = {"Mult": "mul", "Div": "truediv", "BitAnd": "and", "BitOr": "or", "BitXor": "xor"}
