"""What differs between good runs and a mission, and what that says beside the ranking."""

from __future__ import annotations

import io
import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import click
import pytest
from click.testing import CliRunner
from mission_samples import BagFile, SummaryBuilder, comparison, events, key, line, link_unit, ns
from rich.console import Console

import pytpc
from pytpc.api.comparing import RecordedRun, diff, diff_running
from pytpc.base.errors import InputError
from pytpc.base.wording import percent
from pytpc.cli.main import main
from pytpc.cli.mark_commands import _differing
from pytpc.cli.options import offer_good_run
from pytpc.diagnosis.diagnose import diagnose_mission
from pytpc.diagnosis.differences import RunValues, changes_of, differences
from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.blame import blame
from pytpc.present.ranking_tables import print_differences
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc.recording.parameter_values import SetValue as TimedValue
from pytpc.recording.summaries import Summary
from pytpc.ros.earlier_runs import last_unmarked_run
from pytpc.static.link_unit import ParameterRead
from pytpc.static.static_info import StaticInfo
from pytpc.values.recording import params_file

FACES, COVERAGE = comparison(0, "~faces", ">="), comparison(1, "~coverage")
READS = [
    ParameterRead(name, "ros::NodeHandle::param", "double", None, "src/node.cpp", row, 1, "main")
    for name, row in (("~faces", 3), ("~coverage", 4), ("~radius", 5))
]
STATIC = StaticInfo.of([link_unit([FACES, COVERAGE], READS)])


def flight(faces, coverage=0.6, marks=(), node="/uav"):
    """20 s; once a second the second is compared with ``faces``, and 0.5 with ``coverage``."""
    rows = []
    for t in range(20):
        rows.append((t, 0, t >= faces, t, faces, node))
        rows.append((t, 1, coverage < 0.5, 0.5, coverage, node))
    return Recording("flight", events(rows), tuple(marks), 0, ns(20))


def values(**own):
    return {f"/uav/{name}": value for name, value in own.items()}


GOOD = RunValues("good", flight(5), values(faces=5, coverage=0.6, radius=0.17, extra=1))


def found_in(bad, *good, **settings):
    return differences(bad, good or [GOOD], STATIC, **settings)


# With 5 instead of 12 the seconds 5 to 11 would have come out otherwise: 7 of 20 decisions. In the
# 3 s before the mark at 6.5 s are 4, 5 and 6, two of them turned.
def test_a_difference_is_replayed_with_the_good_value():
    now = values(faces=12, coverage=0.6, radius=0.17, extra=1)
    places = {"/uav/faces": "params.yaml:2"}
    bad = RunValues("bad", flight(12, marks=[Mark(ns(6.5), "II")]), now, places)
    found = found_in(bad, window_s=3.0)
    (one,) = found.found
    assert (one.parameter, one.good.value, one.bad.value) == ("/uav/faces", 5, 12)
    assert (one.bad.place, one.state, one.keys) == ("params.yaml:2", "compared", (key(0),))
    assert (one.evaluations, one.turned, one.turned_near) == (20, 7, 2)
    assert one.replayed[0].first_s == 5.0
    assert one.effect == (
        "compared at src/node.cpp:10: 7 of 20 decisions would have come out otherwise"
    )
    assert (found.title, found.is_complete) == ("1 parameter differs from the good run good", True)


def test_what_no_comparison_reports_is_named():
    now = values(faces=5, coverage=0.6, radius=0.42, extra=2)
    found = found_in(RunValues("bad", flight(5), now))
    radius, extra = found.found
    assert (radius.parameter, radius.state) == ("/uav/radius", "used")
    assert radius.effect == "read at src/node.cpp:5, compared nowhere"
    assert (extra.parameter, extra.state) == ("/uav/extra", None)
    assert extra.effect == "read by no analysed node"
    assert found.unreported == (radius,)


# ~radius is read, and has its default, unless somebody set it beside the name that nobody reads.
def test_a_misspelt_name_is_answered_with_the_one_that_is_read():
    now = values(faces=5, coverage=0.6, extra=1, radus=0.17)
    found = found_in(RunValues("bad", flight(5), now)).found
    (unread,) = [one for one in found if one.parameter == "/uav/radus"]
    assert unread.effect == "read by no analysed node; did you mean ~radius?"
    found = found_in(RunValues("bad", flight(5), {**now, "/uav/radius": 0.17})).found
    assert [one.effect for one in found] == ["read by no analysed node"]


