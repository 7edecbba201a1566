"""Whether the outcome of a comparison can be seen: nodes run again with one comparison turned.

A list of the suite says of each comparison whether something exposed depends on it. Here every
other evaluation of the comparison gives the opposite, and what the node exposes is compared with
what it exposed before. ``python -m suite.flips`` prints, for each node, its entries that show.
"""

from __future__ import annotations

import ast
import contextlib
import importlib.abc
import importlib.machinery
import importlib.util
import json
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from types import CodeType, ModuleType

from suite.both_ways import input_of
from suite.expectations import PYTHON_PACKAGE, Entry, load, nodes
from suite.fake_ros import FakeRos
from suite.places import links, place_of, text_between
from suite.python_run import missing_modules, script

SAMPLES = 60
_FLIP = "__flip__"
_NEGATED = {
    ast.Lt: ast.GtE,
    ast.GtE: ast.Lt,
    ast.Gt: ast.LtE,
    ast.LtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot,
    ast.IsNot: ast.Is,
    ast.In: ast.NotIn,
    ast.NotIn: ast.In,
}


class _Turn(ast.NodeTransformer):
    """Turns the comparison, or the flag, at one place."""

    def __init__(self, entry: Entry, source: str) -> None:
        self._wanted = (entry.line, entry.column), entry.text
        self._source = source
        self.turned = 0

    def visit_Compare(self, node: ast.Compare) -> ast.expr:
        for at, link in enumerate(links(self._source, node)):
            if link != self._wanted:
                continue
            self.turned += 1
            if len(node.ops) == 1:
                return _call(node)
            node.ops[at] = _NEGATED[type(node.ops[at])]()
        return self._below(node)

    def visit_MatchValue(self, node: ast.MatchValue) -> ast.MatchValue:
        if self._is_wanted(node.value):
            self.turned += 1
            node.value = ast.Constant(987654321)
        return node

    def visit_Call(self, node: ast.Call) -> ast.expr:
        if self._is_wanted(node) and isinstance(node.func, ast.Name) and node.func.id == "range":
            self.turned += 1
            node.args[0] = ast.BinOp(node.args[0], ast.Add(), ast.Constant(1))
            return node
        return self._value(node)

    def visit_Name(self, node: ast.Name) -> ast.expr:
        return self._value(node)

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        return self._value(node)

    def _value(self, node: ast.expr) -> ast.expr:
        if self._is_wanted(node):
            self.turned += 1
            return _call(node)
        return self._below(node)

    def _below(self, node: ast.expr) -> ast.expr:
        self.generic_visit(node)
        return node

    def _is_wanted(self, node: ast.expr) -> bool:
        return (place_of(node), text_between(self._source, node, node)) == self._wanted


def _call(node: ast.expr) -> ast.expr:
    return ast.Call(ast.Name(_FLIP, ast.Load()), [node], [])


def _flipper() -> Callable[[object], object]:
    count = 0

    def flip(value: object) -> object:
        nonlocal count
        count += 1
        return (not value) if count % 2 else value

    return flip


class _Finder(importlib.abc.MetaPathFinder):
    """Modules of the package and those beside the script, one of them with a turn in it."""

    def __init__(self, node: str, turned: Entry | None) -> None:
        folder = PYTHON_PACKAGE / "src/python_nodes"
        self._files = {f"python_nodes.{path.stem}": path for path in folder.glob("*.py")}
        self._files["python_nodes"] = folder / "__init__.py"
        if script(node).parent.name == node:
            self._files |= {path.stem: path for path in script(node).parent.glob("*.py")}
        self._turned = turned

    @property
    def names(self) -> Sequence[str]:
        """The modules that are found here."""
        return list(self._files)

    def find_spec(
        self, name: str, path: object = None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """Find one of them."""
        if name not in self._files:
            return None
        file = self._files[name]
        is_package = file.name == "__init__.py"
        return importlib.util.spec_from_file_location(
            name,
            file,
            loader=_Loader(name, str(file), self._turned),
            submodule_search_locations=[] if is_package else None,
        )


class _Loader(importlib.machinery.SourceFileLoader):
    def __init__(self, name: str, file: str, turned: Entry | None) -> None:
        super().__init__(name, file)
        self._turned = turned

    def get_code(self, fullname: str) -> CodeType:
        return compiled(Path(self.path), self._turned)

    def exec_module(self, module: ModuleType) -> None:
        module.__dict__[_FLIP] = _flipper()
        super().exec_module(module)


def compiled(file: Path, turned: Entry | None) -> CodeType:
    """A source file, with the turn where it is in this file."""
    source = file.read_text("utf-8")
    tree = ast.parse(source)
    if turned is not None and PYTHON_PACKAGE / turned.file == file:
        turn = _Turn(turned, source)
        tree = ast.fix_missing_locations(turn.visit(tree))
        assert turn.turned == 1, (turned, turn.turned)
    return compile(tree, str(file), "exec")


def exposed(node: str, turned: Entry | None = None) -> list[tuple[str, bytes]]:
    """What a node exposes, with one comparison turned or none."""
    samples = {
        topic: values[:SAMPLES] for topic, values in input_of(node, 1, PYTHON_PACKAGE).items()
    }
    ros = FakeRos(load(node, PYTHON_PACKAGE).params, samples)
    finder = _Finder(node, turned)
    main = ModuleType("__main__")
    main.__dict__[_FLIP] = _flipper()
    code = compiled(script(node), turned)
    kept = dict(sys.modules)
    for name in finder.names:
        sys.modules.pop(name, None)
    sys.modules.update({**ros.modules(), "__main__": main})
    sys.meta_path.insert(0, finder)
    try:
        with contextlib.suppress(SystemExit), contextlib.redirect_stdout(None):
            exec(code, main.__dict__)
    finally:
        sys.meta_path.remove(finder)
        sys.modules.clear()
        sys.modules.update(kept)
    return ros.exposed


def shown(node: str) -> dict[str, bool]:
    """``file:line:column`` of each entry, limits aside -> whether turning it shows."""
    before = exposed(node)
    assert before, f"{node} exposes nothing"
    expectation = load(node, PYTHON_PACKAGE)
    places = {
        f"{entry.file}:{entry.line}:{entry.column}": entry
        for entry in (*expectation.expect, *(expectation.constants or ()), *expectation.absent)
    }
    return {place: exposed(node, entry) != before for place, entry in places.items()}


def main() -> None:
    """Print what shows, as JSON."""
    names = sys.argv[1:] or [node for node in nodes(PYTHON_PACKAGE) if not missing_modules(node)]
    print(json.dumps({node: shown(node) for node in names}))


if __name__ == "__main__":
    main()
