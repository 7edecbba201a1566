"""The mission's sources and what stands about them by hand fit together."""

from __future__ import annotations

import json
import math
import re
import statistics
from collections import Counter
from pathlib import Path

import pytest
import yaml

from pytpc.recording.parameter_change import Change
from pytpc_evaluation.demo.demo_examples import IMAGE_CAPTURE
from pytpc_evaluation.study.changes import harmless_changes
from pytpc_evaluation.treatment import Treatment

PACKAGE = Path(__file__).parents[2] / "examples/image_capture"
# Which handle a parameter is read by is not looked at here.
DOCUMENT = json.loads((PACKAGE / "expected_tpcs.json").read_text().replace('"~', '"'))
READ = re.compile(r'\b(?:param|getParam)\(\s*"(\w+)"')

# Where the source compares something that is not named as the parameter is.
OTHER_NAMES = {
    "cruise_speed": "step",
    "field_of_view_deg": "half_angle_",
    "yaw_tolerance_deg": "yaw_tolerance_",
    "enable_yaw_ctrl": "enable_yaw_ctrl_|enabled\\(\\)",
}


def source_files() -> list[Path]:
    return sorted(path for path in PACKAGE.rglob("*") if path.suffix in (".cpp", ".h"))


def reads() -> set[str]:
    return {name for path in source_files() for name in READ.findall(path.read_text())}


def ident(entry: dict) -> str:
    return f"{entry['unit']}-{Path(entry['file']).name}:{entry['line']}-{entry['parameter']}"


@pytest.mark.parametrize("entry", DOCUMENT["tpcs"], ids=ident)
def test_expected_line_compares_the_parameter(entry):
    line = (PACKAGE / entry["file"]).read_text().splitlines()[entry["line"] - 1]
    parameter = entry["parameter"]
    assert re.search(OTHER_NAMES.get(parameter, rf"\b{parameter}_?\b"), line), line
    if entry["relation"] != "flag":
        assert f" {entry['relation']} " in f" {line} ", line


def test_each_parameter_of_the_lists_is_read_and_each_read_one_is_in_a_list():
    listed = {entry["parameter"] for part in ("tpcs", "not_tpcs") for entry in DOCUMENT[part]}
    together = re.findall(
        r"\(so (?:is|are) ([^)]*)\)", " ".join(entry["reason"] for entry in DOCUMENT["not_tpcs"])
    )
    listed |= {name for names in together for name in names.split(", ")}
    crossing = {entry["parameter"] for entry in DOCUMENT["cross_unit"]}
    assert listed <= reads()
    assert reads() - listed - crossing == set()


def of(unit: str) -> Counter:
    return Counter(
        (entry["parameter"], entry["relation"])
        for entry in DOCUMENT["tpcs"]
        if entry["unit"] == unit
    )


def test_a_fault_may_be_in_no_relation():
    # It is in the word between two of them.
    assert of("face_detector") == of("face_detector_fault")


def test_fault_build_differs_in_the_one_relation():
    assert of("mission") - of("mission_fault") == Counter({("max_coverage_limit", "<"): 1})
    assert of("mission_fault") - of("mission") == Counter({("max_coverage_limit", ">"): 1})


def test_configuration_sets_each_parameter_that_a_node_reads():
    # rate and seed come from the launch file.
    own = yaml.safe_load((PACKAGE / "config/params.yaml").read_text())
    configured = {name for parameters in own.values() for name in parameters}
    assert configured == reads() - {"rate", "seed"}


