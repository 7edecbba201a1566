"""The commands rank and marks: what they print, what they write, and one line for each error."""

from __future__ import annotations

import json

import pytest
from click.testing import CliRunner
from mission_samples import BagFile, comparison, key, line, ns, static_info

from pytpc.cli.main import main
from pytpc.recording.marks import Mark, read_marks


@pytest.fixture
def files(tmp_path):
    """A bag from 1 to 20.9 s with one mark of each type, and the robot's static information."""
    bag = tmp_path / "m.bag"
    with BagFile(bag) as writer:
        write_reports(writer)
        writer.mark(16, "/mark_action")
        writer.mark(20, "/mark_no_action")
    static = tmp_path / "static.json"
    static_info(comparison(0, "faces", ">=", default=3), comparison(1, "coverage")).save(static)
    return bag, static


def write_reports(writer):
    for step in range(200):
        t = 1 + step / 10
        writer.log(t, "/uav", line(0, int(t >= 15), 4 if t >= 15 else 1, 3))
        writer.log(t, "/uav", line(1, 0, 0.3, 0.6))
        writer.log(t, "/uav", line(1, 0, 0.5, 0.6))


@pytest.fixture
def quiet(tmp_path):
    """The same without a mark."""
    bag = tmp_path / "quiet.bag"
    with BagFile(bag) as writer:
        write_reports(writer)
    return bag


