"""What a verdict was worked out from, as one number: where it is another, the method ranks again.

It has all that a method is given of a mission, and the code of the method: the modules that it
imports, and those that they import. What a module says to people (comments, docstrings) is left
out, so that a better word has nothing ranked again.
"""

from __future__ import annotations

import ast
import json
from collections.abc import Callable, Iterator
from functools import cache
from hashlib import sha256
from pathlib import Path

import pytpc
import pytpc_evaluation
from pytpc.base.errors import InputError
from pytpc.recording.graph_file import GRAPH_FILE
from pytpc.recording.mission import EVENTS_FILE, MARKS_FILE, SUMMARIES_FILE
from pytpc_evaluation.demo.demo_examples import EXAMPLES
from pytpc_evaluation.study.changes import CHANGES_FILE
from pytpc_evaluation.study.dataset import CAUSES_FILE, MARKED_FILE
from pytpc_evaluation.treatment import TREATMENT_FILE

_PACKAGES = {package.__name__: Path(package.__path__[0]) for package in (pytpc, pytpc_evaluation)}
_JUDGES = ("pytpc_evaluation.study.data", "pytpc_evaluation.study.judge")
_RECORDING = (EVENTS_FILE, SUMMARIES_FILE, MARKS_FILE)


def mission_digest(out: Path, mission: Path, half: str) -> str:
    """Of all that the methods and the judge read of a mission.

    Args:
        out: the study's folder.
        mission: the mission's folder in it.
        half: of the mission.

    Raises:
        InputError: a file cannot be read.
    """
    system = mission.parent.parent.name
    own = (*_RECORDING, MARKED_FILE, CHANGES_FILE, TREATMENT_FILE, CAUSES_FILE, GRAPH_FILE)
    files = [mission / name for name in own]
    files += [example.study for example in EXAMPLES if example.name == system]
    good = [out / "reference" / system, *sorted((out / "good" / system).glob("seed-*"))]
    files += [folder / name for folder in good for name in _RECORDING]
    files.append(out / "systems" / system / "static.json")
    return digest_of([half, *map(contents, files)])


def method_digest(method: Callable[..., object]) -> str:
    """Of the code by which a method is judged, its own and that of all modules of ours it uses."""
    return _code_digest(method.__module__)


def verdict_digest(mission: str, method: str) -> str:
    """Of both digests."""
    return digest_of([mission, method])


@cache
def _code_digest(module: str) -> str:
    names = [*sorted(modules_used(module)), *_JUDGES]
    return digest_of([(name, sha256(_code(name).encode()).hexdigest()) for name in names])


def modules_used(name: str) -> frozenset[str]:
    """The module of this name, and all of ours that it imports, they import, and so on.

    A package that is only on the way to a module (``pytpc_evaluation.study`` of
    ``pytpc_evaluation.study.case``) is none of them: nothing is taken from it. Nor is ``pytpc``
    itself, which has the version, and all else for those who use it as a library.
    """
    found: set[str] = set()
    left = [name]
    while left:
        one = left.pop()
        if one not in found and _file(one) is not None:
            found.add(one)
            left += _imported(one)
    return frozenset(found)


def _imported(name: str) -> Iterator[str]:
    for node in ast.walk(_tree(name)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            yield node.module
            # What is imported may be a module itself.
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def _file(name: str) -> Path | None:
    """The file of a module of ours; None of others."""
    first, *parts = name.split(".")
    if first not in _PACKAGES or not parts:
        return None
    place = _PACKAGES[first].joinpath(*parts)
    files = (place.with_suffix(".py"), place / "__init__.py")
    return next((file for file in files if file.is_file()), None)


def _tree(name: str) -> ast.Module:
    file = _file(name)
    assert file is not None, f"{name} is a module of ours"
    return ast.parse(file.read_bytes())


def _code(name: str) -> str:
    """What the module does, as text: without its comments, layout and texts that stand alone."""
    tree = _tree(name)
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            body[:] = [one for one in body if not _is_said(one)]
    return ast.dump(tree)


def _is_said(node: ast.stmt) -> bool:
    if not isinstance(node, ast.Expr) or not isinstance(node.value, ast.Constant):
        return False
    return isinstance(node.value.value, str)


def contents(path: Path) -> str:
    """The digest of a file, empty where there is none.

    Raises:
        InputError: it cannot be read.
    """
    try:
        return sha256(path.read_bytes()).hexdigest()
    except FileNotFoundError:
        return ""
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", path) from error


def digest_of(document: object) -> str:
    """Of what can be written as JSON."""
    return sha256(json.dumps(document).encode()).hexdigest()
