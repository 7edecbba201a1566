"""Which variable a name means: Python's scoping rules."""

from __future__ import annotations

import ast
from collections.abc import Iterable
from dataclasses import dataclass, field

from pytpc.python_analysis.ir.instructions import Function, Instr, Variable

_OWN_SCOPE = (ast.FunctionDef, ast.AsyncFunctionDef, ast.Lambda, ast.ClassDef)
_COMPREHENSIONS = (ast.ListComp, ast.SetComp, ast.DictComp, ast.GeneratorExp)


@dataclass
class Names:
    """The names that a piece of code binds, and those that it declares as global or nonlocal."""

    bound: set[str] = field(default_factory=set)
    global_: set[str] = field(default_factory=set)
    nonlocal_: set[str] = field(default_factory=set)

    @property
    def local(self) -> set[str]:
        """The names that belong to the code itself."""
        return self.bound - self.global_ - self.nonlocal_


def names_of(body: Iterable[ast.AST]) -> Names:
    """What ``body`` binds, without the functions and classes in it."""
    names = Names()
    waiting = list(body)
    while waiting:
        node = waiting.pop()
        _note(node, names)
        if isinstance(node, _OWN_SCOPE):
            waiting += getattr(node, "decorator_list", [])
            continue
        if isinstance(node, _COMPREHENSIONS):
            waiting += [part for part in ast.walk(node) if isinstance(part, ast.NamedExpr)]
            continue
        waiting += ast.iter_child_nodes(node)
    return names


def _note(node: ast.AST, names: Names) -> None:
    match node:
        case ast.Name(id=name, ctx=ast.Store() | ast.Del()):
            names.bound.add(name)
        case ast.FunctionDef(name=name) | ast.AsyncFunctionDef(name=name) | ast.ClassDef(name=name):
            names.bound.add(name)
        case ast.Global(names=given):
            names.global_.update(given)
        case ast.Nonlocal(names=given):
            names.nonlocal_.update(given)
        case ast.Import(names=aliases):
            names.bound.update(alias.asname or alias.name.split(".")[0] for alias in aliases)
        case ast.ImportFrom(names=aliases):
            names.bound.update(alias.asname or alias.name for alias in aliases)
        case ast.ExceptHandler(name=str(name)):
            names.bound.add(name)
        case ast.MatchAs(name=str(name)) | ast.MatchStar(name=str(name)):
            names.bound.add(name)
        case ast.MatchMapping(rest=str(name)):
            names.bound.add(name)
        case _:
            pass


class Scope:
    """The names of one function, seen from inside; ``parent`` encloses it.

    In the body of a class ``class_value`` is the class, whose attributes are the names bound there.
    ``renamed`` are the variables of comprehensions and unrolled loops, the innermost last.
    """

    def __init__(
        self,
        function: Function,
        names: Names,
        parent: Scope | None,
        class_value: Instr | None = None,
    ) -> None:
        self.function = function
        self.names = names
        self.parent = parent
        self.class_value = class_value
        self.renamed: list[dict[str, Variable | object]] = []

    def own_attribute(self, name: str) -> bool:
        """True where this is a class body that binds ``name``."""
        return self.class_value is not None and name in self.names.local

    def variable(self, name: str) -> Variable | None:
        """The variable ``name``; None where no enclosing code binds it (a builtin)."""
        if name in self.names.global_:
            return _top(self).make(name, self.function)
        if self.class_value is None and name in self.names.local:
            return self.make(name, self.function)
        above = self.parent
        while above is not None:
            hidden = above.class_value is not None
            if not hidden and name in above.names.local:
                return above.make(name, self.function)
            above = above.parent
        return None

    def make(self, name: str, user: Function) -> Variable:
        """The variable ``name`` of this scope's function, which ``user`` uses."""
        owner = self.function
        if name not in owner.variables:
            owner.variables[name] = Variable(name, owner)
        found = owner.variables[name]
        if user is not owner:
            found.shared = True
        return found


def _top(scope: Scope) -> Scope:
    while scope.parent is not None:
        scope = scope.parent
    return scope
