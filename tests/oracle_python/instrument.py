"""Programs in which each comparison and each flag says what it compares, and can be turned."""

from __future__ import annotations

import ast
from dataclasses import dataclass

_SIGNS = {
    ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=", ast.Eq: "==", ast.NotEq: "!=",
    ast.Is: "is", ast.IsNot: "is not", ast.In: "in", ast.NotIn: "not in",
}  # fmt: skip


@dataclass(frozen=True)
class Place:
    """A comparison (``sign`` is its operator) or a flag (``sign`` is ``flag``).

    Line and column (from 1) of its first character, and of the one behind its last.
    ``can_turn`` is False where turning the outcome would change a value as well.
    """

    file: str
    span: tuple[int, int, int, int]
    sign: str
    can_turn: bool = True


class Instrument(ast.NodeTransformer):
    """Rewrites one module; ``places`` is the table of all modules."""

    def __init__(self, file: str, places: list[Place]) -> None:
        """``file`` is the module's name in places."""
        self.file = file
        self.places = places

    def run(self, source: str) -> ast.Module:
        """The rewritten module."""
        tree = self.visit(ast.parse(source))
        assert isinstance(tree, ast.Module)
        return ast.fix_missing_locations(tree)

    def _number(self, first: ast.expr, last: ast.expr, sign: str, can_turn: bool = True) -> int:
        assert last.end_lineno is not None
        assert last.end_col_offset is not None
        span = (first.lineno, first.col_offset + 1, last.end_lineno, last.end_col_offset + 1)
        self.places.append(Place(self.file, span, sign, can_turn))
        return len(self.places) - 1

    # Comparisons

    def visit_Compare(self, node: ast.Compare) -> ast.expr:
        """Each link becomes a call; further operands are evaluated on demand."""
        operands = [node.left, *node.comparators]
        numbers = [
            self._number(
                node if at == 0 else operands[at],
                node if at == len(node.ops) - 1 else operands[at + 1],
                _SIGNS[type(op)],
            )
            for at, op in enumerate(node.ops)
        ]
        values = [self.visit(operand) for operand in operands]
        if len(numbers) == 1:
            return _call("__compare__", _constant(numbers[0]), *values)
        later = [ast.Lambda(_no_arguments(), value) for value in values[1:]]
        return _call("__chain__", _constant(numbers[0]), values[0], *later)

    # Conditions

    def _condition(self, node: ast.expr) -> ast.expr:
        match node:
            case ast.BoolOp(op=op, values=values):
                return ast.BoolOp(op, [self._condition(value) for value in values])
            case ast.UnaryOp(op=ast.Not() as op, operand=operand):
                return ast.UnaryOp(op, self._condition(operand))
            case ast.Compare() | ast.Constant():
                visited: ast.expr = self.visit(node)
                return visited
            case _:
                return _call("__flag__", _constant(self._number(node, node, "flag")), self.visit(node))

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.expr:
        """In a value all operands but the last decide."""
        values = []
        for value in node.values:
            decides = value is not node.values[-1]
            if decides and isinstance(value, ast.Name | ast.Attribute | ast.Subscript | ast.Call):
                number = self._number(value, value, "flag", can_turn=False)
                values.append(_call("__seen__", _constant(number), self.visit(value)))
            else:
                values.append(self.visit(value))
        return ast.BoolOp(node.op, values)

    def visit_If(self, node: ast.If) -> ast.AST:
        """Its test."""
        return self._tested(node)

    def visit_While(self, node: ast.While) -> ast.AST:
        """Its test, and a step of each round."""
        found = self._tested(node)
        assert isinstance(found, ast.While)
        found.body.insert(0, ast.Expr(_call("__step__")))
        return found

    def visit_For(self, node: ast.For) -> ast.AST:
        """A step of each round."""
        self.generic_visit(node)
        node.body.insert(0, ast.Expr(_call("__step__")))
        return node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.AST:
        """A step of each call."""
        self.generic_visit(node)
        node.body.insert(0, ast.Expr(_call("__step__")))
        return node

    def visit_IfExp(self, node: ast.IfExp) -> ast.AST:
        """Its test."""
        return self._tested(node)

    def visit_Assert(self, node: ast.Assert) -> ast.AST:
        """Its test."""
        return self._tested(node)

    def _tested(self, node: ast.If | ast.While | ast.IfExp | ast.Assert) -> ast.AST:
        test = self._condition(node.test)
        node.test = ast.Constant(True)
        self.generic_visit(node)
        node.test = test
        return node

    def visit_comprehension(self, node: ast.comprehension) -> ast.AST:
        """Its conditions."""
        tests = [self._condition(test) for test in node.ifs]
        node.ifs = []
        self.generic_visit(node)
        node.ifs = tests
        return node

    def visit_ExceptHandler(self, node: ast.ExceptHandler) -> ast.AST:
        """What is caught is looked at."""
        self.generic_visit(node)
        node.body.insert(0, ast.Expr(_call("__caught__")))
        return node


def _call(name: str, *args: ast.expr) -> ast.Call:
    return ast.Call(ast.Name(name, ast.Load()), list(args), [])


def _constant(value: int) -> ast.Constant:
    return ast.Constant(value)


def _no_arguments() -> ast.arguments:
    return ast.arguments([], [], None, [], [], None, [])
