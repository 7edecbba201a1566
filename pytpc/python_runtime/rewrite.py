"""Rewrites a module so that its listed comparisons report.

Text -> syntax tree -> the same tree with calls in it -> code. The program's own frame still
evaluates each subexpression exactly once, in the original place and order: ``yield``, ``await`` and
``:=`` in an operand work as before. Rewritten code keeps the position of the comparison, so that
tracebacks, debuggers and coverage show the lines and columns of the source.

The calls go to an object (`pytpc.python_runtime.sites`) that is a constant of the code: no
namespace changes. `ast` has no such constants, so the tree has a text for each, and the compiled
code gets the object in its place.
"""

from __future__ import annotations

import ast
import sys
from types import CodeType
from typing import TYPE_CHECKING, NamedTuple

from pytpc.python_runtime.find import FoundPlaces, ListedPlace, find, values_of
from pytpc.python_runtime.implicit_sites import ComparedInside, LibraryCall, Loop, Subject
from pytpc.python_runtime.listed import Listed
from pytpc.python_runtime.sites import ComparisonSite, FlagSite, Reported

if TYPE_CHECKING:
    from collections.abc import Callable

    Register = Callable[[ListedPlace], Reported]

# Python 3.11 gives a failed `assert` the position of the comparison in it, if there is one, and an
# error in the truth of a condition that of the comparison before it.
_ASSERTS_AT_COMPARISON = sys.version_info[:2] == (3, 11)
# From Python 3.13 on, the compiler joins a comparison with a `not` whose result is kept: errors of
# either have the position of `not`.
_NOT_COMPARES = sys.version_info >= (3, 13)
# Until Python 3.11 an error in the truth of a condition has the position of the code that tests it,
# later that of the condition.
_ASKERS_PLACE = sys.version_info < (3, 12)
_MARK = "\0tpc constant "


class Rewritten(NamedTuple):
    """A module's code, the number of comparisons that report, and those that do not."""

    code: CodeType
    instrumented: int
    missing: list[Listed]
    unsupported: list[Listed]


def rewrite(
    source: object, path: str, listed: tuple[Listed, ...], register: Register, *, optimize: int = -1
) -> Rewritten:
    """Compile a module with reports in it.

    Args:
        source: its text or bytes, or anything else that ``compile`` takes.
        path: its name in tracebacks.
        listed: the comparisons of this module.
        register: gives the report of a place.
        optimize: as in ``compile``; -1: as the interpreter was started.

    Raises:
        SyntaxError: as in ``compile``.
    """
    tree = compile(source, path, "exec", ast.PyCF_ONLY_AST, dont_inherit=True)  # type: ignore[call-overload]
    found = find(tree, listed)
    constants: dict[str, object] = {}
    _Rewriter(found, register, constants).fields(tree)
    code = compile(tree, path, "exec", dont_inherit=True, optimize=optimize)
    return Rewritten(
        with_constants(code, constants), found.total(), found.missing, found.unsupported
    )


def constant_text(number: int) -> str:
    """The text that stands in the tree for an object among the constants of the code."""
    return f"{_MARK}{number}"


def with_constants(code: CodeType, constants: dict[str, object]) -> CodeType:
    """The code with objects in place of the texts that stand for them, nested code included."""

    def replaced(constant: object) -> object:
        if isinstance(constant, CodeType):
            return with_constants(constant, constants)
        if type(constant) is str and constant.startswith(_MARK):
            return constants[constant]
        return constant

    consts = tuple(replaced(constant) for constant in code.co_consts)
    if all(new is old for new, old in zip(consts, code.co_consts)):
        return code
    return code.replace(co_consts=consts)


class _Chain(NamedTuple):
    """A comparison, what its links report, and whether only its truth is used.

    ``place`` is the expression whose position its last link gets.
    """

    node: ast.Compare
    links: dict[int, list[ListedPlace]]
    asked: bool
    place: ast.expr


