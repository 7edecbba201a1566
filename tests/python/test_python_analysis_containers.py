"""Parameters in lists and dicts: containers that are joined, and operations on tables."""

from __future__ import annotations

from pathlib import Path

import pytest
from python_analysis_samples import analysed, found, marked

SAMPLES = {
    "lists are joined": """
        high = rospy.get_param("~high")
        low = rospy.get_param("~low")
        def cb(msg):
            for limit in [high] + [low, 0.5]:
                if msg.data > limit:  #: ~high >, ~low >
                    pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
    """,
    "a list grows": """
        limits = [rospy.get_param("~first")]
        def cb(msg):
            if any(msg.data > limit for limit in limits):  #: ~first >, ~second >
                pub.publish(msg)
        limits += [rospy.get_param("~second")]
        rospy.Subscriber("in", Float64, cb)
    """,
    "a list several times, and sets": """
        one = rospy.get_param("~one")
        def cb(msg):
            for limit in [one] * 3:
                if msg.data > limit:  #: ~one >
                    pub.publish(msg)
            for limit in {one, 1.0} - {1.0}:
                if msg.data < limit:  #: ~one <
                    pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
    """,
    "dicts are joined": """
        table = {"a": rospy.get_param("~a"), "b": 0.0} | {"c": rospy.get_param("~c")}
        def cb(msg):
            for limit in table.values():
                if msg.data > limit:  #: ~a >, ~c >
                    pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
    """,
    "arithmetic with arrays joins nothing": """
        import numpy as np
        high = rospy.get_param("~high")
        def cb(msg):
            if msg.data > (np.array([high]) + np.array([msg.other]))[0]:
                pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
    """,
    "all entries of a table": """
        table = rospy.get_param("~t")
        def cb(msg):
            for limit in table.values():
                if msg.data > limit:  #: ~t/<dynamic> >
                    pub.publish(msg)
            for name, limit in table.items():
                if msg.kind == name and msg.data > limit:  #: ~t/<dynamic> >
                    pub.publish(msg)
            for name, limits in table.items():
                if msg.data > limits["most"]:  #: ~t/<dynamic>/most >
                    pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
    """,
    "an entry that is taken out, and a copy": """
        table = rospy.get_param("~t")
        def cb(msg):
            if msg.data > table.copy()["x"]:  #: ~t/x >
                pub.publish(msg)
            if msg.data > table.pop("y", 1.0):  #: ~t/y >
                pub.publish(msg)
            if msg.data > table.setdefault("z", 2.0):  #: ~t/z >
                pub.publish(msg)
        rospy.Subscriber("in", Float64, cb)
    """,
}
TABLE = "table = rospy.get_param('~t')\ndef cb(msg):\n    if msg.data > {}:\n"
TABLE += "        pub.publish(msg)\nrospy.Subscriber('in', Float64, cb)\n"


@pytest.mark.parametrize("name", SAMPLES)
def test_found(name: str, tmp_path: Path) -> None:
    assert found(analysed(SAMPLES[name], tmp_path)) == marked(SAMPLES[name])


@pytest.mark.parametrize(
    ("value", "lost"),
    [("{**table}['x']", 0), ("dict(table.items())['x']", 1), ("table.popitem()[1]", 1)],
)
def test_what_is_not_followed_is_said(value: str, lost: int, tmp_path: Path) -> None:
    assert analysed(TABLE.format(value), tmp_path).counts.lost_values == lost
