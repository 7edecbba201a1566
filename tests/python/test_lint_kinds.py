"""The kinds of findings but for unread values: each with what must not be found."""

import math
from dataclasses import replace

import pytest
from lint_samples import FILE, SOURCE, facts, node, read, said, setting

from pytpc.lint.angles import units_of_angles
from pytpc.lint.facts import Crossing, Earlier, Facts, NodeRead, Renamed
from pytpc.lint.finding import Spot
from pytpc.lint.limits import contradicting
from pytpc.lint.recorded import never_crossed, without_effect
from pytpc.lint.settings import deprecated, set_twice, unset
from pytpc.lint.values import out_of_range, wrong_type
from pytpc.recording.declaration import Declared
from pytpc.recording.parameter_values import ValueChange

X = "/robot/guard/x"
RCLPY = "rclpy.node.Node.declare_parameter"


def one_value(value: object, reads: NodeRead) -> Facts:
    return facts({reads.name: value}, node(reads))


def test_set_twice():
    before = Earlier(Spot(FILE, 3), 0.5, is_known=True)
    same = Earlier(Spot(FILE, 3), 0.7, is_known=True)
    twin = Earlier(Spot(FILE, 3), is_same_map=True)
    settings = [setting(f"/{n}", 0.7, n, one) for n, one in enumerate((before, same, twin), 1)]
    found = list(set_twice(Facts([*settings, setting("/4", 0.7, 4)], [])))
    assert said(found) == [
        (1, "/1 is set twice, and 0.7 wins"),
        (2, "/2 is set twice, to the same value"),
        (3, "/3 is set twice in one map, and 0.7 wins"),
    ]
    assert [one.severity for one in found] == ["note", "note", "warning"]
    assert found[0].evidence == (("set to 0.5 before", Spot(FILE, 3)),)


def test_unset():
    reads = [
        read("/robot/guard/port", needed="fails"),
        read("/robot/guard/frame", needed="reports"),
        read("/robot/guard/with_default", 0.5),
        read("/robot/guard/twice", needed="fails"),
        read("/robot/guard/twice", 0.5),
        read("/robot/guard/<dynamic>", needed="fails"),
        read("/robot/guard/by_code", needed="fails"),
        read("/robot/guard/table", needed="fails", is_table=True),
        read("/robot/guard/given", needed="fails"),
    ]
    values: dict[str, object] = {"/robot/guard/given": 1, "/robot/guard/table/p": 1}
    found = list(unset(facts(values, node(*reads), set_by_code=frozenset({"by_code"}))))
    assert said(found) == [
        (20, "nothing sets /robot/guard/port, and /robot/guard fails without it"),
        (20, "nothing sets /robot/guard/frame, and /robot/guard reports an error without it"),
    ]
    assert [one.severity for one in found] == ["error", "warning"]


def test_deprecated():
    old = read(X, deprecation=Spot(SOURCE, 22))
    [found] = deprecated(one_value(1.0, old))
    assert found.text == "the node calls /robot/guard/x deprecated"
    assert [spot.lineno for _, spot in found.evidence] == [22, 20]
    # Not set; and another node reads it, who likes the name.
    assert list(deprecated(facts({}, node(old)))) == []
    assert list(deprecated(facts({X: 1.0}, node(old, read(X))))) == []


# nav_core's loadParameterWithDeprecation(nh, "path_distance_bias", "pdist_scale", 0.6) reads both.
def test_an_old_name():
    magic = read("/robot/guard/<dynamic>", spot=Spot("/ws/src/core/magic.h", 60))
    new = Renamed("path_distance_bias", Spot(SOURCE, 169), "/ws/src/core/magic.h")
    one = node(magic, renamed={"x": new})
    [found] = deprecated(facts({X: 1.0}, one))
    assert found.text == "/robot/guard/x is deprecated; its new name is path_distance_bias"
    assert found.evidence == (("the node says so", Spot(SOURCE, 169)),)
    # Another planner of the same node reads it under this name.
    both = node(magic, read(X, 1.0), renamed={"x": new})
    assert list(deprecated(facts({X: 1.0}, both))) == []
    assert list(deprecated(facts({"/other/x": 1.0}, one))) == []
    # The handle there is that of one planner, and the value is another's.
    for namespace, count in (("guard", 1), ("planner", 0)):
        named = node(magic, renamed={"x": new._replace(namespace=namespace)})
        assert len(list(deprecated(facts({X: 1.0}, named)))) == count


