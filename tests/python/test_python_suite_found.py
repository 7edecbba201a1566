"""The analysis finds in examples/python_nodes what a reader finds."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest

from pytpc.base.errors import RunError
from pytpc.static.static_info import StaticInfo
from suite.expectations import PYTHON_PACKAGE, Verdict, nodes
from suite.known import PYTHON_KNOWN
from suite.report import analyse_python, judge_all

WITH_ANALYSIS = importlib.util.find_spec("pytpc.python_analysis") is not None
needs_analysis = pytest.mark.skipif(not WITH_ANALYSIS, reason="there is no pytpc analyse yet")


@pytest.fixture(scope="module")
def static(tmp_path_factory: pytest.TempPathFactory) -> StaticInfo:
    return analyse_python(tmp_path_factory.mktemp("suite"))


@pytest.fixture(scope="module")
def verdicts(static: StaticInfo) -> dict[str, Verdict]:
    return {verdict.node: verdict for verdict in judge_all(static, PYTHON_PACKAGE)}


@needs_analysis
def test_analyses_every_node(static: StaticInfo) -> None:
    units = {unit.link_unit: unit for unit in static.units}
    assert sorted(units) == nodes(PYTHON_PACKAGE)
    assert {unit.package for unit in units.values()} == {"python_nodes"}
    assert [unit.link_unit for unit in units.values() if unit.status != "ok"] == []


@needs_analysis
@pytest.mark.parametrize("node", nodes(PYTHON_PACKAGE))
def test_finds_what_a_reader_finds(verdicts: dict[str, Verdict], node: str) -> None:
    verdict = verdicts[node]
    is_right = (verdict.missing, verdict.false) == ((), ())
    if node in PYTHON_KNOWN:
        assert not is_right, f"{node} is right now: take it out of suite.known"
        pytest.xfail(PYTHON_KNOWN[node])
    assert verdict.imprecise or is_right, (verdict.missing, verdict.false)


def test_failing_analysis_is_one_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("suite.report.PYTHON_PACKAGE", tmp_path / "nothing")
    with pytest.raises(RunError) as caught:
        analyse_python(tmp_path)
    assert str(caught.value).startswith("pytpc analyse ended with status ")
    assert "\n" not in str(caught.value)
