"""The demonstrations: what they are made of, and what they tell."""

from __future__ import annotations

import io
import re
from dataclasses import replace
from pathlib import Path

import pytest
from mission_samples import comparison, key, link_unit, static_info
from rich.console import Console

from pytpc.base.errors import WorkspaceError
from pytpc.static.link_unit import Comparison, LinkUnit
from pytpc.static.static_info import StaticInfo
from pytpc_evaluation.demo.demo_examples import (
    IMAGE_CAPTURE,
    SHARED_PACKAGE,
    WATER_SAMPLER,
    link_package,
)
from pytpc_evaluation.demo.demo_show import can_be_named, tell_found
from pytpc_evaluation.treatment import Treatment


def test_treatment_is_left_out_where_nothing_compares_its_parameter():
    def of(parameter: str | None) -> Treatment:
        kind = "clean" if parameter is None else "type1"
        return Treatment("x", kind, parameter, "/m", 1, 2, {}, "It lands.", Path("params.yaml"))

    static = static_info(comparison(1, "~here"), comparison(2, "~odd", type="constant"))
    assert can_be_named(of("~here"), static)
    assert can_be_named(of(None), static)
    assert not can_be_named(of("~there"), static)
    assert not can_be_named(of("~odd"), static)


def test_what_was_found_is_told_by_language():
    def unit(name: str, analysis: str | None, *comparisons: Comparison) -> LinkUnit:
        found = link_unit(list(comparisons))
        return replace(found, link_unit=name, tool=replace(found.tool, analysis=analysis))

    def told(*units: LinkUnit) -> str:
        console = Console(record=True, file=io.StringIO())
        tell_found(console, StaticInfo.of(units))
        return console.export_text().strip()

    limits = (comparison(1, "~here"), comparison(2, "~odd", type="constant"))
    in_cpp = unit("control", None, *limits)
    assert told(in_cpp) == "1 comparison of parameters found"
    # A module of two scripts is one place with two keys.
    shared = replace(comparison(3, "~there"), file="src/module.py")
    scripts = [unit("a", "python", shared), unit("b", "python", replace(shared, key=key(4)))]
    expected = "2 comparisons of parameters found: 1 in C++, 1 in Python"
    assert told(in_cpp, *scripts) == expected


def test_launch_file_is_as_for_any_robot():
    # Nothing of TPC is in it: the nodes report by how they were built, and by the environment.
    text = WATER_SAMPLER.launch.read_text()
    assert not re.search(r"tpc|prefix|python", text, re.IGNORECASE)


@pytest.mark.parametrize("example", [IMAGE_CAPTURE, WATER_SAMPLER], ids=lambda one: one.name)
def test_examples_are_whole(example):
    assert example.launch.is_file()
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
