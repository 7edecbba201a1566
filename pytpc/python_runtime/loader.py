"""The import hook: a finder that asks the other finders, and a loader that compiles modules anew.

It looks only at modules whose file has the name of one with listed comparisons. It does not cache
their bytecode: ``__pycache__`` never holds rewritten code, and cached code never replaces it.
"""

from __future__ import annotations

import importlib.machinery
import os
import sys
from collections.abc import Sequence
from types import CodeType, ModuleType
from typing import Any

from pytpc.python_runtime import quiet, ros2_state
from pytpc.python_runtime.errors import warn
from pytpc.python_runtime.instrument import Instrument
from pytpc.python_runtime.listed import ListedFile


class ReportingLoader(importlib.machinery.SourceFileLoader):
    """Loads a module from its source; the base class does all else (``inspect.getsource``)."""

    def __init__(self, fullname: str, path: str, instrument: Instrument) -> None:
        super().__init__(fullname, path)
        self._instrument = instrument

    def get_code(self, fullname: str) -> CodeType | None:
        """The rewritten code, or the ordinary code of a module with nothing to report."""
        path = self.get_filename(fullname)
        data = self.get_data(path)
        return self._instrument.code(data, path) or super().get_code(fullname)


class ReportingFinder:
    """Comes before the other finders, and asks them."""

    def __init__(self, instrument: Instrument) -> None:
        """A package is recognised by the name of its folder."""
        self._instrument = instrument
        self._names = _module_names(instrument.table.by_name)

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None = None,
        target: ModuleType | None = None,
    ) -> importlib.machinery.ModuleSpec | None:
        """The spec of another finder, with our loader if the module may have comparisons."""
        if fullname in quiet.TRACERS:
            quiet.watch()
        if fullname == ros2_state.MODULE:
            return _with_nodes(self._other(fullname, path, target))
        if fullname.rpartition(".")[2] not in self._names:
            return None
        spec = self._other(fullname, path, target)
        if spec is None or not spec.origin or not isinstance(spec.origin, str):
            return spec
        kind, table = type(spec.loader), self._instrument.table
        if kind is importlib.machinery.SourceFileLoader:
            is_init = os.path.basename(spec.origin) == "__init__.py"
            if is_init or table.candidates(spec.origin):
                spec.loader = ReportingLoader(fullname, spec.origin, self._instrument)
        elif table.is_exact(spec.origin):
            why = "it is not loaded from its source"
            if issubclass(kind, importlib.machinery.SourceFileLoader):
                why = f"it is loaded by {kind.__qualname__}, which may change it"
            warn(f"{spec.origin} does not report: {why}")
        return spec

    @staticmethod
    def invalidate_caches() -> None:
        """There are none."""

    def _other(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None
    ) -> importlib.machinery.ModuleSpec | None:
        for finder in list(sys.meta_path):
            find: Any = getattr(finder, "find_spec", None)
            if finder is self or find is None:
                continue
            spec: importlib.machinery.ModuleSpec | None = find(fullname, path, target)
            if spec is not None:
                return spec
        return None


def _with_nodes(
    spec: importlib.machinery.ModuleSpec | None,
) -> importlib.machinery.ModuleSpec | None:
    """Let ``ros2_state`` watch the module once it is loaded, by the loader that it has."""
    loader: Any = None if spec is None else spec.loader
    load = getattr(loader, "exec_module", None)
    if load is None:
        return spec

    def exec_module(module: ModuleType) -> None:
        del loader.exec_module
        load(module)
        ros2_state.watch(module)

    loader.exec_module = exec_module
    return spec


def _module_names(by_name: dict[str, list[ListedFile]]) -> set[str]:
    """The last parts of the names of modules that may have comparisons."""
    names = set()
    for base, files in by_name.items():
        stem = base[:-3] if base.endswith(".py") else base
        names.add(stem)
        for file in files:
            if stem == "__init__":
                names.add(os.path.basename(os.path.dirname(file.path)))
    return names


def install(instrument: Instrument) -> None:
    """Let modules report that are imported from now on."""
    quiet.watch_if_traced()
    ros2_state.watch_if_imported()
    sys.meta_path.insert(0, ReportingFinder(instrument))
