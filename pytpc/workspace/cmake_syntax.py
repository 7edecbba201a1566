"""Whether CMake can parse a list file: its lexical grammar and the nesting of its blocks.

The grammar is that of the manual page cmake-language(7), sections "Source Files" and "Command
Arguments", together with the two legacy forms of unquoted arguments that it describes. What CMake
only warns about (arguments without white space between them) is no fault here either.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum

UTF8_BOM = b"\xef\xbb\xbf"
_OTHER_BOMS = (b"\xff\xfe", b"\xfe\xff", b"\x00\x00\xfe\xff")


@dataclass(frozen=True, slots=True)
class SyntaxFault:
    """Why CMake cannot parse a file, and the line where the faulty thing begins."""

    line: int
    message: str


class Kind(Enum):
    """Kinds of tokens; the value is how a message calls one."""

    NEWLINE = "the end of the line"
    SPACE = "white space"
    LINE_COMMENT = "a comment"
    BRACKET_COMMENT = "a bracket comment"
    BRACKET = "a bracket argument"
    QUOTED = "a quoted argument"
    IDENTIFIER = "a name"
    UNQUOTED = "an unquoted argument"
    OPEN = '"("'
    CLOSE = '")"'
    OPEN_STRING = "a quoted argument that is never closed"
    OPEN_BRACKET = "a bracket that is never closed"
    BAD = "a character that has no meaning here"


@dataclass(frozen=True, slots=True)
class Token:
    """A token, its bytes, and the line on which it begins."""

    kind: Kind
    text: bytes
    line: int


# One element of an unquoted argument: a character without a meaning of its own, or an escape.
_ELEMENT = rb'[^\0\t\n\r "#()=\[\\]|\\[^\0\n]'
_MAKE_VARIABLE = rb"\$\([A-Za-z0-9_]*\)"
_LEGACY_QUOTED = rb'"(?:' + _MAKE_VARIABLE + rb"|" + _ELEMENT + rb'|[ \t=\[])*"'
_TOKEN = re.compile(
    rb"(?P<NEWLINE>\n)"
    rb"|(?P<SPACE>[ \t\r]+)"
    rb"|(?P<BRACKET_COMMENT>\#(?=\[=*\[))"
    rb"|(?P<LINE_COMMENT>\#[^\n]*)"
    rb"|(?P<BRACKET>(?=\[=*\[))"
    rb"|(?P<OPEN>\()"
    rb"|(?P<CLOSE>\))"
    rb'|(?P<QUOTED>"(?:[^"\\]|\\.)*")'
    rb'|(?P<OPEN_STRING>".*)'
    rb"|(?P<UNQUOTED>"
    rb"(?:" + _MAKE_VARIABLE + rb"|" + _ELEMENT + rb"|=)"
    rb"(?:" + _MAKE_VARIABLE + rb"|" + _ELEMENT + rb"|[=\[]|" + _LEGACY_QUOTED + rb")*"
    rb"|\[)"
    rb"|(?P<BAD>.)",
    re.DOTALL,
)
_BRACKET_OPENING = re.compile(rb"\[(=*)\[")
_ESCAPE = re.compile(r"\\([^;])")
_IDENTIFIER = re.compile(rb"[A-Za-z_][A-Za-z0-9_]*")

_PIECES = frozenset({Kind.IDENTIFIER, Kind.UNQUOTED, Kind.QUOTED, Kind.BRACKET})
_BLOCKS = frozenset({"if", "foreach", "while", "function", "macro", "block"})


def tokens(data: bytes) -> Iterator[Token]:
    """Split the bytes of a list file, without a byte order mark, into tokens.

    Every byte belongs to exactly one token, but that a carriage return before a line feed counts
    as part of the line feed. The last token may be ``OPEN_STRING`` or ``OPEN_BRACKET``.
    """
    text = data.replace(b"\r\n", b"\n")
    at, line = 0, 1
    while at < len(text):
        token = _token_at(text, at, line)
        yield token
        at += len(token.text)
        line += token.text.count(b"\n")


def find_fault(data: bytes) -> SyntaxFault | None:
    """The first thing that keeps CMake from parsing the file, or None.

    Args:
        data: the bytes of a CMakeLists.txt or other list file.
    """
    if data.startswith(_OTHER_BOMS):
        return SyntaxFault(1, "the byte order mark is not that of UTF-8")
    found, fault = _parse(data)
    return fault or _nesting_fault(found)


@dataclass(frozen=True, slots=True)
class CmakeArgument:
    """An argument of a command: its text without quotes and escapes, variables not looked up."""

    text: str
    is_quoted: bool


@dataclass(frozen=True, slots=True)
class Command:
    """A command of a list file, its name in lower case."""

    name: str
    line: int
    arguments: list[CmakeArgument]


def commands(data: bytes) -> list[Command]:
    """The commands of a list file, up to a fault in it.

    Commands that only variables or included files give are not among them.
    """
    return _parse(data)[0]


def _parse(data: bytes) -> tuple[list[Command], SyntaxFault | None]:
    found: list[Command] = []
    try:
        for command in _parsed(tokens(data.removeprefix(UTF8_BOM))):
            found.append(command)
    except _FaultError as error:
        return found, error.fault
    return found, None


def _argument(token: Token) -> CmakeArgument:
    text = token.text.decode("utf-8", "replace")
    if token.kind is Kind.BRACKET:
        opening = text.index("[", 1) + 1
        return CmakeArgument(text[opening:-opening].removeprefix("\n"), True)
    if token.kind is Kind.QUOTED:
        text = text[1:-1].replace("\\\n", "")
    return CmakeArgument(_ESCAPE.sub(_unescaped, text), token.kind is Kind.QUOTED)


def _unescaped(match: re.Match[str]) -> str:
    return {"t": "\t", "n": "\n", "r": "\r"}.get(match[1], match[1])


class _FaultError(Exception):
    def __init__(self, line: int, message: str) -> None:
        super().__init__(message)
        self.fault = SyntaxFault(line, message)


def _parsed(stream: Iterator[Token]) -> Iterator[Command]:
    """The commands, each before its arguments are read: a fault may be in these."""
    line_is_fresh = True
    for token in stream:
        match token.kind:
            case Kind.NEWLINE:
                line_is_fresh = True
            case Kind.SPACE | Kind.LINE_COMMENT:
                pass
            case Kind.BRACKET_COMMENT:
                line_is_fresh = False
            case Kind.IDENTIFIER if line_is_fresh:
                shown = token.text.decode("ascii")
                _open(token.line, shown, stream)
                command = Command(shown.lower(), token.line, [])
                yield command
                command.arguments.extend(_arguments(token.line, shown, stream))
                line_is_fresh = False
            case Kind.IDENTIFIER:
                raise _FaultError(token.line, f"expected a new line before {_quoted(token.text)}")
            case _:
                raise _unexpected("expected a command name", token)


def _open(line: int, shown: str, stream: Iterator[Token]) -> None:
    opening = next((token for token in stream if token.kind is not Kind.SPACE), None)
    if opening is None:
        raise _FaultError(line, f'expected "(" after {shown}, found the end of the file')
    if opening.kind is not Kind.OPEN:
        raise _unexpected(f'expected "(" after {shown}', opening)


def _arguments(line: int, shown: str, stream: Iterator[Token]) -> Iterator[CmakeArgument]:
    """The arguments up to the closing parenthesis; parentheses among them are left out."""
    depth = 1
    before = Kind.SPACE
    for token in stream:
        match token.kind:
            case Kind.OPEN:
                depth += 1
            case Kind.CLOSE:
                depth -= 1
                if depth == 0:
                    return
            case kind if kind in _PIECES:
                _check_separation(before, token)
                yield _argument(token)
            case Kind.OPEN_STRING | Kind.OPEN_BRACKET | Kind.BAD:
                raise _unexpected(f"in the arguments of {shown}", token)
        before = token.kind
    raise _FaultError(line, f'the "(" of {shown} is never closed')


def _token_at(text: bytes, at: int, line: int) -> Token:
    match = _TOKEN.match(text, at)
    if match is None or match.lastgroup is None:
        raise AssertionError("the last alternative takes any byte")
    kind = Kind[match.lastgroup]
    end = match.end()
    if kind in (Kind.BRACKET, Kind.BRACKET_COMMENT):
        opening = _BRACKET_OPENING.match(text, end)
        if opening is None:
            raise AssertionError("the lookahead saw an opening bracket")
        closing = b"]" + opening[1] + b"]"
        close = text.find(closing, opening.end())
        if close < 0:
            return Token(Kind.OPEN_BRACKET, text[at:], line)
        end = close + len(closing)
    elif kind is Kind.UNQUOTED and _IDENTIFIER.fullmatch(text, at, end):
        kind = Kind.IDENTIFIER
    return Token(kind, text[at:end], line)


def _check_separation(before: Kind, token: Token) -> None:
    """Nothing may touch a bracket argument or a bracket comment; elsewhere CMake only warns."""
    touches = before in _PIECES or before in (Kind.CLOSE, Kind.BRACKET_COMMENT)
    strict = token.kind is Kind.BRACKET or before in (Kind.BRACKET, Kind.BRACKET_COMMENT)
    if touches and strict:
        raise _FaultError(
            token.line, f"white space is missing between {before.value} and {token.kind.value}"
        )


def _unexpected(expectation: str, token: Token) -> _FaultError:
    shown = token.kind.value
    if token.kind in (Kind.IDENTIFIER, Kind.UNQUOTED, Kind.BAD):
        shown = f"{shown}, {_quoted(token.text)}"
    return _FaultError(token.line, f"{expectation}, found {shown}")


def _quoted(text: bytes) -> str:
    shown = text[:40].decode("utf-8", "backslashreplace")
    return '"' + "".join(c if c.isprintable() else f"\\x{ord(c):02x}" for c in shown) + '"'


def _nesting_fault(found: list[Command]) -> SyntaxFault | None:
    """Blocks must be closed by their own end, and else() comes once and last in an if()."""
    opened: list[tuple[str, int]] = []
    for name, line in ((command.name, command.line) for command in found):
        if name in _BLOCKS:
            opened.append((name, line))
        elif name in ("else", "elseif"):
            if not opened or opened[-1][0] != "if":
                return SyntaxFault(line, f"{name}() without an if(), or after its else()")
            if name == "else":
                opened[-1] = ("else", opened[-1][1])
        elif name.startswith("end") and name.removeprefix("end") in _BLOCKS:
            block = name.removeprefix("end")
            inner = opened.pop() if opened else ("", 0)
            if {"else": "if"}.get(inner[0], inner[0]) != block:
                missing = f": {inner[0]}() of line {inner[1]} is still open" if inner[1] else ""
                return SyntaxFault(line, f"{name}() without {block}(){missing}")
    if opened:
        name, line = opened[-1]
        block = {"else": "if"}.get(name, name)
        return SyntaxFault(line, f"{block}() is never closed by end{block}()")
    return None