def run(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


def one_line(result, *parts):
    assert result.exit_code == 1
    assert result.stdout == ""
    (text,) = [row for row in result.stderr.splitlines() if "warning" not in row]
    assert text.startswith("pytpc: error: ")
    for part in parts:
        assert part in text


def test_the_thesis_has_a_table_for_each_mark(files):
    bag, static = files
    result = run("rank", bag, "--static", static, "--score", "thesis")
    assert result.exit_code == 0, result.output
    lines = result.stdout.splitlines()
    assert lines[0] == "Mark 1 at 15.0 s: type I, did what it should not"
    assert lines[2].split()[:6] == ["1", "faces", "3", "raise", "to", "5"]
    assert lines[2].endswith("src/node.cpp:10  if (value >= faces_) {")
    # Type II at 20 s, window [8, 20]: faces has |1 - 3| 70 times and |4 - 3| 51 times of 121, and
    # one flop: 191 / 121 / (4 - 1) = 0.526; coverage (0.3 + 0.1) / 2 / (0.6 - 0.3) = 0.667.
    # faces turns at 1 and above 4, two away from 3 both: as the last one (4 >= 3) went.
    second = [text.split() for text in lines[4:] if text.strip()]
    assert second[2][:7] == ["1", "faces", "3", "raise", "to", "5", "0.526"]
    assert second[3][:7] == ["2", "coverage", "0.6", "lower", "to", "0.499", "0.667"]


# Both marks come after faces has turned and stayed so; coverage is 0.3 and 0.5 below 0.6 all the
# time. To have faces at 15 s as before, its 4 must stay below the value.
def test_all_marks_stand_together_first(files):
    bag, static = files
    result = run("rank", bag, "--static", static)
    assert result.exit_code == 0, result.output
    lines = [row.strip() for row in result.stdout.splitlines()]
    assert lines[0] == "All 2 marks together: 1 of type I, 1 of type II"
    assert lines[2].split() == [
        "#",
        "Parameter",
        *["Probability", "Type", "Value", "To", "try", "Compared", "at"],
    ]
    (suspect,) = [row for row in lines if row.startswith("1 ")]
    assert suspect.split()[1] == "faces"
    assert suspect.endswith("src/node.cpp:10  if (value >= faces_) {")
    (terms,) = [row for row in lines if row.startswith("Type I: ")]
    assert "None of the parameters: a fault in the code" in terms
    assert "Mark 1" not in result.stdout
    # What each mark says by itself comes behind it.
    each = [
        row for row in run("rank", bag, "--static", static, "--each").stdout.splitlines() if row
    ]
    titles = [row.strip() for row in each if row.startswith(("All", "Mark"))]
    assert titles == [
        lines[0],
        "Mark 1 at 15.0 s: type I, did what it should not",
        "Mark 2 at 19.0 s: type II, does not do what it should",
    ]


def test_all_marks_together_as_json(files):
    bag, static = files
    marks = json.loads(run("rank", bag, "--static", static, "--json", "--top", "1").stdout)
    together = marks[0]["diagnosis"]
    assert marks[1]["diagnosis"] == together
    (first,) = together["suspects"]
    assert (first["position"], first["parameter"], first["lineno"]) == (1, "faces", 10)
    assert together["confidence"] == first["probability"]
    assert together["accused"] == ("faces" if first["probability"] >= 0.5 else None)
    assert together["parameters"] == 2
    assert 0 < first["probability"] + together["none"] < 1
    assert first["remedy"]["direction"] in {"raise", "lower"}
    thesis = json.loads(run("rank", bag, "--static", static, "--json", "--score", "thesis").stdout)
    assert [mark["diagnosis"] for mark in thesis] == [None, None]
    assert (
        thesis[0]["suspects"]
        == json.loads(run("rank", bag, "--static", static, "--json").stdout)[0]["suspects"]
    )


def probabilities(*arguments):
    """The probabilities by parameter."""
    result = run("rank", *arguments, "--json")
    assert result.exit_code == 0, result.output
    suspects = json.loads(result.stdout)[0]["diagnosis"]["suspects"]
    return {suspect["parameter"]: suspect["probability"] for suspect in suspects}


# With 0.4 coverage's 0.5 would have been beyond it all the time; faces was not changed.
def test_what_was_changed_is_likelier(files, tmp_path):
    bag, static = files
    words = (bag, "--static", static)
    plainly = probabilities(*words)
    changes = tmp_path / "changes.json"
    entry = {"parameter": "/node/coverage", "node": "/node", "old": 0.4, "new": 0.6}
    changes.write_text(json.dumps([entry]))
    known = probabilities(*words, "--changes", changes)
    assert plainly["faces"] > plainly["coverage"]
    assert known["coverage"] > 2 * plainly["coverage"]
    assert known["faces"] < 0.01
    # The same from what stood on the parameter server before.
    before = tmp_path / "before.yaml"
    before.write_text("node: {coverage: 0.4, faces: 3, name: a}\n")
    (tmp_path / "params.yaml").write_text("node: {coverage: 0.6, faces: 3, name: a}\n")
    assert probabilities(*words, "--before", before) == pytest.approx(known)


# In the good run coverage was compared with 0.4, faces with the same 3.
def test_what_differs_from_a_good_run_is_likelier(files, tmp_path):
    bag, static = files
    clean = tmp_path / "clean.bag"
    with BagFile(clean) as writer:
        for t in range(1, 20):
            writer.log(t, "/uav", line(0, 0, 1, 3))
            writer.log(t, "/uav", line(1, 0, 0.3, 0.4))
    found = probabilities(bag, "--static", static, "--reference", clean)
    assert found["coverage"] > 2 * probabilities(bag, "--static", static)["coverage"]
    assert found["faces"] < 0.01
    other = tmp_path / "other.bag"
    with BagFile(other) as writer:
        writer.log(1, "/uav", line(7, 0, 1, 2))
    one_line(
        run("rank", bag, "--static", static, "--reference", other),
        "other.bag: the static information knows none of its reports",
    )


def test_what_is_known_beside_the_log_and_does_not_fit(files, tmp_path):
    bag, static = files
    words = ("rank", bag, "--static", static)
    file = tmp_path / "known"
    file.write_text("{}")
    one_line(run(*words, "--changes", file), "known: not a history of changes: expected a list")
    file.write_text("[]")
    assert "known: none of the changed parameters is compared anywhere" in (
        run(*words, "--changes", file).stderr
    )
    one_line(run(*words, "--before", file), "m.bag: has no params.yaml beside it")
    one_line(run(*words, "--changes", tmp_path / "none"), "none: cannot be read")
    for more in (
        ("--changes", file, "--before", file),
        ("--score", "thesis", "--changes", file),
        ("--score", "thesis", "--reference", bag),
    ):
        result = run(*words, *more)
        assert (result.exit_code, result.stdout) == (2, "")


def test_types_that_are_not_believed_do_not_count_together(files):
    bag, static = files
    ignored = run("rank", bag, "--static", static, "--types", "ignore").stdout
    assert "All 2 marks together: 2 without a type" in ignored
    believed = probabilities(bag, "--static", static)
    assert probabilities(bag, "--static", static, "--types", "doubt") == believed


def test_rank_as_json(files):
    bag, static = files
    result = run("rank", bag, "--static", static, "--json", "--top", "1")
    marks = json.loads(result.stdout)
    assert [(mark["type"], len(mark["suspects"])) for mark in marks] == [("I", 1), ("II", 1)]
    first = marks[0]["suspects"][0]
    assert (first["parameter"], first["direction"], first["value"]) == ("faces", "raise", 5)
    # (16 - 15) * (1 + 1)
    assert (first["score"], first["rank"], first["lineno"]) == (2.0, 1.0, 10)


# Suspects of the first mark: faces by type I (2 s), nobody else flopped. Untyped, at 15 s after the
# begin: coverage has a rank by type II.
def test_types_and_their_older_name(files):
    bag, static = files
    believed = json.loads(run("rank", bag, "--static", static, "--json").stdout)
    ignored = json.loads(run("rank", bag, "--static", static, "--json", "--types", "ignore").stdout)
    older = json.loads(run("rank", bag, "--static", static, "--json", "--untyped").stdout)
    assert [s["parameter"] for s in believed[0]["suspects"]] == ["faces"]
    assert [s["parameter"] for s in ignored[0]["suspects"]] == ["faces", "coverage"]
    assert older == ignored
    assert "--untyped" not in run("rank", "--help").stdout
    # Doubted, coverage has 26/32 of its rank by type II: second of two, 1 - 1/2.
    doubted = json.loads(run("rank", bag, "--static", static, "--json", "--types", "doubt").stdout)
    ranks = [(s["parameter"], s["rank"], s["rank2"]) for s in doubted[0]["suspects"]]
    assert ranks == [("faces", 1.0, 1.0), ("coverage", 26 / 64, 0.5)]
    assert run("rank", bag, "--static", static, "--types", "maybe").exit_code == 2


# faces: by type I alone. coverage has no score by it.
def test_whose_score_it_is_where_types_are_mixed(files):
    bag, static = files
    thesis = ("rank", bag, "--static", static, "--score", "thesis")
    assert "By type" not in run(*thesis).stdout
    doubted = run(*thesis, "--types", "doubt").stdout.splitlines()
    assert "By type" in doubted[1]
    assert doubted[2].split()[1:8] == ["faces", "3", "raise", "to", "5", "I", "2"]
    assert doubted[3].split()[1:7] == ["coverage", "0.6", "lower", "to", "0.499", "II"]


# With 0.5 s before the mark at 20 s, faces has only |4 - 3| / (4 - 1) and no flop: 0.333.
def test_another_window(files):
    bag, static = files
    result = run("rank", bag, "--static", static, "--window", "0.5", "--json")
    first = json.loads(result.stdout)[1]["suspects"][0]
    assert (first["parameter"], first["score"]) == ("faces", pytest.approx(1 / 3, rel=1e-12))
    assert run("rank", bag, "--static", static, "--window", "0").exit_code == 2


# 36 s is 15.1 s after the last report: within 20 s coverage was 0.3 and 0.5, which turn below them.
def test_suggestions_look_at_the_same_window(files, quiet):
    _, static = files
    result = run("rank", quiet, "--static", static, "--at", "35", "--window", "20", "--json")
    suspects = json.loads(result.stdout)[0]["suspects"]
    (coverage,) = [found for found in suspects if found["parameter"] == "coverage"]
    assert (coverage["score_type"], coverage["boundary"]) == ("II", 0.5)


def test_suggestions_keep_to_what_is_declared(files, tmp_path):
    bag, static = files
    (tmp_path / "robot").mkdir()
    (tmp_path / "robot" / "package.xml").write_text("<package/>")
    (tmp_path / "robot" / "Robot.cfg").write_text(
        "from dynamic_reconfigure.parameter_generator_catkin import *\n"
        "gen = ParameterGenerator()\n"
        'gen.add("coverage", double_t, 0, "how much", 0.6, 0.55, 1)\n'
        "add_more(gen)\n"
    )
    known = [comparison(0, "faces", ">=", default=3), comparison(1, "coverage")]
    static_info(*known, source_root=str(tmp_path / "robot")).save(static)
    result = run("rank", bag, bag, "--static", static, "--json")
    coverage = json.loads(result.stdout)[1]["suspects"][1]
    assert coverage["direction"] is None
    assert coverage["suggestion"] == "no value in the declared range 0.55..1 would do: below 0.5"
    # Of two missions the sources are one.
    assert result.stderr.count("Robot.cfg:4: add_more(gen): the function is not followed") == 1


# 14.5 s after the begin at 1 s is 15.5 s: faces has flopped 0.5 s before, 0.5 * 2.
def test_a_time_that_nobody_marked(files, quiet):
    _, static = files
    result = run("rank", quiet, "--static", static, "--at", "14.5", "--at", "5", "--json")
    late, early = json.loads(result.stdout)
    assert (late["time_ns"], late["seconds"], late["type"]) == (ns(15.5), 14.5, None)
    assert late["suspects"][0]["score"] == 1.0
    # Until then faces is always 2 from its threshold, as far as ever, D = 1; coverage D = 2/3.
    assert [s["parameter"] for s in early["suspects"]] == ["coverage", "faces"]
    outside = run("rank", quiet, "--static", static, "--at", "100")
    assert outside.exit_code == 0
    said = [row.strip() for row in outside.stdout.splitlines() if row.strip()]
    assert said == [
        "The one mark: 1 without a type",
        "not enough evidence to suspect any parameter",
        "mark 1: the last report up to the mark is 80.1 s before it",
    ]
    thesis = run("rank", quiet, "--static", static, "--at", "100", "--score", "thesis")
    assert "not enough evidence: the last report up to the mark is 80.1 s before" in thesis.stdout


@pytest.mark.parametrize("option", ["--at", "--window"])
@pytest.mark.parametrize("value", ["nan", "inf", "-1", "1e300", "x"])
def test_times_that_are_none(files, option, value):
    bag, static = files
    result = run("rank", bag, "--static", static, option, value)
    assert (result.exit_code, result.stdout) == (2, "")
    assert option in result.stderr


def test_several_missions(files, quiet):
    bag, static = files
    result = run("rank", bag, quiet, bag, "--static", static)
    assert result.exit_code == 0
    assert result.stdout.count(f"{bag}:\n") == 2
    assert result.stdout.count("All 2 marks together: 1 of type I, 1 of type II") == 2
    # Where reading takes more than two seconds its progress stands there, too.
    (warning,) = [line for line in result.stderr.splitlines() if "warning" in line]
    assert warning.startswith(f"pytpc: warning: {quiet}: no marks")
    items = json.loads(run("rank", bag, quiet, "--static", static, "--json").stdout)
    assert [item["mission"] for item in items] == ["m", "m"]
    one_line(run("rank", quiet, quiet, "--static", static), "quiet.bag: no marks", "`pytpc mark ")


# Missions are recorded into bags of one name.
def test_missions_are_called_after_their_folders(files, tmp_path):
    bag, static = files
    folders = [tmp_path / "monday", tmp_path / "tuesday"]
    for folder in folders:
        assert run("convert", bag, "-o", folder).exit_code == 0
    items = json.loads(run("rank", *folders, "--static", static, "--json").stdout)
    assert [item["mission"] for item in items] == ["monday", "monday", "tuesday", "tuesday"]


# Comparison 0 reports 200 times, comparison 1 400 times; only 1 is known.
def test_unknown_keys_are_named_and_the_rest_is_ranked(files, tmp_path):
    bag, _ = files
    other = tmp_path / "other.json"
    static_info(comparison(1, "coverage"), comparison(2, "speed")).save(other)
    result = run("rank", bag, "--static", other, "--json")
    assert result.exit_code == 0
    (warning,) = result.stderr.splitlines()
    assert "200 reports of 1 key left out: not in the static information" in warning
    assert f"{key(0)} (200)" in warning
    first, second = json.loads(result.stdout)
    assert [s["parameter"] for s in second["suspects"]] == ["coverage"]
    assert (first["enough"], first["reason"]) == (False, "no result had changed up to the mark")
    assert (second["enough"], second["reason"]) == (
        False,
        "only coverage had been compared up to the mark",
    )
    static_info(comparison(7, "x")).save(other)
    one_line(
        run("rank", bag, "--static", other),
        "m.bag: the static information knows none of its reports",
    )


def test_the_most_frequent_unknown_keys_are_named(tmp_path):
    bag = tmp_path / "m.bag"
    with BagFile(bag) as writer:
        for number in range(6):
            for step in range(number + 1):
                writer.log(1 + step, "/uav", line(number, 0, step, 5))
        writer.mark(9, "/mark_wrong")
    static = tmp_path / "static.json"
    static_info(comparison(0, "faces")).save(static)
    result = run("rank", bag, "--static", static)
    # 2 + 3 + 4 + 5 + 6 reports of five keys.
    assert "20 reports of 5 keys" in result.stderr
    assert f": {key(5)} (6), {key(4)} (5), {key(3)} (4) and 2 more" in result.stderr


def test_ties_in_the_table(tmp_path):
    bag = tmp_path / "m.bag"
    with BagFile(bag) as writer:
        for t in (1, 2):
            for number in (0, 1):
                writer.log(t, "/uav", line(number, t - 1, t, 1.5))
        for t in (1, 3):
            writer.log(t, "/uav", line(2, t // 3, t, 1.5))
        writer.mark(4, "/mark_action")
    static = tmp_path / "static.json"
    names = ("a", "b", "c")
    static_info(*(comparison(number, name) for number, name in enumerate(names))).save(static)
    result = run("rank", bag, "--static", static, "--score", "thesis")
    starts = [row.split()[:2] for row in result.stdout.splitlines()]
    assert [start for start in starts if len(start) == 2 and start[1] in names] == [
        ["1", "c"],
        ["2=", "a"],
        ["2=", "b"],
    ]


def test_marks_on_another_clock_are_told_in_one_line(files, tmp_path):
    _, static = files
    bag = tmp_path / "clocks.bag"
    with BagFile(bag) as writer:
        write_reports(writer)
        writer.mark(16, "/mark_action", marked=1_790_000_000)
    result = run("rank", bag, "--static", static)
    assert "not enough evidence to suspect any parameter" in result.stdout
    assert "mark 1: the mark is on another clock than the reports" in result.stdout
    (warning,) = [row for row in result.stderr.splitlines() if "marks are" in row]
    # 1,790,000,000 s after 1970 are 20,717 days and some hours: 2026-09-21.
    assert "1 of 1 marks are on another clock than the reports" in warning
    assert "(2026-09-21 and 1.0 s; /use_sim_time?)" in warning


def test_nodes_on_two_clocks_are_told_in_one_line(files, tmp_path):
    _, static = files
    bag = tmp_path / "clocks.bag"
    with BagFile(bag) as writer:
        write_reports(writer)
        for second in range(5):
            writer.log(9, "/wall", line(0, 0, 1, 3), stamp=1_790_000_000 + second)
        writer.mark(16, "/mark_action")
    result = run("rank", bag, "--static", static, "--json")
    (warning,) = [row for row in result.stderr.splitlines() if "reports, of" in row]
    assert "5 of 605 reports, of /wall, are on another clock than the others" in warning
    assert "(2026-09-21 and 1.0 s; /use_sim_time?)" in warning
    # What is later than the mark on its clock does not count: as without /wall, (16 - 15) * 2.
    assert json.loads(result.stdout)[0]["suspects"][0]["score"] == 2.0


# ---- marks ---------------------------------------------------------------------------------------


def test_marks_are_listed(files):
    bag, _ = files
    result = run("marks", bag)
    assert [row.split() for row in result.stdout.splitlines()[:3]] == [
        ["#", "Seconds", "Type", "Observer", "Note"],
        ["1", "15.0", "I"],
        ["2", "19.0", "II"],
    ]
    first = {"time_ns": ns(16), "seconds": 15.0, "type": "I", "observer": "", "note": ""}
    first |= {"where": [], "began": None}
    assert json.loads(run("marks", bag, "--json").stdout)[0] == first
    assert run("marks", bag, "--csv").stdout == (
        f"time_ns,type,observer,note\n{ns(16)},I,,\n{ns(20)},II,,\n"
    )


def test_marks_of_a_recording_without_any(quiet):
    result = run("marks", quiet)
    assert (result.exit_code, result.stdout) == (0, "no marks\n")
    assert json.loads(run("marks", quiet, "--json").stdout) == []


def test_marks_are_added_and_removed_beside_the_recording(quiet):
    before = quiet.read_bytes()
    beside = quiet.with_name("quiet.bag.marks.csv")
    run("marks", quiet, "--add", "5", "II", "--note", "no picture", "--observer", "ana")
    added = run("marks", quiet, "--add", "2.5", "none", "--json")
    untyped, noted = Mark(ns(3.5), None), Mark(ns(6), "II", "ana", "no picture")
    assert [item["seconds"] for item in json.loads(added.stdout)] == [2.5, 5.0]
    assert read_marks(beside) == (untyped, noted)
    rest = run("marks", quiet, "--remove", "1", "--csv")
    assert rest.stdout == f"time_ns,type,observer,note\n{ns(6)},II,ana,no picture\n"
    assert read_marks(beside) == (noted,)
    assert quiet.read_bytes() == before
    # rank sees them.
    assert "no picture" in run("marks", quiet).stdout


def test_what_cannot_be_added_or_removed(files):
    bag, _ = files
    one_line(run("marks", bag, "--remove", "1"), "mark 1 is in the recording itself")
    for arguments, said in (
        (["--remove", "3"], "there are 2 marks"),
        (["--add", "20", "I"], "the mission, which takes 19.9 s"),
        (["--add", "-1", "I"], "outside of the mission"),
        (["--add", "nan", "I"], "outside of the mission"),
        (["--add", "1", "III"], "'III' is not one of"),
        (["--add", "1", "I", "--remove", "1"], "give --add or --remove"),
        (["--note", "x"], "--note, --observer, --where and --began need --add"),
        (["--add", "1", "I", "--began", "soon"], "'soon' is not like 40..50, or 40"),
        (["--add", "1", "I", "--began", "0..2"], "2 s is after the mark at 1 s"),
        (["--add", "1", "I", "--where", "/a b"], "'/a b' is not a ROS name"),
        (["--add", "1", "I", *(f"--where=/t{n}" for n in range(9))], "at most 8 places"),
    ):
        result = run("marks", bag, *arguments)
        assert (result.exit_code, result.stdout) == (2, "")
        assert said in result.stderr
    assert not bag.with_name("m.bag.marks.csv").exists()


def test_places_are_added_with_a_mark_and_listed(quiet):
    places = ["--where", "/cmd_vel", "--where", "~state"]
    run("marks", quiet, "--add", "5", "II", "--note", "no picture", *places)
    run("marks", quiet, "--add", "2.5", "none")
    assert [row.split() for row in run("marks", quiet).stdout.splitlines()] == [
        ["#", "Seconds", "Type", "Observer", "Where", "Note"],
        ["1", "2.5", "none"],
        ["2", "5.0", "II", "/cmd_vel,", "~state", "no", "picture"],
    ]
    said = json.loads(run("marks", quiet, "--json").stdout)
    assert [(mark["note"], mark["where"]) for mark in said] == [
        ("", []),
        ("@/cmd_vel @~state no picture", ["/cmd_vel", "~state"]),
    ]


def test_a_mark_is_added_that_says_when_its_error_began(quiet):
    run("marks", quiet, "--add", "15", "II", "--began", "2.5..5", "--where", "/odom")
    run("marks", quiet, "--add", "16", "I", "--began", "7")
    run("marks", quiet, "--add", "17", "I")
    assert [row.split() for row in run("marks", quiet).stdout.splitlines()] == [
        ["#", "Seconds", "Type", "Observer", "Began", "Where", "Note"],
        ["1", "15.0", "II", "2.5", "-", "5.0", "/odom"],
        ["2", "16.0", "I", "7.0"],
        ["3", "17.0", "I"],
    ]
    said = json.loads(run("marks", quiet, "--json").stdout)
    assert [mark["began"] for mark in said] == [[2.5, 5.0], [7.0, 7.0], None]
    assert said[0]["note"] == "@-12.5..-10 @/odom"


def test_a_note_keeps_its_own_places_with_those_that_are_added(quiet):
    run("marks", quiet, "--add", "5", "II", "--note", "@/odom drifts", "--where", "@/cmd_vel")
    (mark,) = read_marks(quiet.with_name("quiet.bag.marks.csv"))
    assert mark.note == "@/cmd_vel @/odom drifts"


def test_marks_that_cannot_be_written(quiet, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("pytpc.recording.marks_file.write_marks", full)
    one_line(run("marks", quiet, "--add", "1", "I"), "quiet.bag.marks.csv: NOT SAVED")


def test_notes_cannot_steer_the_terminal(quiet):
    quiet.with_name("quiet.bag.marks.csv").write_text(
        f"time_ns,type,observer,note\n{ns(6)},I,[bold]ana,\x1b[2J[red]x\n"
    )
    result = run("marks", quiet)
    assert "[bold]ana" in result.stdout
    assert "\N{REPLACEMENT CHARACTER}[2J[red]x" in result.stdout


def test_a_file_of_marks_is_of_one_recording_and_of_marks(files, quiet, tmp_path):
    _, static = files
    more = tmp_path / "more"
    more.write_text("pupil,mark\nana,1\n")
    one_line(run("rank", quiet, "--static", static, "--marks", more), "more:1: the first line")
    result = run("rank", quiet, quiet, "--static", static, "--marks", more)
    assert result.exit_code == 2
    assert "--marks needs a single RECORDING" in result.output