def test_the_most_telling_difference_is_first():
    now = values(faces=12, coverage=0.7, radius=0.42, extra=2)
    names = [one.parameter for one in found_in(RunValues("bad", flight(12, 0.7), now)).found]
    # 0.5 is below 0.6 and 0.7, so no decision on the coverage turns.
    assert names == ["/uav/faces", "/uav/radius", "/uav/coverage", "/uav/extra"]


def test_a_value_of_any_good_run_is_no_difference():
    other = RunValues("other", flight(12), values(faces=12, coverage=0.6, radius=0.17, extra=1))
    now = values(faces=12, coverage=0.6, radius=0.42, extra=1)
    found = found_in(RunValues("bad", flight(12), now), GOOD, other)
    assert [one.parameter for one in found.found] == ["/uav/radius"]
    assert found.title == "1 parameter differs from the good runs good, other"


def test_a_number_is_the_same_however_it_is_written():
    now = values(faces=5.0, coverage=0.6, radius=0.17, extra=True)
    found = found_in(RunValues("bad", flight(5), now))
    assert [one.parameter for one in found.found] == ["/uav/extra"]


def test_without_recorded_parameters_the_reports_tell():
    found = found_in(RunValues("bad", flight(12)))
    (one,) = found.found
    assert (one.parameter, one.good.value, one.bad.value, one.turned) == ("~faces", 5.0, 12.0, 7)
    assert not found.is_complete
    assert found.notes[0].startswith("no values in a params.yaml beside bad: ")


def test_a_default_that_is_on_no_server_is_found_in_the_reports():
    server = values(radius=0.17)
    good = RunValues("good", flight(5), server)
    (one,) = found_in(RunValues("bad", flight(12), server), good).found
    assert one.parameter == "~faces"


# The default 5 is on no server. With it the seconds 5 to 11 would have come out otherwise.
@pytest.mark.parametrize(("good", "bad"), [(5, 12), (12, 5)])
def test_a_value_that_is_set_in_one_run_only_is_compared_with_the_default(good, bad):
    set_to = {5: values(radius=0.17), 12: values(radius=0.17, faces=12)}
    then = RunValues("good", flight(good), set_to[good])
    found = found_in(RunValues("bad", flight(bad), set_to[bad]), then)
    (one,) = found.found
    assert (one.parameter, one.good.value, one.bad.value) == ("/uav/faces", good, bad)
    assert (one.good.place, one.bad.place)[good > bad] == "default in the code"
    assert (one.evaluations, one.turned, found.unreported) == (20, 7, ())
    assert changes_of(found) == (Change("/uav/faces", "", good, bad),)


def test_the_default_that_is_set_is_no_difference():
    good = RunValues("good", flight(5), values(radius=0.17))
    now = values(radius=0.17, faces=5)
    assert found_in(RunValues("bad", flight(5), now), good).found == ()


# /two has the default of the good run, and /uav, which sets 12, is new.
def test_the_default_of_another_node_is_not_taken():
    good = RunValues("good", flight(5, node="/two"), {"/two/radius": 1})
    now = {"/two/radius": 1, "/uav/faces": 12}
    (one,) = found_in(RunValues("bad", flight(12), now), good).found
    assert (one.good.value, one.bad.value, one.is_silent) == (None, 12, False)
    assert one.effect == (
        "compared at src/node.cpp:10: not replayed, as the good run's value is not known"
    )


# It is reported: the log is not silent about it, it only cannot be replayed.
@pytest.mark.parametrize(("value", "why"), [("five", "the good run's value is no number"),
    ([5, 6], "the good run's value is no number"),
    (10**400, "the threshold that it gives is not known"),
])  # fmt: skip
def test_a_value_that_gives_no_threshold_is_not_replayed(value, why):
    good = RunValues("good", flight(5), values(faces=value))
    found = found_in(RunValues("bad", flight(12), values(faces=12)), good)
    (one,) = found.found
    assert one.effect == f"compared at src/node.cpp:10: not replayed, as {why}"
    assert (found.unreported, one.keys, one.change[-5:]) == ((), (key(0),), "-> 12")


