"""What is exported of a mission, and each format read back by its own reader."""

from __future__ import annotations

import csv
import json
import math
import re
import shutil
from collections import defaultdict
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner, Result
from export_samples import HOSTILE, NODE, exported, mission
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from mission_samples import ns
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

from pytpc.cli.main import main
from pytpc.diagnosis.results.exported import MissionExport
from pytpc.present.viewers.flat_tables import TABLES, write_tables
from pytpc.present.viewers.layouts import foxglove_layout, plotjuggler_layout
from pytpc.present.viewers.mcap_export import write_mcap
from pytpc.recording.marks import Mark, write_marks

LIMIT = "/tpc/arm/guard/limit/node_cpp_10"
NEAR = "/tpc/arm/guard/near/node_cpp_11"
USED = "/tpc/arm/guard/used/node_cpp_12"
# time, topic, value, threshold, margin, result, flop, evaluations; worked out in export_samples.
# The summary at 3.5 s has the first evaluation of ~near, too.
EVALUATIONS = [
    (1.0, LIMIT, 4.0, 3.0, 1.0, True, False, 1),
    (2.0, LIMIT, 2.0, 3.0, -1.0, False, True, 1),
    (2.5, NEAR, 5.0, 8.0, 1.5, True, False, 0),
    (3.0, USED, 1.0, 1.0, None, True, False, 1),
    (3.5, NEAR, 9.0, 8.0, -0.5, False, True, 7),
    (4.0, LIMIT, 4.0, 3.5, 0.5, True, True, 1),
]


def told(margin: float) -> float | None:
    return None if math.isnan(margin) else margin


@pytest.mark.parametrize("size", [1, 2, 100])
def test_evaluations_and_summaries_come_in_order_of_time(size: int) -> None:
    found = exported()
    rows = [
        (time / 1e9, found.series[number].topic, value, thresh, told(margin), result, flop, count)
        for part in found.rows(size)
        for time, number, value, thresh, margin, result, _, flop, count in zip(
            *(column.tolist() for column in part), strict=True
        )
    ]
    assert rows == EVALUATIONS
    assert found.count == 6
    assert [one.unit for one in found.series] == ["parameter", "parameter", ""]


# ~limit is 3 and later 3.5; ~near is half its threshold of 8.
def test_the_values_of_parameters_are_those_of_their_thresholds() -> None:
    values = [(one.time_ns, one.parameter, one.number) for one in exported().values]
    assert values == [
        (ns(1.0), "~limit", 3.0),
        (ns(4.0), "~limit", 3.5),
        (ns(2.5), "~near", 4.0),
        (ns(3.0), "~used", 1.0),
    ]


# /other reports the threshold 6, and the guard only a summary with 8.
def test_the_values_of_a_node_with_summaries_alone_are_its_own() -> None:
    recording = mission((1.5, 1, True, 5.0, 6.0, "/other"))
    events = recording.events.take(recording.events.node == recording.events.nodes.index("/other"))
    both = replace(recording, events=replace(events, nodes=("/other",), node=events.node * 0))
    values = [(one.node, one.time_ns, one.number) for one in exported(both).values]
    assert sorted(values) == [(NODE, ns(3.5), 4.0), ("/other", ns(1.5), 3.0)]


# Under `light`, ~near turns at 2.9 s and 3.1 s: two reports of their own, which its summary of 7
# evaluations has among its flops; then two reports and 5 others are 7. With 3 flops, one is untold.
@pytest.mark.parametrize(("flops", "is_untold"), [(2, False), (3, True)])
def test_what_a_summary_has_counts_once(flops: int, is_untold: bool) -> None:
    recording = mission((2.9, 1, False, 9.0, 8.0, NODE), (3.1, 1, True, 5.0, 8.0, NODE))
    many = replace(recording.summaries, flops=np.array([flops]))
    found = exported(replace(recording, summaries=many))
    near = [one.topic for one in found.series].index(NEAR)
    (rows,) = found.rows(100)
    own = rows.series == near
    # The first one, at 2.5 s, was 0.1 s before the summary began, so that it may be in it.
    assert rows.time_ns[own].tolist() == [ns(2.5), ns(2.9), ns(3.1), ns(3.5)]
    assert rows.evaluations[own].tolist() == [0, 0, 0, 7]
    assert rows.flop[own].tolist() == [False, True, True, is_untold]


