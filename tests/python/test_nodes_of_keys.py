"""A process with several nodes of ROS 2: whose a report is, in every form of a recording."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from mission_samples import comparison, key, link_unit
from ros2_bags import Ros2Bag
from tpc_file import TpcFile, header, name, report, site

from pytpc.api.live_reports import Reports
from pytpc.diagnosis.full_names import with_full_names
from pytpc.diagnosis.results.live import Seen
from pytpc.ingest.decoders import ROS2
from pytpc.ingest.nodes_of_keys import NodesOfKeys
from pytpc.ingest.reading import read
from pytpc.ingest.rosout_line import Named, parse_name
from pytpc.recording.mission import ReadName, Recording, load_recording, save_recording
from pytpc.ros.ros2.marking import encode_string
from pytpc.ros.source import Source
from pytpc.static.link_unit import ParameterRead
from pytpc.static.static_info import StaticInfo

CONTAINER, FRONT, REAR = "/cell/container", "/cell/front", "/cell/rear"
FIRST, SECOND, OTHER = key(1), f"{key(1)}#2", key(2)
HEAD = f"#seq:0,count:3,dropped:0,pid:7,steady:1.0,node:{CONTAINER}\n"
# The reports of the first object are of FRONT, those of the second one of REAR. Nobody has said
# whose the third one is: it stays the container's. The summary is REAR's.
BATCH = (
    HEAD + f"5.0,{FIRST},1,cmp:2,thresh:1,res:1\n"
    f"6.0,{SECOND},1,cmp:2,thresh:1,res:1\n"
    f"7.0,{OTHER},1,cmp:2,thresh:1,res:1\n"
    f"@6.0;8.0\n~{SECOND},0,1,2,7\n"
    f"8.0,threshold_name:{FIRST},node:{FRONT}\n"
    f"8.0,threshold_name:{SECOND},node:{REAR}\n"
    f"8.0,threshold_dropped:{SECOND},count:4,flops:1,why:site\n"
    f"8.0,threshold_name:{key(90)},{FRONT}/limits.low\n"
    f"8.0,threshold_name:{key(90)},{REAR}/limits.low"
)


def nodes(recording: Recording) -> dict[str, set[str]]:
    return {key: set(found) for key, found in recording.nodes_of.items()}


OWN = {FIRST: {FRONT}, SECOND: {REAR}, OTHER: {CONTAINER}}


def bag(folder: Path) -> Path:
    with Ros2Bag(folder / "mission", "mcap") as writer:
        writer.text(9, "/threshold_information", BATCH)
    return folder / "mission"


def file(path: Path) -> Path:
    made = TpcFile(header(node=CONTAINER))
    made.system(site(1, FIRST), site(2, SECOND), site(3, OTHER),
                name(f"{FIRST},node:{FRONT}"), name(f"{SECOND},node:{REAR}"))  # fmt: skip
    made.thread(1, report(1, 1, 0, 0), report(2, 2, 0, 0), report(3, 3, 0, 0))
    return made.write(path)


def test_a_bag_has_the_node_of_each_report(tmp_path):
    recording = read(bag(tmp_path))
    assert nodes(recording) == OWN
    assert [one.node for one in recording.dropped] == [REAR]
    # The process has told them.
    assert recording.names == (
        ReadName(key(90), CONTAINER, f"{FRONT}/limits.low"),
        ReadName(key(90), CONTAINER, f"{REAR}/limits.low"),
    )
    assert recording.malformed == 0
    save_recording(recording, tmp_path / "converted")
    for again in (load_recording(tmp_path / "converted"), read(tmp_path / "converted")):
        assert nodes(again) == OWN


def test_a_file_of_reports_has_the_node_of_each_report(tmp_path):
    assert nodes(read(file(tmp_path / "x.tpc"))) == OWN


# In messages of their own on /rosout, the logger is the node; the file names the process alone.
# Each report is counted once all the same.
def test_the_same_reports_by_two_ways_are_found(tmp_path):
    here = tmp_path / "both"
    here.mkdir()
    path = file(here / "x.tpc")
    alone = read(path)
    # The file's times are of its own clocks.
    with Ros2Bag(here / "bag", "mcap") as writer:
        for row, node in enumerate((FRONT, REAR, CONTAINER)):
            events = alone.events
            cmp, thresh = events.cmp[row], events.thresh[row]
            key_of_row = events.keys[events.key[row]]
            writer.log(
                events.time_ns[row] / 1e9,
                node,
                f"threshold_information:{key_of_row},{events.result[row]:d},"
                f"cmp:{cmp:g},thresh:{thresh:g},res:{events.res[row]:d}",
            )
    recording = read(here)
    assert nodes(recording) == OWN
    assert len(recording.events) == 3


# Another process of the same name had its objects in another order.
def test_what_two_processes_say_differently_is_not_believed(tmp_path):
    with Ros2Bag(tmp_path / "mission", "mcap") as writer:
        writer.text(9, "/threshold_information", BATCH)
        other = f"9.0,threshold_name:{SECOND},node:{FRONT}"
        writer.text(10, "/threshold_information", HEAD.replace("count:3", "count:0") + other)
    assert nodes(read(tmp_path / "mission")) == OWN | {SECOND: {CONTAINER}}


def test_a_listener_hears_the_node_with_the_first_report():
    reports = Reports(ROS2)
    source = Source("/threshold_information", "", "std_msgs/msg/String", "", "")
    items = reports.read(source, encode_string(BATCH), 0.0)
    assert [item.node for item in items] == [FRONT, REAR, CONTAINER, REAR, CONTAINER, CONTAINER]
    # The next batch need not say it again.
    again = f"{HEAD}9.0,{SECOND},0,cmp:0,thresh:1,res:0"
    seen = Seen(9_000_000_000, SECOND, REAR, False, 0.0, 1.0, False)
    assert reports.read(source, encode_string(again), 0.0) == [seen]


def test_each_node_has_its_parameter(tmp_path):
    read_at = ParameterRead(
        "limits.low", "rclcpp::Node::get_parameter", "double", None, "src/node.cpp", 3, 5,
        "Node::Node", key(90),
    )  # fmt: skip
    static = StaticInfo.of([link_unit([comparison(1, "limits.low")], [read_at])])
    # No line says which object has read or compared: the node says enough.
    found = with_full_names(static, read(bag(tmp_path)), {})
    sources = {one.key: one.source for one in found.comparisons.values()}
    assert sources == {FIRST: f"{FRONT}/limits.low", SECOND: f"{REAR}/limits.low"}


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        (f"{SECOND},node:{REAR}", Named(SECOND, "", 0, REAR)),
        (f"{FIRST},{REAR}/x.y,of:3", Named(FIRST, f"{REAR}/x.y", 3)),
        (f"{FIRST},node:rear", None),
        (f"{FIRST},node:{REAR},of:3", None),
        (FIRST, None),
    ],
)
def test_lines_about_names(text, wanted):
    found = parse_name(text)
    assert found == wanted if wanted else not isinstance(found, Named)


# Rows (key, node): (0, 0) moves to 2; (1, 0) and (0, 1) stay.
def test_columns_of_codes():
    moves = NodesOfKeys({(0, 0): 2}, 3)
    column = moves.of(np.array([0, 1, 0], np.int32), np.array([0, 0, 1], np.int32))
    assert column.tolist() == [2, 0, 1]
    assert (moves.of_pair((0, 0)), moves.of_pair((1, 0))) == ((0, 2), (1, 0))
