"""Runs programs under the hook, in the process of the test."""

from __future__ import annotations

import ast
import random
import re
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import CodeType, FrameType
from typing import Any

from hook_places import comparisons, others

from pytpc.python_runtime import quiet, sites
from pytpc.python_runtime.find import ListedPlace
from pytpc.python_runtime.listed import Listed
from pytpc.python_runtime.rewrite import rewrite
from pytpc.python_runtime.sites import Reported

PATH = "/somewhere/program.py"
_POSITION = ("name", "lineno", "end_lineno", "colno", "end_colno")


def listed(lineno: int, column: int, relation: str, **changes: Any) -> Listed:
    """A comparison of the static information; its key is its place, unless it has a name."""
    plain = {
        "key": f"{lineno}:{column}",
        "relation": relation,
        "lineno": lineno,
        "column": column,
        "end_lineno": None,
        "end_column": None,
        "name": None,
        "operand": None,
        "source_code": None,
    }
    return Listed(**{**plain, **changes})


@dataclass
class Taken:
    """Reports in their order, as (key, result, cmp, thresh, res)."""

    rows: list[tuple[str, bool, float, float, bool]] = field(default_factory=list)

    def take(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        self.rows.append((one.key, result, cmp, thresh, res))


@contextmanager
def taking() -> Iterator[Taken]:
    """All reports of this process while the ``with`` block runs."""
    taken = Taken()
    before = sites._take
    sites.set_take(taken.take)
    try:
        yield taken
    finally:
        sites.set_take(before)


def register(place: ListedPlace) -> Reported:
    return Reported(place.listed.key, 1, place.swapped)


def instrumented(source: str, *places: Listed) -> CodeType:
    """The code of a program that reports; all of ``places`` must be in it."""
    rewritten = rewrite(source, PATH, places, register)
    assert not rewritten.missing
    assert not rewritten.unsupported
    assert rewritten.instrumented == len(places)
    return rewritten.code


def everywhere(source: str) -> CodeType:
    """The code of a program in which every place that may be listed reports."""
    tree = ast.parse(source)
    return instrumented(source, *comparisons(tree), *others(tree))


def at_random(source: str, seed: int) -> CodeType:
    """The code of a program in which every comparison reports, and half of the other places."""
    tree = ast.parse(source)
    chosen = random.Random(seed)
    return instrumented(
        source, *comparisons(tree), *(one for one in others(tree) if chosen.random() < 0.5)
    )


def reports(source: str, *places: Listed, **names: object) -> list[tuple[Any, ...]]:
    """What a program reports."""
    with taking() as taken:
        exec(instrumented(source, *places), dict(names))
    return taken.rows


def without_addresses(text: str) -> str:
    """A text without the addresses of objects, which differ from run to run."""
    return re.sub(r"0x[0-9a-f]+", "0x", text)


def outcome(code: CodeType, names: dict[str, object]) -> tuple[object, ...]:
    """What a program does: how it ends, where its error comes from, and what a tracer sees.

    A frame of the hook would be seen, too.
    """
    lines: list[tuple[str, str, int]] = []

    def trace(frame: FrameType, event: str, _: object) -> object:
        file = frame.f_code.co_filename
        if file != PATH and "python_runtime" not in file:
            # Of a library, as when numpy gives a warning for the first time.
            return None
        lines.append((event, frame.f_code.co_name, frame.f_lineno))
        return trace

    quiet.watch()
    raised: Exception | None = None
    before = sys.gettrace()
    sys.settrace(trace)
    try:
        exec(code, names)
    except Exception as error:
        raised = error
    finally:
        sys.settrace(before)
    return ("done",) if raised is None else _ended(raised), lines


def _ended(error: Exception) -> tuple[object, ...]:
    stack = traceback.TracebackException.from_exception(error).stack
    frames = [tuple(getattr(frame, name, None) for name in _POSITION) for frame in stack[1:]]
    files = {frame.filename for frame in stack[1:]}
    return type(error).__name__, without_addresses(str(error)), frames, files
