"""Runs the nodes of examples/rclpy_nodes in one process, feeds them, and notes what they publish.

A program of its own for the interpreter that has rclpy: ``rclpy_host.py CONFIG OUTPUT``. The nodes'
scripts run as they are, except that all share one context and one executor. CONFIG is JSON:
``folder`` with the scripts, their ``nodes``, the ``input``, and for each node its ``params`` and
``messages`` (how many on which topic). OUTPUT gets the messages of each topic, in order, as text.
"""

from __future__ import annotations

import importlib
import json
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import rclpy
from rclpy.action import ActionClient
from rclpy.executors import Executor, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from std_msgs.msg import Float64

PATIENCE_S = 60.0
SETTLED_S = 0.3
_OWN = ("/rosout", "/parameter_events")


class Host:
    """The nodes, and how far they are."""

    def __init__(self) -> None:
        self.executor = SingleThreadedExecutor()
        self.nodes: list[Node] = []
        self.handled: Counter[str] = Counter()
        self.heard: dict[str, list[str]] = {}
        self._spin = Executor.spin
        self._subscribe = Node.create_subscription

    def add(self, node: Node, executor: Executor | None = None) -> None:
        """In place of ``rclpy.spin``."""
        self.nodes.append(node)

    def load(self, folder: Path, names: list[str]) -> None:
        """Run the ``main`` of each script up to where it would spin."""
        host = self

        def spin(executor: Executor) -> None:
            for node in executor.get_nodes():
                executor.remove_node(node)
                host.add(node)

        def subscribe(
            node: Node, kind: Any, topic: str, callback: Callable[..., Any], *rest: Any, **more: Any
        ) -> Any:
            if topic != "input":
                return host._subscribe(node, kind, topic, callback, *rest, **more)
            place = f"{node.get_name()} {len(host.handled)}"
            host.handled[place] = 0

            async def counted(msg: Any) -> None:
                answer = callback(msg)
                if hasattr(answer, "__await__"):
                    await answer
                host.handled[place] += 1

            return host._subscribe(node, kind, topic, counted, *rest, **more)

        patched: dict[tuple[Any, str], Any] = {
            (rclpy, "init"): lambda *args, **kwargs: None,
            (rclpy, "spin"): self.add,
            (Executor, "spin"): spin,
            (Node, "create_subscription"): subscribe,
            (Node, "destroy_node"): lambda node: None,
        }
        before = {place: getattr(*place) for place in patched}
        for (owner, name), value in patched.items():
            setattr(owner, name, value)
        sys.path.insert(0, str(folder))
        for name in names:
            importlib.import_module(name).main()
        for (owner, name), value in before.items():
            setattr(owner, name, value)

    def listen(self, recorder: Node) -> list[Publisher[Any]]:
        """Subscribe to what the nodes publish below their names."""
        found = []
        for node in self.nodes:
            for publisher in node.publishers:
                topic = publisher.topic_name
                if topic.startswith(f"{node.get_fully_qualified_name()}/") and not topic.endswith(
                    ("transition_event", "_action/feedback", "_action/status")
                ):
                    heard = self.heard.setdefault(topic, [])
                    recorder.create_subscription(
                        publisher.msg_type,
                        topic,
                        lambda msg, heard=heard: heard.append(str(msg)),
                        1000,
                    )
                    found.append(publisher)
        return found

    def are_clients_ready(self) -> bool:
        """True once the nodes' clients see their servers."""
        return all(
            all(client.service_is_ready() for client in node.clients)
            and all(
                each.server_is_ready() for each in node.waitables if isinstance(each, ActionClient)
            )
            for node in self.nodes
        )

    def until(self, is_done: Callable[[], bool], what: Callable[[], str], *, spins: bool) -> None:
        """Wait; end the program with one line where it takes too long."""
        end = time.monotonic() + PATIENCE_S
        while not is_done():
            if time.monotonic() > end:
                sys.exit(f"rclpy_host: {what()}")
            if spins:
                self.executor.spin_once(timeout_sec=0.05)
            else:
                time.sleep(0.01)


def main() -> None:
    """Load, feed, and write what was heard."""
    config = json.loads(Path(sys.argv[1]).read_text("utf-8"))
    words = [
        word
        for node, params in config["params"].items()
        for name, value in params.items()
        for word in ("-p", f"{node}:{name}:={json.dumps(value)}")
    ]
    rclpy.init(args=["--ros-args", *words] if words else None)
    host = Host()
    host.load(Path(config["folder"]), config["nodes"])
    recorder = rclpy.create_node("recorder")
    feeder = recorder.create_publisher(Float64, "/input", 1000)
    publishers = host.listen(recorder)
    host.until(
        lambda: (
            feeder.get_subscription_count() >= len(host.handled)
            and all(each.get_subscription_count() for each in publishers)
            and host.are_clients_ready()
        ),
        lambda: "the nodes do not see one another",
        spins=False,
    )
    for node in (recorder, *host.nodes):
        host.executor.add_node(node)
    for number, value in enumerate(config["input"], start=1):
        feeder.publish(Float64(data=value))
        host.until(
            lambda number=number: min(host.handled.values()) >= number,
            lambda: f"not handled: {[name for name, count in host.handled.items() if not count]}",
            spins=True,
        )
    wanted = {
        f"/{node}/{topic}" if not topic.startswith("../") else f"/{topic[3:]}": count
        for node, topics in config["messages"].items()
        for topic, count in topics.items()
    }
    end = time.monotonic() + PATIENCE_S
    while any(len(host.heard.get(topic, ())) < count for topic, count in wanted.items()):
        host.executor.spin_once(timeout_sec=0.05)
        if time.monotonic() > end:
            break
    end = time.monotonic() + SETTLED_S
    while time.monotonic() < end:
        host.executor.spin_once(timeout_sec=0.05)
    Path(sys.argv[2]).write_text(json.dumps(host.heard), "utf-8")


if __name__ == "__main__":
    main()
