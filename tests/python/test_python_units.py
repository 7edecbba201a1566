"""Python nodes of a workspace: how they are named, written, kept and dropped.

``mixed_workspace`` has the sources with their lines; tests/ros builds them.
"""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from static_units import unit

from mixed_workspace import BROKEN_TEXT, CAMERA, PUMP_PY, make_mixed
from pytpc.build import python_units
from pytpc.build.collect import collect_sources
from pytpc.build.python_nodes import PythonBuild, python_of_build
from pytpc.build.python_units import PythonUnits, analyse_workspaces, named_beside
from pytpc.cli.main import main
from pytpc.python_analysis.analysis import analyse_entry
from pytpc.python_analysis.rules_file import load_rules
from pytpc.python_analysis.sources.scripts import Entry
from pytpc.static.link_unit import LinkUnit
from pytpc.static.static_info import StaticInfo, load_link_unit, unit_files
from pytpc.workspace.packages import find_packages, packages_up_to

RULES = load_rules()
TARGET = ("mission", "mission")


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    return make_mixed(tmp_path / "ws")


def built(
    workspace: Path,
    *only: str,
    taken: tuple[tuple[str, str], ...] = (TARGET,),
    python: bool = True,
    tests: bool = False,
) -> PythonUnits:
    """What a build makes of the Python; ``only`` these packages and what they need."""
    packages = find_packages(workspace)
    asked = PythonBuild(
        workspace,
        workspace / ".tpc/build",
        packages,
        chosen=packages_up_to(packages, only),
        rules=RULES if python else None,
        tests=tests,
    )
    return python_of_build(asked, taken)


def names(found: PythonUnits | StaticInfo) -> list[str]:
    return [f"{each.package}/{each.link_unit}" for each in found.units]


def files(workspace: Path) -> list[str]:
    base = workspace / ".tpc/build"
    return [str(path.relative_to(base)) for path in unit_files(base)] if base.is_dir() else []


def test_a_script_that_is_called_as_a_target_is_called_by_its_path(workspace: Path) -> None:
    found = built(workspace)
    assert names(found) == ["camera/node", "mission/scripts/mission.py", "mission/pump"]
    assert [each.script for each in found.units] == [
        "camera/node.py", "scripts/mission.py", "scripts/pump.py",
    ]  # fmt: skip
    assert names(built(workspace, taken=())) == ["camera/node", "mission/mission", "mission/pump"]


def test_the_keys_are_the_same_whatever_the_name(workspace: Path) -> None:
    def keys(found: PythonUnits) -> list[str]:
        return [each.key for one in found.units for each in one.comparisons]

    assert keys(built(workspace)) == keys(built(workspace, taken=()))
    output = workspace / "analysed.json"
    ran = CliRunner().invoke(main, ["analyse", str(workspace), "-o", str(output)])
    assert ran.exit_code == 0, ran.output
    assert set(StaticInfo.load(output).comparisons) == set(keys(built(workspace)))


def test_each_unit_has_a_file_that_no_target_can_have(workspace: Path) -> None:
    found = built(workspace)
    assert files(workspace) == [
        "camera/tpc/node@python.json",
        "mission/tpc/pump@python.json",
        "mission/tpc/scripts%2Fmission.py@python.json",
    ]
    base = workspace / ".tpc/build"
    read = {one.link_unit: one for one in map(load_link_unit, unit_files(base))}
    assert read == {one.link_unit: one for one in found.units}


def test_names_that_are_taken_by_all_that_could_be() -> None:
    """A script in the package's own folder has no slash in its path."""
    data = unit(link_unit="node", script="node")
    data["tool"] = {**data["tool"], "analysis": "python"}
    first = LinkUnit.from_json(data, Path("x"))
    beside = named_beside([first, first, first], {("face", "node")})
    assert [each.link_unit for each in beside] == ["./node", "node_2", "node_3"]
    assert named_beside([first], {("other", "node")}) == [first]


