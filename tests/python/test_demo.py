"""The demonstrations: what is joined for them, and how Python nodes get their words."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import pytest
from mission_samples import comparison, link_unit, static_info

from pytpc import demo_python
from pytpc.demo_examples import IMAGE_CAPTURE, SHARED_PACKAGE, WATER_SAMPLER
from pytpc.demo_python import joined, launch_arguments, static_file
from pytpc.demo_show import can_be_named, link_package
from pytpc.errors import InputError, RunError, WorkspaceError
from pytpc.static_info import LeftOut, StaticInfo
from pytpc.treatment import Treatment


def in_unit(name: str, number: int, source: str) -> StaticInfo:
    """Static information of one link unit with one comparison."""
    unit = replace(link_unit([comparison(number, source)]), link_unit=name)
    return StaticInfo.of([unit], copies={f"/copy/{name}.h": f"/{name}.h"})


def test_joined_static_information_has_all_of_its_parts():
    left_out = LeftOut("robot", "odd", "it was linked without TPC")
    control = replace(in_unit("control", 1, "limit"), left_out=(left_out,))
    both = joined(control, [in_unit("mission", 2, "~patience")])
    assert [unit.link_unit for unit in both.units] == ["control", "mission"]
    assert {c.source for c in both.comparisons.values()} == {"limit", "~patience"}
    assert both.copies == (("/copy/control.h", "/control.h"), ("/copy/mission.h", "/mission.h"))
    assert both.left_out == (left_out,)


def test_one_link_unit_in_two_parts_is_an_error():
    with pytest.raises(InputError, match="link unit mission of package robot occurs twice"):
        joined(in_unit("mission", 1, "a"), [in_unit("mission", 2, "b")])


def test_treatment_is_left_out_where_nothing_compares_its_parameter():
    def of(parameter: str | None) -> Treatment:
        kind = "clean" if parameter is None else "type1"
        return Treatment("x", kind, parameter, "/m", 1, 2, {}, "It lands.", Path("params.yaml"))

    static = static_info(comparison(1, "~here"), comparison(2, "~odd", type="constant"))
    assert can_be_named(of("~here"), static)
    assert can_be_named(of(None), static)
    assert not can_be_named(of("~there"), static)
    assert not can_be_named(of("~odd"), static)


def test_launch_file_has_the_arguments_for_python_nodes(tmp_path):
    # Each node in Python runs with the file that has its own name.
    launch = ET.parse(WATER_SAMPLER.launch).getroot()
    declared = {arg.get("name") for arg in launch.findall("arg")}
    assert set(launch_arguments(tmp_path)) <= declared
    scripts = {Path(node).name for node in WATER_SAMPLER.python_nodes}
    prefixes = {
        node.get("type"): node.get("launch-prefix", "")
        for node in launch.findall("node")
        if node.get("type") in scripts
    }
    assert set(prefixes) == scripts
    for script, prefix in prefixes.items():
        assert f"'/{static_file(Path(), str(script))}'" in prefix


def test_nodes_in_python_are_run_by_the_project_with_absolute_paths(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = launch_arguments(Path("python"), interpreter="/opt/python")
    root = Path(demo_python.__file__).resolve().parents[1]
    assert words["python_runner"] == f"/opt/python {root}/pytpc/run.py"
    assert words["python_static"] == f"{tmp_path}/python"


def test_an_analysis_that_fails_is_one_line(tmp_path):
    odd = replace(WATER_SAMPLER, python_nodes=("nodes/none.py",))
    with pytest.raises(RunError, match=r"pytpc analyse ended with status \d: ") as caught:
        demo_python.analyse_nodes(odd, tmp_path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("example", [IMAGE_CAPTURE, WATER_SAMPLER], ids=lambda one: one.name)
def test_examples_are_whole(example):
    assert example.launch.is_file()
    assert all((example.folder / node).is_file() for node in example.python_nodes)
    assert [one.name for one in example.treatments()] == list(example.shown)
    assert example.goal_topic in example.watched


def test_package_is_linked_anew_where_an_old_link_stands(tmp_path):
    link = tmp_path / "src" / "water_sampler"
    link.parent.mkdir()
    link.symlink_to(tmp_path / "gone")
    for _ in range(2):
        link_package(WATER_SAMPLER, tmp_path)
        linked = {path.name: path.resolve() for path in (tmp_path / "src").iterdir()}
        assert linked == {
            "water_sampler": WATER_SAMPLER.folder,
            "simulated_world": SHARED_PACKAGE,
        }


def test_a_folder_in_the_links_place_is_an_error(tmp_path):
    (tmp_path / "src" / "water_sampler").mkdir(parents=True)
    with pytest.raises(WorkspaceError, match=r"water_sampler: cannot be made: Is a directory"):
        link_package(WATER_SAMPLER, tmp_path)
