"""Which static information a mission is judged with, if none is given."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from mission_samples import SECOND, BagFile, comparison, line, static_info

from pytpc.api.comparing import RecordedRun
from pytpc.api.static_of_mission import find_static
from pytpc.base.errors import InputError
from pytpc.cli.main import main
from pytpc.ros.mission_run import MissionRun, RecordOptions, clear_earlier, keep_static, save_run
from pytpc.static.static_info import StaticInfo

ROOT = Path(__file__).parents[2]
TWO = static_info(comparison(0, "faces", ">="), comparison(1, "coverage"))
ONE = static_info(comparison(1, "coverage"))
NONE = static_info(comparison(7, "x"))


@pytest.fixture
def bag(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A bag far from every workspace: two comparisons change their outcome before a mark."""
    for name in ("CMAKE_PREFIX_PATH", "AMENT_PREFIX_PATH", "ROS_PACKAGE_PATH", "TPC_STATIC"):
        monkeypatch.delenv(name, raising=False)
    here = tmp_path / "here"
    here.mkdir()
    monkeypatch.chdir(here)
    path = tmp_path / "bags/today/mission.bag"
    path.parent.mkdir(parents=True)
    with BagFile(path) as file:
        for at, value in ((100, 1), (104, 9)):
            file.log(at, "/node", line(0, int(value > 4), value, 4))
            file.log(at, "/node", line(1, int(value > 5), value, 5))
        file.mark(106, "/mark_action")
    return path


def saved(static: StaticInfo, path: Path) -> Path:
    static.save(path)
    return path


def rank(*words: object) -> Result:
    return CliRunner().invoke(main, ["rank", *map(str, words)])