# Two files have a NaN of their own each.
def test_lists_are_compared_value_by_value():
    def run(name, *listed):
        return RunValues(name, flight(5), values(faces=5, listed=[*listed, float("nan")]))

    assert found_in(run("bad", 1.0, "a"), run("good", 1, "a")).found == ()
    assert found_in(run("bad", True, "a"), run("good", 1, "a")).found
    assert found_in(run("bad", 1), run("good", 1, "a")).found


def without_events(run, unwanted):
    """The run without the events of a comparison."""
    table = run.events
    return replace(run, events=table.take(table.key != table.keys.index(unwanted)))


def in_summaries(run, faces):
    """The same, but one summary a second says what was compared with ``faces``."""
    builder = SummaryBuilder()
    for t in range(20):
        row = {"count": 2, "flops": 0, "far": 2, "odd": 0, "result": t >= faces, "res": t >= faces}
        row |= {"cmp": t, "thresh": faces, "diff_min": t - faces, "diff_max": t - faces}
        row |= {"diff_mean": t - faces, "abs_mean": abs(t - faces)}
        row |= {"low": min(t, faces), "high": max(t, faces)}
        builder.add(Summary(key(0), "/uav", ns(t), ns(t + 0.9), **row))
    return replace(without_events(run, key(0)), summaries=builder.build())


# With 5 it would have acted from 5 s on; it did not, and was marked at 8 to 10 s.
MARKS = tuple(Mark(ns(at), "II") for at in (8, 9, 10))


def accused_beside(good, bad, *, is_known=True):
    """Who is accused; if ``is_known``, the servers say 5 and 12."""
    changes = [Change("/uav/faces", "", 5.0, 12.0)] if is_known else ()
    return blame(bad, STATIC, Question(references=[good], changes=changes)).accused


# A good run that never got to the comparison says nothing of it; the parameter server does.
def test_what_the_good_run_did_not_compare_is_blamed_if_it_was_changed():
    bad, silent = flight(12, marks=MARKS), without_events(flight(5), key(0))
    assert accused_beside(flight(5), bad) == "~faces"
    assert accused_beside(silent, bad) == "~faces"
    assert accused_beside(silent, bad, is_known=False) is None


# One run under the policy `light`, recorded after its first evaluations, and one under `every`.
@pytest.mark.parametrize("is_light", [(True, False), (False, True), (True, True)])
def test_runs_under_other_policies_are_compared(is_light):
    good, bad = (
        in_summaries(run, faces) if light else run
        for run, faces, light in zip(
            (flight(5), flight(12, marks=MARKS)), (5, 12), is_light, strict=True
        )
    )
    assert accused_beside(good, bad, is_known=False) == "~faces"
    (one,) = found_in(RunValues("bad", bad), RunValues("good", good)).found
    assert (one.parameter, one.good.value, one.bad.value) == ("~faces", 5, 12)
    same = replace(in_summaries(flight(12), 12), marks=MARKS)
    assert accused_beside(same, bad, is_known=False) is None
    assert found_in(RunValues("bad", bad), RunValues("good", same)).found == ()


def two_nodes(first, second, **servers):
    """/uav and /two are the same program, with thresholds of their own."""
    tables = [
        flight(faces, node=node).events for faces, node in ((first, "/uav"), (second, "/two"))
    ]
    rows = [
        (time / 1e9, number, result, cmp, thresh, node)
        for table, node in zip(tables, ("/uav", "/two"), strict=True)
        for number in (0, 1)
        for time, result, cmp, thresh in zip(
            *(
                column[table.rows_of(key(number))]
                for column in (table.time_ns, table.result, table.cmp, table.thresh)
            ),
            strict=True,
        )
    ]
    return Recording("two", events(sorted(rows)), MARKS, 0, ns(20))


# The log's last word on ~faces may come from the node that kept its value.
def test_the_value_to_try_is_that_of_the_node_that_changed():
    good = RunValues("good", two_nodes(5, 5), {"/uav/faces": 5, "/two/faces": 5})
    bad = RunValues("bad", two_nodes(5, 12), {"/uav/faces": 5, "/two/faces": 12})
    found = found_in(bad, good)
    assert [one.change for one in found.found] == ["/two/faces 5 -> 12"]
    question = Question(references=[good.recording], differences=found, changes=changes_of(found))
    told = diagnose_mission(bad.recording, STATIC, question)
    assert told.accused == "~faces"
    assert told.action == (
        "lower ~faces from 12 to 5 (the value of /two/faces before it was changed)"
    )


