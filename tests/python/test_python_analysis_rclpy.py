"""Forms of rclpy that no node of examples/rclpy_nodes has; and the same calls in other places."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

import pytest
from python_analysis_samples import analysed, found, marked

START = """
import rclpy
from rclpy.action import ActionClient, ActionServer, GoalResponse
from rclpy.duration import Duration
from rclpy.lifecycle import SimpleManagedEntity, TransitionCallbackReturn
from rclpy.node import Node
from rclpy.parameter_event_handler import ParameterEventHandler
node = Node("robot")
out = node.create_publisher(Float64, "out", 1)
"""
BODIES = {
    "callbacks that are registered later": """
        top = node.declare_parameter("top", 1.0).value
        slow = node.declare_parameter("slow", 1.0).value
        noted = node.declare_parameter("noted", 1.0).value
        def execute(goal_handle):
            if goal_handle.request.order > slow:  #: slow >
                goal_handle.abort()
            if goal_handle.request.order > noted:
                node.get_logger().info("high")
            return None
        def goal(request):
            if request.order > top:  #: top >
                return GoalResponse.REJECT
            return GoalResponse.ACCEPT
        server = ActionServer(node, Action, "go", execute)
        server.register_goal_callback(goal)
        server.register_execute_callback(execute)
    """,
    "a goal that is awaited": """
        top = node.declare_parameter("top", 1.0).value
        client = ActionClient(node, Action, "go")
        async def on_input(msg):
            goal_handle = await client.send_goal_async(Action.Goal())
            if msg.data > top:  #: top >
                await goal_handle.cancel_goal_async()
        node.create_subscription(Float64, "in", on_input, 1)
    """,
    "a managed entity": """
        class Part(SimpleManagedEntity):
            def __init__(self, robot):
                super().__init__()
                self.top = robot.declare_parameter("top", 1.0).value
                self.load = 0.0
                robot.create_subscription(Float64, "in", self.on_input, 1)
            def on_input(self, msg):
                self.load = msg.data
            def on_activate(self, state):
                if self.load > self.top:  #: top >
                    return TransitionCallbackReturn.FAILURE
                return TransitionCallbackReturn.SUCCESS
            def other(self, state):
                return self.load < self.top
        part = Part(node)
    """,
    "event callbacks by keyword, and of other nodes": """
        top, far, mine = 0.0, 0.0, 0.0
        def on_top(param):
            global top
            top = param.value.double_value
        def on_far(param):
            global far
            far = param.value.double_value
        def on_mine(param):
            global mine
            mine = param.value.double_value
        handler = ParameterEventHandler(node)
        handler.add_parameter_callback(parameter_name="top", node_name=None, callback=on_top)
        handler.add_parameter_callback("far", "/other", on_far)
        handler.add_parameter_callback("mine", node.get_name(), on_mine)
        def on_input(msg):
            if msg.data > top:  #: top >
                out.publish(msg)
            if msg.data > far:
                out.publish(msg)
            if msg.data > mine:  #: mine >
                out.publish(msg)
        node.create_subscription(Float64, "in", on_input, 1)
    """,
    "durations of both units, and scaled": """
        sum = Duration(nanoseconds=node.declare_parameter("ns", 5).value)
        twice = Duration(seconds=node.declare_parameter("s", 5.0).value) * 2
        last = node.get_clock().now()
        def on_input(msg):
            if node.get_clock().now() - last > sum:  #: ns > derived
                out.publish(msg)
            if node.get_clock().now() - last > twice:  #: s > derived
                out.publish(msg)
        node.create_subscription(Float64, "in", on_input, 1)
    """,
    "a prefix that is empty, and one that is not constant": """
        import sys
        every = node.get_parameters_by_prefix("")
        some = node.get_parameters_by_prefix(sys.argv[1])
        def on_input(msg):
            if msg.data > every["limits.top"].value:  #: limits.top >
                out.publish(msg)
            if msg.data < some["low"].value:  #: <dynamic>.low <
                out.publish(msg)
            if some:
                out.publish(msg)
        node.create_subscription(Float64, "in", on_input, 1)
    """,
    "a future of another library passes itself": """
        top = node.declare_parameter("top", 1.0).value
        client = node.create_client(Trigger, "go")
        def on_answer(future):
            if future.result().count > top:  #: top >
                out.publish(Float64())
        client.call_async(Trigger.Request()).add_done_callback(on_answer)
    """,
    "parts of one class that read by names they get": """
        class Limit:
            def __init__(self, robot, name):
                self.name = name
                robot.declare_parameter(name, 1.0)
                self.value = robot.get_parameter(name).value
            def holds(self, sample):
                return sample < self.value  #: low <
        top, low = Limit(node, "top"), Limit(node, "low")
        def on_input(msg):
            if msg.data > top.value:  #: top >
                out.publish(msg)
            if low.holds(msg.data):
                out.publish(msg)
        node.create_subscription(Float64, "in", on_input, 1)
    """,
    "a method that somebody else may call has any of the objects": """
        class Limit:
            def __init__(self, robot, name):
                self.value = robot.declare_parameter(name, 1.0).value
            def hears(self, msg):
                if msg.data < self.value:  #: low <, top <
                    out.publish(msg)
        top, low = Limit(node, "top"), Limit(node, "low")
        for each in (top, low):
            node.create_subscription(Float64, "in", each.hears, 1)
    """,
}


@pytest.mark.parametrize("name", BODIES)
def test_found(name: str, tmp_path: Path) -> None:
    text = START + dedent(BODIES[name])
    assert found(analysed(text, tmp_path)) == marked(text)


def test_the_thesis_profile_has_no_actions(tmp_path: Path) -> None:
    for name in ("callbacks that are registered later", "a managed entity"):
        text = START + dedent(BODIES[name])
        assert found(analysed(text, tmp_path, profile="thesis")) == set()
