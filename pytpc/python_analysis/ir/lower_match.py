"""``match``: one test after another."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from pytpc.python_analysis.ir.instructions import Block, Instr

if TYPE_CHECKING:
    from pytpc.python_analysis.ir.lower_statements import StatementLowering


def lower_match(lowering: StatementLowering, node: ast.Match) -> None:
    """Lower the cases in their order."""
    subject = lowering.value(node.subject)
    after = lowering.new_block()
    for case in node.cases:
        further = lowering.new_block()
        _pattern(lowering, case.pattern, subject, further)
        if case.guard is not None:
            body = lowering.new_block()
            lowering.condition(case.guard, body, further)
            lowering.block = body
        lowering.statements(case.body)
        lowering.jump(after)
        lowering.block = further
    lowering.jump(after)
    lowering.block = after


def _pattern(lowering: StatementLowering, pattern: ast.pattern, subject: Instr, no: Block) -> None:
    """Test and bind; go on in the current block where it matches, at ``no`` where it does not."""
    match pattern:
        case ast.MatchValue(value=value):
            known = isinstance(value, ast.Constant | ast.UnaryOp | ast.BinOp)
            if known:
                _test(lowering, pattern, subject, no)
            else:
                outcome = lowering.emit(
                    "compare", pattern, subject, lowering.value(value), data="Eq"
                )
                _go_on(lowering, outcome, pattern, no)
        case ast.MatchSingleton():
            _test(lowering, pattern, subject, no)
        case ast.MatchAs(pattern=inner, name=name):
            if inner is not None:
                _pattern(lowering, inner, subject, no)
            if name is not None:
                lowering.store_name(name, subject, pattern)
        case ast.MatchOr(patterns=patterns):
            _either(lowering, patterns, subject, no)
        case ast.MatchStar(name=name):
            if name is not None:
                lowering.store_name(name, subject, pattern)
        case ast.MatchSequence(patterns=patterns):
            _test(lowering, pattern, subject, no)
            _elements(lowering, patterns, subject, no)
        case ast.MatchMapping(keys=keys, patterns=patterns, rest=rest):
            _test(lowering, pattern, subject, no)
            for key, inner in zip(keys, patterns, strict=True):
                where = lowering.value(key)
                _pattern(lowering, inner, lowering.emit("item", inner, subject, where), no)
            if rest is not None:
                lowering.store_name(rest, subject, pattern)
        case ast.MatchClass():
            _class(lowering, pattern, subject, no)


def _either(
    lowering: StatementLowering, patterns: list[ast.pattern], subject: Instr, no: Block
) -> None:
    matched = lowering.new_block()
    for pattern in patterns:
        other = no if pattern is patterns[-1] else lowering.new_block()
        _pattern(lowering, pattern, subject, other)
        lowering.jump(matched)
        lowering.block = other
    lowering.block = matched


def _elements(
    lowering: StatementLowering, patterns: list[ast.pattern], subject: Instr, no: Block
) -> None:
    starred = any(isinstance(pattern, ast.MatchStar) for pattern in patterns)
    for index, pattern in enumerate(patterns):
        if starred:
            source = lowering.emit("iter", pattern, subject)
            element = lowering.emit("next", pattern, source)
        else:
            where = lowering.emit("const", pattern, data=index)
            element = lowering.emit("item", pattern, subject, where)
        _pattern(lowering, pattern, element, no)


def _class(lowering: StatementLowering, pattern: ast.MatchClass, subject: Instr, no: Block) -> None:
    lowering.value(pattern.cls)
    _test(lowering, pattern, subject, no)
    for index, inner in enumerate(pattern.patterns):
        where = lowering.emit("const", inner, data=index)
        _pattern(lowering, inner, lowering.emit("item", inner, subject, where), no)
    for name, inner in zip(pattern.kwd_attrs, pattern.kwd_patterns, strict=True):
        _pattern(lowering, inner, lowering.emit("attr", inner, subject, data=name), no)


def _test(lowering: StatementLowering, pattern: ast.pattern, subject: Instr, no: Block) -> None:
    """What a pattern asks of the subject itself decides as a ``switch`` does."""
    outcome = lowering.emit("match", pattern, subject)
    _go_on(lowering, outcome, pattern, no)


def _go_on(lowering: StatementLowering, outcome: Instr, pattern: ast.pattern, no: Block) -> None:
    yes = lowering.new_block()
    lowering.branch(outcome, pattern, yes, no)
    lowering.block = yes