def test_each_mark_is_judged_by_those_up_to_it() -> None:
    found = exported()
    assert [(one.time_ns, one.mark) for one in found.suspects] == [(ns(4.5), 1), (ns(5.0), 2)]
    assert all(
        sum(one.probability for one in at.suspects) + at.none == pytest.approx(1.0)
        for at in found.suspects
    )
    kinds = [line.kind for line in found.log]
    assert kinds.count("mark") == 2
    assert kinds.count("verdict") == 2


# Both nodes run the same program; only the guard's ~limit turned.
@pytest.mark.parametrize("is_marked", [True, False])
def test_layouts_show_the_node_that_turned(is_marked: bool) -> None:
    recording = mission(
        (1.5, 0, True, 4.0, 3.0, "/arm/afar"), (4.1, 0, True, 4.0, 3.0, "/arm/afar")
    )
    found = exported(recording if is_marked else replace(recording, marks=()))
    shown = [found.series[number] for number in found.first]
    assert [one.node for one in shown if one.parameter == "~limit"] == [NODE]


def messages_of(path: Path) -> dict[str, list[tuple[float, Any]]]:
    found = defaultdict(list)
    with path.open("rb") as stream:
        reader = make_reader(stream, decoder_factories=[DecoderFactory()])
        for _, channel, message, decoded in reader.iter_decoded_messages():
            assert message.publish_time == message.log_time
            found[channel.topic].append((message.log_time / 1e9, decoded))
    return found


@pytest.fixture
def mcap(tmp_path: Path) -> Path:
    write_mcap(exported(), tmp_path / "mission.mcap")
    return tmp_path / "mission.mcap"


def test_mcaps_own_reader_reads_it(mcap: Path) -> None:
    found = messages_of(mcap)
    rows = sorted(
        (time, topic, m.value, m.threshold, told(m.margin), m.result, m.flop, m.evaluations)
        for topic in (LIMIT, NEAR, USED)
        for time, m in found[topic]
    )
    assert rows == EVALUATIONS
    assert [(time, m.type, m.observer, m.note) for time, m in found["/tpc/marks"]] == [
        (4.5, 1, "ann", "=SUM(A1)"),
        (5.0, 2, "", ""),
    ]
    (_, first), (_, last) = found["/tpc/suspects"]
    assert (first.mark, last.mark) == (1, 2)
    likeliest = last.suspects[0]
    (name,) = [topic for topic in found if topic.startswith("/tpc/probabilities/limit")]
    assert likeliest.parameter == "~limit"
    assert found[name][-1][1].probability == likeliest.probability
    assert [(time, m.value) for time, m in found["/tpc/arm/guard/limit/parameter"]] == [
        (1.0, 3.0),
        (4.0, 3.5),
    ]


def test_the_ranks_are_those_of_each_period(mcap: Path) -> None:
    times = [time for time, _ in messages_of(mcap)["/tpc/ranks/limit"]]
    assert times == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]


# Both are written by a part of their own; the file's reader and the table must agree on each.
def test_ranks_in_the_file_are_those_of_the_table(mcap: Path, tmp_path: Path) -> None:
    write_tables(exported(), tmp_path, "parquet")
    rows = pq.read_table(tmp_path / "ranks.parquet").to_pylist()
    table = {(r["time_ns"] / 1e9, r["parameter"]): [r["rank1"], r["rank2"]] for r in rows}
    ranks = exported().ranks
    assert len(rows) == ranks.combined.size > 0
    for time, message in messages_of(mcap)["/tpc/ranks/limit"]:
        assert [message.type1, message.type2] == table[time, "~limit"]
    column = ranks.parameters.index("~limit")
    assert [table[t / 1e9, "~limit"] for t in ranks.times_ns.tolist()] == [
        [float(one[row, column]) for one in (ranks.rank1, ranks.rank2)]
        for row in range(ranks.times_ns.size)
    ]


def test_rosbags_reads_it_by_the_definitions_in_it(mcap: Path) -> None:
    with AnyReader([mcap], default_typestore=get_typestore(Stores.EMPTY)) as reader:
        connections = [one for one in reader.connections if one.topic == LIMIT]
        values = [
            reader.deserialize(data, connection.msgtype).value
            for connection, _, data in reader.messages(connections)
        ]
    assert values == [4.0, 2.0, 4.0]


def test_the_file_says_what_each_topic_is(mcap: Path) -> None:
    with mcap.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    about = {one.topic: one.metadata for one in summary.channels.values()}
    assert about[NEAR]["node"] == NODE
    assert about[NEAR]["parameter"] == "~near"
    assert about[NEAR]["place"] == "src/node.cpp:11"
    assert about[NEAR]["margin_unit"] == "parameter"
    assert summary.statistics is not None
    assert summary.statistics.message_start_time == ns(1.0)