def test_a_declaration_that_calls_its_field_deprecated():
    reads = read(X, api="dynamic_reconfigure::Server::setCallback")
    old = replace(declared("x", 0, 1), description="Deprecated, use limit")
    [found] = deprecated(facts({X: 0.5}, node(reads), declared=[old]))
    assert found.text == "the declaration of /robot/guard/x calls it deprecated"
    other = declared("x", 0, 1, place="/ws/src/robot/cfg/Other.cfg:3")
    assert list(deprecated(facts({X: 0.5}, node(reads), declared=[old, other]))) == []


@pytest.mark.parametrize(
    ("value", "reads", "why"),
    [
        ("0.5", read(X, 0.7), "a string: the node reads a double, so it takes its default (0.7)"),
        (1, read(X, True), "an int: the node reads a bool, so it takes its default (true)"),
        (5, read(X, "map"), "an int: the node reads a string, so it takes its default (map)"),
        (True, read(X, 0.7), "a bool: the node reads a double, so it takes its default (0.7)"),
        (2.5, read(X, 3), "a double, and the node rounds it to 3"),
        ([1, 2], read(X, 3), "a list, and the node reads an int"),
        ("no", read(X, True, api="rospy.get_param"),
         "a string, and the node expects a bool as its default is"),
        (1, read(X, 1.0, api=RCLPY), "an int, and the node refuses all but a double"),
        (1.0, read(X, 1, api="rclcpp::Node::declare_parameter"),
         "a double, and the node refuses all but an int"),
    ],
)  # fmt: skip
def test_wrong_types(value: object, reads: NodeRead, why: str):
    [(_, text)] = said(wrong_type(one_value(value, reads)))
    shown = {True: "true"}.get(value, value) if isinstance(value, bool) else value
    assert text == f"/robot/guard/x is {shown}, {why}"


@pytest.mark.parametrize(
    ("value", "reads"),
    [
        (1, read(X, 0.7)),
        (3.0, read(X, 3)),
        (1, read(X, 1.0, api="rospy.get_param")),
        (1.5, read(X, 1, api="rospy.get_param")),
        ("a", read(X, api="rospy.get_param", type="")),
        ([1.0], read(X, type="std::vector<double>")),
        ({"p": 1}, read(X, type="XmlRpc::XmlRpcValue", is_table=True)),
        # int(rospy.get_param('~x', '57600')), and flags that are numbers.
        (115200, read(X, "57600", api="rospy.get_param", is_converted=True)),
        (1, read(X, False, api="rospy.get_param")),
        (True, read(X, 0, api="rospy.get_param")),
        (None, read(X, 0.7)),
    ],
)
def test_right_types(value: object, reads: NodeRead):
    assert list(wrong_type(one_value(value, reads))) == []


# One that takes it is enough: costmap_2d reads its footprint as a text and as a list.
def test_a_type_that_one_of_two_reads_takes():
    found = facts({X: "[[1, 2]]"}, node(read(X, 0.7), read(X, "")))
    assert list(wrong_type(found)) == []


def declared(name: str, low: float | None, high: float | None, **changes: object) -> Declared:
    given = {"choices": (), "package": "/ws/src/robot", "place": "/ws/src/robot/cfg/Guard.cfg:9"}
    given |= changes  # type: ignore[assignment]
    return Declared(name, "double", low, high, None, None, description="", **given)  # type: ignore[arg-type]


