"""The quick part of the study on a real graph: four flights, and one with a suggestion."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner, Result

from pytpc.base.errors import MissingToolError
from pytpc.base.paths import cmake_file, log_library, plugin
from pytpc.cli.main import main
from pytpc.ingest.reading import read
from pytpc.recording.faults import unknown_keys
from pytpc.recording.parameter_change import Change
from pytpc.static.static_info import StaticInfo
from pytpc.values.recording import read_parameters
from pytpc_evaluation.demo.demo_examples import WATER_SAMPLER
from pytpc_evaluation.demo.demo_show import Built
from pytpc_evaluation.study.changes import DECOYS
from pytpc_evaluation.treatment import load_treatment

# Of simulated time; a machine that cannot keep up is slower, and flies the same.
RATE = "24"
TREATED = {
    "missions/water_sampler/type1_full_vial_volume/seed-1": "I",
    "missions/water_sampler/type2_min_conductivity/seed-1": "II",
}
MISSIONS = ("missions/water_sampler/clean/seed-1", *TREATED)
REFERENCE = "reference/water_sampler"

try:
    for half in (cmake_file, plugin, log_library):
        half()
except MissingToolError as error:
    pytest.skip(f"the C++ half is not installed: {error}", allow_module_level=True)


def study(out: Path, *words: str) -> Result:
    return CliRunner().invoke(main, ["study", *words, "--out", str(out), "--rate", RATE, "--json"])


@pytest.fixture(scope="module")
def out(water: Built, study_out: Path) -> Iterator[Path]:
    """The study's folder with the quick part of it."""
    result = study(study_out, "run", "--quick")
    assert result.exit_code == 0, result.stderr
    rows = json.loads(result.stdout)
    assert [row["folder"] for row in rows] == [REFERENCE, *MISSIONS]
    assert [(row["state"], row["kept"]) for row in rows] == [("done", False)] * 4
    # Each went as its treatment demands.
    assert [row["remarks"] for row in rows] == [[]] * 4
    yield study_out


def test_what_was_flown_is_not_flown_again(out):
    before = {path: path.stat().st_mtime_ns for path in out.rglob("done.json")}
    rows = json.loads(study(out, "run", "--quick").stdout)
    assert [row["kept"] for row in rows] == [True] * 4
    assert {path: path.stat().st_mtime_ns for path in out.rglob("done.json")} == before


@pytest.mark.parametrize("label", [REFERENCE, *MISSIONS])
def test_missions_are_read_like_any_other(out, label):
    recording = read(out / label)
    static = StaticInfo.load(out / "systems/water_sampler/static.json")
    assert unknown_keys(recording.events, static) == {}
    assert (recording.malformed, recording.lost, recording.dropped) == (0, {}, ())
    # Both languages report, on the simulated clock, which begins at 0 and has no date.
    reporting = {static.unit_of(key).is_python for key in recording.events.keys}
    assert reporting == {False, True}
    assert 0 <= recording.events.time_ns[0] < recording.events.time_ns[-1] < 300 * 10**9
    assert load_treatment(out / label).name == (
        "clean" if label == REFERENCE else label.split("/")[2]
    )
    rest = {path.name for path in (out / label).iterdir()}
    assert not rest & {"mission.bag", "tpc", "ros"}


@pytest.mark.parametrize("label", [REFERENCE, *MISSIONS])
def test_the_changes_are_what_stood_on_the_robot(out, label):
    changes = [Change(**one) for one in json.loads((out / label / "changes.json").read_text())]
    own = read_parameters(WATER_SAMPLER.parameters)
    stood = read_parameters(out / label / "params.yaml")
    others = {name: stood[name] for name in own if stood[name] != own[name]}
    assert others == {f"{one.node}/{one.parameter.lstrip('~')}": one.new for one in changes}
    assert len(changes) == (0 if label == REFERENCE else DECOYS + (label in TREATED))


@pytest.mark.parametrize("label", TREATED)
def test_people_mark_what_they_saw(out, label):
    folder, kind = out / label, TREATED[label]
    causes = json.loads((folder / "causes.json").read_text())
    assert min(causes, key=lambda cause: cause["start"])["kind"] == kind
    rows = pq.read_table(folder / "marks.parquet").to_pylist()
    assert rows
    for row in rows:
        cause = causes[row["cause"]]
        assert row["right"] == cause["kind"]
        assert row["time_ns"] > cause["start"] * 1e9
    marks = read(folder).marks
    told = sorted((row["time_ns"], row["right"], row["observer"]) for row in rows)
    assert sorted((one.time_ns, one.type, one.observer) for one in marks) == told
    # On the clock of the reports.
    assert max(row["time_ns"] for row in rows) <= read(folder).end_ns


def test_the_right_value_takes_the_error_away(out):
    wanted = out / "results" / "suggestions-wanted.json"
    wanted.parent.mkdir()
    treatment = WATER_SAMPLER.treatment("type2_min_conductivity")
    suggestion = {
        "system": "water_sampler",
        "treatment": treatment.name,
        "seed": 1,
        "parameter": treatment.parameter,
        "node": treatment.node,
        "value": treatment.old,
    }
    wanted.write_text(json.dumps([suggestion]))
    result = study(out, "suggested")
    assert result.exit_code == 0, result.stderr
    (row,) = json.loads(result.stdout)
    assert (row["gone"], row["new"], row["reached"], row["failure"]) == (True, False, True, "")
