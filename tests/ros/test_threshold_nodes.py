"""The suite of nodes: what is found in each, and that the passes change nothing of what they do."""

from __future__ import annotations

from pathlib import Path

import pytest

from pytpc.build.build import workspace_env
from suite.both_ways import Results, Variant, differences, run_all, totals
from suite.build import Suite, build_suite, instrumented, link_plain
from suite.expectations import Verdict, nodes
from suite.known import KNOWN
from suite.report import judge_all

SEED = 20


@pytest.fixture(scope="module")
def suite(tmp_path_factory: pytest.TempPathFactory) -> Suite:
    return build_suite(tmp_path_factory.mktemp("suite") / "ws")


@pytest.fixture(scope="module")
def verdicts(suite: Suite) -> dict[str, Verdict]:
    return {verdict.node: verdict for verdict in judge_all(suite.result.static)}


def run_both_ways(suite: Suite, folder: Path) -> Results:
    with_passes = instrumented(suite)
    variants = [
        Variant("plain", link_plain(suite)),
        Variant("reporting", with_passes),
        Variant("silent", with_passes, {"TPC_SINK": "off"}),
    ]
    return run_all(variants, workspace_env(suite.result.bases.install), folder, seed=SEED)


@pytest.fixture(scope="module")
def results(suite: Suite, tmp_path_factory: pytest.TempPathFactory) -> Results:
    return run_both_ways(suite, tmp_path_factory.mktemp("graph"))


@pytest.mark.parametrize("node", nodes())
def test_finds_what_a_reader_finds(verdicts: dict[str, Verdict], node: str) -> None:
    verdict = verdicts[node]
    is_right = (verdict.missing, verdict.false) == ((), ())
    if node in KNOWN:
        assert not is_right, f"{node} is right now: take it out of suite.known"
        pytest.xfail(KNOWN[node])
    assert verdict.imprecise or is_right, (verdict.missing, verdict.false)


def test_analyses_and_instruments_every_node(suite: Suite) -> None:
    units = {unit.link_unit: unit for unit in suite.result.units}
    assert sorted(units) == nodes()
    assert [unit.link_unit for unit in units.values() if unit.status != "ok"] == []


@pytest.mark.parametrize("node", nodes())
def test_publishes_the_same_with_the_passes(results: Results, node: str) -> None:
    assert list(differences(node, results[node])) == []


def test_nodes_published_and_reported(suite: Suite, results: Results) -> None:
    counts = totals(results)
    assert counts["plain"]["messages"] > 50 * len(nodes())
    assert counts["silent"]["reports"] == counts["plain"]["reports"] == 0
    comparing = {unit.link_unit for unit in suite.result.units if unit.comparisons}
    reporting = {node for node, variants in results.items() if variants["reporting"].reports}
    assert reporting <= comparing
    assert len(reporting) > 0.85 * len(comparing)


# The levels that are not the default take a build each.
LEVELS = {"O0": ("Debug", ()), "O1": ("None", ("-DCMAKE_CXX_FLAGS=-O1 -g",)), "O3": ("Release", ())}


@pytest.mark.slow
@pytest.mark.parametrize("level", LEVELS)
def test_finds_and_publishes_the_same_at_other_levels(
    suite: Suite, level: str, tmp_path: Path
) -> None:
    build_type, cmake_args = LEVELS[level]
    other = build_suite(tmp_path / "ws", build_type, cmake_args)
    assert judge_all(other.result.static) == judge_all(suite.result.static)
    if level in ("O0", "O3"):
        results = run_both_ways(other, tmp_path / "graph")
        assert [text for node in nodes() for text in differences(node, results[node])] == []
