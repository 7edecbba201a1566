"""Full names of parameters: told by the nodes, or found by name, value and class."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest
from click.testing import CliRunner
from mission_samples import BagFile, comparison, events, key, line, link_unit
from tpc_file import TpcFile, header, name, report, site

from pytpc.cli.main import main
from pytpc.diagnosis.full_names import with_full_names
from pytpc.ingest.reading import read
from pytpc.recording.faults import unknown_keys
from pytpc.recording.mission import ReadName, Recording, load_recording, save_recording
from pytpc.static.link_unit import ParameterRead, Place
from pytpc.static.static_info import StaticInfo

NODE = "/move_base"
NAMED = ReadName(key(90), NODE, "/move_base/local/radius")


def read_at(lineno: int, source: str, number: int | None = 90) -> ParameterRead:
    return ParameterRead(
        source, "ros::NodeHandle::param", "double", None, "src/node.cpp", lineno, 5, "Node::Node",
        None if number is None else key(number),
    )  # fmt: skip


def static(*comparisons, reads=()):
    return StaticInfo.of([link_unit(comparisons, reads)])


def mission(rows, names=()):
    return Recording("m", events(rows, NODE), (), 0, 10**9, names=tuple(names))


def sources(found: StaticInfo) -> list[str | None]:
    return [one.source for one in found.comparisons.values()]


def test_a_reported_name_replaces_what_is_not_known():
    given = static(comparison(1, "<dynamic>/radius"), reads=[read_at(3, "<dynamic>/radius")])
    found = with_full_names(given, mission([(1, 1, 0, 1, 2)], [NAMED]), {})
    assert sources(found) == ["/move_base/local/radius"]
    # The type of the variable is still found by the name.
    assert found.units[0].parameters[0].name == "/move_base/local/radius"


def test_two_objects_with_names_of_their_own_leave_it_open():
    given = static(comparison(1, "<dynamic>/radius"), reads=[read_at(3, "<dynamic>/radius")])
    other = replace(NAMED, name="/move_base/global/radius")
    assert with_full_names(given, mission([(1, 1, 0, 1, 2)], [NAMED, other]), {}) is given


# The handle came from another link unit: the source has no namespace, the robot has one.
@pytest.mark.parametrize(
    ("source", "told", "expected"),
    [
        ("radius", "/move_base/local/radius", "/move_base/local/radius"),
        ("radius", "/radius", "radius"),
        ("~radius", "/move_base/radius", "~radius"),
        ("/radius", "/radius", "/radius"),
    ],
)
def test_a_name_that_the_node_completes_stays(source, told, expected):
    given = static(comparison(1, source), reads=[read_at(3, source)])
    told_of = mission([(1, 1, 0, 1, 2)], [replace(NAMED, name=told)])
    assert sources(with_full_names(given, told_of, {})) == [expected]


# Nobody reported names. 0.5 was compared; only one of the two radii had that value.
def test_by_value():
    given = static(comparison(1, "<dynamic>/radius"))
    values = {"/move_base/local/radius": 0.3, "/move_base/global/radius": 0.5, "/other/radius": 0.5}
    found = with_full_names(given, mission([(1, 1, 0, 1, 0.5)]), values)
    assert sources(found) == ["/move_base/global/radius"]


def test_the_same_value_twice_is_decided_by_the_class_or_stays_open():
    values = {"/move_base/DWAPlanner/tolerance": 0.1, "/move_base/Trajectory/tolerance": 0.1}
    told = mission([(1, 1, 0, 1, 0.1)])
    of_class = static(comparison(1, "<dynamic>/tolerance", function="dwa::DWAPlanner::isDone"))
    assert sources(with_full_names(of_class, told, values)) == ["/move_base/DWAPlanner/tolerance"]
    neither = static(comparison(1, "<dynamic>/tolerance", function="Latch::isDone"))
    assert with_full_names(neither, told, values) is neither


def test_an_older_name_that_is_not_set_is_left_out():
    new = comparison(1, "~max_vel_trans")
    old = comparison(2, "~max_trans_vel", lineno=new.lineno)
    elsewhere = comparison(3, "~max_trans_vel")
    told = mission([(1, 1, 0, 1, 2), (1, 2, 0, 1, 2), (1, 3, 0, 1, 2)])
    given = static(new, old, elsewhere)
    found = with_full_names(given, told, {"/move_base/max_vel_trans": 0.5})
    assert list(found.comparisons) == [new.key, elsewhere.key]
    # It is known all the same.
    assert not unknown_keys(told.events, found)
    # Without the values of the server, and where neither is set, both stay.
    assert with_full_names(given, told, {}) is given
    assert with_full_names(given, told, {"/move_base/other": 1}) is given


def test_names_in_every_form_of_a_recording(tmp_path):
    bag = tmp_path / "mission.bag"
    with BagFile(bag) as writer:
        writer.log(10, NODE, line(1, 0, 1, 2))
        for _ in range(2):  # nodes say it again and again
            writer.log(11, NODE, f"threshold_name:{key(90)},{NAMED.name}")
        writer.log(12, NODE, f"threshold_name:{key(90)},not a name")
        batch = (
            "#seq:0,count:0,dropped:0,pid:9,steady:1.0\n"
            f"12.0,threshold_name:{key(91)},/move_base/global/radius"
        )
        writer.text(12, "/threshold_information", NODE, batch)
    recording = read(bag)
    assert recording.names == (NAMED, ReadName(key(91), NODE, "/move_base/global/radius"))
    assert [one.what for one in recording.malformed_first] == [
        "KEY,/full/name is expected, column 16"
    ]
    save_recording(recording, tmp_path / "converted")
    assert load_recording(tmp_path / "converted").names == recording.names
    assert read(tmp_path / "converted").names == recording.names


def test_names_in_a_file_of_reports(tmp_path):
    long = "/move_base/" + "l" * 100
    made = TpcFile(header(node=NODE))
    made.system(site(1, key(1)), name(f"{key(90)},{NAMED.name}"), name(f"{key(91)},{long}"),
                name("nonsense"), site(2, key(2)))  # fmt: skip
    made.thread(1, report(1, 1, 0, 0), report(2, 2, 0, 0))
    recording = read(made.write(tmp_path / "x.tpc"))
    assert recording.names == (NAMED, ReadName(key(91), NODE, long))
    assert len(recording.events) == 2
    assert [one.what.partition(" at ")[0] for one in recording.malformed_first] == [
        "KEY,/full/name is expected"
    ]


def test_rank_prints_the_full_name(tmp_path):
    bag = tmp_path / "mission.bag"
    with BagFile(bag) as writer:
        writer.log(9, NODE, f"threshold_name:{key(90)},{NAMED.name}")
        writer.log(10, NODE, line(1, 0, 1, 2))
        writer.log(11, NODE, line(1, 1, 3, 2))
        writer.mark(12, "/mark_action")
    given = static(
        comparison(1, "<dynamic>/radius", source_code="if (v > r) {"),
        reads=[read_at(3, "<dynamic>/radius")],
    )
    path = tmp_path / "static.json"
    path.write_text(json.dumps(given.to_json()))
    done = CliRunner().invoke(main, ["rank", str(bag), "--static", str(path)])
    assert done.exit_code == 0, done.output
    assert "/move_base/local/radius" in done.output
    assert "<dynamic>" not in done.output
    for asked in ("/move_base/local/radius", "radius"):
        done = CliRunner().invoke(
            main, ["suggest", str(bag), asked, "--static", str(path), "--value", "5"]
        )
        assert done.exit_code == 0, done.output
        assert done.output.startswith("/move_base/local/radius = 5:")


def test_the_place_of_a_read_in_another_file_is_not_taken():
    given = static(
        comparison(1, "<dynamic>/radius", param_reads=(Place("src/other.cpp", 3),)),
        reads=[read_at(3, "<dynamic>/radius")],
    )
    assert with_full_names(given, mission([(1, 1, 0, 1, 2)], [NAMED]), {}) is given
