"""Comparisons inside library functions: which calls compare, and which do not."""

from __future__ import annotations

from pathlib import Path

import pytest
from python_analysis_samples import analysed, found, marked, only

START = """import math, operator
import operator as op
from operator import gt
import numpy as np
p = rospy.get_param('~p')
q = rospy.get_param('~q')
own = operator.gt if rospy.is_shutdown() else operator.lt
def cb(m):
"""
END = "rospy.Subscriber('in', Float64, cb)\n"
# What is compared is worked out from what CPython evaluates: min(a, b) `b < a`, max(a, b) `b > a`.
SAMPLES = {
    "min first": "pub.publish(min(p, m.data))  #: ~p <",
    "min second": "pub.publish(min(m.data, p))  #: ~p >",
    "max first": "pub.publish(max(p, m.data))  #: ~p >",
    "max second": "pub.publish(max(m.data, p))  #: ~p <",
    "max third": "pub.publish(max(m.data, 1.0, p))  #: ~p <",
    "both": "pub.publish(max(p, m.data, q))  #: ~p >, ~q <",
    "derived": "pub.publish(min(m.data, p * 2))  #: ~p > derived",
    "numpy": "pub.publish(np.minimum(m.data, p))  #: ~p >",
    "clip": "pub.publish(np.clip(m.data, p, q))  #: ~p <, ~q >",
    "clip by keyword": "pub.publish(np.clip(m.data, a_max=q, a_min=-q))  #: ~q >, ~q < derived",
    "clip the threshold": "pub.publish(np.clip(p, 0, 1))",
    "the result is logged": "print(min(p, m.data))",
    "a key": "pub.publish(min(p, m.data, key=abs))",
    "unpacked": "pub.publish(min(*m.data, p))",
    "one iterable": "pub.publish(min([p, m.data]))",
    "operator": "if op.le(m.data, p):  #: ~p <=\n        pub.publish(m)",
    "turned": "if operator.ge(p, m.data):  #: ~p <=\n        pub.publish(m)",
    "imported": "if not gt(m.data, p):  #: ~p >\n        pub.publish(m)",
    "stored": "y = np.greater_equal(m.data, p)  #: ~p >=\n    if np.any(y):\n        pub.publish()",
    "is": "if op.is_not(m.data, p):  #: ~p !=\n        pub.publish(m)",
    "close": "if math.isclose(p, m.data):  #: ~p ==\n        pub.publish(m)",
    "tolerance": "if np.isclose(m.data, 1, atol=p):  #: ~p <=\n        pub.publish(m)",
    "one of two functions": "if own(m.data, p):\n        pub.publish(m)  # own may be two",
    "a constant beside": "if m.data > min(p, 3):  #: ~p > derived, ~p <\n        pub.publish(m)",
    "constants beside a measurement": "z = p if m.data else m.data\n    pub.publish(min(z, 3))",
}


@pytest.mark.parametrize("name", SAMPLES)
def test_samples(name: str, tmp_path: Path) -> None:
    text = f"{START}    {SAMPLES[name]}\n{END}"
    assert found(analysed(text, tmp_path)) == marked(text)


def test_place_operand_and_way(tmp_path: Path) -> None:
    text = START + "    y = min(m.data, p)\n    pub.publish(y)\n" + END
    one = only(analysed(text, tmp_path))
    # Three lines of the prelude, eight of START; `min` begins behind `    y = `, its call has 14
    # characters.
    assert (one.lineno, one.column, one.end_column, one.operand) == (12, 9, 23, "choice 2")
    # The publish, the store of y, the choice.
    assert one.distance == 3
    assert [(step.step, step.lineno) for step in one.path] == [
        ("read", 8), ("compare", 12), ("store", 12), ("expose", 13)
    ]  # fmt: skip


def test_what_is_cut_is_no_lost_threshold(tmp_path: Path) -> None:
    text = "p = rospy.get_param('~p')\ndef cb(m):\n    pub.publish({})\n" + END
    cut = analysed(text.format("max(m.data, p)"), tmp_path)
    assert cut.counts.lost_values == 0
    keyed = analysed(text.format("max(m.data, p, key=abs)"), tmp_path)
    assert keyed.counts.lost_values == 1
    # The larger of two parameters is a threshold that is not followed.
    both = "q = rospy.get_param('~q')\n" + text.format("max(p, q)")
    assert analysed(both, tmp_path).counts.lost_values == 1
    # What is measured and clipped to two parameters is measured; a clipped parameter is lost.
    between = "import numpy\nq = rospy.get_param('~q')\n" + text
    assert analysed(between.format("numpy.clip(m.data, p, q)"), tmp_path).counts.lost_values == 0
    assert analysed(between.format("numpy.clip(p, 0, 10)"), tmp_path).counts.lost_values == 1
