"""The messages that a comparison of a Python node depends on, and the type of what it publishes."""

from __future__ import annotations

from pathlib import Path

from python_analysis_samples import analysed

from pytpc.python_analysis.analysis import analyse_entry
from pytpc.python_analysis.rules_file import load_rules
from pytpc.python_analysis.sources.packages import entry_of
from pytpc.static.link_unit import LinkUnit

ROSPY = """
    from std_msgs.msg import Bool, Int32
    import std_msgs.msg

    class Node:
        def __init__(self):
            self.far = rospy.get_param("~far")
            self.retry = rospy.get_param("~retry")
            self.alone = rospy.get_param("~alone")
            self.use = rospy.get_param("~use")
            self.count, self.enabled = 0, False
            rospy.Subscriber("scan", Float64, self.on_scan)
            rospy.Subscriber("~enable", Bool, callback=self.on_enable)
            rospy.Subscriber("/count", std_msgs.msg.Int32, lambda m: self.on_count(m.data))

        def on_scan(self, message):
            if message.data > self.far:
                pub.publish(1)
            if self.use:
                pub.publish(2)

        def on_enable(self, message):
            self.enabled = message.data

        def on_count(self, count):
            self.count = count

        def step(self):
            if rospy.get_time() > self.alone:
                pub.publish(3)
            if not self.enabled:
                return
            if self.count > self.retry:
                pub.publish(4)

    node = Node()
    while not rospy.is_shutdown():
        node.step()
"""

RCLPY = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool, Float64

class Guard(Node):
    def __init__(self):
        super().__init__("guard")
        self.limit = self.declare_parameter("limit", 1.0).value
        self.out = self.create_publisher(Bool, "~/stop", 1)
        self.create_subscription(Float64, "speed", self.on_speed, 1)

    def on_speed(self, message):
        if message.data > self.limit:
            self.out.publish(Bool())

rclpy.init()
rclpy.spin(Guard())
"""


def messages(unit: LinkUnit) -> dict[str | None, list[tuple[str | None, str | None, str]]]:
    return {
        each.source: [(one.topic, one.type, one.by) for one in each.received or ()]
        for each in unit.comparisons
    }


def test_the_topics_of_callbacks_are_found_by_value_and_by_control(tmp_path: Path) -> None:
    unit = analysed(ROSPY, tmp_path)

    assert messages(unit) == {
        "~far": [("scan", "std_msgs/Float64", "value")],
        "~use": [("scan", "std_msgs/Float64", "control")],
        "~alone": [],
        "~retry": [
            ("/count", "std_msgs/Int32", "value"),
            ("~enable", "std_msgs/Bool", "control"),
        ],
    }
    assert {each.message for each in unit.comparisons} == {"std_msgs/Float64"}
    places = {one.lineno for each in unit.comparisons for one in each.received or ()}
    # PRELUDE has 3 lines and the text begins with an empty one.
    assert places == {15, 16, 17}


def test_types_of_ros2_have_the_folder_of_messages_in_them(tmp_path: Path) -> None:
    script = tmp_path / "guard.py"
    script.write_text(RCLPY)
    unit = analyse_entry(entry_of(script), load_rules())

    assert messages(unit) == {"limit": [("speed", "std_msgs/msg/Float64", "value")]}
    assert unit.comparisons[0].topic == "~/stop"
    assert unit.comparisons[0].message == "std_msgs/msg/Bool"
