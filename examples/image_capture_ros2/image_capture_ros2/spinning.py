"""The life of a node."""

from collections.abc import Callable
from typing import TypeVar

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node

NodeT = TypeVar("NodeT", bound=Node)


def run_node(make: Callable[[], NodeT], run: Callable[[NodeT], None] = rclpy.spin) -> None:
    """Run a node until it is told to stop."""
    rclpy.init()
    node = make()
    try:
        run(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except Exception:
        # Ctrl-C may come in the middle of a publish.
        if rclpy.ok():
            raise
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
