"""From expressions of the syntax tree to instructions."""

from __future__ import annotations

import ast
import builtins

from pytpc.python_analysis.ir.builder import Builder
from pytpc.python_analysis.ir.instructions import ANY, Block, Instr, Shape, Variable
from pytpc.python_analysis.ir.literals import known_elements
from pytpc.python_analysis.ir.scopes import Names

Comprehension = ast.ListComp | ast.SetComp | ast.GeneratorExp | ast.DictComp
UNROLLED = 24
"""Loops over at most this many constants are unrolled."""


class ExpressionLowering(Builder):
    """Lowers the expressions of one function; its subclass lowers statements."""

    # Conditions

    def condition(self, node: ast.expr, yes: Block, no: Block) -> None:
        """Evaluate ``node`` and continue at ``yes`` or ``no``."""
        for part in ast.walk(node):
            self.function.conditions.setdefault(part, node)
        match node:
            case ast.BoolOp(op=op, values=values):
                for value in values[:-1]:
                    further = self.new_block()
                    if isinstance(op, ast.And):
                        self.condition(value, further, no)
                    else:
                        self.condition(value, yes, further)
                    self.block = further
                self.condition(values[-1], yes, no)
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                self.condition(operand, no, yes)
            case ast.Compare():
                self._links(node, yes, no)
            case ast.Constant(value=value):
                self.jump(yes if value else no)
            case _:
                self.branch(self.value(node), node, yes, no)

    def _links(self, node: ast.Compare, yes: Block, no: Block) -> None:
        left = self.value(node.left)
        for op, right in zip(node.ops, node.comparators, strict=True):
            after = self.value(right)
            outcome = self.emit("compare", node, left, after, data=type(op).__name__)
            further = yes if right is node.comparators[-1] else self.new_block()
            self.branch(outcome, node, further, no)
            self.block, left = further, after

    def _value_BoolOp(self, node: ast.BoolOp) -> Instr:
        variable, after = self.temporary(), self.new_block()
        for operand in node.values:
            value = self.value(operand)
            self.emit("store", operand, value, data=variable)
            if operand is node.values[-1]:
                break
            further = self.new_block()
            ways = (further, after) if isinstance(node.op, ast.And) else (after, further)
            self.branch(value, operand, *ways)
            self.block = further
        return self._joined(variable, after, node)

    def _joined(self, variable: Variable, after: Block, node: ast.expr) -> Instr:
        """The value that the branches stored in ``variable``, in the block ``after`` them."""
        self.jump(after)
        self.block = after
        return self.emit("load", node, data=variable)

    def _value_IfExp(self, node: ast.IfExp) -> Instr:
        variable, after = self.temporary(), self.new_block()
        yes, no = self.new_block(), self.new_block()
        self.condition(node.test, yes, no)
        self.block = yes
        self.emit("store", node.body, self.value(node.body), data=variable)
        self.jump(after)
        self.block = no
        self.emit("store", node.orelse, self.value(node.orelse), data=variable)
        return self._joined(variable, after, node)

    def _value_Compare(self, node: ast.Compare) -> Instr:
        if len(node.ops) == 1:
            left, right = self.value(node.left), self.value(node.comparators[0])
            return self.emit("compare", node, left, right, data=type(node.ops[0]).__name__)

        variable, after = self.temporary(), self.new_block()
        left = self.value(node.left)
        for op, right_node in zip(node.ops, node.comparators, strict=True):
            right = self.value(right_node)
            outcome = self.emit("compare", node, left, right, data=type(op).__name__)
            self.emit("store", node, outcome, data=variable)
            if right_node is node.comparators[-1]:
                break
            further = self.new_block()
            self.branch(outcome, node, further, after)
            self.block, left = further, right
        return self._joined(variable, after, node)

    # Values

    def value(self, node: ast.expr) -> Instr:
        """The instruction that has the value of ``node``."""
        lower = getattr(self, f"_value_{type(node).__name__}", None)
        if lower is not None:
            found: Instr = lower(node)
            return found
        # A form of a later Python: its parts are evaluated, its value is unknown.
        parts = [
            self.value(part) for part in ast.iter_child_nodes(node) if isinstance(part, ast.expr)
        ]
        return self.emit("build", node, *parts, data="text")

    def _value_Constant(self, node: ast.Constant) -> Instr:
        return self.emit("const", node, data=node.value)

    def _value_Name(self, node: ast.Name) -> Instr:
        return self.name(node.id, node)

    def name(self, name: str, node: ast.AST) -> Instr:
        """The value of a name."""
        for renamed in reversed(self.scope.renamed):
            if name in renamed:
                known = renamed[name]
                op = "load" if isinstance(known, Variable) else "const"
                return self.emit(op, node, data=known)
        if self.scope.own_attribute(name) and self.scope.class_value is not None:
            return self.emit("attr", node, self.scope.class_value, data=name)
        variable = self.scope.variable(name)
        if variable is not None:
            return self.emit("load", node, data=variable)
        if self.stars and not hasattr(builtins, name):
            return self.emit("attr", node, self.stars[-1], data=name)
        if name == "__name__":
            return self.emit("build", node, data="text")
        return self.emit("external", node, data=f"builtins.{name}")

    def _value_Attribute(self, node: ast.Attribute) -> Instr:
        return self.emit("attr", node, self.value(node.value), data=node.attr)

    def _value_Subscript(self, node: ast.Subscript) -> Instr:
        return self.emit("item", node, self.value(node.value), self.value(node.slice))

    def _value_Slice(self, node: ast.Slice) -> Instr:
        parts = [self.value(part) for part in (node.lower, node.upper, node.step) if part]
        return self.emit("build", node, *parts, data="slice")

    def _value_Call(self, node: ast.Call) -> Instr:
        if isinstance(node.func, ast.Name) and node.func.id == "super" and not node.args:
            return self._super(node)
        function = self.value(node.func)
        values, names = [], []
        for argument in node.args:
            starred = isinstance(argument, ast.Starred)
            values.append(self.value(argument))
            names.append("*" if starred else None)
        for keyword in node.keywords:
            values.append(self.value(keyword.value))
            names.append(keyword.arg or "**")
        return self.emit("call", node, function, *values, data=Shape(tuple(names)))

    def _super(self, node: ast.Call) -> Instr:
        """``super()`` takes its class and object from its place."""
        function = self.emit("external", node.func, data="builtins.super")
        first = self.function.parameters[:1]
        args = [self.emit("load", node, data=variable) for variable in first]
        return self.emit("call", node, function, *args, data=Shape((None,) * len(args)))

    def _value_BinOp(self, node: ast.BinOp) -> Instr:
        left, right = self.value(node.left), self.value(node.right)
        return self.emit("binary", node, left, right, data=type(node.op).__name__)

    def _value_UnaryOp(self, node: ast.UnaryOp) -> Instr:
        operand = self.value(node.operand)
        return self.emit("unary", node, operand, data=type(node.op).__name__)

    def _value_Tuple(self, node: ast.Tuple | ast.List | ast.Set) -> Instr:
        kind = type(node).__name__.lower()
        if any(isinstance(element, ast.Starred) for element in node.elts):
            built = self.emit("build", node, data=kind)
            for element in node.elts:
                inner = element.value if isinstance(element, ast.Starred) else element
                value = self.value(inner)
                if inner is not element:
                    value = self.emit("next", inner, self.emit("iter", inner, value))
                self.put(built, None, value, element)
            return built
        return self.emit("build", node, *[self.value(part) for part in node.elts], data=kind)

    _value_List = _value_Set = _value_Tuple

    def put(self, container: Instr, key: Instr | None, value: Instr, node: ast.AST) -> None:
        """Store into a container, without ``key`` at an unknown place."""
        where = key if key is not None else self.emit("const", node, data=ANY)
        self.emit("setitem", node, container, where, value)

    def _value_Dict(self, node: ast.Dict) -> Instr:
        built = self.emit("build", node, data="dict")
        for key, value in zip(node.keys, node.values, strict=True):
            if key is None:
                inner = self.value(value)
                method = self.emit("attr", value, built, data="update")
                self.emit("call", value, method, inner, data=Shape((None,)))
            else:
                where = self.value(key)
                self.put(built, where, self.value(value), value)
        return built

    def _value_JoinedStr(self, node: ast.JoinedStr) -> Instr:
        return self.emit("build", node, *[self.value(part) for part in node.values], data="text")

    def _value_FormattedValue(self, node: ast.FormattedValue) -> Instr:
        return self.emit("build", node, self.value(node.value), data="text")

    def _value_Starred(self, node: ast.Starred | ast.Await) -> Instr:
        return self.emit("copy", node, self.value(node.value))

    _value_Await = _value_Starred

    def _value_NamedExpr(self, node: ast.NamedExpr) -> Instr:
        value = self.value(node.value)
        self.store_name(node.target.id, value, node)
        return self.emit("copy", node, value)

    def _value_Yield(self, node: ast.Yield) -> Instr:
        self.function.is_generator = True
        value = self.value(node.value) if node.value else self.emit("const", node)
        return self.emit("yield", node, value)

    def _value_YieldFrom(self, node: ast.YieldFrom) -> Instr:
        self.function.is_generator = True
        source = self.emit("iter", node, self.value(node.value))
        return self.emit("yield", node, self.emit("next", node, source))

    def _value_Lambda(self, node: ast.Lambda) -> Instr:
        return self.make_function(node, "<lambda>", node.args, Names())

    def _value_ListComp(self, node: Comprehension) -> Instr:
        """The loops of a comprehension are part of the function, with variables of their own."""
        kinds = {"DictComp": "dict", "SetComp": "set"}
        built = self.emit("build", node, data=kinds.get(type(node).__name__, "list"))
        after = self.new_block()
        depth = len(self.scope.renamed)
        self._generate(node, node.generators, built, after)
        del self.scope.renamed[depth:]
        self.block = after
        return built

    _value_SetComp = _value_GeneratorExp = _value_DictComp = _value_ListComp

    def _generate(
        self, node: Comprehension, generators: list[ast.comprehension], built: Instr, after: Block
    ) -> None:
        if not generators:
            if isinstance(node, ast.DictComp):
                key = self.value(node.key)
                self.put(built, key, self.value(node.value), node.value)
            else:
                self.put(built, None, self.value(node.elt), node.elt)
            self.jump(after)
            return
        first, rest = generators[0], generators[1:]
        elements = self.known_elements(first.target, first.iter)
        if elements is not None:
            for element in elements:
                further = self.new_block()
                self.scope.renamed.append(dict(element))
                self._filtered(node, first, rest, built, further)
                self.scope.renamed.pop()
                self.block = further
            self.jump(after)
            return
        source = self.emit("iter", first.iter, self.value(first.iter))
        head, body = self.new_block(), self.new_block()
        self.jump(head)
        self.block = head
        self.branch(self.emit("more", first.iter, source), first.iter, body, after)
        self.block = body
        self.scope.renamed.append(self._fresh(first.target))
        self.assign(first.target, self.emit("next", first.iter, source))
        self._filtered(node, first, rest, built, head)

    def _filtered(
        self,
        node: Comprehension,
        generator: ast.comprehension,
        rest: list[ast.comprehension],
        built: Instr,
        after: Block,
    ) -> None:
        for test in generator.ifs:
            further = self.new_block()
            self.condition(test, further, after)
            self.block = further
        self._generate(node, rest, built, after)

    def _fresh(self, target: ast.expr) -> dict[str, Variable | object]:
        """A new variable for each name in the target of a comprehension."""
        names = [part.id for part in ast.walk(target) if isinstance(part, ast.Name)]
        return {name: self.temporary() for name in names}

    def known_elements(self, target: ast.expr, source: ast.expr) -> list[dict[str, object]] | None:
        """The values of ``target`` for each element, where all are constants and few."""
        if any(
            isinstance(part, ast.Name) and part.id in renamed
            for part in ast.walk(source)
            for renamed in self.scope.renamed
        ):
            return None
        return known_elements(target, source, self.module, UNROLLED)

    # What statements define

    def store_name(self, name: str, value: Instr, node: ast.AST) -> None:
        """Bind a name."""
        for renamed in reversed(self.scope.renamed):
            known = renamed.get(name)
            if isinstance(known, Variable):
                self.emit("store", node, value, data=known)
                return
        if self.scope.own_attribute(name) and self.scope.class_value is not None:
            self.emit("setattr", node, self.scope.class_value, value, data=name)
            return
        variable = self.scope.variable(name)
        if variable is not None:
            self.emit("store", node, value, data=variable)

    def assign(self, target: ast.expr, value: Instr) -> None:
        """Bind a target."""
        raise NotImplementedError

    def make_function(
        self, node: ast.AST, name: str, arguments: ast.arguments, names: Names
    ) -> Instr:
        """A function as a value."""
        raise NotImplementedError
