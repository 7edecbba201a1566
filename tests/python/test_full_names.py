"""Full names of parameters: told by the nodes, or found by name, value and class."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner
from mission_samples import BagFile, comparison, events, key, line, link_unit
from tpc_file import TpcFile, header, name, report, site

from pytpc.cli.main import main
from pytpc.diagnosis.full_names import with_full_names, with_keys_of
from pytpc.diagnosis.thresholds.units import read_type
from pytpc.ingest.reading import read
from pytpc.recording.events import Events
from pytpc.recording.faults import unknown_keys
from pytpc.recording.mission import ReadName, Recording, load_recording, save_recording
from pytpc.static.explanations import look_up
from pytpc.static.link_unit import ParameterRead, Place
from pytpc.static.parameters import same_parameter
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


# A layer reads it with the handle of the costmap, and its buffer with that of the layer.
def test_names_that_mean_the_same_parameters_become_one():
    far, near = "~<dynamic>/<dynamic>/height", "~<dynamic>/height"
    given = static(
        comparison(1, far), comparison(2, near), comparison(3, "~<dynamic>/width"),
        reads=[read_at(3, far), read_at(4, near)],
    )  # fmt: skip
    values = {f"/move_base/{one}/layer/height": 2.0 for one in ("global", "local")}
    rows = [(t, n, 0, 1, 2) for t in (1, 2) for n in (1, 2, 3)]
    found = with_full_names(given, mission(rows), {**values, "/move_base/local/width": 3.0})
    assert sources(found)[0] == sources(found)[1]
    assert {read.name for read in found.units[0].parameters} == {sources(found)[0]}
    # Nothing is known of the parameters without the server.
    assert with_full_names(given, mission(rows), {}) is given


def test_two_objects_with_names_of_their_own_leave_it_open():
    given = static(comparison(1, "<dynamic>/radius"), reads=[read_at(3, "<dynamic>/radius")])
    other = replace(NAMED, name="/move_base/global/radius")
    assert with_full_names(given, mission([(1, 1, 0, 1, 2)], [NAMED, other]), {}) is given


@pytest.mark.parametrize(
    "api", ["rclpy.node.Node.declare_parameter", "rclcpp::Node::get_parameter"]
)
@pytest.mark.parametrize("said", [[], [replace(NAMED, name=f"{NODE}/radius")]])
def test_a_parameter_of_ros2_is_the_nodes_own(api, said):
    read = replace(read_at(3, "radius"), api=api)
    given = static(comparison(1, "radius"), reads=[read])
    found = with_full_names(given, mission([(1, 1, 0, 1, 2)], said), {})
    assert sources(found) == [f"{NODE}/radius"]
    assert with_full_names(found, mission([(1, 1, 0, 1, 2)], said), {}) is found
    # If nothing has evaluated it, its node is not known.
    assert sources(with_full_names(given, mission([], said[:0]), {})) == ["~radius"]
    # In ROS 1 it is one of the node's namespace.
    old = static(comparison(1, "radius"), reads=[read_at(3, "radius")])
    assert sources(with_full_names(old, mission([(1, 1, 0, 1, 2)]), {})) == ["radius"]


# Two processes run one program, and so have one suspect; two nodes of one process have two.
@pytest.mark.parametrize("is_told", [False, True])
def test_nodes_of_ros2_are_told_apart_where_their_comparisons_are(is_told):
    read = replace(read_at(3, "radius"), api="rclpy.node.Node.get_parameter")
    given = static(comparison(1, "radius"), reads=[read])
    nodes = "/robot1/guard", "/robot2/guard"
    for keys, expected in (
        ((key(1), key(1)), ["~radius"]),
        ((key(1), f"{key(1)}#2"), [f"{node}/radius" for node in nodes]),
    ):
        table = Events(
            np.array([1, 2], np.int64), np.array([0, len(set(keys)) - 1], np.int32),
            np.array([True, True]), np.array([3.0, 3.0]), np.array([2.0, 2.0]),
            np.array([True, True]), np.array([0, 1], np.int32), tuple(sorted(set(keys))), nodes,
        )  # fmt: skip
        names = tuple(ReadName(key(90), node, f"{node}/radius") for node in nodes)
        told = Recording("m", table, (), 0, 10**9, names=names if is_told else ())
        assert sources(with_full_names(given, told, {})) == expected


LOCAL, GLOBAL = "/move_base/local/radius", "/move_base/global/radius"


def instance(number, of):
    """The key of another object's evaluations."""
    return f"{key(number)}#{of}"


