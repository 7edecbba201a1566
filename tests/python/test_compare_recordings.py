"""What two recordings decided differently, with numbers worked out by hand."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from click.testing import CliRunner
from mission_samples import SummaryBuilder, comparison, events, key, link_unit, ns
from test_command_line_page import WORDS, fields

from pytpc.api.comparing import is_recording
from pytpc.cli.main import main
from pytpc.diagnosis.decisions import decisions
from pytpc.diagnosis.differences import RunValues
from pytpc.diagnosis.results.decisions import DecisionChange, RunDecisions
from pytpc.recording.mission import Recording, save_recording
from pytpc.recording.summaries import Summary
from pytpc.static.static_info import StaticInfo

EXAMPLE = Path(__file__).parents[2] / "examples/recorded_mission"
FACES, COVERAGE = comparison(0, "~faces", ">="), comparison(1, "~coverage")
STATIC = StaticInfo.of([link_unit([FACES, COVERAGE], [])])


def flight(faces, coverage=0.6, *, start=0, seconds=10, node="/uav"):
    """Once a second the second is compared with ``faces``, and 0.5 with ``coverage``."""
    rows = []
    for t in range(seconds):
        rows.append((start + t, 0, t >= faces, t, faces, node))
        rows.append((start + t, 1, coverage < 0.5, 0.5, coverage, node))
    return Recording("flight", events(rows), (), ns(start), ns(start + seconds))


def values(**own):
    return {f"/uav/{name}": value for name, value in own.items()}


def compared(old: Recording, new: Recording, **places: str) -> RunDecisions:
    before = RunValues("old", old, values(faces=5, coverage=0.6))
    after = RunValues("new", new, values(faces=8, coverage=0.6), places)
    return decisions(before, after, STATIC)


def faces_of(found: RunDecisions) -> DecisionChange:
    (one,) = [each for each in found.found if each.parameter == "~faces"]
    return one


# OLD is true in the seconds 5 to 9, NEW in 8 and 9. The margins are -5 to 4 and -8 to 1; in the
# middle are -1 and 0, and -4 and -3. Times count from the start of each mission.
def test_how_often_which_way_and_by_how_much():
    found = compared(flight(5), flight(8, start=1000))
    one = faces_of(found)
    assert (one.old.evaluations, one.old.true, one.old.flops, one.old.turned_s) == (10, 0.5, 1, 5.0)
    assert (one.new.evaluations, one.new.true, one.new.flops, one.new.turned_s) == (10, 0.2, 1, 8.0)
    assert (one.old.low, one.old.middle, one.old.high) == (-5.0, -0.5, 4.0)
    assert (one.new.low, one.new.middle, one.new.high) == (-8.0, -3.5, 1.0)
    assert (one.old.thresholds, one.new.thresholds) == ((5.0,), (8.0,))
    assert one.earlier_s == -3.0
    assert one.what == "turned in both, first 3.0 s later in NEW"
    assert one.share == pytest.approx(-0.3)


def test_the_value_of_the_parameter_and_where_it_was_set():
    found = faces_of(compared(flight(5), flight(8), **{"/uav/faces": "params.yaml:2"}))
    assert (found.old.value.value, found.old.value.place) == (5, "")
    assert (found.new.value.value, found.new.value.place) == (8, "params.yaml:2")


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        (5, 20, "turned only in OLD"),
        (20, 5, "turned only in NEW"),
        (0, 20, "always true in OLD, always false in NEW"),
        (20, 30, "the same outcome with another threshold"),
        (20, 20, "decided alike"),
        (5, 5, "decided alike"),
    ],
)
def test_the_main_difference(old, new, what):
    assert faces_of(compared(flight(old), flight(new))).what == what


# The same flops, but a second more of the robot: the numbers are not the same.
def test_a_longer_flight_did_not_decide_alike():
    one = faces_of(compared(flight(5), flight(5, seconds=11)))
    assert one.what == "turned in both, first at the same time"
    assert not one.is_alike


def test_the_largest_difference_comes_first():
    found = compared(flight(5, 0.6), flight(20, 0.6))
    assert [one.parameter for one in found.found] == ["~faces", "~coverage"]
    found = compared(flight(5, 0.6), flight(6, 0.4))
    # All outcomes of ~coverage are other ones: 0 % true and 100 %.
    assert [one.parameter for one in found.found] == ["~coverage", "~faces"]
    assert [one.parameter for one in compared(flight(5), flight(8)).differing] == ["~faces"]


def test_what_only_one_run_evaluated():
    rows = flight(8).events
    only = replace(flight(8), events=rows.take(rows.key == rows.keys.index(key(0))))
    whats = {one.parameter: one.what for one in compared(flight(5), only).found}
    assert whats["~coverage"] == "evaluated only in OLD"
    whats = {one.parameter: one.what for one in compared(only, flight(5)).found}
    assert whats["~coverage"] == "evaluated only in NEW"


def test_keys_of_another_build_are_counted():
    other = flight(5).with_keys(lambda each: each.replace("0000-5000", "0000-5001"))
    assert compared(other, flight(5)).unknown == (2, 0)


def summary(**changes) -> Summary:
    """Of the seconds 0 to 10: 100 evaluations, all false, 2 to 8 below the threshold 9."""
    made = Summary(
        key=key(0), node="/uav", begin_ns=ns(0), end_ns=ns(10), count=100, flops=0, far=100, odd=0,
        result=False, res=False, cmp=1.0, thresh=9.0, diff_min=-8.0, diff_max=-2.0, diff_mean=-5.0,
        abs_mean=5.0, low=1.0, high=9.0,
    )  # fmt: skip
    return replace(made, **changes)


# Three evaluations beside the summary: at 20 s one with the margin 1, at 21 and 22 s two with 3.
def test_summaries_count_as_their_evaluations():
    builder = SummaryBuilder()
    builder.add(summary())
    rows = [
        (20, 0, True, 10, 9, "/uav"),
        (21, 0, True, 12, 9, "/uav"),
        (22, 0, True, 12, 9, "/uav"),
    ]
    run = Recording("r", events(rows), (), 0, ns(30), summaries=builder.build())
    one = faces_of(compared(run, flight(5))).old
    assert (one.evaluations, one.true) == (103, 3 / 103)
    assert (one.low, one.middle, one.high) == (-8.0, -5.0, 3.0)
    assert one.thresholds == (9.0,)


# The summary has both flops of the log: it is true from 4 to 6 s, a fifth of its time.
def test_a_summary_with_flops_is_true_for_its_share_of_the_time():
    builder = SummaryBuilder()
    builder.add(summary(flops=2, diff_max=1.0))
    rows = [(0, 0, False, 1, 9, "/uav"), (4, 0, True, 10, 9, "/uav"), (6, 0, False, 8, 9, "/uav")]
    run = Recording("r", events(rows), (), 0, ns(10), summaries=builder.build())
    one = faces_of(compared(run, flight(5))).old
    assert (one.evaluations, one.flops, one.turned_s) == (100, 2, 4.0)
    assert one.true == pytest.approx(0.2)


def test_values_that_are_not_finite_have_no_margin():
    rows = [(0, 0, False, float("nan"), 9, "/uav"), (1, 0, False, float("inf"), 9, "/uav")]
    run = Recording("r", events(rows), (), 0, ns(10))
    one = faces_of(compared(run, flight(5))).old
    assert (one.evaluations, one.low, one.middle, one.high) == (2, None, None, None)


# ---- The command.


def run(*words: object, status: int = 0):
    result = CliRunner().invoke(main, ["compare", *map(str, words)])
    assert result.exit_code == status, result.output
    return result


@pytest.fixture
def other(tmp_path: Path) -> Path:
    """The first 30 s of the example mission."""
    from pytpc.api.missions import read  # noqa: PLC0415

    mission = read(EXAMPLE)
    end = mission.start_ns + ns(30)
    folder = tmp_path / "shorter"
    shutil.copytree(EXAMPLE, folder)
    cut = replace(
        mission, events=mission.events.between(mission.start_ns, end), end_ns=end, marks=()
    )
    save_recording(cut, folder)
    return folder


def test_the_command(other: Path):
    lines = run(EXAMPLE, other).stdout.splitlines()
    assert lines[0].endswith(
        " of 34 comparisons did not decide alike in OLD recorded_mission (88.1 s) and NEW shorter"
        " (30.0 s)"
    )
    # The mission times out at 75 s, so only the longer one can have seen it.
    place = next(n for n, line in enumerate(lines) if line.startswith("~mission_timeout"))
    assert lines[place + 1] == "  turned only in OLD"
    assert "1 flop, first at 77.3 s" in lines[place + 2]
    differing = int(lines[0].split()[0])
    alike = run(EXAMPLE, other, "--all").stdout.count("  decided alike")
    assert differing + alike == 34
    assert lines[-1] == f"{alike} other comparisons: --all lists them"


def test_the_command_as_json(other: Path):
    document = json.loads(run(EXAMPLE, other, "--json").stdout)
    assert document["kind"] == "recordings"
    assert document["new"] == {"name": "shorter", "seconds": 30.0, "unknown": 0}
    assert len(document["comparisons"]) == 34
    assert set(fields(document)) <= WORDS


def test_a_recording_with_itself_is_refused(tmp_path: Path):
    copy = tmp_path / "copy"
    shutil.copytree(EXAMPLE, copy)
    said = run(EXAMPLE, copy, status=1).stderr
    assert f"{copy}: has the same reports as {EXAMPLE}" in said


def test_what_is_a_recording(tmp_path: Path):
    static = tmp_path / "base-of-main"
    static.write_text((EXAMPLE / "static.json").read_text())
    bag = tmp_path / "bags"
    bag.mkdir()
    assert not is_recording(static)
    assert not is_recording(bag)
    (bag / "a.bag").write_bytes(b"#ROSBAG V2.0\n")
    assert is_recording(bag)
    assert is_recording(bag / "a.bag")
    assert is_recording(EXAMPLE)
    # A built workspace may have a bag lying around.
    (bag / ".tpc").mkdir()
    (bag / ".tpc/static.json").write_text("{}")
    assert not is_recording(bag)
    assert not is_recording(tmp_path / "none")
