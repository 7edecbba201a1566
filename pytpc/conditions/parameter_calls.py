"""What the source beside a call that reads a parameter says: whether the value must be set.

The static information has the name and the default of a read. Here the text around it is looked at:
what the node does without a value, whether it calls the name deprecated, and whether the call can
be made only while the node starts. Where the text does not say so plainly, nothing is said.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Literal

from pytpc.base.source_bytes import source_bytes

Needed = Literal["", "fails", "reports"]

_CPP_CHECKED = re.compile(r"if\s*\(.*!\s*[\w.:>()-]*\b(?:getParam|param::get)\s*\(")
_CPP_REPORTS = re.compile(
    r"\b(?:ROS_ERROR|ROS_FATAL|ROS_BREAK|RCLCPP_ERROR|RCLCPP_FATAL)\w*|\bthrow\b|\bexit\s*\("
    r"|\bshutdown\s*\(|\breturn\s+(?:false|-1|1|EXIT_FAILURE)\b"
)
_CPP_DECLARED_ALONE = re.compile(r"declare_parameter\s*<[^<>]*>\s*\(\s*\"[^\"]*\"\s*\)")
_CPP_DECLARED_TYPE = re.compile(
    r"declare_parameter\s*\(\s*\"[^\"]*\"\s*,\s*(?:rclcpp::)?(?:ParameterType::)?PARAMETER_\w+\s*\)"
)
_DEPRECATED = re.compile(r"deprecat|obsolete|no longer (?:used|supported)", re.IGNORECASE)
_SAYS = re.compile(r"WARN|ERROR|\blog|print|cerr|cout|warn|INFO")
_FIRST_TEXT = re.compile(r"\"([\w~/.]+)\"")
_CPP_LOOP = re.compile(r"\b(?:while|for|do)\b|\]\s*\(|\]\s*\{")
_CPP_START = frozenset({"main", "onInit"})
_PYTHON_START = frozenset({"main", "__init__", "<module>", ""})
# In a descriptor of ROS 2: the node takes values of all types.
_ANY_TYPE = "dynamic_typing"
_CONVERSIONS = frozenset({"int", "float", "str", "bool", "array", "literal_eval"})
_REPORTED_WITHIN = 6
_NEAR = 4
_LONGEST_BLOCK = 10
_FARTHEST = 400
_INITIALISERS = 12


@dataclass(frozen=True, slots=True)
class CallText:
    """What the source says beside a call.

    ``deprecation`` is the number of a line. ``is_converted`` says that the code makes a number, a
    text or a flag of the value, of whatever type it is.
    """

    needed: Needed = ""
    deprecation: int | None = None
    at_start: bool = False
    is_converted: bool = False


NOTHING = CallText()


def call_text(path: str, lineno: int, api: str, function: str) -> CallText:
    """What the source says beside the call in a line.

    Args:
        path: the file.
        lineno: the line, from 1.
        api: the function that is called.
        function: in which it is called, with its scopes and parameters, as the static information
            has it.
    """
    if path.endswith(".py") or api.startswith(("rospy", "rclpy", "rosparam")):
        source = _python(path)
        return NOTHING if source is None else _of_python(source, lineno, api)
    lines = _lines(path)
    if not 0 < lineno <= len(lines):
        return NOTHING
    at = lineno - 1
    return CallText(
        _needed(lines, at, api),
        _deprecation(lines, at),
        _at_start(lines, at, function),
        any(_ANY_TYPE in line for line in lines),
    )


@lru_cache(maxsize=512)
def _lines(path: str) -> Sequence[str]:
    """The lines of a file, without comments of C++."""
    try:
        text = source_bytes(Path(path)).decode("utf-8", "replace")
    except OSError:
        return ()
    return without_comments(text).splitlines()


_COMMENT_OR_TEXT = re.compile(r"//[^\n]*|/\*.*?\*/|\"(?:\\.|[^\"\\\n])*\"|'(?:\\.|[^'\\\n])'", re.S)


def without_comments(text: str) -> str:
    r"""C++ without its comments, with the same lines.

    >>> without_comments('a; // b\n"/*" /* c\n*/ d')
    'a; \n"/*" \n d'
    """

    def kept(found: re.Match[str]) -> str:
        piece = found[0]
        return "\n" * piece.count("\n") if piece.startswith(("//", "/*")) else piece

    return _COMMENT_OR_TEXT.sub(kept, text)


def _needed(lines: Sequence[str], at: int, api: str) -> Needed:
    if "declare_parameter" in api:
        call = " ".join(lines[at : at + 3])
        alone = _CPP_DECLARED_ALONE.search(call) or _CPP_DECLARED_TYPE.search(call)
        return "fails" if alone else ""
    before = " ".join(lines[max(0, at - 1) : at + 1])
    if _CPP_CHECKED.search(before) is None:
        return ""
    after = lines[at + 1 : at + 1 + _REPORTED_WITHIN]
    block = _block_behind([lines[at], *after])
    return "reports" if any(_CPP_REPORTS.search(line) for line in block) else ""


def _block_behind(lines: Sequence[str]) -> Iterator[str]:
    """The lines up to the end of the statement that begins in the first one."""
    depth = 0
    for line in lines:
        yield line
        depth += line.count("{") - line.count("}")
        if ("}" in line or line.rstrip().endswith(";")) and depth <= 0:
            return


def _deprecation(lines: Sequence[str], at: int) -> int | None:
    """The line that says that a name is deprecated, in the block of an ``if`` about this call.

    The call is the condition (``if (nh.getParam("old", x)) { ROS_WARN("... deprecated") }``), or is
    in the block, as with ``hasParam``.
    """
    first = at if re.search(r"\bif\s*\(", lines[at]) else _opening_if(lines, at)
    if first is None:
        return None
    before = ""
    called = _FIRST_TEXT.search(" ".join(lines[at : at + 2]))
    for number, line in enumerate(_block_behind(lines[first : first + _LONGEST_BLOCK]), first):
        if _DEPRECATED.search(line) and _SAYS.search(before + line):
            # The message may be about another name.
            parts = [
                _message(lines[n], n == at)
                for n in range(max(first, number - 1), number + 2)
                if n < len(lines)
            ]
            is_about_it = called is None or _is_named(called[1], " ".join(parts))
            return number + 1 if is_about_it else None
        before = line
    return None


def _message(line: str, has_call: bool) -> str:
    """What may be of a message in a line; behind the call that reads, where that is in it."""
    said = _SAYS.search(line)
    return line if not has_call else line[said.start() :] if said is not None else ""


def _is_named(name: str, text: str) -> bool:
    """Whether a text has the last part of a name, as a word."""
    last = name.rpartition("/")[2].lstrip("~")
    return re.search(rf"(?<!\w){re.escape(last)}(?!\w)", text) is not None


def _opening_if(lines: Sequence[str], at: int) -> int | None:
    """The line of the ``if`` in whose block a line is; None if it is in another kind of block."""
    depth = 0
    for number in range(at - 1, max(-1, at - 1 - _NEAR), -1):
        depth += lines[number].count("}") - lines[number].count("{")
        if depth < 0:
            for opening in range(number, max(-1, number - 2), -1):
                if re.search(r"\bif\s*\(", lines[opening]):
                    return opening
            return None
    return None


def _at_start(lines: Sequence[str], at: int, function: str) -> bool:
    """Whether a call is in ``main`` or a constructor, and in no loop and no lambda there."""
    scopes = function.partition("(")[0].split("::")
    name = re.sub(r"<.*", "", scopes[-1])
    is_constructor = len(scopes) > 1 and re.sub(r"<.*", "", scopes[-2]) == name
    if name not in _CPP_START and not is_constructor:
        return False
    depth = 0
    for number in range(at - 1, max(-1, at - _FARTHEST), -1):
        line = lines[number]
        depth += line.count("}") - line.count("{")
        if depth < 0:
            depth = 0
            opening = " ".join(lines[_first_of(lines, number) : number + 1])
            if re.search(rf"\b{re.escape(name)}\s*\(", opening):
                return True
            if _CPP_LOOP.search(opening):
                return False
    return False


def _first_of(lines: Sequence[str], number: int) -> int:
    """Where the statement that a line is the last of begins; initialisers may be many lines."""
    first = number
    while first > max(0, number - _INITIALISERS):
        before = lines[first - 1].strip()
        if not before or before.endswith((";", "{", "}")):
            break
        first -= 1
    return first


@lru_cache(maxsize=512)
def _python(path: str) -> _Python | None:
    try:
        return _Python(source_bytes(Path(path)))
    except (OSError, SyntaxError, ValueError, RecursionError, MemoryError):
        return None


class _Python:
    """A Python file with the parents of its nodes."""

    def __init__(self, data: bytes) -> None:
        tree = ast.parse(data)
        self.text = data.decode("utf-8", "replace")
        self.lines = self.text.splitlines()
        self.parents = {
            child: node for node in ast.walk(tree) for child in ast.iter_child_nodes(node)
        }
        self.calls: dict[int, list[ast.Call]] = {}
        for node in ast.walk(tree):
            if isinstance(node, ast.Call):
                self.calls.setdefault(node.lineno, []).append(node)

    def above(self, node: ast.AST) -> Iterator[ast.AST]:
        """What a node is in, from the inside."""
        above = self.parents.get(node)
        while above is not None:
            yield above
            above = self.parents.get(above)


def _of_python(source: _Python, lineno: int, api: str) -> CallText:
    last = api.rpartition(".")[2]
    found = [call for call in source.calls.get(lineno, ()) if _called(call) == last]
    if len(found) != 1:
        return NOTHING
    call = found[0]
    above = list(source.above(call))
    needed: Needed = "fails" if _is_needed(source, call, above, last) else ""
    outer = above[0] if above else None
    is_converted = isinstance(outer, ast.Call) and _called(outer) in _CONVERSIONS
    is_converted = is_converted or _ANY_TYPE in source.text
    return CallText(
        needed, _python_deprecation(source, call, above), _python_start(above), is_converted
    )


def _called(call: ast.Call) -> str:
    name = call.func
    return name.attr if isinstance(name, ast.Attribute) else getattr(name, "id", "")


def _is_needed(source: _Python, call: ast.Call, above: Sequence[ast.AST], last: str) -> bool:
    given = len(call.args) + len(call.keywords)
    if last == "declare_parameter":
        second = call.args[1] if len(call.args) > 1 else None
        return given == 2 and second is not None and "Parameter.Type." in ast.unparse(second)
    if last != "get_param" or given != 1:
        return False
    if any(isinstance(one, ast.Try) and one.handlers for one in above):
        return False
    return "has_param" not in source.text


def _python_deprecation(source: _Python, call: ast.Call, above: Sequence[ast.AST]) -> int | None:
    """The line beside a call, in the same block, that says that its name is deprecated.

    It must have the name: beside a call there may be a message about another one.
    """
    given = call.args[0] if call.args else None
    if not isinstance(given, ast.Constant) or not isinstance(given.value, str):
        return None
    statement = next((one for one in (call, *above) if isinstance(one, ast.stmt)), None)
    block = source.parents.get(statement) if statement is not None else None
    for name in ("body", "orelse"):
        beside = getattr(block, name, None)
        if isinstance(beside, list) and statement in beside:
            at = beside.index(statement)
            for one in beside[max(0, at - 1) : at + 2]:
                for said in _messages(one):
                    text = ast.unparse(said)
                    is_said = _DEPRECATED.search(text) and _SAYS.search(text)
                    if is_said and _is_named(given.value, text):
                        return said.lineno
    return None


def _messages(statement: ast.stmt) -> Iterator[ast.stmt]:
    """The calls in a statement, or in an ``if`` behind a call, that may print a message."""
    if isinstance(statement, ast.Expr):
        yield statement
    elif isinstance(statement, ast.If):
        yield from (one for one in statement.body if isinstance(one, ast.Expr))


def _python_start(above: Sequence[ast.AST]) -> bool:
    if any(isinstance(one, ast.While | ast.For | ast.Lambda | ast.comprehension) for one in above):
        return False
    functions = [one for one in above if isinstance(one, ast.FunctionDef | ast.AsyncFunctionDef)]
    return len(functions) <= 1 and all(one.name in _PYTHON_START for one in functions)
