"""Exposing statements in Python, and the distance to them."""

from dataclasses import replace
from pathlib import Path
from textwrap import dedent

import pytest
from python_analysis_samples import analysed, found, marked, only

from pytpc.python_analysis.analysis import analyse_entry
from pytpc.python_analysis.rules_file import load_rules
from pytpc.python_analysis.sources.packages import entry_of

_READ = "limit = rospy.get_param('~limit')\n"

BODIES = {
    "service proxy, called and by call": """
        go = rospy.ServiceProxy("go", Float64)
        def cb(msg):
            if msg.data > limit:  #: ~limit >
                go(1)
            if msg.data < limit:  #: ~limit <
                go.call(2)
        rospy.Subscriber("in", Float64, cb)
    """,
    "making a service proxy exposes nothing": """
        def cb(msg):
            if msg.data > limit:
                rospy.ServiceProxy("go", Float64)
                rospy.wait_for_service("go")
                rospy.loginfo("made")
        rospy.Subscriber("in", Float64, cb)
    """,
    "what a service answers": """
        def answer(request):
            if request.value > limit:  #: ~limit >
                return 1
            return 2
        rospy.Service("ask", Float64, answer)
    """,
    "actionlib, tf": """
        import actionlib
        from tf2_ros import TransformBroadcaster
        client = actionlib.SimpleActionClient("move", Float64)
        frames = TransformBroadcaster()
        def cb(msg):
            if msg.data > limit:  #: ~limit >
                client.send_goal(msg)
            if msg.data == limit:  #: ~limit ==
                frames.sendTransform(msg)
            if msg.data < limit:
                client.wait_for_result()
        rospy.Subscriber("in", Float64, cb)
    """,
    "publishers in a dict, a list, an argument, a method": """
        pubs = {"a": rospy.Publisher("a", Float64), "b": [pub]}
        class Sender:
            def __init__(self, out):
                self.out = out
            def send(self, value):
                self.out.publish(value)
        sender = Sender(pub)
        def cb(msg):
            if msg.data > limit:  #: ~limit >
                pubs["a"].publish(1)
            if msg.data < limit:  #: ~limit <
                for each in pubs["b"]:
                    each.publish(2)
            if msg.data == limit:  #: ~limit ==
                sender.send(3)
        rospy.Subscriber("in", Float64, cb)
    """,
    "an outcome that is itself published": """
        from std_msgs.msg import Bool
        state = Bool()
        def is_high(value):
            return value > limit  #: ~limit >
        def cb(msg):
            pub.publish(Bool(msg.data < limit))  #: ~limit <
            state.data = msg.data >= limit or is_high(msg.data)  #: ~limit >=
            pub.publish(state)
            rospy.loginfo(msg.data == limit)
            kept = msg.data != limit
            rospy.loginfo("%s", kept)
        rospy.Subscriber("in", Float64, cb)
    """,
    "publish of something else": """
        class Log:
            def publish(self, text):
                rospy.loginfo(text)
        log = Log()
        def cb(msg):
            if msg.data > limit:
                log.publish("high")
        rospy.Subscriber("in", Float64, cb)
    """,
}


@pytest.mark.parametrize("name", BODIES)
def test_found(name: str, tmp_path: Path) -> None:
    text = _READ + dedent(BODIES[name])
    assert found(analysed(text, tmp_path)) == marked(text)


def test_the_thesis_profile_has_no_actions(tmp_path: Path) -> None:
    text = _READ + dedent(BODIES["actionlib, tf"])
    assert found(analysed(text, tmp_path, profile="thesis")) == set()


def test_distances_and_topics(tmp_path: Path) -> None:
    unit = analysed(
        """
        far = rospy.get_param("~far")
        near = rospy.get_param("~near")
        side = rospy.get_param("~side")
        def send(msg):
            pub.publish(msg)
        def cb(msg):
            if msg.data > far:
                if msg.data > near:
                    pub.publish(msg)
        def other(msg):
            if msg.data > side:
                send(msg)
        rospy.Subscriber("in", Float64, cb)
        rospy.Subscriber("in", Float64, other)
        """,
        tmp_path,
    )
    # The branch around a publish has 1, the one around that branch 2. In `send` no branch decides,
    # so its call enters round 2, and the branch around the call has 2.
    assert {c.source: c.distance for c in unit.comparisons} == {"~far": 2, "~near": 1, "~side": 2}
    assert {c.topic for c in unit.comparisons} == {"out"}


def test_places_of_a_chain_and_of_a_flag(tmp_path: Path) -> None:
    unit = analysed(
        """
        low, high = rospy.get_param("~low"), rospy.get_param("~high")
        def cb(msg):
            if (low) < msg.data <= high and not high:
                pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
        """,
        tmp_path,
    )
    # Columns from 1 in `    if (low) < msg.data <= high and not high:`: the `(` has 8, `msg` 16,
    # the end of `msg.data` is 24, the first `high` 28 to 32, the second one 41 to 45.
    places = {(c.source, c.relation): (c.column, c.end_column, c.operand) for c in unit.comparisons}
    assert places == {
        ("~low", ">"): (8, 24, "left"),
        ("~high", "<="): (16, 32, "right"),
        ("~high", "flag"): (41, 45, None),
    }
    # All three are one condition.
    assert {c.other_thresholds for c in unit.comparisons} == {2}


def test_the_way_of_a_comparison(tmp_path: Path) -> None:
    unit = analysed(
        """
        limit = rospy.get_param("~limit")
        def cb(msg):
            high = msg.data > limit
            if high:
                pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
        """,
        tmp_path,
    )
    assert [(step.step, step.lineno) for step in only(unit).path] == [
        ("read", 5),
        ("compare", 7),
        ("decide", 8),
        ("expose", 9),
    ]


def test_constants_only_when_asked_for(tmp_path: Path) -> None:
    text = """
        TOP = 7
        def cb(msg):
            if msg.data > 3.5 and msg.data < TOP and msg.ok != 0:
                pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
        """
    assert analysed(text, tmp_path).comparisons == ()
    rules = replace(load_rules(), constants=True)
    unit = analyse_entry(entry_of(tmp_path / "node.py"), rules)
    # `!= 0` is no comparison with a constant.
    assert [(c.name, c.relation, c.type, c.source) for c in unit.comparisons] == [
        ("3.5", ">", "constant", None),
        ("TOP", "<", "constant", None),
    ]
    assert (unit.counts.comparisons, unit.counts.constants) == (0, 2)


def test_a_mask_by_a_constant(tmp_path: Path) -> None:
    text = """
        import numpy as np
        def cb(msg):
            scan = np.array(msg.ranges)
            pub.publish(scan[scan > 3.5])
        rospy.Subscriber("in", Float64, cb)
        """
    assert analysed(text, tmp_path).comparisons == ()
    unit = analyse_entry(entry_of(tmp_path / "node.py"), replace(load_rules(), constants=True))
    assert [(c.name, c.relation, c.distance) for c in unit.comparisons] == [("3.5", ">", 1)]


def test_an_outcome_that_is_published_has_a_path_and_a_distance(tmp_path: Path) -> None:
    text = _READ + dedent("""
        def cb(msg):
            state = Float64()
            state.data = msg.data < limit
            pub.publish(state)
        rospy.Subscriber("in", Float64, cb)
    """)
    found = only(analysed(text, tmp_path))
    assert [step.step for step in found.path] == ["read", "compare", "store", "expose"]
    assert found.distance == 2
    assert not analysed(text, tmp_path, profile="thesis").comparisons