def rows_of(*keys):
    """Two evaluations under each key, as a table of events."""
    return Events.of(
        time_ns=np.arange(2 * len(keys)),
        key=np.repeat(np.arange(len(keys)), 2),
        result=np.tile([False, True], len(keys)),
        cmp=np.ones(2 * len(keys)),
        thresh=np.full(2 * len(keys), 2.0),
        res=np.tile([False, True], len(keys)),
        node=np.zeros(2 * len(keys), np.int32),
        keys=keys,
        nodes=(NODE,),
    )


def two_objects(*names):
    """Objects 7 and 5 evaluate comparison 1; what was told besides that."""
    return Recording(
        "m",
        rows_of(key(1), instance(1, 2)),
        (),
        0,
        10**9,
        names=(ReadName(key(1), NODE, "", 7), ReadName(instance(1, 2), NODE, "", 5), *names),
    )


# Object 7 has read the local radius, object 5 the global one.
def test_two_objects_have_the_names_that_each_has_read():
    given = static(comparison(1, "<dynamic>/radius"), reads=[read_at(3, "<dynamic>/radius")])
    told = two_objects(
        ReadName(key(90), NODE, LOCAL),
        ReadName(key(90), NODE, GLOBAL),
        ReadName(key(90), NODE, LOCAL, 7),
        ReadName(key(90), NODE, GLOBAL, 5),
    )
    found = with_full_names(given, told, {})
    assert {one: found.comparisons[one].source for one in found.comparisons} == {
        key(1): LOCAL,
        instance(1, 2): GLOBAL,
    }
    # What the source says of a comparison holds for both of its objects.
    assert found.comparisons[instance(1, 2)] == replace(
        given.comparisons[key(1)], key=instance(1, 2), source=GLOBAL
    )
    assert [read.name for read in found.units[0].parameters] == [GLOBAL, LOCAL]
    assert not unknown_keys(told.events, found)
    assert found.unit_of(instance(1, 2)).link_unit == given.units[0].link_unit
    # What has its names already stays.
    assert with_full_names(found, told, {}) is found
    # A user who copies the key of an instance gets what the source says.
    assert [one.comparison.key for one in look_up(given, instance(1, 2)).comparisons] == [key(1)]


# Both names are known, but not whose they are; then the number tells the objects apart.
def test_two_objects_without_names_have_numbers():
    given = static(
        comparison(1, "<dynamic>/radius"),
        comparison(2, "~patience"),
        comparison(3, "<dynamic>/tolerance"),
        reads=[read_at(3, "<dynamic>/radius")],
    )
    keys = (key(1), instance(1, 2), instance(1, 0), instance(2, 2), instance(1, 10))
    names = (ReadName(key(90), NODE, LOCAL), ReadName(key(90), NODE, GLOBAL))
    told = Recording("m", rows_of(*keys), (), 0, 10**9, names=names)
    found = with_full_names(given, told, {}).comparisons
    assert {one: found[one].source for one in found} == {
        key(1): "<dynamic>/radius",
        instance(1, 0): "<dynamic>/radius (further objects)",
        instance(1, 2): "<dynamic>/radius (object 2)",
        instance(1, 10): "<dynamic>/radius (object 10)",
        key(2): "~patience",
        instance(2, 2): "~patience",
        key(3): "<dynamic>/tolerance",
    }
    assert read_type(found[instance(1, 2)], given.units[0]) == "double"
    again = with_full_names(with_full_names(given, told, {}), told, {}).comparisons
    assert again == found
    assert same_parameter("radius", "<dynamic>/radius (object 2)")
    assert same_parameter("/move_base/local/radius", "<dynamic>/radius (further objects)")