def test_the_recordings_own_counts(bag: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    saved(ONE, bag.parent / "static.json")
    saved(TWO, tmp_path / "here/static.json")
    found = find_static(bag.parent)
    assert (found.is_own, found.path) == (True, bag.parent / "static.json")
    result = rank(bag.parent)
    assert result.exit_code == 0
    # It is what was recorded: nothing needs to be said, but that it does not know key 0.
    assert "static information:" not in result.stderr
    # A workspace that was built since does not change the answer, and --static does.
    assert "faces" not in result.stdout
    assert (
        "faces"
        in rank(bag.parent, "--static", tmp_path / "here").stdout
        + rank(bag.parent, "--static", tmp_path / "here/static.json", "--each").stdout
    )


def test_what_knows_most_of_the_reports_counts(bag: Path, tmp_path: Path):
    saved(ONE, tmp_path / "here/static.json")
    whole = saved(TWO, tmp_path / "bags/.tpc/static.json")
    saved(NONE, tmp_path / "static.json")
    result = rank(bag)
    assert result.exit_code == 0
    assert result.stderr == f"static information: {whole} (it has 2 of 2 reported comparisons)\n"
    whole.unlink()
    assert f"{tmp_path}/here/static.json (it has 1 of 2 reported" in rank(bag).stderr


@pytest.mark.parametrize(
    ("variable", "place"),
    [
        ("CMAKE_PREFIX_PATH", "ws/.tpc/install/robot"),
        ("CMAKE_PREFIX_PATH", "ws/devel"),
        ("AMENT_PREFIX_PATH", "ws/install"),
        ("ROS_PACKAGE_PATH", "ws/src"),
        ("TPC_STATIC", "ws"),
        ("TPC_STATIC", "ws/.tpc/static.json"),
    ],
)
def test_sourced_workspaces(
    variable: str, place: str, bag: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    there = saved(TWO, tmp_path / "ws/.tpc/static.json")
    monkeypatch.setenv(variable, f"/opt/ros/noetic:{tmp_path / place}")
    result = rank(bag)
    assert (result.exit_code, f"static information: {there} " in result.stderr) == (0, True)


def test_a_running_robot_gets_the_first(bag: Path, tmp_path: Path):
    assert bag.is_file()
    there = saved(NONE, tmp_path / ".tpc/static.json")
    found = find_static()
    assert (found.path, found.words) == (there, f"static information: {there}")


def test_none_is_found(bag: Path):
    result = rank(bag)
    assert result.exit_code == 1
    assert result.stderr == (
        f"pytpc: error: {bag}: no static information in its folder, above it, in this folder, or in"
        " a sourced workspace; give it with --static WORKSPACE, the one that `pytpc build` built\n"
    )


def test_none_fits_and_a_broken_one_is_passed_over(bag: Path, tmp_path: Path):
    other = saved(NONE, tmp_path / "here/static.json")
    (tmp_path / "bags/static.json").write_text("{")
    result = rank(bag)
    assert result.exit_code == 1
    assert result.stderr == (
        f"pytpc: error: {bag}: no static information that was found knows its reports"
        f" ({tmp_path}/bags/static.json and 1 more); give it with --static WORKSPACE, the one that"
        " `pytpc build` built\n"
    )
    assert other.is_file()


def test_missions_of_two_builds_are_each_judged_with_their_own(bag: Path, tmp_path: Path):
    other = tmp_path / "bags/tomorrow"
    other.mkdir()
    (other / "mission.bag").write_bytes(bag.read_bytes())
    saved(ONE, bag.parent / "static.json")
    saved(TWO, other / "static.json")
    result = rank(bag.parent, other, "--json")
    assert [one["parameters"] for one in json.loads(result.stdout)] == [1, 2]


# The recorder of a running robot keeps what it finds, though it may be that of another robot.
def test_a_guess_counts_only_if_nothing_fits_better(bag: Path, tmp_path: Path):
    out = bag.parent
    guess = saved(ONE, tmp_path / "ws/.tpc/static.json")
    run = MissionRun(bag, out / "params.yaml", "done", 1.0, 1.0, 0, {}, {}, {})
    for guessed in (True, False):
        options = RecordOptions(out, static=guess, is_static_guessed=guessed)
        keep_static(options)
        save_run(run, options)
        assert (find_static(out).is_own, find_static(out).path) == (
            not guessed,
            out / "static.json",
        )
        whole = saved(TWO, tmp_path / "here/static.json")
        said = rank(out).stderr
        assert (f"static information: {whole} (it has 2 of 2" in said) == guessed
        whole.unlink()
        # The workspace was built again since; the copy is older, and as good.
        assert f"{out}/static.json (it has 1 of 2" in rank(out).stderr or not guessed


# The code is known if the copy was given, or if it has each comparison that the nodes reported.
@pytest.mark.parametrize(
    ("static", "guessed", "is_known"),
    [(TWO, True, True), (TWO, False, True), (ONE, True, False), (ONE, False, True)],
)
def test_a_guess_that_has_all_that_was_reported_says_what_the_code_is(
    static: StaticInfo, guessed: bool, is_known: bool, bag: Path, tmp_path: Path
):
    out = bag.parent
    static = replace(static, sources=(("/src/robot/src/node.cpp", "0" * 64),))
    options = RecordOptions(
        out, static=saved(static, tmp_path / "ws/.tpc/static.json"), is_static_guessed=guessed
    )
    keep_static(options)
    save_run(MissionRun(bag, out / "params.yaml", "done", 1.0, 1.0, 0, {}, {}, {}), options)
    run = RecordedRun.of(out)
    assert run.static_file == (out / "static.json" if is_known else None)
    assert (run.build is not None) == is_known


def test_a_recording_keeps_a_copy_and_says_where_it_is_from(tmp_path: Path):
    there = saved(TWO, tmp_path / "ws/.tpc/static.json")
    out = tmp_path / "out"
    out.mkdir()
    options = RecordOptions(out, static=there, until="/mission_done")
    keep_static(options)
    content = there.read_bytes()
    run = MissionRun(out / "mission.bag", out / "params.yaml", "done", 1.0, 1.0, 0, {}, {}, {})
    save_run(run, options)
    # The workspace is built again.
    saved(NONE, there)
    assert (out / "static.json").read_bytes() == content
    run_file = json.loads((out / "run.json").read_text())
    assert run_file["until"] == "/mission_done"
    told = run_file["static"]
    assert told["path"] == str(there)
    assert len(told["sha256"]) == 64
    # The copy goes with the rest, so that it is never that of another mission.
    clear_earlier(out)
    assert not (out / "static.json").exists()
    save_run(run, replace(options, static=None))
    assert json.loads((out / "run.json").read_text())["static"] is None


def test_the_place_that_run_json_names(bag: Path, tmp_path: Path):
    there = saved(TWO, tmp_path / "far/ws/.tpc/static.json")
    for text in ('{"static": {"path": "%s"}}' % there, "[]", '{"static": {"path": 3}}', "{"):  # noqa: UP031
        (bag.parent / "run.json").write_text(text)
        if "ws" in text:
            assert rank(bag).stderr.startswith(f"static information: {there} ")
        else:
            assert rank(bag).exit_code == 1


def test_a_recording_without_reports_says_that(bag: Path, tmp_path: Path):
    with BagFile(tmp_path / "empty.bag") as file:
        file.mark(3, "/mark_action")
        file.mark(3 + SECOND / 1e9, "/mark_action")
    result = rank(tmp_path / "empty.bag")
    assert result.exit_code == 1
    assert "no threshold reports" in result.stderr
    with pytest.raises(InputError, match="no static information"):
        find_static(bag)
