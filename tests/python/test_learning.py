"""What is learned from good runs: small recordings, in a profile that --reference takes."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner
from mission_samples import comparison, events, key, ns, static_info

import pytpc
from pytpc.api.comparing import RecordedRun
from pytpc.cli.main import main
from pytpc.diagnosis.thinned import CHANGES, EVENLY, thinned
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording, load_recording, save_recording
from pytpc.recording.profile import PROFILE_FILE, runs_in
from pytpc.static.other_builds import keys_in
from pytpc.static.static_info import StaticInfo

SPEED, HEIGHT = 0, 1
STATIC = static_info(comparison(SPEED, "~max_speed"), comparison(HEIGHT, "~max_height"))


def flight(name="monday", limit=4.0, marks=(), length=100, at=0):
    """The speed grows by 0.1 a tick of 0.1 s up to 5 and begins anew; the height is always 1."""
    rows = []
    for tick in range(length * 10):
        t, speed = at + tick / 10, tick % 51 / 10
        rows.append((t, SPEED, speed > limit, speed, limit))
        rows.append((t + 0.01, HEIGHT, False, 1.0, 9.0))
    return Recording(name, events(rows), tuple(marks), ns(at), ns(at + length))


def of(recording, number):
    table = recording.events
    return table.take(table.rows_of(key(number)))


# 1,000 evaluations of each: of the height 64 remain, of the speed at most that and both ends of 16
# changes, the first threshold and four extremes.
def test_a_good_run_is_made_small():
    small = thinned(flight())
    assert len(of(small, HEIGHT)) == EVENLY
    assert EVENLY < len(of(small, SPEED)) <= EVENLY + 2 * CHANGES + 5


def test_the_range_the_ends_and_the_thresholds_stay():
    whole, small = of(flight(), SPEED), of(thinned(flight()), SPEED)
    assert (small.cmp.min(), small.cmp.max()) == (0.0, 5.0)
    assert {*small.thresh.tolist()} == {4.0}
    assert (small.time_ns[0], small.time_ns[-1]) == (whole.time_ns[0], whole.time_ns[-1])


# Above 4.0 are 4.1 to 5.0: 10 of 51 evaluations, 0.196; of 64 evenly spread ones one is 0.016.
def test_how_often_it_came_out_true_stays():
    small = of(thinned(flight()), HEIGHT)
    assert not small.res.any()
    evenly = of(thinned(flight(limit=4.0)), SPEED)
    held = np.diff(evenly.time_ns.astype(float))
    assert np.sum(held * evenly.res[:-1]) / held.sum() == pytest.approx(10 / 51, abs=0.05)


def test_an_empty_recording_stays_empty():
    assert len(thinned(Recording("none", events([]), (), 0, 0)).events) == 0


def saved(folder, recording, parameters=None):
    save_recording(recording, folder)
    if parameters is not None:
        (folder / "params.yaml").write_text(parameters)
    return folder


def asked(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


@pytest.fixture
def robot(tmp_path):
    """Two good runs with other settings, a mission with marks, and its static information."""
    STATIC.save(tmp_path / "static.json")
    saved(tmp_path / "monday", flight("monday", 4.0))
    saved(tmp_path / "tuesday", flight("tuesday", 4.5, at=200))
    marks = [Mark(ns(400 + t), "I", "ana") for t in (37, 52)]
    saved(tmp_path / "today", flight("today", 1.0, marks, at=400))
    return tmp_path


def learned(robot, *names):
    return asked("learn", *(robot / name for name in names), "-o", robot / "good")


def test_a_profile_is_taken_for_the_runs_in_it(robot):
    assert learned(robot, "monday", "tuesday").exit_code == 0
    words = ("rank", robot / "today", "--static", robot / "static.json", "--json", "--reference")
    by_profile = json.loads(asked(*words, robot / "good").stdout)
    runs = (robot / "monday", "--reference", robot / "tuesday")
    by_runs = json.loads(asked(*words, *runs).stdout)
    first = [found[0]["diagnosis"]["suspects"][0] for found in (by_profile, by_runs)]
    assert [one["parameter"] for one in first] == ["~max_speed", "~max_speed"]
    assert first[0]["probability"] == pytest.approx(first[1]["probability"], abs=0.01)


def test_the_same_run_again_replaces_the_first(robot):
    learned(robot, "monday")
    assert learned(robot, "monday").exit_code == 0
    assert [run.name for run in runs_in(robot / "good")] == ["monday"]


def test_runs_are_listed_by_time_and_can_be_removed(robot):
    learned(robot, "tuesday", "monday")
    listed = json.loads(asked("learn", "-o", robot / "good", "--json").stdout)
    assert [(one["source"], one["reports"]) for one in listed] == [
        (str(robot / "monday"), 2000),
        (str(robot / "tuesday"), 2000),
    ]
    assert asked("learn", "-o", robot / "good", "--remove", "monday").exit_code == 0
    assert [run.name for run in runs_in(robot / "good")] == ["tuesday"]


def test_marks_are_warned_of_and_not_learned(robot):
    result = learned(robot, "today")
    assert "has 2 marks, so somebody saw errors" in result.stderr
    (run,) = runs_in(robot / "good")
    assert load_recording(robot / "good" / run.folder).marks == ()


def test_the_values_of_parameters_are_kept(robot):
    saved(robot / "monday", flight(), "max_speed: 4.0\n")
    learned(robot, "monday")
    (run,) = runs_in(robot / "good")
    folder = robot / "good" / run.folder
    assert RecordedRun.of(folder).values.values == {"/max_speed": 4.0}


def failed(robot, *words):
    result = asked(*words)
    assert result.exit_code == 1
    (line,) = result.stderr.splitlines()
    return line


def test_a_mission_is_not_its_own_good_run(robot):
    learned(robot, "today")
    words = ("rank", robot / "today", "--static", robot / "static.json")
    result = asked(*words, "--reference", robot / "good")
    assert result.exit_code == 1
    assert "has the same reports as the mission" in result.stderr


def test_another_folder_is_not_overwritten(robot):
    line = failed(robot, "learn", robot / "monday", "-o", robot)
    assert "is there and is no profile of good runs; give another -o FOLDER" in line


def test_without_a_profile_and_a_recording_there_is_nothing_to_do(robot):
    line = failed(robot, "learn", "-o", robot / "nothing")
    assert "no profile of good runs here; give recordings to learn" in line


def test_a_run_that_is_not_there_cannot_be_removed(robot):
    learned(robot, "monday")
    line = failed(robot, "learn", "-o", robot / "good", "--remove", "friday")
    assert "no run called friday; there are: monday-" in line


def test_a_profile_of_a_newer_format_is_refused(robot):
    learned(robot, "monday")
    (robot / "good" / PROFILE_FILE).write_text('{"schema": 2}')
    words = ("rank", robot / "today", "--static", robot / "static.json")
    line = failed(robot, *words, "--reference", robot / "good")
    assert "format 2; this one reads 1" in line


def test_an_empty_profile_says_how_to_fill_it(robot):
    learned(robot, "monday")
    asked("learn", "-o", robot / "good", "--remove", "monday")
    words = ("rank", robot / "today", "--static", robot / "static.json")
    line = failed(robot, *words, "--reference", robot / "good")
    assert "no good run in this profile; add one with `pytpc learn`" in line


def test_two_runs_at_the_same_times_are_two(robot):
    saved(robot / "again" / "monday", flight("monday", 4.2))
    assert learned(robot, "monday", "again/monday").exit_code == 0
    assert len(runs_in(robot / "good")) == 2


def test_a_run_with_broken_values_is_refused_when_it_is_learned(robot):
    saved(robot / "monday", flight(), "max_speed: [4.0\n")
    assert "params.yaml" in failed(robot, "learn", robot / "monday", "-o", robot / "good")


def test_what_is_not_finished_is_no_run(robot):
    learned(robot, "monday")
    (run,) = runs_in(robot / "good")
    (robot / "good" / run.folder).rename(robot / "good" / ".learning-1")
    assert runs_in(robot / "good") == []


def test_a_broken_run_is_named(robot):
    learned(robot, "monday")
    (run,) = runs_in(robot / "good")
    file = robot / "good" / run.folder / "learned.json"
    file.write_text(file.read_text().replace('"reports": 2000', '"reports": -1'))
    line = failed(robot, "learn", "-o", robot / "good")
    assert "reports is no whole number below 2^63" in line
    assert str(file) in line


def test_a_part_of_a_profile_is_not_learned_again(robot):
    learned(robot, "monday")
    (run,) = runs_in(robot / "good")
    line = failed(robot, "learn", robot / "good" / run.folder, "-o", robot / "more")
    assert "is a part of a profile already; give the recording itself" in line


def test_a_profile_is_taken_by_the_api(robot):
    learned(robot, "monday", "tuesday")
    found = pytpc.diagnose(robot / "today", robot / "static.json", reference=robot / "good")
    assert found.rows()[0]["parameter"] == "~max_speed"
    assert found.differences is not None
    assert len(found.differences.good) == 2


def test_without_reports_nothing_is_learned(robot):
    saved(robot / "silent", Recording("silent", events([]), (), 0, ns(1)))
    assert "no threshold reports" in failed(robot, "learn", robot / "silent", "-o", robot / "good")


# The other build has two lines more above the comparisons, so that its keys are others.
OTHER = static_info(
    comparison(10, "~max_speed", lineno=12),
    comparison(11, "~max_height", lineno=13),
)


def test_a_good_run_of_another_build_is_matched_by_place(robot):
    run = flight("before", 4.0)
    other = {key(0): key(10), key(1): key(11)}
    names = tuple(other[one] for one in run.events.keys)
    saved(robot / "before", replace(run, events=replace(run.events, keys=names)))
    OTHER.save(robot / "before" / "static.json")
    (robot / "before" / "run.json").write_text("{}")
    learned(robot, "before")
    words = ("rank", robot / "today", "--static", robot / "static.json")
    result = asked(*words, "--reference", robot / "good", "--json")
    assert result.exit_code == 0, result.stderr
    first = json.loads(result.stdout)[0]["diagnosis"]["suspects"][0]
    assert (first["parameter"], first["probability"] > 0.5) == ("~max_speed", True)


# Two lines were added above: what was at 14 is at 16, and has the key that another one had there.
def test_a_key_that_is_another_comparison_there_is_not_trusted():
    here = static_info(
        comparison(14, "~a", lineno=14, source_code="if (x > a_)"),
        comparison(16, "~a", lineno=16, source_code="if (y > a_)"),
    )
    there = static_info(
        comparison(12, "~a", lineno=12, source_code="if (x > a_)"),
        comparison(14, "~a", lineno=14, source_code="if (y > a_)"),
    )
    assert keys_in(here, there) == {key(12): key(14), key(14): key(16)}


# One line was added above, and what was at 11 is gone: what was at 10 has its key now.
def test_a_comparison_that_is_gone_does_not_keep_a_key_that_another_one_has_here():
    here = static_info(comparison(11, "~a", lineno=11, source_code="if (x > a_)"))
    there = static_info(
        comparison(10, "~a", lineno=10, source_code="if (x > a_)"),
        comparison(11, "~a", lineno=11, source_code="if (y > a_)"),
    )
    found = keys_in(here, there)
    assert found[key(10)] == key(11)
    assert found[key(11)] not in here.comparisons


# The keys of today are those of the other build, moved on by one: renamed twice, 0 would be 2.
def test_the_keys_of_another_build_are_renamed_once(robot):
    names = ("~max_speed", "~max_height", "~most")
    code = [f"if (value > {name}_)" for name in names]
    here = [comparison(n, name, source_code=code[n - 1]) for n, name in enumerate(names, 1)]
    there = [comparison(n, name, source_code=code[n]) for n, name in enumerate(names)]
    saved(robot / "before", flight("before", 4.0))
    static_info(*there).save(robot / "before" / "static.json")
    (robot / "before" / "run.json").write_text("{}")
    run = flight("now", 1.0, [Mark(ns(37), "I")])
    moved = run.with_keys(lambda one: {key(0): key(1), key(1): key(2)}[one])
    saved(robot / "now", moved)
    static_info(*here).save(robot / "now.json")
    words = ("rank", robot / "now", "--static", robot / "now.json", "--json", "--reference")
    result = asked(*words, robot / "before")
    assert result.exit_code == 0, result.stderr
    found = json.loads(result.stdout)[0]["diagnosis"]
    assert [one["parameter"] for one in found["differences"]["parameters"]] == ["~max_speed"]


def test_alike_comparisons_of_a_function_are_matched_by_their_order():
    here = static_info(comparison(0, "~a", lineno=20), comparison(1, "~a", lineno=30))
    there = static_info(comparison(5, "~a", lineno=25), comparison(4, "~a", lineno=35))
    assert keys_in(here, there) == {key(5): key(0), key(4): key(1)}


def test_where_one_is_new_the_source_line_tells():
    here = static_info(
        comparison(0, "~a", lineno=20, source_code="if (x > a_)"),
        comparison(1, "~a", lineno=30, source_code="if (y > a_)"),
    )
    there = static_info(comparison(5, "~a", lineno=25, source_code="if (y > a_)"))
    assert keys_in(here, there) == {key(5): key(1)}


def test_what_moved_to_another_function_is_found_in_its_file():
    here = static_info(comparison(0, "~a", function="Node::check"))
    there = static_info(comparison(5, "~a", function="Node::step"))
    assert keys_in(here, there) == {key(5): key(0)}


def test_what_is_not_clear_is_left_out():
    here = static_info(comparison(0, "~a"), comparison(1, "~a"))
    there = static_info(comparison(5, "~a"))
    assert keys_in(here, there) == {}
    assert keys_in(StaticInfo.of([]), there) == {}