def test_out_of_range():
    reads = read(X, api="dynamic_reconfigure::Server::setCallback")
    inside = declared("x", 0, 1)
    [found] = out_of_range(facts({X: 3.5}, node(reads), declared=[inside]))
    assert found.text == (
        "/robot/guard/x is 3.5, outside of what is declared: 0 to 1; its server makes 1 of it"
    )
    assert found.evidence == (("declared", Spot("/ws/src/robot/cfg/Guard.cfg", 9)),)
    choices = declared("x", None, None, choices=(("Fast", 1), ("Slow", 2)))
    [found] = out_of_range(facts({X: 3}, node(reads), declared=[choices]))
    assert found.text.endswith("outside of what is declared: 1 (Fast), 2 (Slow)")


# The server of another plugin of the node has the field, too, from a declaration that is not known.
def test_a_range_of_another_plugin_says_nothing():
    api = "dynamic_reconfigure::Server::setCallback"
    own, other = read(X, api=api), read(X, api=api, spot=Spot("/ws/src/arm/src/arm.cpp", 7))
    arm = declared("x", 0, 9, package="/ws/src/arm")
    inside = declared("x", 0, 1)
    assert list(out_of_range(facts({X: 3.5}, node(own, other), declared=[inside]))) == []
    assert list(out_of_range(facts({X: 3.5}, node(own, other), declared=[inside, arm]))) == []
    assert len(list(out_of_range(facts({X: 10}, node(own, other), declared=[inside, arm])))) == 1


# A server of dynamic_reconfigure compares with both ends, and NaN is neither below nor above.
def test_not_a_number_is_out_of_range_and_stays():
    reads = read(X, api="dynamic_reconfigure::Server::setCallback")
    for low, high in ((0.0, 1.0), (0.0, None), (None, 1.0)):
        one = declared("x", low, high)
        [found] = out_of_range(facts({X: math.nan}, node(reads), declared=[one]))
        assert "its server makes" not in found.text


@pytest.mark.parametrize(
    ("value", "one", "api"),
    [
        (1.0, declared("x", 0, 1), "dynamic_reconfigure::Server::setCallback"),
        (9.0, declared("y", 0, 1), "dynamic_reconfigure::Server::setCallback"),
        (9.0, declared("x", 0, 1), "ros::NodeHandle::param"),
        (9.0, declared("x", 0, 1, package="/ws/src/arm"), "dynamic_reconfigure::Server"),
        (9.0, declared("x", 2, 1), "dynamic_reconfigure::Server::setCallback"),
        (True, declared("x", 2, 3), "dynamic_reconfigure::Server::setCallback"),
    ],
)
def test_in_range(value: object, one: Declared, api: str):
    found = facts({X: value}, node(read(X, api=api)), declared=[one])
    assert list(out_of_range(found)) == []


@pytest.mark.parametrize(
    ("low", "high"),
    [
        ("min_vel", "max_vel"),
        ("range_lower", "range_upper"),
        ("zLow", "zHigh"),
        ("minimum_gap", "maximum_gap"),
        ("lim.min", "lim.max"),
    ],
)
def test_limits(low: str, high: str):
    names = f"/robot/guard/{low}", f"/robot/guard/{high}"
    found = facts({names[0]: 2.0, names[1]: 1.0}, node(*map(read, names)))
    own = high.rpartition(".")[2]
    assert said(contradicting(found)) == [(1, f"{names[0]} is 2, above {own}, which is 1")]
    assert list(contradicting(facts({names[0]: 1.0, names[1]: 1.0}))) == []


def test_a_limit_above_the_default_of_the_other_one():
    reads = [read("/robot/guard/min_vel", 0.1), read("/robot/guard/max_vel", 0.5)]
    [found] = contradicting(facts({"/robot/guard/min_vel": 2.0}, node(*reads)))
    assert found.text == "/robot/guard/min_vel is 2, above max_vel, which is 0.5"
    assert found.evidence == (("max_vel: default", Spot(SOURCE, 20)),)
    [found] = contradicting(facts({"/robot/guard/max_vel": 0.05}, node(*reads)))
    assert found.evidence == (("min_vel: default", Spot(SOURCE, 20)),)


