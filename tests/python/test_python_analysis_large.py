"""Programs in which a value may be many objects: which are distinguished, and which given up."""

from __future__ import annotations

from pathlib import Path
from textwrap import indent

from python_analysis_samples import analysed

from pytpc.python_analysis.ir.program import Program
from pytpc.python_analysis.points_to.points_to import PointsTo
from pytpc.python_analysis.rules_file import load_rules
from pytpc.python_analysis.sources.packages import entry_of

LIMIT = """
class Limit:
    def __init__(self, value):
        self.value = value

    def passes(self, msg):
        return msg.data < self.value

limits = []
"""
USE = """
def callback(msg):
    for limit in limits:
        if limit.passes(msg):
            pub.publish(msg)

rospy.Subscriber("in", Float64, callback)
"""


def test_an_object_made_at_each_of_a_hundred_places(tmp_path: Path) -> None:
    made = "".join(f'limits.append(Limit(rospy.get_param("~p{n}")))\n' for n in range(100))
    unit = analysed(LIMIT + made + USE, tmp_path)
    assert {each.source for each in unit.comparisons} == {f"~p{n}" for n in range(100)}


def points_of(text: str, folder: Path) -> PointsTo:
    (folder / "node.py").write_text(text)
    entry = entry_of(folder / "node.py")
    program = Program(entry)
    program.load()
    return PointsTo(program, load_rules())


def test_objects_of_one_class_are_told_apart_at_64_places(tmp_path: Path) -> None:
    made = "".join(f"first{n} = Limit({n})\n" for n in range(200))
    points = points_of(LIMIT + made, tmp_path)
    # The 64 first ones, and one for all others.
    assert sorted(map(len, points.instances.values())) == [65]


def test_a_value_that_may_be_too_much_is_given_up(tmp_path: Path) -> None:
    # Objects of 300 classes in one list.
    classes = "".join(
        f"class C{n}:\n" + indent("def run(self):\n    return 1\n", "    ") for n in range(300)
    )
    made = "".join(f"items.append(C{n}())\n" for n in range(300))
    text = f"{classes}items = []\n{made}for item in items:\n    item.run()\n"
    points = points_of(text, tmp_path)
    assert points.given_up
    assert max(len(list(points.of(node))) for node in points.given_up) == 128


def test_effects_come_through_calls_and_recursion(tmp_path: Path) -> None:
    # `step` and `again` call each other; `again` writes the limit, so `check` sees both values.
    text = """
        class Node:
            def __init__(self):
                self.limit = 1.0

            def step(self, count):
                if count:
                    self.again(count - 1)

            def again(self, count):
                self.limit = rospy.get_param("~limit")
                self.step(count)

            def check(self, msg):
                self.limit = 2.0
                self.step(3)
                if msg.data > self.limit:
                    pub.publish(msg)

        rospy.Subscriber("in", Float64, Node().check)
    """
    assert [each.source for each in analysed(text, tmp_path).comparisons] == ["~limit"]
