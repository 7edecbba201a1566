"""Finds where the values in launch files of ROS 2 are written, for ``ros2_launch_tracer``.

launch forgets lines. XML and YAML are therefore read with readers of our own that keep them, and
for Python the call that made an action is looked up in the syntax tree of its file.
"""

from __future__ import annotations

import ast
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.parsers import expat

import yaml

# What launch has made; it is not installed where this is checked.
Given = Any
# A file and a line, with what else is known of the place.
Place = Any


class Elements:
    """Reads XML and YAML in place of launch's readers, and knows the lines of all elements."""

    def __init__(self, files: dict[str, None]) -> None:
        self._lines: dict[int, tuple[str, int]] = {}
        # An id is that of an element as long as the element lives.
        self._kept: list[Any] = []
        self._files = files
        # launch_xml's reader annotates with these names.
        self.Element = ElementTree.Element
        self.ParseError = ElementTree.ParseError

    def parse(self, file: Given) -> Elements._Tree:
        """``xml.etree.ElementTree.parse``."""
        name, data = self._read(file)
        builder = ElementTree.TreeBuilder()
        parser = expat.ParserCreate()

        def start(tag: str, attributes: dict[str, str]) -> None:
            self._note(builder.start(tag, attributes), name, parser.CurrentLineNumber)

        parser.StartElementHandler = start
        parser.EndElementHandler = builder.end
        parser.CharacterDataHandler = builder.data
        parser.Parse(data, True)
        return Elements._Tree(builder.close())

    class _Tree:
        def __init__(self, root: Given) -> None:
            self._root = root

        def getroot(self) -> Given:
            return self._root

    def safe_load(self, file: Given) -> Given:
        """``yaml.safe_load``, with maps that know their lines."""
        name, data = self._read(file)

        class Loader(yaml.SafeLoader):  # type: ignore[misc]
            pass

        def of_map(loader: Given, node: Given) -> Given:
            loader.flatten_mapping(node)
            made: dict[Any, Any] = {}
            for key, value in node.value:
                made[loader.construct_object(key, deep=True)] = loader.construct_object(
                    value, deep=True
                )
            result = _Map(made)
            result.lines = {
                key.value: value.start_mark.line + 1
                for key, value in node.value
                if isinstance(key, yaml.ScalarNode)
            }
            self._note(result, name, node.start_mark.line + 1)
            return result

        Loader.add_constructor("tag:yaml.org,2002:map", of_map)
        return yaml.load(data, Loader)

    def _read(self, file: Given) -> tuple[str, str]:
        if isinstance(file, (str, Path)):
            with Path(file).open(encoding="utf-8") as stream:
                return str(file), stream.read()
        name = str(getattr(file, "name", ""))
        self._files[name] = None
        return name, file.read()

    def _note(self, element: Given, name: str, line: int) -> None:
        self._lines[id(element)] = (name, line)
        self._kept.append(element)

    def place(self, element: Given, attribute: str = "") -> Place | None:
        """Where an element, or one of its attributes, is written."""
        if id(element) not in self._lines:
            return None
        name, line = self._lines[id(element)]
        if isinstance(element, _Map):
            line = element.lines.get(attribute, line)
        return {"file": name, "lineno": line}

    def parameters(self, element: Given) -> list[tuple[Place | None, dict[str, Place]]]:
        """The place of each ``<param>`` of a node, and those of the values in it by name."""
        found = []
        for param in children(element, "param"):
            named: dict[str, Place] = {}
            self._values(param, "", named)
            found.append((self.place(param, "from"), named))
        return found

    def passed(self, include: Given, name: str) -> Place | None:
        """Where an ``<include>`` sets an argument."""
        for tag in ("let", "arg"):
            for one in children(include, tag):
                if attribute_of(one, "name") == name:
                    return self.place(one, "value")
        return None

    def _values(self, param: Given, before: str, named: dict[str, Place]) -> None:
        name = attribute_of(param, "name")
        if not isinstance(name, str):
            return
        full = before + name
        place = self.place(param, "value")
        if place is not None:
            named[full] = place
        for below in children(param, "param"):
            self._values(below, full + ".", named)


class _Map(dict):  # type: ignore[type-arg]
    """A map of YAML with the line of the value of each key."""

    lines: dict[str, int]


def children(element: Given, tag: str) -> list[Any]:
    """The elements of this name below one of XML or YAML."""
    if isinstance(element, dict):
        below = element.get(tag, [])
        return below if isinstance(below, list) else []
    if isinstance(element, list):
        return []
    return [one for one in element if one.tag == tag]