@pytest.mark.parametrize(
    "values",
    [
        # No upper limit.
        {"min_range": 0.2, "max_range": -1.0},
        # Other namespaces, other names, no numbers.
        {"min_x": 2.0, "a/max_x": 1.0},
        {"min_x": 2.0, "max_y": 1.0},
        {"min_x": "b", "max_x": "a"},
        # A hysteresis may be either way round.
        {"low_threshold": 5.0, "high_threshold": 1.0},
        {"minutes": 5.0, "maxutes": 1.0},
    ],
)
def test_limits_that_do_not_contradict(values: dict[str, object]):
    found = facts({f"/robot/guard/{name}": value for name, value in values.items()}, node())
    assert list(contradicting(found)) == []


@pytest.mark.parametrize(
    ("name", "value", "reads", "why"),
    [
        ("yaw_tolerance", 15.0, read("", 0.2),
         "which seems to be in degrees (0.261799 rad): its default, 0.2, is in radians"),
        ("fov_rad", 90.0, read("", 0.0),
         "which seems to be in degrees (1.5708 rad): its name says radians"),
        ("limit", 45.0, read("", 0.0, angle="radians"),
         "which seems to be in degrees (0.785398 rad): the code takes it in radians"),
        ("max_turn_rate", 90.0, read("", 1.0),
         "which seems to be in degrees (1.5708 rad): its default, 1, is in radians"),
        ("max_angle", 1.5708, read("", 30.0, angle="degrees"),
         "which seems to be in radians (90.0002 degrees): the code makes radians of it"),
    ],
)  # fmt: skip
def test_degrees(name: str, value: float, reads: NodeRead, why: str):
    full = f"/robot/guard/{name}"
    own = read(full, reads.default, angle=reads.angle)
    [(_, text)] = said(units_of_angles(facts({full: value}, node(own))))
    assert text == f"{full} is {value:g}, {why}"


@pytest.mark.parametrize(
    ("name", "value", "reads"),
    [
        ("yaw_tolerance", 3.1, read("", 0.2)),
        ("yaw_tolerance_deg", 15.0, read("", 0.2)),
        ("max_angle", 15.0, read("", 30.0)),
        ("max_angle", 15.0, read("", 0.2, angle="degrees")),
        ("vtheta_samples", 20.0, read("", 3.0)),
        ("angle_bins", 20, read("", 3)),
        ("max_turn_rate", 9.0, read("", 1.0)),
        ("distance", 15.0, read("", 0.2)),
        ("max_angle", 1.5, read("", 30.0, angle="degrees")),
        ("max_angle", 90.0, read("", 30.0, angle="degrees")),
    ],
)
def test_no_degrees(name: str, value: float, reads: NodeRead):
    full = f"/robot/guard/{name}"
    own = read(full, reads.default, angle=reads.angle)
    assert list(units_of_angles(facts({full: value}, node(own)))) == []


def test_changes_without_effect():
    change = ValueChange(9, X, 0.5, 0.7)
    at_start = read(X, 0.5, at_start=True)
    [found] = without_effect(facts({X: 0.5}, node(at_start), changes=[change, change]))
    assert found.text == (
        "/robot/guard/x was changed from 0.5 to 0.7 while the robot ran; /robot/guard reads it only"
        " when it starts"
    )
    again = node(at_start, read(X, 0.5))
    assert list(without_effect(facts({X: 0.5}, again, changes=[change]))) == []
    new = ValueChange(9, X, None, 0.7)
    assert list(without_effect(facts({X: 0.5}, node(at_start), changes=[new]))) == []


def test_thresholds_that_were_never_crossed():
    one = Crossing(X, Spot(SOURCE, 40), "d <  x_", 0.5, 1200, 60.4, 0.125, False, 2)
    [found] = never_crossed(facts({X: 0.5}, node(read(X)), crossings=[one]))
    assert found.text == (
        "/robot/guard/x (0.5) was never crossed: d < x_ was false in all 1,200 evaluations over"
        " 60 s in 2 recordings, at least 0.125 away"
    )
    assert found.spot == Spot(FILE, 1)
    [found] = never_crossed(facts({}, crossings=[one]))
    assert found.spot == Spot(SOURCE, 40)


def test_a_number_that_is_none():
    found = facts({X: math.nan, "/robot/guard/min_x": math.nan, "/robot/guard/max_x": 1.0})
    assert list(contradicting(found)) == []
