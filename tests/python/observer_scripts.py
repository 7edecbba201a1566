"""The observers' scripts of the examples, as modules; none of them needs ROS for its rules."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from types import ModuleType

from pytpc_evaluation.demo.demo_examples import SHARED_PACKAGE, Example


def shared_module(name: str) -> ModuleType:
    """A module of the package that the examples' observers share."""
    shared = str(SHARED_PACKAGE / "src")
    if shared not in sys.path:
        sys.path.append(shared)
    return importlib.import_module(f"simulated_world.{name}")


def load_observer(example: Example) -> ModuleType:
    """The module of an example's observer."""
    shared_module("observer")
    name = f"{example.name}_observer"
    spec = importlib.util.spec_from_file_location(name, example.folder / "scripts/observer.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module