class _Rewriter:
    """Changes a tree in place.

    ``asked``: the program tests the truth of an expression once, and uses nothing else of it.
    """

    def __init__(
        self, found: FoundPlaces, register: Register, constants: dict[str, object]
    ) -> None:
        self._found = found
        self._register = register
        self._constants = constants
        # What tests the truth of a condition: a statement, an expression, a pattern.
        self._asker: ast.AST = ast.Module(body=[], type_ignores=[])

    def fields(self, node: ast.AST) -> None:
        """Rewrite the expressions and statements in ``node``."""
        if isinstance(node, ast.stmt):
            self._asker = node
        elif type(node).__name__ == "match_case":
            self._asker = node.pattern  # type: ignore[attr-defined]
        for name, value in ast.iter_fields(node):
            if isinstance(value, ast.expr):
                setattr(node, name, self._expression(value, _is_asked(node, name)))
            elif isinstance(value, list):
                value[:] = [
                    self._expression(item, _is_asked(node, name))
                    if isinstance(item, ast.expr)
                    else self._other(item)
                    for item in value
                ]
            elif isinstance(value, ast.AST):
                self.fields(value)

    def _other(self, item: object) -> object:
        if type(item).__name__ == "Match":
            self._match(item)  # type: ignore[arg-type]
        elif isinstance(item, ast.AST):
            self.fields(item)
        return item

    def _match(self, node: ast.Match) -> None:
        """A ``match`` of a parameter, or with a parameter among its values.

        ``case VALUE`` becomes ``case _ if subject == VALUE``, which means the same. Each guard ends
        with a call that reports the case as taken; a last case reports that none was.
        """
        compared = [
            [value for value in values_of(case.pattern) if value in self._found.patterns]
            for case in node.cases
        ]
        places = self._found.subjects.get(node.subject, [])
        original = node.subject
        self.fields(node)
        if not places and not any(compared):
            return
        subject = Subject(tuple(self._register(place) for place in places))
        node.subject = self._call(
            self._constant(subject, _first(original)), "hold", [node.subject], node.subject
        )
        for case, values in zip(node.cases, compared):
            is_last = case is node.cases[-1]
            is_default = (
                isinstance(case.pattern, ast.MatchAs)
                and case.pattern.pattern is None
                and case.guard is None
            )
            if is_default and not is_last:
                # A syntax error, which the compiler reports.
                continue
            where = ast.copy_location(ast.Constant(value=True, kind=None), case.pattern)
            if is_default:
                # It still matches everything, so that the `match` ends as before.
                call = self._call(self._constant(subject, where), "default", [], where)
                case.body.insert(0, ast.copy_location(ast.Expr(value=call), where))
                return
            said = self._call(self._constant(subject, where), "taken", [], where)
            guards = [self._equality(case, subject, where)] if values else []
            guards += [case.guard] if case.guard is not None else []
            case.guard = self._joined(ast.And(), [*guards, said], where)
        last = node.cases[-1].pattern
        where = ast.copy_location(ast.Constant(value=True, kind=None), last)
        none = self._call(self._constant(subject, where), "none", [], where)
        nothing = ast.copy_location(ast.Pass(), last)
        anything = ast.copy_location(ast.MatchAs(), last)
        node.cases.append(ast.match_case(pattern=anything, guard=none, body=[nothing]))

    def _equality(self, case: ast.match_case, subject: Subject, where: ast.expr) -> ast.expr:
        """The pattern of a case as a condition; the case gets a pattern that matches everything."""
        conditions = []
        for value in values_of(case.pattern):
            held = self._call(self._constant(subject, where), "held", [], value)
            equal = ast.copy_location(
                ast.Compare(left=held, ops=[ast.Eq()], comparators=[value]), value
            )
            links = {0: self._found.patterns.get(value, [])}
            conditions.append(self._chain(_Chain(equal, links, True, equal), 0, held, held))
        case.pattern = ast.copy_location(ast.MatchAs(), case.pattern)
        return self._joined(ast.Or(), conditions, where)

    @staticmethod
    def _joined(operator: ast.boolop, parts: list[ast.expr], where: ast.expr) -> ast.expr:
        if len(parts) == 1:
            return parts[0]
        return ast.copy_location(ast.BoolOp(op=operator, values=parts), where)

    def _expression(
        self, node: ast.expr, asked: bool, negation: ast.expr | None = None
    ) -> ast.expr:
        """The replacement of ``node``, which is the operand of ``negation`` if there is one."""
        flags = self._found.flags.get(node)
        links = self._found.links.get(node) if isinstance(node, ast.Compare) else None
        asker = self._asker
        is_branch = asked and isinstance(node, _BRANCHES)
        if not is_branch:
            self._asker = node
        self._parts(node, asked and not flags)
        if not is_branch:
            self._asker = asker
        if asked and isinstance(node, ast.Compare) and _ASSERTS_AT_COMPARISON:
            self._asker = node
        new: ast.expr = node
        if links is not None and isinstance(node, ast.Compare):
            place = negation if negation is not None and _is_joined(node) else node
            new = self._chain(_Chain(node, links, asked, place), 0, node.left, _first(node.left))
            if asked and _ASSERTS_AT_COMPARISON:
                true = ast.copy_location(ast.Constant(value=True, kind=None), node)
                still = ast.Compare(left=new, ops=[ast.Is()], comparators=[true])
                new = ast.copy_location(still, node)
        calls = self._found.calls.get(node)
        if calls is not None and isinstance(node, ast.Call):
            new = self._library_call(node, calls)
        if flags is not None:
            new = self._flag(new, flags, asker if asked else None)
        loops = self._found.loops.get(node)
        if loops is not None:
            loop = Loop(tuple(self._register(place) for place in loops))
            new = self._call(self._constant(loop, _first(node)), "over", [new], node)
        return new

    def _parts(self, node: ast.expr, asked: bool) -> None:
        """Rewrite the operands. If ``and``, ``or``, ``not`` or ``? :`` is asked, so are they."""
        if isinstance(node, ast.BoolOp):
            node.values[:] = [self._expression(value, asked) for value in node.values]
        elif isinstance(node, ast.IfExp):
            node.test = self._expression(node.test, True)
            node.body = self._expression(node.body, asked)
            node.orelse = self._expression(node.orelse, asked)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            # As a value, `not x` itself tests x, and errors of x have the position of `not`.
            node.operand = self._expression(node.operand, asked, None if asked else node)
        else:
            self.fields(node)

    def _constant(self, value: object, where: ast.expr) -> ast.expr:
        mark = constant_text(len(self._constants))
        self._constants[mark] = value
        return _at(ast.Constant(value=mark, kind=None), where)

    def _call(
        self, site: ast.expr, method: str, arguments: list[ast.expr], to: ast.AST
    ) -> ast.expr:
        """``SITE.method(arguments).__next__()``, whose attribute ends on the line of the call.

        Otherwise Python takes the line on which the attribute ends for that of the call.
        """
        attribute = ast.Attribute(value=site, attr=method, ctx=ast.Load())
        _at(attribute, site)
        call = ast.copy_location(ast.Call(func=attribute, args=arguments, keywords=[]), to)
        attribute = ast.Attribute(value=call, attr="__next__", ctx=ast.Load())
        ast.copy_location(attribute, to)
        attribute.end_lineno, attribute.end_col_offset = call.lineno, call.col_offset
        return ast.copy_location(ast.Call(func=attribute, args=[], keywords=[]), to)

    def _chain(self, chain: _Chain, link: int, left: ast.expr, first: ast.expr) -> ast.expr:
        """The comparison from ``link`` on, with ``left`` as its left operand.

        Its evaluation begins at ``first``. Links behind the last one that reports are not changed.
        """
        node, links = chain.node, chain.links
        if link > max(links):
            rest = ast.Compare(left=left, ops=node.ops[link:], comparators=node.comparators[link:])
            return ast.copy_location(rest, node)
        reported = tuple(self._register(place) for place in links.get(link, ()))
        comparison = ComparisonSite(type(node.ops[link]).__name__, reported)
        right = node.comparators[link]
        is_last = link + 1 == len(node.ops)
        method = "link" if not is_last else "truth" if chain.asked else "compare"
        site = self._constant(comparison, first)
        this = self._call(site, method, [left, right], chain.place if is_last else node)
        if is_last:
            return this
        handed = self._call(self._constant(comparison, node), "right", [], node)
        ending = "failed" if chain.asked else "outcome"
        ended = self._call(self._constant(comparison, node), ending, [], node)
        body = self._chain(chain, link + 1, handed, node)
        return ast.copy_location(ast.IfExp(test=this, body=body, orelse=ended), node)

    def _library_call(self, node: ast.Call, places: list[ListedPlace]) -> ast.expr:
        inside = tuple(
            ComparedInside(self._register(place), place.listed.relation, place.listed.operand or "")
            for place in places
        )
        names: list[ast.expr | None] = [
            ast.copy_location(ast.Constant(value=keyword.arg, kind=None), keyword.value)
            for keyword in node.keywords
        ]
        keywords = ast.Dict(keys=names, values=[keyword.value for keyword in node.keywords])
        ast.copy_location(keywords, node)
        site = self._constant(LibraryCall(inside), _first(node))
        return self._call(site, "call", [node.func, *node.args, keywords], node)

    def _flag(self, node: ast.expr, places: list[ListedPlace], asker: ast.AST | None) -> ast.expr:
        """``node`` with a report of its truth, which ``asker`` tests; None where it is a value."""
        flag = FlagSite(tuple(self._register(place) for place in places))
        method = "value" if asker is None else "truth"
        place = node if asker is None or not _ASKERS_PLACE else asker
        return self._call(self._constant(flag, _first(node)), method, [node], place)


