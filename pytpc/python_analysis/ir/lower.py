"""From the syntax tree of a module to instructions: its functions, classes and ``match``."""

from __future__ import annotations

import ast
from collections.abc import Sequence

from pytpc.python_analysis.ir.builder import Resolver
from pytpc.python_analysis.ir.instructions import (
    Block,
    ClassInfo,
    Function,
    Instr,
    Module,
    Shape,
    Variable,
    reachable,
)
from pytpc.python_analysis.ir.lower_statements import StatementLowering
from pytpc.python_analysis.ir.scopes import Names, Scope, names_of

_MARKING = ("property", "staticmethod", "classmethod", "setter", "getter", "cached_property")


def lower_module(module: Module, resolve: Resolver, numbers: list[int]) -> None:
    """Fill in the functions of ``module``; its body is the first."""
    body = Function("<module>", module, module.tree)
    module.body = body
    waiting = [(body, Scope(body, names_of(module.tree.body), None))]
    stars: list[Instr] = []
    while waiting:
        function, scope = waiting.pop(0)
        module.functions.append(function)
        lowering = Lowering(scope, resolve, numbers)
        lowering.stars = stars
        lowering.run_function()
        waiting += lowering.pending


class Lowering(StatementLowering):
    """Lowers one function."""

    def run(self, body: Sequence[ast.stmt]) -> None:
        """Lower a body, to the function's end."""
        self.statements(body)
        self.jump(self._exit)
        self.function.blocks.append(self._exit)
        _drop_unreachable(self.function)

    def run_function(self) -> None:
        """Lower the function of the scope: its parameters and its body."""
        node = self.function.node
        for index, variable in enumerate(self.function.parameters):
            value = self.emit("param", node, data=index)
            self.function.param_instrs.append(value)
            self.emit("store", node, value, data=variable)
        if isinstance(node, ast.Lambda):
            self.emit("return", node.body, self.value(node.body))
            self.run([])
        elif isinstance(node, ast.Module | ast.FunctionDef | ast.AsyncFunctionDef):
            self.run(node.body)

    # Functions and classes

    def _do_FunctionDef(self, node: ast.FunctionDef | ast.AsyncFunctionDef) -> None:
        value = self.make_function(node, node.name, node.args, names_of(node.body))
        made = value.data
        marks = tuple(ast.unparse(mark).rsplit(".", 1)[-1] for mark in node.decorator_list)
        assert isinstance(made, Function)
        made.decorators = tuple(mark for mark in marks if mark in _MARKING)
        value = self._decorated(value, node)
        if "setter" in made.decorators:
            name = f"{node.name}.setter"
            if self.scope.class_value is not None:
                self.emit("setattr", node, self.scope.class_value, value, data=name)
            return
        self.store_name(node.name, value, node)

    _do_AsyncFunctionDef = _do_FunctionDef

    def _decorated(
        self, value: Instr, node: ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef
    ) -> Instr:
        for decorator in reversed(node.decorator_list):
            if ast.unparse(decorator).rsplit(".", 1)[-1] in _MARKING:
                continue
            function = self.value(decorator)
            value = self.emit("call", node, function, value, data=Shape((None,), decorates=True))
        return value

    def make_function(
        self, node: ast.AST, name: str, arguments: ast.arguments, names: Names
    ) -> Instr:
        """The function as a value; its body is lowered later."""
        function = Function(self._qualified(name), self.module, node)
        positional = [*arguments.posonlyargs, *arguments.args]
        given = [*positional]
        if arguments.vararg:
            function.vararg = len(given)
            given.append(arguments.vararg)
        function.keyword_only = len(given)
        given += arguments.kwonlyargs
        if arguments.kwarg:
            function.kwarg = len(given)
            given.append(arguments.kwarg)
        names.bound.update(argument.arg for argument in given)
        scope = Scope(function, names, self.scope)
        scope.renamed = [dict(renamed) for renamed in self.scope.renamed]
        for renamed in scope.renamed:
            for bound in names.local & renamed.keys():
                del renamed[bound]
            for known in renamed.values():
                if isinstance(known, Variable):
                    known.shared = True
        function.parameters = [scope.make(argument.arg, function) for argument in given]
        defaults: list[Instr] = []
        first = len(positional) - len(arguments.defaults)
        for index, given_default in enumerate(arguments.defaults):
            function.defaults[first + index] = len(defaults)
            defaults.append(self.value(given_default))
        for index, default in enumerate(arguments.kw_defaults):
            if default is not None:
                function.defaults[function.keyword_only + index] = len(defaults)
                defaults.append(self.value(default))
        if self.scope.class_value is not None:
            function.owner = self.class_info
        self.pending.append((function, scope))
        return self.emit("function", node, *defaults, data=function)

    class_info: ClassInfo | None = None

    def _qualified(self, name: str) -> str:
        if self.class_info is not None:
            return f"{self.class_info.qualname}.{name}"
        if self.function.qualname == "<module>":
            return name
        return f"{self.function.qualname}.<locals>.{name}"

    def _do_ClassDef(self, node: ast.ClassDef) -> None:
        info = ClassInfo(self._qualified(node.name), self.module, node)
        self.module.classes.append(info)
        marks = [ast.unparse(mark) for mark in (*node.decorator_list, *node.bases)]
        info.is_record = any("dataclass" in mark or "NamedTuple" in mark for mark in marks)
        info.fields = [
            part.target.id
            for part in node.body
            if isinstance(part, ast.AnnAssign) and isinstance(part.target, ast.Name)
        ]
        bases = [self.value(base) for base in node.bases]
        value = self.emit("class", node, *bases, data=info)
        outer_scope, outer_info = self.scope, self.class_info
        scope = Scope(self.function, names_of(node.body), outer_scope, value)
        scope.renamed = outer_scope.renamed
        self.scope, self.class_info = scope, info
        self.statements(node.body)
        self.scope, self.class_info = outer_scope, outer_info
        self.store_name(node.name, self._decorated(value, node), node)

    # Match: one test after another

    def _do_Match(self, node: ast.Match) -> None:
        subject = self.value(node.subject)
        after = self.new_block()
        for case in node.cases:
            further = self.new_block()
            self._pattern(case.pattern, subject, further)
            if case.guard is not None:
                body = self.new_block()
                self.condition(case.guard, body, further)
                self.block = body
            self.statements(case.body)
            self.jump(after)
            self.block = further
        self.jump(after)
        self.block = after

    def _pattern(self, pattern: ast.pattern, subject: Instr, no: Block) -> None:
        """Test and bind; continue in the current block where it matches, else at ``no``."""
        match pattern:
            case ast.MatchValue(value=value):
                known = isinstance(value, ast.Constant | ast.UnaryOp | ast.BinOp)
                if known:
                    self._test(pattern, subject, no)
                else:
                    outcome = self.emit("compare", pattern, subject, self.value(value), data="Eq")
                    self._go_on(outcome, pattern, no)
            case ast.MatchSingleton():
                self._test(pattern, subject, no)
            case ast.MatchAs(pattern=inner, name=name):
                if inner is not None:
                    self._pattern(inner, subject, no)
                if name is not None:
                    self.store_name(name, subject, pattern)
            case ast.MatchOr(patterns=patterns):
                self._either(patterns, subject, no)
            case ast.MatchStar(name=name):
                if name is not None:
                    self.store_name(name, subject, pattern)
            case ast.MatchSequence(patterns=patterns):
                self._test(pattern, subject, no)
                self._elements(patterns, subject, no)
            case ast.MatchMapping(keys=keys, patterns=patterns, rest=rest):
                self._test(pattern, subject, no)
                for key, inner in zip(keys, patterns, strict=True):
                    where = self.value(key)
                    self._pattern(inner, self.emit("item", inner, subject, where), no)
                if rest is not None:
                    self.store_name(rest, subject, pattern)
            case ast.MatchClass():
                self._class(pattern, subject, no)

    def _either(self, patterns: list[ast.pattern], subject: Instr, no: Block) -> None:
        matched = self.new_block()
        for pattern in patterns:
            other = no if pattern is patterns[-1] else self.new_block()
            self._pattern(pattern, subject, other)
            self.jump(matched)
            self.block = other
        self.block = matched

    def _elements(self, patterns: list[ast.pattern], subject: Instr, no: Block) -> None:
        starred = any(isinstance(pattern, ast.MatchStar) for pattern in patterns)
        for index, pattern in enumerate(patterns):
            self._pattern(pattern, self.part(subject, index, starred, pattern), no)

    def _class(self, pattern: ast.MatchClass, subject: Instr, no: Block) -> None:
        self.value(pattern.cls)
        self._test(pattern, subject, no)
        for index, inner in enumerate(pattern.patterns):
            self._pattern(inner, self.part(subject, index, False, inner), no)
        for name, inner in zip(pattern.kwd_attrs, pattern.kwd_patterns, strict=True):
            self._pattern(inner, self.emit("attr", inner, subject, data=name), no)

    def _test(self, pattern: ast.pattern, subject: Instr, no: Block) -> None:
        """A pattern's own test of the subject is a predicate, like a ``switch``."""
        outcome = self.emit("match", pattern, subject)
        self._go_on(outcome, pattern, no)

    def _go_on(self, outcome: Instr, pattern: ast.pattern, no: Block) -> None:
        yes = self.new_block()
        self.branch(outcome, pattern, yes, no)
        self.block = yes


def _drop_unreachable(function: Function) -> None:
    reached = reachable([function.blocks[0]])
    if function.exit is not None:
        reached.add(function.exit)
    function.blocks = [block for block in function.blocks if block in reached]
    for number, block in enumerate(function.blocks):
        block.number = number
