"""A survey from tree to tree, with builds that are only pretended: tests/ros has real ones."""

import json
import os
from collections.abc import Callable
from pathlib import Path

import pytest
from packages import add_package, install_prefix
from survey_samples import build

from mixed_workspace import BROKEN_TEXT, make_mixed
from pytpc.base.errors import RunError, WorkspaceError
from pytpc.workspace.colcon import Bases
from pytpc_evaluation.survey import surveying
from pytpc_evaluation.survey.measured_build import BuildWay, Measured, read_tree, underlaid
from pytpc_evaluation.survey.surveying import Options, SurveyProgress, survey
from pytpc_evaluation.survey.trees import Tree

Log = list[tuple[str, str]]
Below = dict[tuple[str, str], str]


@pytest.fixture
def prefix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "prefix"
    install_prefix(folder)
    (folder / "lib/tpc/TpcDefer.so").touch()
    monkeypatch.setenv("TPC_PREFIX", str(folder))
    return folder


@pytest.fixture
def below() -> Below:
    """What each build that was pretended stood on."""
    return {}


@pytest.fixture
def built(prefix: Path, below: Below, monkeypatch: pytest.MonkeyPatch) -> Log:
    """What was built: tree and way; each leaves an install base."""
    log: Log = []

    def measure(tree: Tree, bases: Bases, way: BuildWay, _on_output: object) -> Measured:
        log.append((tree.name, bases.root.name))
        bases.install.mkdir(parents=True, exist_ok=True)
        setup = bases.install / "local_setup.bash"
        setup.write_text(f'export BELOW="$BELOW {tree.name}/{bases.root.name}"\n', encoding="utf-8")
        below[log[-1]] = way.environment.get("BELOW", "")
        return Measured(build(2.0))

    monkeypatch.setattr(surveying, "measure", measure)
    return log


def run(output: Path, *trees: Path, **changes: object) -> list[str]:
    """The names in the results of a survey."""
    options = Options(output, 2, **changes)  # type: ignore[arg-type]
    return [result.name for result in survey(trees, options, lambda step: None)]


@pytest.fixture
def trees(tmp_path: Path) -> tuple[Path, Path]:
    """Two trees: ``upper`` needs ``lower``."""
    upper, lower = tmp_path / "upper", tmp_path / "lower"
    add_package(upper / "app", more="<depend>base</depend>")
    add_package(lower / "base")
    return upper, lower


def test_each_tree_is_built_both_ways_upon_what_it_needs(
    tmp_path: Path, trees: tuple[Path, Path], built: Log, below: Below
) -> None:
    # In the order given; built from below, the second tree with TPC first.
    assert run(tmp_path / "out", *trees) == ["upper", "lower"]
    assert built == [("lower", "plain"), ("lower", "tpc"), ("upper", "tpc"), ("upper", "plain")]
    assert below["lower", "tpc"] == ""
    assert below["upper", "tpc"] == " lower/tpc"
    assert below["upper", "plain"] == " lower/plain"


def test_what_is_known_is_not_built_again(
    tmp_path: Path, trees: tuple[Path, Path], built: Log
) -> None:
    output = tmp_path / "out"
    run(output, *trees)
    built.clear()
    assert run(output, *trees) == ["upper", "lower"]
    assert built == []
    run(output, trees[1], rerun=True)
    assert built == [("lower", "plain"), ("lower", "tpc")]


def test_a_changed_tree_is_built_again_with_what_stands_on_it(
    tmp_path: Path, trees: tuple[Path, Path], built: Log
) -> None:
    output = tmp_path / "out"
    run(output, *trees)
    built.clear()
    (trees[0] / "app/new.cpp").write_text("int x;\n", encoding="utf-8")
    run(output, *trees)
    assert {name for name, _ in built} == {"upper"}
    built.clear()
    (trees[1] / "base/new.cpp").write_text("int x;\n", encoding="utf-8")
    run(output, *trees)
    assert {name for name, _ in built} == {"upper", "lower"}


def test_the_python_of_a_tree_is_analysed(tmp_path: Path, built: Log) -> None:
    """Also where it does not build, and again where it has changed."""
    tree = make_mixed(tmp_path / "ws")
    steps: list[SurveyProgress] = []
    (found,) = survey([tree], Options(tmp_path / "out", 2), steps.append)
    assert (found.found.comparisons, found.found.python, found.found.units) == (0, 4, 3)
    assert found.found.failed == (
        f"mission/scripts/broken.py: {tree}/src/mission/scripts/broken.py:3: {BROKEN_TEXT}",
    )
    told = [step.far for step in steps if step.what == "analysing Python"]
    assert told == ["", "1 of 3 scripts", "2 of 3 scripts", "3 of 3 scripts"]
    assert found.tpc == build(2.0)
    (tree / "src/camera/camera/node.py").write_text("x = 1\n", encoding="utf-8")
    (found,) = survey([tree], Options(tmp_path / "out", 2), steps.append)
    assert found.found.python == 3


