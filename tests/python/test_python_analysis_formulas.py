"""Thresholds that are computed with values that are not constant, and outcomes that are exposed.

The marks beside the lines were written by hand, from the source, before the analysis was run.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from python_analysis_samples import analysed, found, marked, only

from pytpc.static.coverage import coverage
from pytpc.static.static_info import StaticInfo

SAMPLES = {
    "a product, a sum, a difference": """
        limit, margin, slack = (rospy.get_param(n) for n in ("~limit", "~margin", "~slack"))
        def heard(m):
            if m.data > rospy.get_param("~gain") * m.speed:  #: ~gain > derived
                pub.publish(1)
            if m.data < m.floor - rospy.get_param("~bias"):  #: ~bias < derived
                pub.publish(2)
            if m.data / m.speed > 2 * rospy.get_param("~most") + m.floor:  #: ~most > derived
                pub.publish(3)
        rospy.Subscriber("in", object, heard)
    """,
    "two parameters, each with the other": """
        low, span = rospy.get_param("~low", 1.0), rospy.get_param("~span", 1.0)
        def heard(m):
            if m.data > low + span:  #: ~low > derived, ~span > derived
                pub.publish(1)
        rospy.Subscriber("in", object, heard)
    """,
    "a difference to zero": """
        goal = rospy.get_param("~goal")
        def heard(m):
            if m.data - goal > 0:  #: ~goal < derived
                pub.publish(1)
            if m.data * goal > 0:
                pub.publish(2)
        rospy.Subscriber("in", object, heard)
    """,
    "times and durations are numbers": """
        class Node:
            def __init__(self):
                self.patience = rospy.get_param("~patience")
                self.timeout = rospy.Duration(rospy.get_param("~timeout"))
                self.last = rospy.Time.now()
                self.deadline = None
            def heard(self, m):
                now = rospy.Time.now()
                if now > self.last + rospy.Duration(self.patience):  #: ~patience > derived
                    pub.publish(1)
                if (now - self.last).to_sec() > self.patience:  #: ~patience >
                    pub.publish(2)
                if now - self.last > self.timeout:  #: ~timeout >
                    pub.publish(3)
                if self.deadline and now > self.deadline:  #: ~timeout > derived
                    pub.publish(4)
                self.deadline = now + self.timeout
        rospy.Subscriber("in", object, Node().heard)
    """,
    "what is measured is no threshold, whatever it is computed with": """
        class Node:
            def __init__(self):
                self.gain, self.rate = rospy.get_param("~gain"), rospy.get_param("~rate")
                self.mean, self.most = rospy.get_param("~mean"), rospy.get_param("~most")
                self.total = 0.0
            def heard(self, m):
                v = m.data
                if self.gain * v > 10:
                    pub.publish(1)
                if self.gain * v > self.most:  #: ~most >
                    pub.publish(2)
                self.total += self.rate * v
                if self.total > m.other:
                    pub.publish(3)
                level = 0.5 * self.mean + 0.5 * v
                if v > level:
                    pub.publish(4)
                if v + self.gain > m.other + self.gain * m.speed:
                    pub.publish(5)
                if abs(v - self.mean) > 0.1:
                    pub.publish(6)
                if max(v, self.rate * m.speed) > m.other:
                    pub.publish(7)
        rospy.Subscriber("in", object, Node().heard)
    """,
    "texts are put together, not computed": """
        prefix = rospy.get_param("~prefix", "a")
        def heard(m):
            if m.data == prefix + m.name:
                pub.publish(1)
        rospy.Subscriber("in", object, heard)
    """,
    "an outcome that is exposed": """
        from std_msgs.msg import Bool
        class Node:
            def __init__(self):
                self.low, self.high = rospy.get_param("~low"), rospy.get_param("~high")
                self.near, self.far = rospy.get_param("~near"), rospy.get_param("~far")
                self.kept = rospy.get_param("~kept")
                rospy.Service("near", object, self.is_near)
                rospy.Service("far", object, self.is_far)
            def heard(self, m):
                pub.publish(Bool(m.volts < self.low))  #: ~low <
                out = Bool()
                out.data = m.volts > self.high * m.scale  #: ~high > derived
                pub.publish(out)
                unused = Bool()
                unused.data = m.volts > self.kept
            def is_near(self, request):
                return request.x < self.near  #: ~near <
            def is_far(self, request):
                answer = Bool()
                answer.success = request.x > self.far  #: ~far >
                return answer
        rospy.Subscriber("in", object, Node().heard)
    """,
    "lists and dicts of parameters": """
        class Node:
            def __init__(self):
                self.limits = rospy.get_param("~limits")
                self.steps = rospy.get_param("~steps")
                self.first, self.second = rospy.get_param("~pair")
            def heard(self, m):
                if m.x > self.limits["low"]:  #: ~limits/low >
                    pub.publish(0)
                if m.x < self.limits["a"]["b"]:  #: ~limits/a/b <
                    pub.publish(1)
                if m.x > self.steps[0]:  #: ~steps >
                    pub.publish(2)
                if m.x > self.second * m.y:  #: ~pair > derived
                    pub.publish(3)
                if any(m.x > step for step in self.steps):  #: ~steps >
                    pub.publish(4)
        rospy.Subscriber("in", object, Node().heard)
    """,
}


@pytest.mark.parametrize("name", SAMPLES)
def test_formulas(name: str, tmp_path: Path) -> None:
    assert found(analysed(SAMPLES[name], tmp_path)) == marked(SAMPLES[name])


@pytest.mark.parametrize(
    ("threshold", "text"),
    [
        ("p * m.speed", "x * m.speed"),
        ("m.speed - p", "m.speed - x"),
        ("m.floor - (2 * p + 1)", "m.floor - (2 * x + 1)"),
        ("(1 + p) * m.speed - 2", "(x + 1) * m.speed - 2"),
        ("3 * (p + m.speed)", "3 * (x + m.speed)"),
        ("p / m.speed + m.floor", "x / m.speed + m.floor"),
        ("(m.a + m.b) * p", "(m.a + m.b) * x"),
        ("m.speed * math.sqrt(p)", "m.speed * sqrt(x)"),
    ],
)
def test_text_of_a_formula(threshold: str, text: str, tmp_path: Path) -> None:
    body = f"""
        import math
        p = rospy.get_param("~p")
        def heard(m):
            if m.x > {threshold}:
                pub.publish(1)
        rospy.Subscriber("in", object, heard)
    """
    transform = only(analysed(body, tmp_path)).transform
    assert transform is not None
    assert (transform.kind, transform.text, transform.tree) == ("expression", text, None)


def test_three_values_are_too_many(tmp_path: Path) -> None:
    body = """
        p = rospy.get_param("~p")
        def heard(m):
            if m.x > p * m.a + m.b:
                pub.publish(1)
            if m.x > p * m.a + m.b - m.c:
                pub.publish(2)
        rospy.Subscriber("in", object, heard)
    """
    unit = analysed(body, tmp_path)
    assert only(unit).lineno == 7
    assert [spot.lineno for spot in unit.blind_spots if spot.kind == "lost_value"] == [9]


def test_every_parameter_has_a_state(tmp_path: Path) -> None:
    body = """
        gain, rate = rospy.get_param("~gain"), rospy.get_param("~rate")
        low, shown = rospy.get_param("~low"), rospy.get_param("~shown")
        text = "frame: " + rospy.get_param("~frame", "map")
        rospy.get_param("~ignored")
        import other
        def heard(m):
            if gain * m.x > 10:
                pub.publish(1)
            pub.publish(rate)
            if m.x < low:
                pub.publish(2)
            if m.x > shown:
                print("high")
            other.use(rospy.get_param("~handed"))
        rospy.Subscriber("in", object, heard)
    """
    static = StaticInfo((analysed(body, tmp_path),), ())
    states = {one.parameter: one.state for one in coverage(static)}
    assert states == {
        "~gain": "lost",
        "~rate": "used",
        "~low": "compared",
        "~shown": "hidden",
        "~frame": "lost",
        "~ignored": "used",
        "~handed": "lost",
    }


@pytest.mark.parametrize(
    "value",
    [
        'p + "/base"',
        '"/" + p',
        '"%s" % p',
        'p % (m.x, "a")',
        'f"{m.frame}/" + p',
        "p + SUFFIX",
        "[0] * p",
        "(m.x,) * p",
    ],
)
def test_what_is_computed_with_text_or_a_list_is_no_threshold(value: str, tmp_path: Path) -> None:
    body = f"""
        p = rospy.get_param("~p")
        SUFFIX = "/base"
        def heard(m):
            if m.data == {value}:
                pub.publish(1)
        rospy.Subscriber("in", object, heard)
    """
    unit = analysed(body, tmp_path)
    assert unit.comparisons == ()
    assert [spot.kind for spot in unit.blind_spots] == ["lost_value"]
