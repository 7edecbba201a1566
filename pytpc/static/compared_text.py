"""What a comparison compares, read from its source line alone.

Of an older build only the static information is left, so nothing is parsed: the line is split at
its comparison operators, and the side that names the threshold is told from the other one. A line
where that is not clear gives nothing.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple

MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<=", "==": "==", "!=": "!="}
"""Each operator, and the one that says the same with its sides exchanged."""

_TOKEN = re.compile(
    r"""(?P<text>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*')"""
    r"|(?P<arrow>->\*?|<<=?|>>=?|::|<=>)"
    r"|(?P<relation><=|>=|==|!=|<|>)"
    r"|(?P<end>&&|\|\||[?:;,{}]|\breturn\b|\band\b|\bor\b|\bif\b|\belif\b|\bwhile\b|\bassert\b"
    r"|(?<![=!<>+\-*/%&|^])=(?!=))"
    r"|(?P<open>[(\[])|(?P<close>[)\]])"
    r"|(?P<other>.)",
    re.DOTALL,
)
_TEMPLATE = re.compile(
    r"\b(static_cast|dynamic_cast|reinterpret_cast|const_cast|vector|map|set|numeric_limits|max|min"
    r"|abs|shared_ptr|pair)\s*<[^<>()]*>"
)
_SPACE = re.compile(r"\s+")
_WORD = re.compile(r"\w")
_PATH_BACKWARDS = re.compile(r"(?:[\w.\[\]]|>-|::)*")
_NOT_BACKWARDS = re.compile(r"\s*!|\s+ton\b")


class Sides(NamedTuple):
    """The two sides of a comparison: that of the threshold, and the operator as it is written."""

    compared: str
    threshold: str
    written: str


def without_space(text: str | None) -> str:
    """A source line as it is compared with another: spaces count only between words.

    >>> without_space("if ( a<b )"), without_space("return  a < b;"), without_space(None)
    ('if(a<b)', 'return a<b;', '')
    """
    squeezed = _SPACE.sub(" ", text or "").strip()
    parts = squeezed.split(" ")
    made = parts[0]
    for part in parts[1:]:
        both = _WORD.match(made[-1:]) and _WORD.match(part[:1])
        made += f" {part}" if both else part
    return made


def without_name(line: str, name: str | None) -> str:
    """A line without the name of its threshold.

    >>> without_name("if(a<node->limit_)", "Node::limit_")
    'if(a<node->)'
    """
    return line if not name else re.sub(rf"(?<!\w){re.escape(_last(name))}(?!\w)", "", line)


def sides(line: str | None, name: str | None, relation: str) -> Sides | None:
    """The two sides of the comparison with the threshold ``name``; None if that is not clear.

    Args:
        line: the source line.
        name: the variable with the threshold, or a number.
        relation: the operator, with the threshold on its right-hand side.

    >>> sides("if (limit_ < speed && x < 3)", "limit_", ">")
    Sides(compared='speed', threshold='limit_', written='<')
    """
    if not line or not name or relation not in MIRRORED:
        return None
    found = []
    for left, written, right in _comparisons(line):
        if written == relation and _names(right, name):
            found.append(Sides(left, right, written))
        if written == MIRRORED[relation] and _names(left, name):
            found.append(Sides(right, left, written))
    return found[0] if len(found) == 1 else None


def only_comparison(line: str | None, relation: str) -> tuple[str, str] | None:
    """Both sides of the only comparison of a line with this operator, or the mirrored one.

    They are as with ``relation``, so that ``a > b`` and ``b < a`` give the same. None if the line
    has several such comparisons, or none.

    >>> only_comparison("if (ready && now > limit())", ">"), only_comparison("limit() < now)", ">")
    (('now', 'limit()'), ('now', 'limit()'))
    """
    if not line or relation not in MIRRORED:
        return None
    found = []
    for left, written, right in _comparisons(line):
        if written == relation:
            found.append((left, right))
        elif written == MIRRORED[relation]:
            found.append((right, left))
    return found[0] if len(found) == 1 else None


def is_negated(line: str | None, name: str | None) -> bool | None:
    """Whether a flag is read with a ``!`` or ``not`` before it; None if that is not clear.

    >>> is_negated("if (!use_ && x)", "use_"), is_negated("if (a.use_)", "use_")
    (True, False)
    """
    if not line or not name:
        return None
    found = list(re.finditer(rf"\b{re.escape(_last(name))}\b(?!\s*\()", line))
    if len(found) != 1:
        return None
    # Backwards from the name over what it is a member of.
    before = line[: found[0].start()][::-1]
    path = _PATH_BACKWARDS.match(before)
    return _NOT_BACKWARDS.match(before, path.end() if path else 0) is not None


def _comparisons(line: str) -> list[tuple[str, str, str]]:
    """Each comparison of a line: its left side, its operator, its right side."""
    tokens = _tokens(_TEMPLATE.sub(lambda found: " " * len(found[0]), line))
    found = []
    for number, (kind, start, end) in enumerate(tokens):
        if kind == "relation":
            left = _reach(map(tokens.__getitem__, range(number - 1, -1, -1)), "close", "open")
            right = _reach(map(tokens.__getitem__, range(number + 1, len(tokens))), "open", "close")
            begin = left[-1][1] if left else start
            stop = right[-1][2] if right else end
            sides_ = _bare(line[begin:start]), line[start:end], _bare(line[end:stop])
            if sides_[0] and sides_[2]:
                found.append(sides_)
    return found


def _tokens(line: str) -> list[tuple[str, int, int]]:
    return [(str(one.lastgroup), one.start(), one.end()) for one in _TOKEN.finditer(line)]


def _reach(
    tokens: Iterable[tuple[str, int, int]], deeper: str, higher: str
) -> list[tuple[str, int, int]]:
    """The tokens up to the end of the operand: a bracket that it does not open, or an operator."""
    depth, reached = 0, []
    for token in tokens:
        kind = token[0]
        depth += (kind == deeper) - (kind == higher)
        if depth < 0 or (depth == 0 and kind in ("end", "relation")):
            break
        reached.append(token)
    return reached


def _bare(text: str) -> str:
    """The operand without spaces, and without brackets around all of it."""
    bare = without_space(text)
    while bare.startswith("(") and bare.endswith(")") and _is_one(bare):
        bare = bare[1:-1]
    return bare


def _is_one(text: str) -> bool:
    """Whether the first bracket is closed by the last."""
    depth = 0
    for place, letter in enumerate(text):
        depth += (letter == "(") - (letter == ")")
        if depth == 0:
            return place == len(text) - 1
    return False


def _names(side: str, name: str) -> bool:
    last = _last(name)
    return re.search(rf"(?<!\w){re.escape(last)}(?!\w)", side) is not None


def _last(name: str) -> str:
    return re.split(r"::|\.|->", name)[-1].strip() or name
