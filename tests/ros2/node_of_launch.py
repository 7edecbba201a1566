"""A node of rclpy that writes the parameters that it was started with to a file, and ends."""

import json
import os
import sys
from pathlib import Path

import rclpy
from rclpy.node import Node

rclpy.init()
node = Node("unnamed", allow_undeclared_parameters=True)
name = node.get_fully_qualified_name()
given = {key: repr(one.value) for key, one in node._parameter_overrides.items()}
folder = Path(os.environ["TPC_TEST_FOLDER"])
(folder / f"{name.replace('/', '+')}.json").write_text(json.dumps(given))
node.destroy_node()
rclpy.try_shutdown()
sys.exit(0)
