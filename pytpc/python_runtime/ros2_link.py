"""The hidden node ``NODE/_tpc`` of a node of ROS 2, in a context of its own.

The program's context, executor, callbacks and shutdown are not touched. Nothing here is called
before the program has made a node, so all of rclpy's modules are there.
"""

from __future__ import annotations

import sys
from time import monotonic_ns
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable

    # What a hidden node is asked for: the value of one of its parameters, by name.
    Ask = Callable[[str], Any]

NAME = "_tpc"
# To join the graph usually takes less than this. Where it takes longer, what is waited for on the
# graph takes as many times longer, at most twice.
_JOINED_NS = 20_000_000
_SLOWEST = 2.0


class ContextShutDown(Exception):
    """A signal has shut a context down before its node was there."""


class Link:
    """The context and what is in it. The thread that makes it also spins and closes it."""

    def __init__(self, node: str, domain: int | None, ask: Ask | None) -> None:
        """``node``: the full name of the program's node. Without ``ask`` there are no services.

        Raises:
            ContextShutDown: a signal has shut the context down meanwhile.
            Exception: rclpy's own, where the graph cannot be used.
        """
        from rclpy.context import Context  # noqa: PLC0415

        self.node_name = node
        self.began_ns = monotonic_ns()
        # How long it took to join the graph.
        self.took_ns = 0
        self._publishers: dict[str, Any] = {}
        self._executor: Any = None
        self.node: Any = None
        self._context = Context()
        has_begun = False
        try:
            # The process's logging belongs to the program.
            options: dict[str, Any] = {} if domain is None else {"domain_id": domain}
            self._context.init(args=_arguments(sys.argv), initialize_logging=False, **options)
            has_begun = True
            self.node = _hidden_node(node, self._context, ask)
            if ask is not None:
                self._executor = _executor(self._context, self.node)
            self.took_ns = monotonic_ns() - self.began_ns
        except BaseException as error:
            is_shut = has_begun and not self.is_open()
            self.close()
            if is_shut:
                raise ContextShutDown("a signal has shut it down") from error
            raise

    def is_open(self) -> bool:
        """Whether it can be used. rclpy's signal handlers shut down all contexts of a process."""
        return bool(self._context.ok())

    def slowness(self) -> float:
        """How many times longer than usual the graph takes."""
        return min(max(1.0, self.took_ns / _JOINED_NS), _SLOWEST)

    def publisher(self, kind: Any, topic: str, qos: Any) -> Any:  # noqa: ANN401
        """The publisher of a topic, made once."""
        if topic not in self._publishers:
            self._publishers[topic] = self.node.create_publisher(kind, topic, qos)
        return self._publishers[topic]

    def known_subscribers(self, topic: str) -> int:
        """The number of the topic's subscribers that were discovered so far."""
        return int(self.node.count_subscribers(topic))

    def serve(self, timeout_s: float) -> None:
        """Answer those who read or change the settings; wait for one, at most ``timeout_s``.

        Raises:
            Exception: rclpy's own, where the context was shut down.
        """
        if self._executor is not None:
            self._executor.spin_once(timeout_sec=timeout_s)

    def wake(self) -> None:
        """End `serve`; another thread may call this."""
        try:
            if self._executor is not None:
                # Its `wake` has it wait again.
                self._executor.create_task(_nothing)
        except Exception:
            # It is closed meanwhile.
            return

    def close(self) -> None:
        """Leave the graph."""
        for end in (
            lambda: self._executor and self._executor.shutdown(timeout_sec=0),
            lambda: self.node and self.node.destroy_node(),
            self._context.try_shutdown,
        ):
            try:
                end()
            except Exception:
                # A signal has shut it down.
                continue


def _arguments(words: list[str]) -> list[str]:
    """Of the program's arguments for ROS those that its context needs, too: the enclave.

    Names are not remapped again, and parameters of the program's node are not those of the hidden
    one.
    """
    for flag in ("--enclave", "-e"):
        if "--ros-args" in words and flag in words[:-1]:
            return ["--ros-args", "--enclave", words[words.index(flag) + 1]]
    return []


def _hidden_node(node: str, context: Any, ask: Ask | None) -> Any:  # noqa: ANN401
    """A node of rclpy; its parameters have the values that ``ask`` gives when they are read."""
    from rclpy.node import Node  # noqa: PLC0415
    from rclpy.parameter import Parameter  # noqa: PLC0415

    class HiddenNode(Node):  # type: ignore[misc]
        """See above."""

        is_of_tpc = True

        def get_parameter(self, name: str) -> Any:  # noqa: ANN401
            """The value in effect."""
            held = super().get_parameter(name)
            value = None if ask is None else ask(name)
            return held if value is None else Parameter(name, value=value)

        def get_parameters(self, names: list[str]) -> list[Any]:
            """The values in effect."""
            return [self.get_parameter(name) for name in names]

    # A `use_sim_time` of all nodes would make it listen to /clock for nothing.
    usual = {"use_sim_time": False, "start_type_description_service": False}
    return HiddenNode(
        NAME,
        namespace=node,
        context=context,
        use_global_arguments=False,
        enable_rosout=False,
        start_parameter_services=ask is not None,
        parameter_overrides=[Parameter(name, value=value) for name, value in usual.items()],
    )


def _nothing() -> None:
    """A task for the executor."""


def _executor(context: Any, node: Any) -> Any:  # noqa: ANN401
    from rclpy.executors import SingleThreadedExecutor  # noqa: PLC0415

    executor = SingleThreadedExecutor(context=context)
    executor.add_node(node)
    return executor
