"""The example at both ends of optimisation: the same findings, all of them instrumented."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from conftest import build_example
from pytpc.build.build import BuildResult
from pytpc.static.link_unit import Comparison, PathStep


def test_finds_the_same_without_optimisation(built: BuildResult, tmp_path: Path) -> None:
    result = build_example(tmp_path / "ws", "Debug")
    unoptimised, optimised = own_comparisons(result), own_comparisons(built)
    assert list(unoptimised) == list(optimised)
    for key, comparison in optimised.items():
        other = unoptimised[key]
        # Far from the exposing statement the compiler's own intermediate values can add a step.
        assert abs(other.distance - comparison.distance) <= (comparison.distance > 3)
        assert without_compilers_choice(other) == without_compilers_choice(comparison)
    for unit in (*built.units, *result.units):
        assert unit.counts.not_instrumented == 0, unit.link_unit


def own_comparisons(result: BuildResult) -> dict[str, Comparison]:
    """Those in the package itself: an installed header's path is in its key."""
    found = result.static.comparisons.items()
    return {key: one for key, one in found if not Path(one.file).is_absolute()}


def without_compilers_choice(comparison: Comparison) -> Comparison:
    """The comparison without its distance and without where its path's functions return.

    Above -O0 clang gives a return of a local the place of the closing brace, where the local's
    life ends; at -O0 it gives it the place of the return statement. The two workspaces, and the
    headers that are installed there, are in different folders.
    """
    return replace(comparison, distance=0, path=tuple(map(without_return_place, comparison.path)))


def without_return_place(step: PathStep) -> PathStep:
    step = replace(step, file=Path(step.file).name)
    if step.step != "return":
        return step
    return replace(step, lineno=0, column=0, source_code="")