def test_a_script_that_is_no_python_is_left_out_with_its_line(workspace: Path) -> None:
    (broken,) = built(workspace).left_out
    script = workspace / "src/mission/scripts/broken.py"
    assert (broken.package, broken.link_unit) == ("mission", "scripts/broken.py")
    assert broken.reason == f"{script}:3: {BROKEN_TEXT}"


def test_a_text_that_no_json_can_have_costs_that_script_alone(workspace: Path) -> None:
    pump = workspace / "src/mission/scripts/pump.py"
    pump.write_text(PUMP_PY + "    rospy.get_param('\\ud800')\n", encoding="utf-8")
    found = built(workspace)
    assert names(found) == ["camera/node", "mission/scripts/mission.py"]
    (reason,) = (one.reason for one in found.left_out if one.link_unit == "scripts/pump.py")
    assert reason.startswith("not UTF-8, so cannot be written as JSON: ")


def test_a_module_of_two_scripts_is_one_row(workspace: Path) -> None:
    found = built(workspace)
    static = StaticInfo.of(found.units)
    assert [(tpc.place, tpc.lineno, tpc.link_units) for tpc in static.tpcs] == [
        ("camera/node.py", 8, ("camera/node",)),
        ("scripts/mission.py", 8, ("mission/scripts/mission.py",)),
        ("scripts/mission.py", 9, ("mission/scripts/mission.py",)),
        ("src/sampling/limits.py", 5, ("mission/pump", "mission/scripts/mission.py")),
    ]


def test_the_file_of_a_script_that_is_no_more_goes(workspace: Path) -> None:
    built(workspace)
    (workspace / "src/mission/scripts/pump.py").unlink()
    assert names(built(workspace)) == ["camera/node", "mission/scripts/mission.py"]
    assert len(files(workspace)) == 2


def test_of_packages_that_are_not_built_what_was_written_stays(workspace: Path) -> None:
    built(workspace)
    (workspace / "src/mission/scripts/mission.py").unlink()
    (workspace / "src/camera/camera/node.py").write_text("x = 1\n", encoding="utf-8")
    # Of camera the script is still there; that it is no node any more is not looked at.
    assert names(built(workspace, "mission")) == ["mission/pump", "camera/node"]
    assert names(built(workspace, "camera")) == ["mission/pump"]


def test_a_chosen_package_comes_with_what_it_needs(workspace: Path) -> None:
    assert names(built(workspace, "mission")) == ["mission/scripts/mission.py", "mission/pump"]
    assert len(built(workspace, "camera").units) == 3


def test_without_python_an_earlier_build_is_forgotten(workspace: Path) -> None:
    built(workspace)
    assert names(built(workspace, "mission", python=False)) == ["camera/node"]
    assert files(workspace) == ["camera/tpc/node@python.json"]


def test_scripts_in_folders_of_tests_are_asked_for(workspace: Path) -> None:
    tests = workspace / "src/mission/test"
    tests.mkdir()
    (tests / "pump.py").write_text(PUMP_PY, encoding="utf-8")
    assert len(built(workspace).units) == 3
    assert names(built(workspace, "mission", tests=True)) == [
        "mission/scripts/mission.py", "mission/pump", "mission/test/pump.py", "camera/node",
    ]  # fmt: skip


def test_only_the_scripts_of_packages_are_a_workspaces(workspace: Path) -> None:
    loose = workspace / "tools/mission"
    loose.mkdir(parents=True)
    (loose / "loose.py").write_text(PUMP_PY, encoding="utf-8")
    assert len(built(workspace).units) == 3