def attribute_of(element: Given, name: str) -> Given:
    """An attribute as written; None where there is none."""
    return element.get(name)


_TREES: dict[str, ast.Module | None] = {}


def _tree(name: str) -> ast.Module | None:
    """The syntax tree of a file, which is read once."""
    if name not in _TREES:
        try:
            _TREES[name] = ast.parse(Path(name).read_bytes(), filename=name)
        except (OSError, SyntaxError, ValueError):
            _TREES[name] = None
    return _TREES[name]


def _call(name: str, lineno: int, made: str) -> ast.Call | None:
    """The call in this line that makes something of a class; None if there are several."""
    tree = _tree(name)
    if tree is None:
        return None
    fitting = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.Call)
        and node.lineno <= lineno <= (node.end_lineno or node.lineno)
        and _last_name(node.func) == made
    ]
    beginning = [node for node in fitting if node.lineno == lineno] or fitting
    latest = max((node.lineno for node in beginning), default=0)
    chosen = [node for node in beginning if node.lineno == latest]
    return chosen[0] if len(chosen) == 1 else None


def _last_name(node: ast.AST) -> str:
    if isinstance(node, ast.Attribute):
        return node.attr
    return node.id if isinstance(node, ast.Name) else ""


def argument_place(frame: tuple[str, int], made: str, keyword: str, number: int) -> Place | None:
    """Where an argument of the call that made an action is written."""
    call = _call(*frame, made)
    value = None if call is None else _argument(call, keyword, number)
    return None if value is None else _place(frame[0], value)


def _argument(call: ast.Call, keyword: str, number: int) -> ast.expr | None:
    for one in call.keywords:
        if one.arg == keyword:
            return one.value
    return call.args[number] if 0 <= number < len(call.args) else None


def _place(name: str, value: ast.AST) -> Place:
    return {"file": name, "lineno": value.lineno}  # type: ignore[attr-defined]


def _followed(name: str, value: ast.expr | None) -> ast.expr | None:
    """What a variable was set to, where it is set once in the file."""
    tree = _tree(name)
    if not isinstance(value, ast.Name) or tree is None:
        return value
    set_to = [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Assign)
        for target in node.targets
        if isinstance(target, ast.Name) and target.id == value.id
    ]
    return set_to[0] if len(set_to) == 1 else value


def parameters_in_python(
    frame: tuple[str, int], made: str
) -> list[tuple[Place | None, dict[str, Place]]]:
    """As ``Elements.parameters``, for the argument ``parameters`` of a call in Python."""
    name = frame[0]
    call = _call(*frame, made)
    given = None if call is None else _followed(name, _argument(call, "parameters", -1))
    if not isinstance(given, ast.List):
        return []
    found: list[tuple[Place | None, dict[str, Place]]] = []
    for item in given.elts:
        value = _followed(name, item)
        named: dict[str, Place] = {}
        if isinstance(value, ast.Dict):
            _of_dict(name, value, "", named)
        elif isinstance(value, ast.Call) and _last_name(value.func) == "Parameter":
            key, own = _argument(value, "name", 0), _argument(value, "value", 1)
            if isinstance(key, ast.Constant) and own is not None:
                named[str(key.value)] = _place(name, own)
        found.append((_place(name, item), named))
    return found


def passed_in_python(frame: tuple[str, int], name: str) -> Place | None:
    """Where the call that makes an include sets an argument, in a dictionary or in pairs."""
    call = _call(*frame, "IncludeLaunchDescription")
    for node in () if call is None else ast.walk(call):
        pairs: list[tuple[ast.AST | None, ast.AST]] = []
        if isinstance(node, ast.Dict):
            pairs = list(zip(node.keys, node.values))
        elif isinstance(node, ast.Tuple) and len(node.elts) == 2:
            pairs = [(node.elts[0], node.elts[1])]
        for key, value in pairs:
            if isinstance(key, ast.Constant) and key.value == name:
                return _place(frame[0], value)
    return None


def _of_dict(name: str, given: ast.Dict, before: str, named: dict[str, Place]) -> None:
    for key, value in zip(given.keys, given.values):
        if not isinstance(key, ast.Constant):
            continue
        full = before + str(key.value)
        below = _followed(name, value)
        if isinstance(below, ast.Dict):
            _of_dict(name, below, full + ".", named)
        else:
            named[full] = _place(name, value)