def fields_of(path: Path) -> dict[str, set[str]]:
    return {topic: set(found[0][1].__slots__) for topic, found in messages_of(path).items()}


def test_all_that_the_foxglove_layout_names_is_in_the_file(mcap: Path) -> None:
    layout = foxglove_layout(exported())
    fields = fields_of(mcap)
    text = json.dumps(layout)
    named = re.findall(r'"(?:value|topicPath)": "(/tpc[^"]*)"', text)
    assert len(named) >= 8
    for path in named:
        topic, _, field = path.partition(".")
        assert field in fields[topic], path
    assert layout["configById"]["RosOut!log"]["topicToRender"] in fields
    assert set(re.findall(r"[A-Za-z]+![a-z0-9]+", json.dumps(layout["layout"]))) == set(
        layout["configById"]
    )


def test_all_that_the_plotjuggler_layout_names_is_in_the_file(mcap: Path) -> None:
    root = plotjuggler_layout(exported(), mcap.parent / "layouts/mission.xml", mcap)
    fields = fields_of(mcap)
    curves = [str(one.get("name")) for one in root.iter("curve")]
    assert f"{LIMIT}/value" in curves
    assert f"{LIMIT}/threshold" in curves
    for curve in curves:
        topic, _, field = curve.rpartition("/")
        assert field in fields[topic], curve
    file = root.find("previouslyLoaded_Datafiles/fileInfo")
    assert file is not None
    assert file.get("filename") == "../mission.mcap"
    parameters = file.find("plugin/parameters")
    assert parameters is not None
    assert set(str(parameters.get("selected_topics")).split(";")) <= set(fields)
    # What is plotted is in the range that is shown, relative to the first time of the file.
    (limit,) = [one for one in root.iter("DockArea") if "~limit" in str(one.get("name"))][:1]
    shown = limit.find("plot/range")
    assert shown is not None
    assert float(str(shown.get("bottom"))) < 2.0
    assert float(str(shown.get("top"))) > 4.0
    assert float(str(shown.get("right"))) == 5.0


# pandas reads it: the names, and the numbers of the rows above.
def test_tables_as_parquet(tmp_path: Path) -> None:
    write_tables(exported(), tmp_path, "parquet")
    assert sorted(one.name for one in tmp_path.iterdir()) == sorted(
        f"{name}.parquet" for name in TABLES
    )
    rows = pq.read_table(tmp_path / "evaluations.parquet").to_pylist()
    assert [(r["time_ns"] / 1e9, r["value"], told(r["margin"])) for r in rows] == [
        (time, value, margin) for time, _, value, _, margin, *_ in EVALUATIONS
    ]
    assert [r["seconds"] for r in rows] == [0.0, 1.0, 1.5, 2.0, 2.5, 3.0]
    assert rows[4]["evaluations"] == 7
    assert rows[0]["parameter"] == "~limit"
    suspects = pq.read_table(tmp_path / "suspects.parquet").to_pylist()
    assert {one["mark"] for one in suspects} == {1, 2}


