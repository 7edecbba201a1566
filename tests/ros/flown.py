"""What the tests of an example robot on a real graph share: its flights, and what was expected."""

from __future__ import annotations

import functools
import json
from collections import Counter
from collections.abc import Callable

import pytest

from pytpc.base.errors import MissingToolError
from pytpc.base.paths import cmake_file, log_library, plugin
from pytpc.static.static_info import StaticInfo
from pytpc_evaluation.demo.demo import TreatedMission, run_treatment
from pytpc_evaluation.demo.demo_examples import Example
from pytpc_evaluation.demo.demo_show import Built

FIELDS = ("unit", "file", "line", "parameter", "type", "relation")

Fly = Callable[..., TreatedMission]


def need_cpp_half() -> None:
    """Skip the module where the C++ half is not installed."""
    try:
        for half in (cmake_file, plugin, log_library):
            half()
    except MissingToolError as error:
        pytest.skip(f"the C++ half is not installed: {error}", allow_module_level=True)


def expected(example: Example, file: str, part: str = "tpcs") -> Counter[tuple]:
    """One of an example's lists that were written by hand."""
    document = json.loads((example.folder / file).read_text())
    return Counter(tuple(entry[name] for name in FIELDS) for entry in document[part])


def found(static: StaticInfo) -> Counter[tuple]:
    """The same of what the analysis found."""
    return Counter(
        (unit.link_unit, c.file, c.lineno, c.source, c.type, c.relation)
        for unit in static.units
        for c in unit.comparisons
        if c.type != "constant"
    )


def flights(
    example: Example, robot: Built, rate: str, tmp_path_factory: pytest.TempPathFactory
) -> Fly:
    """Flies a treatment under a seed (1), each once."""

    @functools.cache
    def once(name: str, seed: int = 1) -> TreatedMission:
        return run_treatment(
            example,
            example.treatment(name),
            seed=seed,
            install_env=robot.env,
            static_info=robot.static,
            out_dir=tmp_path_factory.mktemp(name),
            timeout_s=150.0,
            launch_args={"rate": rate},
        )

    return once