@pytest.fixture
def analysed(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The scripts that were analysed, one after another."""
    log: list[str] = []

    def analyse(entry: Entry, *how: Any) -> LinkUnit:
        log.append(entry.name)
        return analyse_entry(entry, *how)

    monkeypatch.setattr(python_units, "analyse_entry", analyse)
    return log


ONCE = ["node", "mission", "pump"]


def test_what_has_not_changed_is_not_analysed_again(workspace: Path, analysed: list[str]) -> None:
    first = built(workspace)
    (workspace / "src/mission/src/mission.cpp").write_text("int x;", encoding="utf-8")
    assert built(workspace) == first
    assert analysed == ONCE


def no_shebang(workspace: Path) -> None:
    """A script without a suffix, which is none any more."""
    (workspace / "src/mission/scripts/bare").write_text("nothing", encoding="utf-8")


CHANGES: dict[str, Callable[[Path], object]] = {
    "a module": lambda ws: (ws / "src/mission/src/sampling/limits.py").write_text("x = 1"),
    "a new module": lambda ws: (ws / "src/mission/scripts/rospy.py").write_text("x = 1"),
    "a broken script": lambda ws: (ws / "src/mission/scripts/broken.py").write_text("x = 1"),
    "a script without a suffix": no_shebang,
    "a package": lambda ws: (ws / "src/camera/package.xml").write_text(CAMERA + "<!-- -->"),
    "a file of ours": lambda ws: (ws / ".tpc/build/camera/tpc/node@python.json").unlink(),
    "a broken file of ours": lambda ws: (ws / ".tpc/python.json").write_text("[]"),
}


@pytest.mark.parametrize("change", CHANGES)
def test_what_has_changed_is_analysed_again(
    workspace: Path, analysed: list[str], change: str
) -> None:
    bare = workspace / "src/mission/scripts/bare"
    bare.write_text("#!/usr/bin/python3\n", encoding="utf-8")
    built(workspace)
    CHANGES[change](workspace)
    built(workspace)
    assert len(analysed) == 6


def test_other_wishes_are_analysed_again(workspace: Path, analysed: list[str]) -> None:
    built(workspace)
    built(workspace, taken=())
    built(workspace, "camera", tests=True)
    assert len(analysed) == 9
    built(workspace, python=False)
    assert files(workspace) == []
    built(workspace, "camera", tests=True)
    assert len(analysed) == 12


def test_what_failed_is_tried_again(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The time that a script may take is another one on a busy machine."""
    nothing = {"parameters": (), "exposing": (), "comparisons": ()}

    def fail(entry: Entry, *how: Any) -> LinkUnit:
        unit = analyse_entry(entry, *how)
        why = {"status": "failed", "failure": "it took more than 120 s"}
        return replace(unit, not_exposed=(), blind_spots=(), **nothing, **why)

    with monkeypatch.context() as patched:
        patched.setattr(python_units, "analyse_entry", fail)
        assert {each.status for each in built(workspace).units} == {"failed"}
    assert {each.status for each in built(workspace).units} == {"ok"}


def test_a_package_that_is_reached_by_a_link(workspace: Path) -> None:
    (workspace / "src/camera").rename(workspace.parent / "camera")
    (workspace / "src/camera").symlink_to(workspace.parent / "camera")
    roots = {each.link_unit: each.source_root for each in built(workspace).units}
    assert sorted(roots) == ["node", "pump", "scripts/mission.py"]
    assert roots["node"] == str(workspace / "src/camera")


def collected(workspace: Path, *sources: Path) -> tuple[list[str], list[str]]:
    """Names and what was dropped, where the Python of the workspace is analysed."""
    every = [workspace, *sources]
    found = collect_sources(every, python=analyse_workspaces(every, RULES))
    return names(found.static), [
        f"{one.file.unit.link_unit}: {one.reason}" for one in found.dropped
    ]


def target(folder: Path) -> None:
    """The file of the C++ node ``mission``."""
    data = unit(package="mission", link_unit="mission")
    (folder / "tpc").mkdir(parents=True)
    (folder / "tpc/mission.json").write_text(json.dumps(data), encoding="utf-8")


ALL = ["camera/node", "mission/mission", "mission/pump", "mission/scripts/mission.py"]


def test_collect_joins_a_build_and_the_python_of_the_sources(workspace: Path) -> None:
    target(workspace / "build/mission")
    assert collected(workspace) == (ALL, [])


def test_collect_needs_no_build_for_python_alone(workspace: Path) -> None:
    assert collected(workspace)[0] == ["camera/node", "mission/mission", "mission/pump"]


def test_what_collect_analyses_takes_the_place_of_what_was_written(workspace: Path) -> None:
    target(workspace / ".tpc/build/mission")
    built(workspace)
    (workspace / "src/camera/camera/node.py").write_text("x = 1\n", encoding="utf-8")
    assert collected(workspace) == (ALL[1:], [])


def test_of_a_build_folder_what_is_written_there_counts(workspace: Path) -> None:
    target(workspace / ".tpc/build/mission")
    built(workspace)
    base = workspace / ".tpc/build"
    (workspace / "src/camera/camera/node.py").unlink()
    (base / "COLCON_IGNORE").touch()
    assert analyse_workspaces([base, base / "none"], RULES) == PythonUnits()
    found = collect_sources([base])
    assert names(found.static) == ALL[1:]
    assert [one.reason for one in found.dropped] == [
        f"its script, {workspace}/src/camera/camera/node.py, no longer exists"
    ]


def test_a_script_is_not_missed_where_the_sources_are_not(workspace: Path) -> None:
    built(workspace)
    (workspace / "src").rename(workspace.parent / "elsewhere")
    assert collect_sources([workspace / ".tpc/build"]).dropped == ()


def test_a_script_is_no_target_that_cmake_could_know(workspace: Path) -> None:
    """``pump`` is no target of CMake's in a folder of which CMake left an answer."""
    built(workspace)
    record = workspace / ".tpc/build/mission/tpc/targets.tsv"
    record.write_text("mission\tother\t/x/other\t/x/other.json\t\n", encoding="utf-8")
    assert collect_sources([workspace / ".tpc/build"]).dropped == ()


def test_a_unit_under_two_names_is_one(workspace: Path) -> None:
    """It was called ``mission`` before there was a target of that name."""
    built(workspace, taken=())
    (workspace / ".tpc/build").rename(workspace / ".tpc/old")
    target(workspace / ".tpc/build/mission")
    built(workspace)
    found = collect_sources([workspace / ".tpc/old", workspace / ".tpc/build"])
    assert names(found.static) == ALL
    assert len(found.dropped) == 3


def test_documents_of_both_halves_are_joined_under_names_of_their_own(workspace: Path) -> None:
    target(workspace / "build/mission")
    output = workspace / "python.json"
    CliRunner().invoke(main, ["analyse", str(workspace), "-o", str(output)])
    found = collect_sources([output, workspace / "build"])
    assert names(found.static) == ALL


def test_the_command_collect(workspace: Path) -> None:
    target(workspace / "build/mission")
    output = workspace / "static.json"

    def run(*options: str) -> tuple[str, str]:
        ran = CliRunner().invoke(main, ["collect", str(workspace), "-o", str(output), *options])
        assert ran.exit_code == 0, ran.output
        return ran.stdout.splitlines()[-1], ran.stderr

    # C++: one; Python: camera, two in mission.py, one that two scripts have.
    said, errors = run()
    assert said == f"5 comparisons (6 keys) in 4 link units: {output}"
    script = workspace / "src/mission/scripts/broken.py"
    assert errors == f"mission/scripts/broken.py reports nothing: {script}:3: {BROKEN_TEXT}\n"
    assert run("--no-python") == (f"1 comparison in 1 link unit: {output}", "")
    own = workspace / "own.json"
    own.write_text('{"reads": [{"function": "len", "name": 0}]}', encoding="utf-8")
    assert run("--python-rules", str(own))[0].startswith("5 comparisons")
    own = workspace / "broken.json"
    own.write_text('{"reeds": []}', encoding="utf-8")
    ran = CliRunner().invoke(main, ["collect", str(workspace), "--python-rules", str(own)])
    assert (ran.exit_code, ran.stdout) == (1, "")
    assert f"{own}: /" in ran.stderr and "'reeds'" in ran.stderr