@pytest.mark.parametrize(
    "part",
    [
        "lib/tpc/TpcPasses.so",
        "lib/libtpc_log.so",
        "share/tpc/cmake/tpc.cmake",
        "share/tpc/rules/ros1.json",
    ],
)
def test_another_plugin_has_everything_built_again(
    tmp_path: Path, trees: tuple[Path, Path], built: Log, prefix: Path, part: str
) -> None:
    output = tmp_path / "out"
    run(output, *trees)
    built.clear()
    (prefix / part).parent.mkdir(exist_ok=True)
    (prefix / part).write_text("new", encoding="utf-8")
    run(output, *trees)
    assert len(built) == 4


def test_other_arguments_for_cmake_have_everything_built_again(
    tmp_path: Path, trees: tuple[Path, Path], built: Log
) -> None:
    output = tmp_path / "out"
    run(output, *trees)
    built.clear()
    run(output, *trees, cmake_args=("-DPYVER=3.11",))
    assert len(built) == 4


def test_without_plain_builds_there_is_one_of_each(
    tmp_path: Path, trees: tuple[Path, Path], built: Log
) -> None:
    run(tmp_path / "out", *trees, plain=False)
    assert built == [("lower", "tpc"), ("upper", "tpc")]


def test_an_interrupted_survey_goes_on(
    tmp_path: Path, trees: tuple[Path, Path], built: Log, monkeypatch: pytest.MonkeyPatch
) -> None:
    output = tmp_path / "out"
    pretended: Callable[..., Measured] = surveying.measure

    def interrupted(tree: Tree, *arguments: object, **named: object) -> Measured:
        if tree.name == "upper":
            raise KeyboardInterrupt
        return pretended(tree, *arguments, **named)

    run(output, *trees)
    # Measuring again is interrupted, too: the old result of that tree has gone with its builds.
    with monkeypatch.context() as context, pytest.raises(KeyboardInterrupt):
        context.setattr(surveying, "measure", interrupted)
        run(output, *trees, rerun=True)
    assert [path.stem.split("-")[0] for path in (output / "results").iterdir()] == ["lower"]
    built.clear()
    run(output, *trees)
    assert {name for name, _ in built} == {"upper"}


def test_a_result_that_cannot_be_read_is_measured_again(
    tmp_path: Path, trees: tuple[Path, Path], built: Log
) -> None:
    output = tmp_path / "out"
    run(output, trees[1])
    (file,) = (output / "results").iterdir()
    known = json.loads(file.read_text(encoding="utf-8"))
    by_hand = {**known, "plain": {**known["plain"], "processor": "2.0"}}
    for text in ("{", json.dumps({"version": 99}), json.dumps(by_hand)):
        built.clear()
        file.write_text(text, encoding="utf-8")
        run(output, trees[1])
        assert len(built) == 2


def test_trees_of_one_name_are_told_apart(tmp_path: Path, built: Log) -> None:
    for branch in ("old", "new"):
        add_package(tmp_path / branch / "nav/src/move")
    names = run(tmp_path / "out", tmp_path / "old/nav", tmp_path / "new/nav", tmp_path / "old/nav")
    assert names == ["old/nav", "new/nav"]
    assert len(list((tmp_path / "out/results").iterdir())) == 2


def test_two_surveys_do_not_write_into_one_folder(
    tmp_path: Path, trees: tuple[Path, Path], built: Log
) -> None:
    def second(step: SurveyProgress) -> None:
        with pytest.raises(WorkspaceError, match="out: another survey is running here"):
            run(tmp_path / "out", trees[1])
        assert run(tmp_path / "elsewhere", trees[1]) == ["lower"]

    survey([trees[1]], Options(tmp_path / "out", 2), second)
    # Nothing is left of the first one that would be in the way.
    assert run(tmp_path / "out", trees[1]) == ["lower"]


