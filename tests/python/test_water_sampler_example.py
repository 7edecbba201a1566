"""The water sampler's sources in two languages fit what stands about them by hand."""

from __future__ import annotations

import ast
import json
import re
from collections import Counter
from pathlib import Path
from statistics import median

import pytest
import yaml

from pytpc_evaluation.demo.demo_examples import WATER_SAMPLER
from pytpc_evaluation.study.changes import harmless_changes
from pytpc_evaluation.treatment import Treatment

PACKAGE = WATER_SAMPLER.folder
CPP = json.loads((PACKAGE / "expected_tpcs.json").read_text())
PYTHON = json.loads((PACKAGE / "expected_python_tpcs.json").read_text())
CPP_READ = re.compile(r'\b(?:param|getParam)\(\s*"(\w+)"')
PYTHON_READ = re.compile(r'rospy\.get_param\("~(\w+)"')

# Where the source compares something that is not named as the parameter is.
OTHER_NAMES = {
    "cruise_speed": "step",
    "height_tolerance_cm": "height_tolerance",
    "max_pump_requests": "max_requests",
    "pump_retry_period": "retry_period",
}


def source_files(*endings: str) -> list[Path]:
    folders = ("include", "src", "nodes")
    return [
        path
        for folder in folders
        for path in sorted((PACKAGE / folder).rglob("*"))
        if path.suffix in endings
    ]


def reads(pattern: re.Pattern[str], *endings: str) -> set[str]:
    return {name for path in source_files(*endings) for name in pattern.findall(path.read_text())}


def ident(entry: dict) -> str:
    return f"{entry['unit']}-{Path(entry['file']).name}:{entry['line']}-{entry['parameter']}"


@pytest.mark.parametrize("entry", [*CPP["tpcs"], *PYTHON["tpcs"], *PYTHON["either"]], ids=ident)
def test_expected_line_compares_the_parameter(entry):
    line = (PACKAGE / entry["file"]).read_text().splitlines()[entry["line"] - 1]
    parameter = entry["parameter"].removeprefix("~")
    assert re.search(rf"(\b|_){OTHER_NAMES.get(parameter, parameter)}(\b|_)", line), line
    if entry["relation"] != "flag":
        assert f" {entry['relation']} " in line, line


@pytest.mark.parametrize("entry", [*CPP["not_tpcs"], *PYTHON["not_tpcs"]], ids=ident)
def test_line_of_what_is_no_tpc_names_the_parameter(entry):
    line = (PACKAGE / entry["file"]).read_text().splitlines()[entry["line"] - 1]
    parameter = entry["parameter"].removeprefix("~")
    assert parameter.removeprefix("tank_") in line, line


@pytest.mark.parametrize(
    ("document", "pattern", "endings"),
    [(CPP, CPP_READ, (".cpp", ".h")), (PYTHON, PYTHON_READ, (".py",))],
    ids=["C++", "Python"],
)
def test_each_parameter_of_the_lists_is_read_and_each_read_one_is_in_a_list(
    document, pattern, endings
):
    entries = [*document["tpcs"], *document["not_tpcs"]]
    listed = {entry["parameter"].removeprefix("~") for entry in entries}
    reasons = " ".join(entry["reason"] for entry in document["not_tpcs"])
    for together in re.findall(r"\(so (?:is|are) ([^)]*)\)", reasons):
        listed |= set(together.split(", "))
    assert listed == reads(pattern, *endings)


@pytest.mark.parametrize(
    ("document", "unit", "parameter", "right", "wrong"),
    [(PYTHON, "mission", "~max_dip_depth", "<", ">"), (CPP, "pump_control", "~min_flow", ">", "<")],
)
def test_fault_differs_in_the_one_relation(document, unit, parameter, right, wrong):
    def of(unit: str) -> Counter:
        return Counter(
            (entry["parameter"], entry["relation"])
            for entry in document["tpcs"]
            if entry["unit"] == unit
        )

    assert of(unit) - of(f"{unit}_fault") == Counter({(parameter, right): 1})
    assert of(f"{unit}_fault") - of(unit) == Counter({(parameter, wrong): 1})


def test_configuration_sets_each_parameter_that_a_node_reads():
    # rate and seed come from the launch file.
    own = yaml.safe_load((PACKAGE / "config/params.yaml").read_text())
    in_python = set(own.pop("mission"))
    in_cpp = {name for parameters in own.values() for name in parameters}
    assert in_cpp == reads(CPP_READ, ".cpp", ".h") - {"rate", "seed"}
    assert in_python == reads(PYTHON_READ, ".py")