# These test nothing themselves where their truth is tested.
_BRANCHES = (ast.BoolOp, ast.IfExp, ast.UnaryOp)
_ASKING = {
    "If": ("test",),
    "While": ("test",),
    "Assert": ("test",),
    "comprehension": ("ifs",),
    "match_case": ("guard",),
}
# The field that an expression evaluates first.
_FIRST = {
    "Attribute": "value",
    "Await": "value",
    "BinOp": "left",
    "Call": "func",
    "Compare": "left",
    "FormattedValue": "value",
    "IfExp": "test",
    "NamedExpr": "value",
    "Starred": "value",
    "Subscript": "value",
    "UnaryOp": "operand",
}


def _is_asked(node: ast.AST, field: str) -> bool:
    return field in _ASKING.get(type(node).__name__, ())


def _is_joined(node: ast.Compare) -> bool:
    """Whether the compiler joins this comparison with the ``not`` whose operand it is."""
    is_ordinary = not isinstance(node.ops[0], (ast.Is, ast.IsNot, ast.In, ast.NotIn))
    return _NOT_COMPARES and len(node.ops) == 1 and is_ordinary


def _first(node: ast.expr) -> ast.expr:
    """The part of an expression that is evaluated first; tracing sees it begin there."""
    while True:
        field = _FIRST.get(type(node).__name__)
        if field is not None:
            node = getattr(node, field)
        elif isinstance(node, (ast.List, ast.Tuple, ast.Set)) and node.elts:
            node = node.elts[0]
        elif isinstance(node, (ast.BoolOp, ast.JoinedStr)) and node.values:
            node = node.values[0]
        elif isinstance(node, ast.Dict) and node.keys and node.keys[0] is not None:
            node = node.keys[0]
        else:
            return node


def _at(node: ast.expr, where: ast.expr) -> ast.expr:
    """``node`` with no width, at the beginning of ``where``."""
    ast.copy_location(node, where)
    node.end_lineno, node.end_col_offset = node.lineno, node.col_offset
    return node
