"""The mission's sources and what stands about them by hand fit together."""

from __future__ import annotations

import json
import re
from collections import Counter
from pathlib import Path

import pytest
import yaml

PACKAGE = Path(__file__).parents[2] / "examples/image_capture"
# Which handle a parameter is read by is not looked at here.
DOCUMENT = json.loads((PACKAGE / "expected_tpcs.json").read_text().replace('"~', '"'))
READ = re.compile(r'\b(?:param|getParam)\(\s*"(\w+)"')

# Where the source compares something that is not named as the parameter is.
OTHER_NAMES = {
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


def test_fault_build_differs_in_the_one_relation():
    def of(unit: str) -> Counter:
        return Counter(
            (entry["parameter"], entry["relation"])
            for entry in DOCUMENT["tpcs"]
            if entry["unit"] == unit
        )

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
