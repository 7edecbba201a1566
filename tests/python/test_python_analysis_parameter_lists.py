"""Lists of rclpy's parameters: requested ones, and those that a callback gets."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent, indent

import pytest
from python_analysis_samples import analysed, found, marked

START = """
from rclpy.node import Node
class Robot(Node):
    def __init__(self):
        super().__init__("robot")
        self.out = self.create_publisher(Float64, "out", 1)
        self.create_subscription(Float64, "in", self.on_input, 1)
"""
USE = """
    def on_input(self, msg):
        if msg.data > self.top:  #: top >
            self.out.publish(msg)
        if msg.data < self.low:  #: low <
            self.out.publish(msg)
Robot()
"""
SAMPLES = {
    "unpacked": 'low, top = self.get_parameters(["low", "top"])\n'
    "self.low = low.value\n"
    "self.top = top.get_parameter_value().double_value\n",
    "by place": 'both = self.declare_parameters("", [("top", 1.0), ("low", 2.0)])\n'
    "self.top = both[0].value\n"
    "self.low = both[-1].value\n",
    "a callback": "self.add_on_set_parameters_callback(self.changed)\n",
}
CHANGED = """
    def changed(self, params):
        for param in params:
            if param.name == "low":
                self.low = param.value
            elif param.name == "top" and param.value is not None:
                self.top = param.value
            else:
                self.other = param.value
        return None
"""


@pytest.mark.parametrize("name", SAMPLES)
def test_names_of_elements(name: str, tmp_path: Path) -> None:
    text = START + indent(dedent(SAMPLES[name]), "        ") + CHANGED + USE
    assert {each for each in found(analysed(text, tmp_path)) if each[2] in "<>"} == marked(text)