def test_the_table_of_the_thesis_is_covered():
    # Table 6.12.
    named = {
        "collapse_deadband",
        "enable_baro_ctrl_mode",
        "enable_derv_fir_filter",
        "enable_pitch_ctrl",
        "enable_roll_ctrl",
        "enable_thrust_ctrl",
        "enable_thrust_iir_filter",
        "enable_yaw_ctrl",
        "face_detection_threshold",
        "gps_enable_mode",
        "max_coverage_limit",
        "max_pkt_size",
        "max_selfie_count",
        "min_coverage_limit",
        "min_displacement",
        "min_land_height",
        "min_z_displacement",
        "selfie_control_rate",
        "waypose_idle_timeout",
    }
    compared = {entry["parameter"] for entry in DOCUMENT["tpcs"]}
    assert named <= compared
    assert len(compared) >= 28


def test_package_is_large_enough_to_be_a_robot():
    lines = sum(len(path.read_text().splitlines()) for path in source_files())
    assert lines > 1500


def treatments(kind: str) -> list[Treatment]:
    folders = sorted((PACKAGE / "treatments").glob(f"{kind}*"))
    return [IMAGE_CAPTURE.treatment(folder.name) for folder in folders]


@pytest.mark.parametrize("kind", ["type1", "type2"])
def test_treatments_of_a_type_change_five_parameters_of_three_nodes(kind):
    changed = treatments(kind)
    assert len({treatment.parameter for treatment in changed}) >= 5
    nodes = {treatment.node for treatment in changed}
    assert nodes == {"/mission", "/face_detector", "/flight_controller"}


def test_no_parameter_is_changed_in_both_types():
    first, second = (
        {treatment.parameter for treatment in treatments(kind)} for kind in ("type1", "type2")
    )
    assert first & second == set()


@pytest.mark.parametrize("treatment", treatments("type"), ids=lambda treatment: str(treatment.name))
def test_treatment_changes_one_compared_parameter_past_where_it_tips(treatment):
    own = yaml.safe_load((PACKAGE / "config/params.yaml").read_text())
    node, name = treatment.node.lstrip("/"), treatment.parameter.lstrip("~")
    assert treatment.name == f"{treatment.type}_{name}"
    assert yaml.safe_load(treatment.overlay.read_text()) == {node: {name: treatment.new}}
    assert own[node][name] == treatment.old
    assert treatment.old != treatment.new
    if treatment.tipping is None:
        assert treatment.round == 3  # nobody searched for it
    else:
        assert sorted([treatment.old, treatment.tipping, treatment.new])[1] == treatment.tipping
    assert name in {entry["parameter"] for entry in DOCUMENT["tpcs"]}


def test_what_changes_no_parameter_sets_none():
    # The file of clean is loaded after the treatment's.
    assert len(treatments("fault")) == 2
    for treatment in [*treatments("clean"), *treatments("fault")]:
        assert yaml.safe_load(treatment.overlay.read_text()) == {}


def test_faults_are_those_that_the_launch_file_knows():
    launch = (PACKAGE / "launch/image_capture.launch").read_text()
    known = set(re.findall(r"'(\w+)'", " ".join(re.findall(r"eval fault [^\"]*", launch))))
    assert known == {"none"} | {treatment.launch["fault"] for treatment in treatments("fault")}


def times(one: Treatment | Change) -> float:
    """How many times as large, or as small, a change makes its number."""
    return max(one.old, one.new) / min(one.old, one.new) if min(one.old, one.new) else math.inf


def test_harmless_changes_are_as_large_as_those_of_the_treatments():
    decoys = harmless_changes(IMAGE_CAPTURE)
    assert len(decoys) >= 20
    factors = [times(one) for one in decoys]
    assert statistics.median(factors) >= statistics.median(map(times, treatments("type")))
    assert 1.3 <= min(factors) <= max(factors) <= 60.0
    greater = sum(one.new > one.old for one in decoys)
    assert len(decoys) / 3 <= greater <= len(decoys) * 2 / 3
    assert {one.node for one in decoys} > {"/mission", "/face_detector", "/flight_controller"}
    # They are compared as the treatments' are.
    compared = {entry["parameter"] for entry in DOCUMENT["tpcs"]}
    assert {one.parameter.lstrip("~") for one in decoys} <= compared
