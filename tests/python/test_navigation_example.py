"""The ground robot's sources in two languages fit what stands about them by hand."""

from __future__ import annotations

import re
from collections import Counter

import pytest
import yaml
from robot_sources import CPP, CPP_READ, PYTHON, PYTHON_READ, RobotSources, ident, relations

from pytpc_evaluation.demo.demo_examples import NAVIGATION
from pytpc_evaluation.treatment import Treatment

PACKAGE = NAVIGATION.folder
# Angles and lengths are compared in rad and m, and named so.
ROBOT = RobotSources(
    PACKAGE,
    {
        "backup_distance_cm": "backup_distance",
        "careful_speed": "careful_speed",
        "cruise_speed": "speed",
        "goal_radius_cm": "goal_radius",
        "heading_tolerance_deg": "heading_tolerance",
        "max_jump_angle_deg": "max_jump_angle",
        "max_tilt_deg": "max_tilt",
        "sharp_speed": "speed",
        "spin_angle_deg": "spin_angle",
        "stuck_distance_cm": "stuck_distance",
        "stuck_turn_deg": "stuck_turn",
        "turn_angle_deg": "turn_angle",
        "turn_exit_deg": "turn_exit_angle",
        "turn_in_place_deg": "turn_in_place_angle",
    },
)
IN_CPP, IN_PYTHON = ROBOT.cpp, ROBOT.python


@pytest.mark.parametrize(
    "entry", [*IN_CPP["tpcs"], *IN_PYTHON["tpcs"], *IN_PYTHON["either"]], ids=ident
)
def test_expected_line_compares_the_parameter(entry):
    ROBOT.assert_compares(entry)


@pytest.mark.parametrize(
    ("document", "pattern", "endings"),
    [(IN_CPP, CPP_READ, CPP), (IN_PYTHON, PYTHON_READ, PYTHON)],
    ids=["C++", "Python"],
)
def test_each_parameter_of_the_lists_is_read_and_each_read_one_is_in_a_list(
    document, pattern, endings
):
    assert ROBOT.listed(document) == ROBOT.reads(pattern, endings)


def test_python_fault_differs_in_the_one_relation():
    right, wrong = (relations(IN_PYTHON, unit) for unit in ("mission", "mission_fault"))
    assert right - wrong == Counter({("~goal_radius_cm", "<"): 1})
    assert wrong - right == Counter({("~goal_radius_cm", ">"): 1})


def test_plugin_with_the_fault_has_the_same_relations():
    # It compares degrees with radians: what is compared is wrong, not how.
    right, wrong = (
        relations(IN_CPP, unit)
        for unit in ("navigation_controllers", "navigation_controllers_fault")
    )
    assert right == wrong


def test_configuration_is_what_the_sources_read_with_their_defaults():
    own = ROBOT.configured
    in_python = own.pop("mission")
    assert in_python == ROBOT.python_defaults()
    configured = {name: value for parameters in own.values() for name, value in parameters.items()}
    defaults = ROBOT.cpp_defaults()
    # The rate and the seed come from the launch file.
    assert defaults.pop("rate") == 4.0
    assert defaults.pop("controller").strip('"') == configured.pop("controller")
    assert defaults == {name: configured[name] for name in defaults}
    # What has no default there has one as a variable.
    assert set(configured) - set(defaults) == {"max_duration"}


def test_many_parameters_are_compared():
    assert len({entry["parameter"] for entry in IN_CPP["tpcs"]}) >= 60
    assert len({entry["parameter"] for entry in IN_PYTHON["tpcs"]}) >= 18


def treatments(kind: str) -> list[Treatment]:
    folders = sorted((PACKAGE / "treatments").glob(f"{kind}*"))
    return [NAVIGATION.treatment(folder.name) for folder in folders]


@pytest.mark.parametrize("kind", ["type1", "type2"])
def test_treatments_of_a_type_change_parameters_of_many_nodes(kind):
    changed = treatments(kind)
    assert len({treatment.parameter for treatment in changed}) >= 5
    nodes = {treatment.node for treatment in changed}
    # The mission is in Python, the controller a plugin.
    assert nodes > {"/mission", "/controller_host", "/localisation"}


def test_no_parameter_is_changed_in_both_types():
    first, second = (
        {treatment.parameter for treatment in treatments(kind)} for kind in ("type1", "type2")
    )
    assert first & second == set()


@pytest.mark.parametrize("treatment", treatments("type"), ids=lambda treatment: str(treatment.name))
def test_treatment_changes_one_compared_parameter_past_where_it_tips(treatment):
    node, name = treatment.node.lstrip("/"), treatment.parameter.lstrip("~")
    assert treatment.name == f"{treatment.type}_{name}"
    assert yaml.safe_load(treatment.overlay.read_text()) == {node: {name: treatment.new}}
    assert ROBOT.configured[node][name] == treatment.old
    if treatment.tipping is None:
        assert treatment.round == 3  # nobody searched for it
    else:
        assert sorted([treatment.old, treatment.tipping, treatment.new])[1] == treatment.tipping
    compared = {entry["parameter"] for entry in [*IN_CPP["tpcs"], *IN_PYTHON["tpcs"]]}
    assert name in {parameter.lstrip("~") for parameter in compared}


def test_what_changes_no_parameter_sets_none():
    # The file of clean is loaded after the treatment's.
    assert len(treatments("fault")) == 2
    for treatment in [*treatments("clean"), *treatments("fault")]:
        assert yaml.safe_load(treatment.overlay.read_text()) == {}


def test_faults_are_those_that_the_launch_file_knows():
    launch = NAVIGATION.launch.read_text()
    known = set(re.findall(r"'(\w+)'", " ".join(re.findall(r"eval fault [^\"]*", launch))))
    assert known == {"none"} | {treatment.launch["fault"] for treatment in treatments("fault")}


def test_treatments_under_which_the_lamp_is_lit_late_are_there():
    late = {"type2_replan_period", "type2_retry_period", "type2_settle_time"}
    assert late == NAVIGATION.reached_under
    for treatment in treatments("type2"):
        said = [] if treatment.name in late else [NAVIGATION.reached]
        assert NAVIGATION.goal_remarks(treatment, reached=True) == said


def test_observer_knows_the_arena_as_it_is_simulated():
    sources = ("include/navigation/floor_plan.h", "src/ground_simulator/arena.cpp")
    sizes = {"ArenaWidth": "8.0", "ArenaHeight": "6.0"}
    boxes = set()
    for source in sources:
        text = (PACKAGE / source).read_text()
        for name, size in sizes.items():
            text = text.replace(name, size)
        for corners in re.findall(r"\{((?:[-\d. +]+, ){3}[-\d. +]+)\}", text):
            terms = (re.findall(r"-?[\d.]+", corner) for corner in corners.split(","))
            boxes.add(tuple(round(sum(map(float, term)), 6) for term in terms))
    observer = NAVIGATION.observer.read_text()
    standing = re.search(r"^STANDING = (\(.*?^\))", observer, re.MULTILINE | re.DOTALL)
    assert standing is not None
    assert {tuple(box) for box in yaml.safe_load(standing[1].translate(BRACKETS))} == boxes


BRACKETS = str.maketrans("()", "[]")