def test_a_tree_whose_path_is_not_utf_8_is_refused(tmp_path: Path) -> None:
    folder = tmp_path / os.fsdecode(b"a\xff")
    add_package(folder / "base")
    with pytest.raises(WorkspaceError, match="the path is not UTF-8"):
        read_tree(folder)


def test_the_output_is_not_put_into_a_tree(tmp_path: Path, built: Log) -> None:
    add_package(tmp_path / "tree/a")
    with pytest.raises(WorkspaceError, match="is in the tree"):
        run(tmp_path / "tree/out", tmp_path / "tree")
    assert built == []


def test_steps_say_which_tree_and_what(
    tmp_path: Path, trees: tuple[Path, Path], built: Log
) -> None:
    steps: list[SurveyProgress] = []
    survey([trees[1]], Options(tmp_path / "out", 1), steps.append)
    assert [step.what for step in steps] == [
        "reading sources",
        "counting lines",
        "building without TPC",
        "building with TPC",
        "analysing Python",
    ]
    assert {(step.tree, step.number, step.total) for step in steps} == {("lower", 1, 1)}


def names_of(tree: Tree) -> list[str]:
    return [package.name for package in tree.packages]


def test_a_tree_of_packages(tmp_path: Path) -> None:
    add_package(tmp_path / "b", more="<depend>a</depend><exec_depend>rviz</exec_depend>")
    add_package(tmp_path / "a", cmakelists=b"project(a)\n")
    tree = read_tree(tmp_path)
    assert names_of(tree) == ["a", "b"]
    assert tree.packages[1].needs == {"a", "rviz"}


def test_a_dependency_of_ros_2_is_none_of_ros_1(tmp_path: Path) -> None:
    more = '<depend condition="$ROS_VERSION == 2">rclcpp</depend><depend>roscpp</depend>'
    add_package(tmp_path / "a", more=more)
    assert read_tree(tmp_path).packages[0].needs == {"roscpp"}


def test_packages_that_no_build_can_take_are_set_aside(tmp_path: Path) -> None:
    add_package(tmp_path / "good")
    add_package(tmp_path / "half", cmakelists=b"project(half\n")
    add_package(tmp_path / "more/good")
    (add_package(tmp_path / "torn") / "package.xml").write_text("<package>", encoding="utf-8")
    tree = read_tree(tmp_path)
    assert names_of(tree) == ["good"]
    reasons = {fault.package: fault.reason for fault in tree.unreadable}
    assert list(reasons) == ["half", "good", "torn"]
    assert "CMakeLists.txt:1: CMake cannot parse this" in reasons["half"]
    assert reasons["good"].endswith("good: " + str(tmp_path / "good") + " has this name, too")
    assert "package.xml:1: not XML" in reasons["torn"]


def test_a_cmake_project_is_a_tree_of_one(tmp_path: Path) -> None:
    (tmp_path / "CMakeLists.txt").write_text('PROJECT( "lib" CXX)\n', encoding="utf-8")
    tree = read_tree(tmp_path)
    assert [(one.name, one.path, one.build_type) for one in tree.packages] == [
        ("lib", tmp_path, "cmake")
    ]


@pytest.mark.parametrize("there", [True, False])
def test_what_is_no_tree_is_refused(tmp_path: Path, there: bool) -> None:
    folder = tmp_path / "x"
    if there:
        folder.mkdir()
    with pytest.raises(WorkspaceError, match=r"neither a package\.xml" if there else "no such"):
        read_tree(folder)


def test_flags_of_the_caller_stand_behind_ours(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CXXFLAGS", "-Werror -DX=1")
    flags = underlaid([], 1)["CXXFLAGS"].split()
    assert "-Wno-error=register" in flags
    assert flags[-2:] == ["-Werror", "-DX=1"]


def test_set_up_scripts_are_sourced_in_order(tmp_path: Path) -> None:
    setups = [tmp_path / "a.bash", tmp_path / "b.bash"]
    setups[0].write_text("export ONE=1\necho noise\n", encoding="utf-8")
    setups[1].write_text('export TWO="$ONE and 2"\n', encoding="utf-8")
    environment = underlaid(setups, 3)
    assert (environment["TWO"], environment["MAKEFLAGS"]) == ("1 and 2", "-j3")
    assert environment["CCACHE_DISABLE"] == "1"
    setups[1].write_text("echo broken >&2\nreturn 4\n", encoding="utf-8")
    with pytest.raises(RunError, match="status 4: broken"):
        underlaid(setups, 3)
    with pytest.raises(WorkspaceError, match="no such set-up script"):
        underlaid([tmp_path / "c.bash"], 3)
