"""Real builds of a workspace with nodes in C++ and in Python; its sources are mixed_workspace's."""

import json
import subprocess
from pathlib import Path

import pytest
from click.testing import CliRunner

from mixed_workspace import BROKEN_TEXT, make_mixed
from pytpc.base.errors import MissingToolError
from pytpc.base.paths import cmake_file, log_library, plugin
from pytpc.build.build import build_workspace
from pytpc.cli.main import main
from pytpc.python_runtime.listed import read_table
from pytpc.static.static_info import StaticInfo
from pytpc.workspace import patch
from pytpc.workspace.colcon import BuildError, BuildOptions, build_environment
from terminals import Terminal, pytpc

try:
    for half in (cmake_file, plugin, log_library):
        half()
except MissingToolError as error:
    pytest.skip(f"the C++ half is not installed: {error}", allow_module_level=True)

UNITS = ["camera/node", "mission/mission", "mission/pump", "mission/scripts/mission.py"]
# Place and parameter, in both languages; the module of two scripts once.
PLACES = [
    ("camera/node.py", 8, "bright"),
    ("scripts/mission.py", 8, "~top"),
    ("scripts/mission.py", 9, "~ready"),
    ("src/mission.cpp", 8, "~max_depth"),
    ("src/sampling/limits.py", 5, "~low"),
]


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    workspace = make_mixed(tmp_path_factory.mktemp("built"))
    build_workspace(workspace)
    return workspace


def names(static: StaticInfo) -> list[str]:
    return [f"{unit.package}/{unit.link_unit}" for unit in static.units]


def run(*words: str | Path) -> str:
    ran = CliRunner().invoke(main, [str(word) for word in words])
    assert ran.exit_code == 0, ran.output
    return ran.stdout


def test_both_languages_are_in_one_file(built: Path) -> None:
    static = StaticInfo.load(built / ".tpc/static.json")
    assert names(static) == UNITS
    assert [(tpc.place, tpc.lineno, tpc.parameter) for tpc in static.tpcs] == PLACES
    (broken,) = static.left_out
    assert (broken.package, broken.link_unit) == ("mission", "scripts/broken.py")
    assert broken.reason == f"{built}/src/mission/scripts/broken.py:3: {BROKEN_TEXT}"


def test_a_second_build_gives_the_same(built: Path) -> None:
    first = (built / ".tpc/static.json").read_bytes()
    build_workspace(built)
    assert (built / ".tpc/static.json").read_bytes() == first


def test_the_commands_know_both(built: Path, tmp_path: Path) -> None:
    listed = json.loads(run("list", built, "--json"))
    assert [one["source"] for one in listed] == [parameter for _, _, parameter in PLACES]
    (shown,) = json.loads(run("show", built, "~top", "--json"))["comparisons"]
    assert shown["condition"]["text"] == "height > top\n            and not ready"
    (shown,) = json.loads(run("show", built, "~max_depth", "--json"))["comparisons"]
    assert shown["condition"]["text"] == "depth + argc > max_depth"
    assert "read     scripts/mission.py:6" in run("explain", built, "~top")
    run("blind-spots", built)
    run("doctor", built)
    run("export", built, "--html", tmp_path / "x.html", "--sarif", tmp_path / "x.sarif")
    rules = json.loads((tmp_path / "x.sarif").read_text())["runs"][0]["results"]
    assert len(rules) == len(PLACES)
    page = (tmp_path / "x.html").read_text()
    assert page.count("scripts/mission.py") >= 2
    assert page.count("and not ready") >= 2


def test_what_is_installed_is_told_by_its_file(built: Path) -> None:
    install = built / ".tpc/install/mission/lib/mission/mission.py"
    assert install.is_file()
    table = read_table([str(built)], str(install))
    assert sorted(table.by_name) == ["limits.py", "mission.py"]


def test_collect_of_the_build_folder_is_what_was_built(built: Path, tmp_path: Path) -> None:
    run("collect", built / ".tpc/build", "-o", tmp_path / "out.json")
    assert names(StaticInfo.load(tmp_path / "out.json")) == UNITS


def test_a_build_of_ones_own_is_joined_with_python(tmp_path: Path) -> None:
    workspace = make_mixed(tmp_path)
    patch.run(workspace)
    command = ["colcon", "build", "--cmake-args", "-DPYTHON_EXECUTABLE=/usr/bin/python3"]
    subprocess.run(command, cwd=workspace, env=build_environment(), check=True, capture_output=True)
    output = tmp_path / "out.json"
    run("collect", workspace, "-o", output)
    found = StaticInfo.load(output)
    assert names(found) == UNITS
    assert [(tpc.place, tpc.lineno, tpc.parameter) for tpc in found.tpcs] == PLACES
    run("collect", workspace, "--no-python", "-o", output)
    assert names(StaticInfo.load(output)) == ["mission/mission"]


def test_python_of_a_package_that_is_left_alone(tmp_path: Path) -> None:
    workspace = make_mixed(tmp_path)
    cpp = workspace / "src/mission/src/mission.cpp"
    no_clang = "#ifdef __clang__\n#error no\n#endif\n"
    cpp.write_text(no_clang + cpp.read_text("utf-8"), "utf-8")
    with pytest.raises(BuildError):
        build_workspace(workspace, BuildOptions(fallback=False))
    result = build_workspace(workspace)
    assert list(result.left_alone) == ["mission"]
    # The target is there, so the script is called as it is beside it.
    assert names(result.static) == ["camera/node", "mission/pump", "mission/scripts/mission.py"]
    assert [one.link_unit for one in result.static.left_out] == ["mission", "scripts/broken.py"]


def test_a_person_is_told_what_to_type_next(built: Path) -> None:
    with Terminal(pytpc("build", str(built)), built) as terminal:
        assert terminal.wait(300) == 0
        assert f"next: pytpc run {built} LAUNCH" in terminal.text
    # Programs that read the output are not.
    assert "next:" not in run("build", built)