# In the good run the global object compared first, so the keys are the other way round, and a third
# object has the number that is free in the mission.
# Only of object 7 it is known which name it has read; the read has that name then.
@pytest.mark.parametrize("source", ["<dynamic>/radius", "<dynamic>"])
def test_the_type_of_a_read_is_found_under_any_name(source):
    given = static(comparison(1, source), reads=[read_at(3, source)])
    names = [ReadName(key(90), NODE, name) for name in (LOCAL, GLOBAL)]
    told = replace(
        mission([], [*names, ReadName(key(90), NODE, LOCAL, 7), ReadName(key(1), NODE, "", 7)]),
        events=rows_of(key(1), instance(1, 2)),
    )
    (unit,) = with_full_names(given, told, {}).units
    assert [one.source for one in unit.comparisons] == [LOCAL, f"{source} (object 2)"]
    assert [read_type(one, unit) for one in unit.comparisons] == ["double", "double"]


@pytest.mark.parametrize("end", ["#b", "#", "#2#", "# 2", "#-1", "#1.5"])
def test_a_key_of_another_form_is_no_instance(end):
    given = static(comparison(1, "<dynamic>/radius"), reads=[read_at(3, "<dynamic>/radius")])
    told = replace(mission([]), events=rows_of(key(1), f"{key(1)}{end}"))
    assert with_full_names(given, told, {}) is given


def test_the_objects_of_a_good_run_get_the_keys_of_the_mission():
    given = static(comparison(1, "<dynamic>/radius"), reads=[read_at(3, "<dynamic>/radius")])
    read = (
        ReadName(key(90), NODE, LOCAL),
        ReadName(key(90), NODE, GLOBAL),
        ReadName(key(90), NODE, LOCAL, 7),
        ReadName(key(90), NODE, GLOBAL, 5),
    )
    told = two_objects(*read)
    good = Recording(
        "good",
        rows_of(key(1), instance(1, 2), instance(1, 3)),
        (),
        0,
        10**9,
        names=(*read, ReadName(key(1), NODE, "", 5), ReadName(instance(1, 2), NODE, "", 7)),
    )
    named = with_full_names(given, told, {})
    found = with_keys_of(good, given, named)
    assert found.events.keys == (instance(1, 2), key(1), instance(1, 3))
    assert found.events.key.tolist() == good.events.key.tolist()
    # Commands that share a question ask for it several times.
    assert with_keys_of(found, given, named) is found
    # The same order in both runs, and runs without instances, stay as they are.
    assert with_keys_of(told, given, named) is told
    plain = Recording("plain", rows_of(key(1)), (), 0, 1)
    assert with_keys_of(plain, given, given) is plain


# The mission's only object read the global radius; in the good run that was the second one. The
# first one makes room.
def test_an_object_that_only_the_good_run_has_gives_way():
    given = static(comparison(1, "<dynamic>/radius"), reads=[read_at(3, "<dynamic>/radius")])
    one = Recording("m", rows_of(key(1)), (), 0, 1, names=(ReadName(key(90), NODE, GLOBAL),))
    good = two_objects(
        ReadName(key(90), NODE, LOCAL),
        ReadName(key(90), NODE, GLOBAL),
        ReadName(key(90), NODE, LOCAL, 7),
        ReadName(key(90), NODE, GLOBAL, 5),
    )
    found = with_keys_of(good, given, with_full_names(given, one, {}))
    assert found.events.keys == (instance(1, 3), key(1))