def test_several_values_without_a_server_are_said():
    found = found_in(RunValues("bad", two_nodes(5, 12)), RunValues("good", two_nodes(5, 5)))
    assert found.found == ()
    assert found.notes[1:] == ("not compared, as the reports of a run have several values: ~faces",)


# It kept its value, as one of the runs had it; that run has no params.yaml, but reports.
def test_a_good_run_without_a_server_counts_by_its_reports():
    bad = RunValues("bad", flight(12), values(faces=12, coverage=0.6, radius=0.17, extra=1))
    assert found_in(bad, GOOD, RunValues("other", flight(12))).found == ()


# Another node of the same program has a parameter of that name, and evaluates nothing.
def test_decisions_of_another_node_do_not_count():
    good = RunValues("good", flight(5), {"/uav/faces": 5, "/two/faces": 5})
    (one,) = found_in(RunValues("bad", flight(5), {"/uav/faces": 5, "/two/faces": 9}), good).found
    assert (one.parameter, one.evaluations) == ("/two/faces", 0)
    assert one.effect == "compared at src/node.cpp:10: not evaluated in this mission"


def test_differences_are_changes_for_the_ranking():
    now = values(faces=12, coverage=0.6, radius=0.17, extra="far")
    first, second = changes_of(found_in(RunValues("bad", flight(12), now)))
    assert (first.parameter, first.old, first.new) == ("/uav/faces", 5.0, 12.0)
    assert second.parameter == "/uav/extra"
    assert second.new != second.new


def recorded(tmp_path):
    """Two recorded missions with their parameters, and the static information."""

    def record(name, faces, radius, first, *marks):
        folder = tmp_path / name
        folder.mkdir()
        with BagFile(folder / "mission.bag") as bag:
            for t in range(first, 20):
                bag.log(t, "/uav", line(0, int(t >= faces), t, faces))
                bag.log(t, "/uav", line(1, 0, 0.5, 0.6))
            for at in marks:
                bag.mark(at, "/mark_no_action")
        parameters = f"uav: {{faces: {faces}, coverage: 0.6, radius: {radius}}}\nrun_id: {name}\n"
        (folder / "params.yaml").write_text(parameters)
        messages = {"/mark_no_action": len(marks)}
        run = {"launch": "/robot.launch", "ended": "done", "messages": messages}
        (folder / "run.json").write_text(json.dumps(run))
        return folder

    static = tmp_path / "static.json"
    STATIC.save(static)
    good, bad = record("monday", 5, 0.17, 2), record("tuesday", 5, 0.42, 1, 12.0, 15.0)
    return good, bad, static


@pytest.fixture
def runs(tmp_path):
    return recorded(tmp_path)


