"""Feeds nodes of rclcpp that run beside it, and notes what they publish.

A program of its own for the interpreter that has rclpy: ``rclcpp_feeder.py CONFIG OUTPUT``. CONFIG
is JSON: the ``input``, how many ``subscriptions`` it must have, and for each of the ``nodes`` its
``messages``: the topics, the type of each and how many messages it gets. OUTPUT gets the messages
of each topic, in order, as text.

It prints a line when it listens: then the nodes are to be started. A node that answers a call has
seen all that this program listens to, because that was made before the caller was.
"""

from __future__ import annotations

import importlib
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path

import rclpy
from rcl_interfaces.srv import ListParameters
from std_msgs.msg import Float64

PATIENCE_S = 300.0
SETTLED_S = 0.5
ASK_AGAIN_S = 2.0


def class_of(kind: str) -> type:
    """The class of a message: ``std_msgs/msg/Float64``."""
    package, _, name = kind.partition("/msg/")
    found: type = getattr(importlib.import_module(f"{package}.msg"), name)
    return found


def main() -> None:
    """Listen, wait for the nodes, feed them, and write what was heard."""
    config = json.loads(Path(sys.argv[1]).read_text("utf-8"))
    rclpy.init()
    node = rclpy.create_node("feeder")
    heard: dict[str, list[str]] = {}
    wanted = {}
    for name, messages in config["nodes"].items():
        for topic, (kind, count) in messages.items():
            place = f"/{name}/{topic}"
            wanted[place] = count
            mine = heard.setdefault(place, [])
            node.create_subscription(
                class_of(kind), place, lambda msg, mine=mine: mine.append(str(msg)), 1000
            )
    feeder = node.create_publisher(Float64, "/input", 1000)
    clients = {
        name: node.create_client(ListParameters, f"/{name}/list_parameters")
        for name in config["nodes"]
    }

    def until(is_done: Callable[[], bool], what: Callable[[], str]) -> None:
        end = time.monotonic() + PATIENCE_S
        while not is_done():
            rclpy.spin_once(node, timeout_sec=0.05)
            if time.monotonic() > end:
                sys.exit(f"rclcpp_feeder: {what()}")

    print("listens", flush=True)
    until(
        lambda: all(client.service_is_ready() for client in clients.values()),
        lambda: f"not up: {[name for name in clients if not clients[name].service_is_ready()]}",
    )
    # A node whose side of the connection is not up yet loses the call: it is asked again.
    silent = set(clients)
    end = time.monotonic() + PATIENCE_S
    while silent and time.monotonic() < end:
        calls = {name: clients[name].call_async(ListParameters.Request()) for name in silent}
        ask_again = time.monotonic() + ASK_AGAIN_S
        while time.monotonic() < ask_again and not all(call.done() for call in calls.values()):
            rclpy.spin_once(node, timeout_sec=0.05)
        silent -= {name for name, call in calls.items() if call.done()}
    if silent:
        sys.exit(f"rclcpp_feeder: no answer: {sorted(silent)}")
    until(
        lambda: feeder.get_subscription_count() >= config["subscriptions"],
        lambda: f"{feeder.get_subscription_count()} subscriptions to /input",
    )
    for value in config["input"]:
        feeder.publish(Float64(data=value))
    end = time.monotonic() + PATIENCE_S
    while any(len(heard[place]) < count for place, count in wanted.items()):
        rclpy.spin_once(node, timeout_sec=0.05)
        if time.monotonic() > end:
            break
    end = time.monotonic() + SETTLED_S
    while time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.05)
    Path(sys.argv[2]).write_text(json.dumps(heard), "utf-8")


if __name__ == "__main__":
    main()