# The second object compares 0.5, and one radius of the server has that value.
def test_the_value_tells_which_parameter_an_object_has():
    table = rows_of(key(1), instance(1, 2))
    table = replace(table, thresh=np.array([0.3, 0.3, 0.5, 0.5]))
    given = static(comparison(1, "<dynamic>/radius"))
    found = with_full_names(given, Recording("m", table, (), 0, 1), {LOCAL: 0.3, GLOBAL: 0.5})
    assert sources(found) == [LOCAL, GLOBAL]


# A parameter that one object reads is not an older name of what the other one reads.
def test_an_unset_parameter_of_one_object_stays():
    given = static(comparison(1, "<dynamic>/radius"), reads=[read_at(3, "<dynamic>/radius")])
    told = two_objects(
        ReadName(key(90), NODE, LOCAL),
        ReadName(key(90), NODE, GLOBAL),
        ReadName(key(90), NODE, LOCAL, 7),
        ReadName(key(90), NODE, GLOBAL, 5),
    )
    assert sources(with_full_names(given, told, {LOCAL: 2.0})) == [LOCAL, GLOBAL]


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


# The second object's evaluations have a key of their own in every form of a report.
def test_objects_in_every_form_of_a_recording(tmp_path):
    second = instance(1, 2)
    bag = tmp_path / "mission.bag"
    with BagFile(bag) as writer:
        writer.log(10, NODE, line(1, 0, 1, 2))
        writer.log(11, NODE, f"threshold_information:{second},1,cmp:3,thresh:2,res:1")
        writer.log(12, NODE, f"threshold_name:{second},of:5")
        writer.log(12, NODE, f"threshold_name:{key(90)},{LOCAL},of:5")
        writer.log(12, NODE, f"threshold_name:{key(90)}")
        batch = (
            "#seq:0,count:1,dropped:0,pid:9,steady:1.0\n"
            f"13.0,{second},0,cmp:1,thresh:2,res:0\n"
            f"@12.0;13.0\n~{second},0,1,2,7\n"
            f"13.0,threshold_name:{key(90)},{GLOBAL},of:7"
        )
        writer.text(13, "/threshold_information", NODE, batch)
    recording = read(bag)
    names = (
        ReadName(key(90), NODE, GLOBAL, 7),
        ReadName(key(90), NODE, LOCAL, 5),
        ReadName(second, NODE, "", 5),
    )
    assert recording.names == tuple(sorted(names))
    assert [one.what for one in recording.malformed_first] == [
        "KEY,/full/name is expected, column 16"
    ]
    events = recording.events
    assert [events.keys[code] for code in events.key] == [key(1), second, second]
    # The outcome of the first object is none of the second's.
    assert events.flop.tolist() == [False, False, True]
    summaries = recording.summaries
    assert [summaries.keys[code] for code in summaries.key] == [second]
    save_recording(recording, tmp_path / "converted")
    for again in (load_recording(tmp_path / "converted"), read(tmp_path / "converted")):
        assert again.names == recording.names
        assert again.events.keys == events.keys
    # Versions that know of no objects read the rest.
    document = json.loads((tmp_path / "converted" / "marks.json").read_text())
    assert document["names"] == []


def test_names_in_a_file_of_reports(tmp_path):
    long = "/move_base/" + "l" * 100
    made = TpcFile(header(node=NODE))
    made.system(site(1, key(1)), name(f"{key(90)},{NAMED.name}"), name(f"{key(91)},{long}"),
                name("nonsense"), name(f"{key(2)}#2,of:3"), site(2, f"{key(2)}#2"))  # fmt: skip
    made.thread(1, report(1, 1, 0, 0), report(2, 2, 0, 0))
    recording = read(made.write(tmp_path / "x.tpc"))
    told = (NAMED, ReadName(key(91), NODE, long), ReadName(f"{key(2)}#2", NODE, "", 3))
    assert recording.names == tuple(sorted(told))
    assert recording.events.keys == (key(1), f"{key(2)}#2")
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
