"""The example at both ends of optimisation: the same findings, all of them instrumented."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from conftest import build_example

from pytpc.build import BuildResult


def test_finds_the_same_without_optimisation(built: BuildResult, tmp_path: Path) -> None:
    result = build_example(tmp_path / "ws", "Debug")
    unoptimised, optimised = result.static.comparisons, built.static.comparisons
    assert list(unoptimised) == list(optimised)
    for key, comparison in optimised.items():
        other = unoptimised[key]
        # Far from the exposing statement the compiler's own intermediate values can add a step.
        assert abs(other.distance - comparison.distance) <= (comparison.distance > 3)
        assert replace(other, distance=comparison.distance) == comparison
    for unit in (*built.units, *result.units):
        assert unit.counts.not_instrumented == 0, unit.link_unit