# A spreadsheet works out what begins with an equals sign; a number stays one.
def test_tables_as_csv_run_no_formula(tmp_path: Path) -> None:
    write_tables(exported(), tmp_path, "csv")
    with (tmp_path / "marks.csv").open(newline="") as stream:
        assert [one["note"] for one in csv.DictReader(stream)] == ["'=SUM(A1)", ""]
    with (tmp_path / "evaluations.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [float(one["value"]) for one in rows] == [4.0, 2.0, 5.0, 1.0, 9.0, 4.0]
    assert rows[1]["margin"] == "-1"
    assert rows[0]["relation"] == ">"


def hostile() -> MissionExport:
    return exported(
        mission((5.5, 0, True, 4.0, 3.0, HOSTILE), (5.6, 0, True, 4.0, 3.0, f"{HOSTILE}!"))
    )


def test_hostile_names_are_legal_and_do_not_meet(tmp_path: Path) -> None:
    found = hostile()
    write_mcap(found, tmp_path / "mission.mcap")
    topics = set(messages_of(tmp_path / "mission.mcap"))
    script = [one for one in topics if "script" in one and "limit/node" in one]
    assert len(script) == 2
    assert all(re.fullmatch(r"[A-Za-z0-9_/]+", one) for one in topics)
    write_tables(found, tmp_path / "csv", "csv")
    write_tables(found, tmp_path / "parquet", "parquet")
    root = plotjuggler_layout(found, tmp_path / "x.xml", None)
    again = ElementTree.fromstring(ElementTree.tostring(root))
    assert "\n" not in "".join(str(one.get("name")) for one in again.iter("DockArea"))
    assert json.loads(json.dumps(foxglove_layout(found)))


def test_a_mission_without_marks_and_reports_of_known_comparisons(tmp_path: Path) -> None:
    recording = mission()
    found = exported(replace(recording, marks=(), events=recording.events.take(slice(0, 0))))
    assert found.suspects == ()
    assert found.count == 1
    write_mcap(found, tmp_path / "mission.mcap")
    assert len(messages_of(tmp_path / "mission.mcap")[NEAR]) == 1


def asked(*words: str) -> Result:
    return CliRunner().invoke(main, list(words))


EXAMPLE = Path(__file__).parents[2] / "examples/recorded_mission"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([EXAMPLE / "static.json", "--mcap", "x"], "is static information, for --sarif and --html"),
        ([EXAMPLE, "--html", "x"], "is a recording, for --mcap, --foxglove"),
        ([EXAMPLE, "--html", "x", "--csv", "y"], "--csv is for a recording"),
        ([EXAMPLE, "--csv", "x", "--package", "y"], "--package is for static information"),
        ([EXAMPLE / "static.json", "--html", "x", "--period", "2"], "--period is for recordings"),
        ([EXAMPLE, EXAMPLE, "--csv", "x"], "give one recording as SOURCE for --csv"),
    ],
)
def test_what_does_not_fit_the_source_is_refused(words: list[object], said: str) -> None:
    ran = asked("export", *map(str, words))
    assert ran.exit_code == 2
    assert said in " ".join(ran.stderr.split())


def test_the_command_writes_several_at_once(tmp_path: Path) -> None:
    outputs = {
        "--mcap": tmp_path / "m.mcap",
        "--foxglove": tmp_path / "m.json",
        "--plotjuggler": tmp_path / "m.xml",
        "--csv": tmp_path / "csv",
    }
    words = [str(word) for pair in outputs.items() for word in pair]
    ran = asked("export", str(EXAMPLE), "--json", *words)
    assert ran.exit_code == 0, ran.stderr
    document = json.loads(ran.stdout)
    assert document["rows"] == 12797
    assert document["marks"] == 5
    assert document["outputs"] == {name.lstrip("-"): str(path) for name, path in outputs.items()}
    assert all(path.exists() for path in outputs.values())


# The mission's own folder, its marks, and the marks of another mission stay as they are.
@pytest.mark.parametrize(
    ("words", "status", "said"),
    [
        (["--mcap", "."], 1, ".: it is a folder; give --mcap the path of a file"),
        (["--mcap", "day/m.mcap"], 1, "day/m.mcap: --mcap would write into the recording"),
        (["--csv", "day"], 1, "day/evaluations.csv: --csv would write into the recording"),
        (["--csv", "link"], 1, "link/evaluations.csv: --csv would write into the recording"),
        (["--csv", "other"], 1, "other/marks.csv: --csv would write into the recording"),
        (["--marks", "more.csv", "--rerun", "more.csv"], 1, "more.csv: --rerun would write into"),
        (["--mcap", "x", "--foxglove", "./x"], 2, "--mcap and --foxglove name the same file: x"),
    ],
)
def test_what_is_read_and_marks_are_not_replaced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, words: list[str], status: int, said: str
) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copytree(EXAMPLE, "day")
    Path("link").symlink_to("day")
    Path("other").mkdir()
    for path in (Path("other/marks.csv"), Path("more.csv")):
        write_marks([Mark(ns(1.0), "I")], path)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    ran = asked("export", "day", *words)
    assert ran.exit_code == status, ran.output
    assert said in " ".join(ran.stderr.split())
    assert before == {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}


def test_a_recording_that_is_a_file_is_not_replaced(tmp_path: Path) -> None:
    source = tmp_path / "mission.mcap"
    write_mcap(exported(), source)
    before = source.read_bytes()
    ran = asked("export", str(source), "--mcap", str(source), "--static", str(EXAMPLE))
    assert ran.exit_code == 1
    assert "--mcap would write into the recording" in ran.stderr
    assert source.read_bytes() == before


def test_both_kinds_of_tables_may_share_a_folder(tmp_path: Path) -> None:
    ran = asked("export", str(EXAMPLE), "--csv", str(tmp_path), "--parquet", str(tmp_path))
    assert ran.exit_code == 0, ran.stderr
    assert len(list(tmp_path.iterdir())) == 2 * len(TABLES)