def asked(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


def test_diff_says_what_differs_and_where(runs):
    good, bad, static = runs
    result = asked("diff", good, bad, "--static", static)
    assert result.exit_code == 0, result.output
    assert "1 parameter differs from the good run monday" in result.stdout
    assert "/uav/radius" in result.stdout
    assert "read at src/node.cpp:5, compared nowhere" in result.stdout
    (one,) = json.loads(asked("diff", good, bad, "--static", static, "--json").stdout)["parameters"]
    assert (one["parameter"], one["good"]["value"], one["bad"]["value"]) == (
        "/uav/radius",
        0.17,
        0.42,
    )
    assert diff(good, bad, static).found[0].parameter == "/uav/radius"


# Comparison 0 evaluates 0 to 19 with 12 and would with 5: 5 to 11 turn, first at 5 s. Comparison 1
# evaluates 0.5 and turns nothing: with both, 7 of 40 turn, and 7 of 20 at the first place.
@pytest.mark.parametrize("several", [False, True])
def test_diff_says_once_what_became_of_the_only_comparison(several):
    here = [FACES, replace(COVERAGE, name="~faces", source="~faces")] if several else [FACES]
    static = StaticInfo.of([link_unit(here, READS)])
    bad = RunValues("bad", flight(12, 12), values(faces=12))
    found = differences(bad, [RunValues("good", flight(5, 5), values(faces=5))], static)
    with io.StringIO() as out:
        print_differences(Console(file=out, width=1000), found, most=None, each=True)
        text = out.getvalue()
    assert text.count("7 of ") == (2 if several else 1), text
    assert text.count("src/node.cpp:10") == (2 if several else 1), text
    assert text.count("first at 5.0 s") == 1, text


# Every compared parameter kept its value: none of them is likely, and only ~radius is listed.
def test_the_verdict_names_what_differs_and_is_not_reported(runs):
    good, bad, static = runs
    found = pytpc.diagnose(bad, static, reference=good)
    assert found.accused is None
    assert [one.accused.parameter for one in found.shown] == ["~radius"]
    assert found.action == "lower ~radius from 0.42 to 0.17 (the value of the good run)"
    first, none = percent(found.blame.confidence), percent(found.blame.none)
    assert found.headline == (
        f"not sure: ~radius is likeliest ({first}), and no comparison reports it; none of the"
        f" parameters: {none}"
    )
    for command in ("rank", "suggest"):
        result = asked(command, bad, "--static", static, "--reference", good)
        assert result.exit_code == 0, result.output
        first, *_ = result.stdout.splitlines()
        assert first.rstrip() == "1 parameter differs from the good run monday"
        assert found.headline in " ".join(result.stdout.split())


def test_the_last_run_without_marks_is_found(runs):
    good, bad, _ = runs
    assert last_unmarked_run(bad) == good
    assert last_unmarked_run(bad / "mission.bag") == good
    assert last_unmarked_run(good) is None
    (good.parent / "latest").symlink_to(good)
    assert last_unmarked_run(good) is None
    (good.parent / "latest").unlink()
    (good / "run.json").write_text("[]")
    assert last_unmarked_run(bad) is None


def rewrite(folder, **changes):
    file = folder / "run.json"
    file.write_text(json.dumps({**json.loads(file.read_text()), **changes}))


# Its messages have the mark that was taken back, too; the file of marks is left with no line.
def test_a_run_whose_marks_were_all_taken_back_is_offered(runs):
    good, bad, _ = runs
    rewrite(good, messages={"/mark_action": 1, "/mark_undo": 1})
    assert last_unmarked_run(bad) is None
    rewrite(good, marks=0)
    assert last_unmarked_run(bad) == good
    (good / "marks.csv").write_text("time_ns,type,observer,note\n")
    assert last_unmarked_run(bad) == good
    (good / "marks.csv").write_text("time_ns,type,observer,note\n5,I,,\n")
    assert last_unmarked_run(bad) is None
    (good / "marks.csv").write_text("time_ns,type,observer,note\nsoon\n")
    assert last_unmarked_run(bad) is None


# Another robot or world may be chosen by an argument, and a run without reports is no good run.
@pytest.mark.parametrize(
    "changes",
    [{"args": {"world": "b"}}, {"ended": "failed"}, {"reports": 0, "reports_in_files": 0,
     "summaries_in_files": 0}],
)  # fmt: skip
def test_a_run_that_was_launched_otherwise_or_failed_is_not_offered(runs, changes):
    good, bad, _ = runs
    rewrite(good, **changes)
    assert last_unmarked_run(bad) is None
    rewrite(good, args={}, ended="done", reports=0, reports_in_files=12)
    assert last_unmarked_run(bad) == good


def offered_in(text):
    """The good runs that an answer offers; it may name them from the folder where it is asked."""
    return [Path(name).resolve() for name in re.findall(r"--reference (\S+)", text)]


# A time limit is how a run without an end of its own is ended. If a topic was to end it, it failed.
def test_a_run_that_ended_by_its_time_limit_is_offered_unless_a_topic_was_to_end_it(runs):
    good, bad, static = runs
    # Version 0.2 did not write whether a topic was to end it.
    rewrite(good, ended="timeout")
    assert "until" not in json.loads((good / "run.json").read_text())
    assert last_unmarked_run(bad) is None
    rewrite(good, until=None)
    assert last_unmarked_run(bad) == good
    for command in ("rank", "suggest", "report"):
        output = ("-o", good.parent / "page.html") if command == "report" else ()
        said = asked(command, bad, "--static", static, *output).stderr
        assert offered_in(said) == [good], command
    rewrite(good, until="/mission_done")
    assert last_unmarked_run(bad) is None


# The two marks of tuesday say that it is the bad run.
def test_a_marked_run_is_not_taken_as_good_without_a_word(runs):
    good, bad, static = runs
    marked = f"{bad}: has 2 marks, so somebody saw errors in this good run; give one that nobody"
    swapped = (
        f"{good}: nobody marked it; is it the good run? pytpc diff {good} {bad} --static {static}"
    )
    result = asked("diff", bad, good, "--static", static)
    assert result.exit_code == 0
    assert marked in result.stderr
    assert swapped in result.stderr
    # Two good runs cannot be one bad one.
    copy = shutil.copytree(bad, bad.with_name("wednesday"))
    twice = asked("diff", bad, copy, good, "--static", static)
    assert "is it the good run" not in twice.stderr
    again = asked("rank", good, "--static", static, "--at", "12", "--reference", bad)
    assert (again.exit_code, again.stderr.count(marked)) == (0, 1)
    assert "good run" not in asked("diff", good, bad, "--static", static).stderr


def test_the_same_run_is_offered_once(runs):
    good, bad, static = runs
    context = click.Context(main)
    with context, CliRunner().isolation() as (_, err, _):
        offer_good_run(bad)
        offer_good_run(bad)
    assert err.getvalue().decode().count("nobody marked it") == 1
    assert offered_in(asked("rank", bad, "--static", static).stderr) == [good]


@pytest.fixture
def two_bags(runs):
    """Both bags in one folder, without any parameters."""
    good, bad, static = runs
    for run in (good, bad):
        (run / "mission.bag").rename(good.parent / f"{run.name}.bag")
    return good.parent / "monday.bag", good.parent / "tuesday.bag", static


# What the note says to do is read: params.yaml would be of both bags.
def test_the_note_says_what_is_read(two_bags):
    good, bad, static = two_bags
    (good.parent / "params.yaml").write_text("uav: {faces: 5}")
    assert diff(good, bad, static).notes == (
        "no values in a params.yaml beside monday.bag, tuesday.bag: of these runs only parameters"
        " that are compared are known; `pytpc record` writes one, and `rosparam dump"
        " BAG.params.yaml` does for a bag",
    )
    for bag in (good, bad):
        bag.with_name(f"{bag.name}.params.yaml").write_text(f"uav: {{radius: {bag.stem}}}")
    found = diff(good, bad, static)
    assert (found.is_complete, found.found[0].change) == (True, "~radius monday -> tuesday")


# /uav/radius and /two/radius are both ~radius in the source, and the reader must know which it is.
def test_what_differs_is_called_as_suspects_are_if_that_is_clear():
    both = {"/uav/radius": 0.17, "/two/radius": 0.17, "/uav/faces": 5, "/uav/extra": 1}
    now = {"/uav/radius": 0.42, "/two/radius": 0.17, "/uav/faces": 12, "/uav/extra": 2}
    good = RunValues("good", flight(5), both)
    found = found_in(RunValues("bad", flight(12), now), good)
    assert [(one.parameter, one.name) for one in found.found] == [
        ("/uav/faces", "~faces"),
        ("/uav/radius", "/uav/radius"),
        ("/uav/extra", "/uav/extra"),
    ]
    assert found.line.startswith("differs from the good run good: ~faces 5 -> 12, /uav/radius ")
    # The default of /two is on no server.
    now = {"/uav/radius": 0.17, "/uav/faces": 12}
    bad = RunValues("bad", two_nodes(12, 5), now)
    good = RunValues("good", two_nodes(5, 5), {"/uav/radius": 0.17, "/uav/faces": 5})
    (one,) = found_in(bad, good).found
    assert (one.parameter, one.name) == ("/uav/faces", "/uav/faces")


# Only the running node knows the end of the name, so that both are ~faces_<dynamic> in the source.
def test_what_differs_has_its_full_name_if_the_source_does_not_know_all_of_it():
    static = StaticInfo.of([link_unit([comparison(0, "~faces_<dynamic>")])])
    nothing = Recording("bad", events([]), (), 0, ns(1))
    good = RunValues("good", nothing, {"/uav/faces_a": 5, "/uav/faces_b": 5})
    bad = RunValues("bad", nothing, {"/uav/faces_a": 12, "/uav/faces_b": 5})
    (one,) = differences(bad, [good], static).found
    assert (one.parameter, one.name) == ("/uav/faces_a", "/uav/faces_a")
    good, bad = replace(good, values={"/uav/faces_a": 5}), replace(bad, values={"/uav/faces_a": 12})
    (one,) = differences(bad, [good], static).found
    assert one.name == "/uav/faces_a"


# `mark` knows no comparison, so it cannot say that none differs.
def test_marking_says_only_what_it_knows(two_bags):
    good, bad, _ = two_bags
    (note,) = _differing(bad, None, [good])
    assert note.startswith("no values in a params.yaml beside monday.bag, ")


def test_without_its_parameters_no_run_is_compared_with_a_running_robot(two_bags):
    with pytest.raises(InputError, match=r"no params\.yaml beside it, so nothing can be compared"):
        diff_running(two_bags[0], "http://localhost:1")
    with pytest.raises(ValueError, match="there is no good run"):
        diff([], two_bags[1], two_bags[2])


@pytest.mark.parametrize("name", ["m.**", "m.[", "m.bag", "m"])
def test_a_file_of_any_name_may_have_parameters(tmp_path, name):
    (tmp_path / name).touch()
    (tmp_path / "params.yaml").touch()
    assert params_file(tmp_path / name) == tmp_path / "params.yaml"


# Not "12 parameters were taken away": the dump was interrupted.
def test_an_empty_dump_says_nothing(runs):
    good, bad, static = runs
    (good / "params.yaml").write_text("")
    found = diff(good, bad, static)
    assert (found.found, found.is_complete) == ((), False)
    assert found.notes[0].startswith("no values in a params.yaml beside monday: ")


@pytest.mark.parametrize("text", ["5", "[1, 2]"])
def test_what_has_no_names_is_no_dump(runs, text):
    good, bad, static = runs
    (good / "params.yaml").write_text(text)
    result = asked("diff", good, bad, "--static", static)
    assert result.exit_code == 1
    assert result.stderr == (
        f"pytpc: error: {good}/params.yaml: not a dump of the parameter server: it has no names\n"
    )


# The value was 12 from second 6 to 14, and 5 again at the end, as in the good run.
def test_a_value_that_was_set_while_it_ran_differs_though_the_last_one_does_not():
    now = values(faces=5, coverage=0.6, radius=0.17, extra=1)
    over_time = [(0, 5), (6, 12), (14, 5)]
    timed = [TimedValue(ns(second), "/uav/faces", value) for second, value in over_time]
    recording = replace(flight(5), values=tuple(timed))
    (one,) = found_in(RunValues("bad", recording, now)).found
    assert (one.parameter, one.good.value, one.bad.value) == ("/uav/faces", 5, 12)
    assert one.bad.place == "set while it ran, at 6.0 s"
    # A good run that had it at some time clears it.
    cleared = replace(GOOD, recording=replace(GOOD.recording, values=tuple(timed)))
    assert found_in(RunValues("bad", recording, now), cleared).found == ()
    assert found_in(GOOD, cleared).found == ()


# 5, and then 12 until the end: the change is what differs, with its time.
def test_the_value_at_the_end_is_told_with_the_time_from_which_on_it_held():
    timed = (TimedValue(0, "/uav/faces", 5), TimedValue(ns(3), "/uav/faces", 12))
    bad = RunValues("bad", replace(flight(12), values=timed), {**GOOD.values, "/uav/faces": 12})
    (one,) = found_in(bad).found
    assert (one.good.value, one.bad.value) == (5, 12)
    assert one.bad.place == "set while it ran, at 3.0 s"


def test_a_recording_without_params_yaml_has_the_values_over_time(tmp_path):
    timed = (TimedValue(0, "/uav/faces", 5), TimedValue(ns(3), "/uav/faces", 12))
    run = RecordedRun(replace(flight(12), values=timed), tmp_path)
    assert run.values.values == {"/uav/faces": 12}