def test_defaults_in_the_source_are_the_configuration():
    own = yaml.safe_load((PACKAGE / "config/params.yaml").read_text())
    in_python = {
        name: ast.literal_eval(text)
        for path in source_files(".py")
        for name, text in re.findall(r'get_param\("~(\w+)", ([^)]+)\)', path.read_text())
    }
    assert in_python == own.pop("mission")
    in_cpp = {
        name: yaml.safe_load(text)
        for path in source_files(".cpp")
        for name, text in re.findall(r'\.param\("(\w+)", \w+, ([^)]+)\)', path.read_text())
    }
    # The rate comes from the launch file; what has no default there has one as a variable.
    assert in_cpp.pop("rate") == 4.0
    configured = {name: value for parameters in own.values() for name, value in parameters.items()}
    assert in_cpp == {name: configured[name] for name in in_cpp}
    assert set(configured) - set(in_cpp) == {"max_duration"}


def test_both_languages_compare_many_parameters():
    in_cpp = {entry["parameter"] for entry in CPP["tpcs"]}
    in_python = {entry["parameter"] for entry in PYTHON["tpcs"]}
    assert len(in_cpp) >= 25
    assert len(in_python) >= 20


def treatments() -> list[Treatment]:
    return [WATER_SAMPLER.treatment(path.name) for path in (PACKAGE / "treatments").iterdir()]


@pytest.mark.parametrize("kind", ["type1", "type2"])
def test_parameters_of_each_language_are_changed_in_each_type_of_treatment(kind):
    changed = [str(each.parameter) for each in treatments() if each.type == kind]
    assert len(changed) == len(set(changed)) >= 5
    for document in (CPP, PYTHON):
        compared = {entry["parameter"] for entry in document["tpcs"]}
        assert len(compared & set(changed)) >= 2


def test_no_parameter_is_changed_in_two_treatments():
    changed = Counter(each.parameter for each in treatments() if each.parameter is not None)
    assert set(changed.values()) == {1}


@pytest.mark.parametrize("treatment", treatments(), ids=lambda each: each.name)
def test_treatment_changes_one_number_and_says_so(treatment):
    overlay = yaml.safe_load(treatment.overlay.read_text())
    assert treatment.name == treatment.overlay.parent.name
    if treatment.parameter is None:
        assert overlay == {}
        assert treatment.name.startswith(treatment.type)
        return
    node, name = treatment.node.removeprefix("/"), treatment.parameter.removeprefix("~")
    assert treatment.name == f"{treatment.type}_{name}"
    assert overlay == {node: {name: treatment.new}}
    own = yaml.safe_load((PACKAGE / "config/params.yaml").read_text())
    assert own[node][name] == treatment.old
    # The behaviour tips between the right value and the wrong one.
    low, high = sorted((treatment.old, treatment.new))
    if treatment.tipping is None:
        assert treatment.round == 3  # nobody searched for it
    else:
        assert low < treatment.tipping < high


def test_faults_are_those_of_the_launch_file():
    launch = WATER_SAMPLER.launch.read_text()
    faults = [each for each in treatments() if each.type == "fault"]
    assert len(faults) == 2
    for each in faults:
        assert list(each.launch) == ["fault"]
        assert each.name == f"fault_{each.launch['fault']}"
        assert launch.count(f"$(eval fault == '{each.launch['fault']}')") == 2


def test_decoys_change_parameters_of_both_languages_by_as_much_as_the_treatments_do():
    decoys = harmless_changes(WATER_SAMPLER)
    changed = [(each.old, each.new) for each in treatments() if each.parameter is not None]

    def factor(old: float, new: float) -> float:
        return max(new / old, old / new)

    usual = median(factor(old, new) for old, new in changed)
    assert median(factor(each.old, each.new) for each in decoys) >= usual
    ups = sum(each.new > each.old for each in decoys)
    assert len(decoys) / 3 < ups < len(decoys) * 2 / 3
    for document in (CPP, PYTHON):
        compared = {entry["parameter"] for entry in document["tpcs"]}
        assert len(compared & {each.parameter for each in decoys}) >= 5


def test_demonstration_flies_treatments_that_are_there():
    assert WATER_SAMPLER.shown[0] == "clean"
    assert set(WATER_SAMPLER.shown) <= {each.name for each in treatments()}


def test_treatments_under_which_the_vial_is_filled_are_there():
    assert {each.name for each in treatments()} > WATER_SAMPLER.reached_under
    for each in treatments():
        nevertheless = each.type == "clean" or each.name in WATER_SAMPLER.reached_under
        said = [] if nevertheless else [WATER_SAMPLER.reached]
        assert WATER_SAMPLER.goal_remarks(each, reached=True) == said
