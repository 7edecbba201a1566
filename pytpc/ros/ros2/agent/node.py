"""The agent: a node of ROS 2 that pytpc starts under the interpreter that has rclpy.

It subscribes to raw messages, publishes bytes, and asks nodes for their parameters, as it is told
on standard input; what it hears goes to standard output. It imports nothing of pytpc and runs on
Python 3.8; `pipe` says what the frames are.
"""

import collections
import json
import os
import queue
import sys
import tempfile
import threading
import time
from typing import Any

from .calls import Calls
from .connections import services_of, topics_of
from .message_types import class_of, definition_of
from .pipe import TIME, Writer, read_frame

LOOK_S = 0.25
DEPTH = 5000
ACKNOWLEDGED_S = 5.0
KINDS = {
    1: "bool_value",
    2: "integer_value",
    3: "double_value",
    4: "string_value",
    5: "byte_array_value",
    6: "bool_array_value",
    7: "integer_array_value",
    8: "double_array_value",
    9: "string_array_value",
}


class Agent:
    """The node, and what it was told to do."""

    def __init__(self, writer: Any, rclpy: Any) -> None:
        self._writer = writer
        self._rclpy = rclpy
        self.context = rclpy.Context()
        rclpy.init(args=[], context=self.context)
        from rclpy.executors import SingleThreadedExecutor

        self.node = rclpy.create_node(
            "_tpc_agent_%d" % os.getpid(),
            context=self.context,
            enable_rosout=False,
            start_parameter_services=False,
        )
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self.commands: Any = queue.SimpleQueue()
        self.wake = self.node.create_guard_condition(self._take_commands)
        self.node.create_timer(LOOK_S, self._look)
        self._wanted: Any = {}
        self._subscriptions: Any = {}
        self._by_number: Any = {}
        # What makes subscriptions anew, by their numbers.
        self._to_make: Any = {}
        self._publishers: Any = {}
        self._calls = Calls(self.node, writer)
        # Messages without room, by the heads of their topics.
        self._lost: Any = collections.Counter()
        self._graph: Any = None
        self.ended = False

    def run(self) -> None:
        """Work until told to end."""
        self._look()
        while not self.ended and self.context.ok():
            self.executor.spin_once(timeout_sec=1.0)

    def close(self) -> None:
        """Leave the graph."""
        self.executor.shutdown(timeout_sec=1.0)
        self.node.destroy_node()
        self._rclpy.shutdown(context=self.context)

    def _take_commands(self) -> None:
        while True:
            try:
                head, body = self.commands.get_nowait()
            except queue.Empty:
                return
            try:
                getattr(self, "do_" + head["op"])(head, body)
            except Exception as error:
                self._writer.put(
                    {
                        "ev": "answer",
                        "id": head.get("id"),
                        "error": one_line(error),
                        "op": head["op"],
                    }
                )

    def do_end(self, head: Any, body: Any) -> None:
        """Send what has come, and end."""
        for subscription in self._subscriptions.values():
            self._drain(*subscription)
        self._tell_lost()
        self.ended = True

    def do_subscribe(self, head: Any, body: Any) -> None:
        """Subscribe to a topic, as soon as its type is known."""
        self._wanted[head["topic"]] = (head.get("type"), head.get("history"))
        self._subscribe_known(dict(self.node.get_topic_names_and_types()))

    def do_drain(self, head: Any, body: Any) -> None:
        """Send what has come, and then the answer, when others have what was published."""
        for subscription in self._subscriptions.values():
            self._drain(*subscription)
        self._tell_lost()
        self._wait_for_receivers()
        self._writer.put({"ev": "answer", "id": head["id"]})

    def do_connections(self, head: Any, body: Any) -> None:
        """Answer with all topics and services, and their nodes."""
        found = {"topics": topics_of(self.node), "services": services_of(self.node)}
        self._writer.put(dict(found, ev="answer", id=head["id"]))

    def do_advertise(self, head: Any, body: Any) -> None:
        """Become a publisher of a topic."""
        if head["topic"] not in self._publishers:
            kind = class_of(head["type"])
            self._publishers[head["topic"]] = self.node.create_publisher(kind, head["topic"], 100)
        self._look()

    def do_publish(self, head: Any, body: Any) -> None:
        """Publish bytes."""
        self._publishers[head["topic"]].publish(bytes(body))

    def _wait_for_receivers(self) -> None:
        """Wait until they have what was published, but not long for one that hangs."""
        from rclpy.duration import Duration

        until = time.monotonic() + ACKNOWLEDGED_S
        for publisher in self._publishers.values():
            left = max(0.0, until - time.monotonic())
            publisher.wait_for_all_acked(Duration(seconds=left))

    def do_values(self, head: Any, body: Any) -> None:
        """Ask a node for all of its parameters; the answer is a ParameterEvent."""
        from rcl_interfaces.srv import GetParameters, ListParameters

        def listed(answer: Any) -> None:
            names = list(answer.result.names)
            request = GetParameters.Request(names=names)
            self._calls.call(
                head,
                GetParameters,
                "get_parameters",
                request,
                lambda answer: self._answer_values(head, names, answer.values),
            )

        self._calls.call(head, ListParameters, "list_parameters", ListParameters.Request(), listed)

    def _answer_values(self, head: Any, names: Any, values: Any) -> None:
        from rcl_interfaces.msg import Parameter, ParameterEvent
        from rclpy.serialization import serialize_message

        event = ParameterEvent(node=head["node"])
        for name, value in zip(names, values):
            if value.type:
                event.new_parameters.append(Parameter(name=name, value=value))
        self._writer.put(
            {"ev": "answer", "id": head["id"], "node": head["node"]}, serialize_message(event)
        )

    def do_set(self, head: Any, body: Any) -> None:
        """Set parameters of a node; the answer has for each whether it was taken, and why not."""
        from rcl_interfaces.msg import Parameter, ParameterValue
        from rcl_interfaces.srv import SetParameters

        parameters = []
        for name, kind, value in head["parameters"]:
            one = ParameterValue(type=kind)
            if kind:
                as_bytes = [bytes([byte]) for byte in value] if kind == 5 else value
                setattr(one, KINDS[kind], as_bytes)
            parameters.append(Parameter(name=name, value=one))

        def done(answer: Any) -> None:
            results = [[one.successful, one.reason] for one in answer.results]
            self._writer.put({"ev": "answer", "id": head["id"], "results": results})

        request = SetParameters.Request(parameters=parameters)
        # Sent again, it might undo what somebody has set meanwhile.
        once = dict(head, once=True)
        self._calls.call(once, SetParameters, "set_parameters", request, done)

    def _look(self) -> None:
        """See what is on the graph; tell what is new."""
        self._take_commands()
        # The hidden nodes of TPC are there for whoever asks for settings.
        pairs = self.node.get_node_names_and_namespaces()
        nodes = sorted({space.rstrip("/") + "/" + name for name, space in pairs})
        self._calls.look(nodes)
        self._make_again()
        self._tell_lost()
        own = self.node.get_fully_qualified_name()
        topics = dict(self.node.get_topic_names_and_types())
        graph = {
            "ev": "graph",
            "nodes": [name for name in nodes if name != own],
            "topics": topics,
            "clock": self.node.count_publishers("/clock"),
            "subscribers": {
                topic: publisher.get_subscription_count()
                for topic, publisher in self._publishers.items()
            },
            "publishers": {
                topic: self.node.count_publishers(topic) for topic in self._subscriptions
            },
        }
        if graph != self._graph:
            self._graph = graph
            self._subscribe_known(topics)
            self._writer.put(graph)

    def _subscribe_known(self, topics: Any) -> None:
        for topic, (kind, history) in list(self._wanted.items()):
            if topic in self._subscriptions:
                continue
            kinds = [kind] if kind else topics.get(topic, [])
            if kinds:
                self._subscribe(topic, kinds[0], history)

    def _subscribe(self, topic: Any, kind: Any, history: Any) -> None:
        try:
            message = class_of(kind)
            definition = definition_of(kind)
        except Exception as error:
            del self._wanted[topic]
            what = "%s: the type %s is not installed (%s)" % (topic, kind, one_line(error))
            self._writer.put({"ev": "untaken", "topic": topic, "why": what})
            return
        number = len(self._subscriptions)
        head = json.dumps({"m": number}).encode()
        told = {"ev": "subscribed", "number": number, "topic": topic, "type": kind}
        self._writer.put(dict(told, definition=definition))
        self._receive(topic, message, history, number, head)

    def _receive(self, topic: Any, message: Any, history: Any, number: Any, head: Any) -> None:
        """Make a subscription that fits those who publish now.

        If ``history`` is None, one that does not fit those who come later is made anew.
        """

        def make(events: Any) -> Any:
            return self.node.create_subscription(
                message,
                topic,
                lambda data, info: self._first(number, data, info),
                self._quality(topic, history),
                raw=True,
                event_callbacks=events,
            )

        def again() -> None:
            if history is None:
                self._to_make[number] = lambda: self._receive(topic, message, None, number, head)

        try:
            made = make(events_of(lambda count: self._lose(topic, count), again))
        except Exception:
            # Some middleware does not tell of lost messages.
            made = make(None)
        self._subscriptions[topic] = self._by_number[number] = (made, head)

    def _quality(self, topic: Any, history: Any) -> Any:
        """Of service. ``history``: with what was sent before; None: if all publishers offer it."""
        from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

        found = self.node.get_publishers_info_by_topic(topic)
        offers = [one.qos_profile for one in found]
        best = any(one.reliability == ReliabilityPolicy.BEST_EFFORT for one in offers)
        if history is None:
            kept = [one.durability == DurabilityPolicy.TRANSIENT_LOCAL for one in offers]
            history = bool(kept) and all(kept)
        return QoSProfile(
            history=HistoryPolicy.KEEP_LAST,
            depth=DEPTH,
            reliability=ReliabilityPolicy.BEST_EFFORT if best else ReliabilityPolicy.RELIABLE,
            durability=DurabilityPolicy.TRANSIENT_LOCAL if history else DurabilityPolicy.VOLATILE,
        )

    def _make_again(self) -> None:
        """Replace the subscriptions that do not fit a new publisher."""
        for number, make in list(self._to_make.items()):
            del self._to_make[number]
            former, head = self._by_number[number]
            self._drain(former, head)
            self.node.destroy_subscription(former)
            make()

    def _first(self, number: Any, data: Any, info: Any) -> None:
        subscription, head = self._by_number[number]
        self._put(head, data, info)
        self._drain(subscription, head)

    def _drain(self, subscription: Any, head: Any) -> None:
        """Take all messages that wait: the executor would wake once for each."""
        with subscription.handle:
            for _ in range(DEPTH):
                taken = subscription.handle.take_message(subscription.msg_type, True)
                if taken is None:
                    return
                self._put(head, taken[0], taken[1])

    def _put(self, head: Any, data: Any, info: Any) -> None:
        if not self._writer.has_room():
            self._lost[head] += 1
            return
        stamp = info.get("source_timestamp", 0) if isinstance(info, dict) else 0
        self._writer.put(head, TIME.pack(stamp) + bytes(data))

    def _lose(self, topic: Any, count: Any) -> None:
        self._writer.put({"ev": "lost", "topic": topic, "count": count})

    def _tell_lost(self) -> None:
        """Tell how many messages had no room."""
        for topic, (_, head) in self._subscriptions.items():
            if self._lost[head]:
                self._lose(topic, self._lost.pop(head))


def events_of(lose: Any, misfit: Any) -> Any:
    """What the middleware tells of a subscription.

    ``lose`` is called with a number of messages that it has lost, and ``misfit`` when a publisher
    does not offer what the subscription asks for.
    """
    try:
        from rclpy.event_handler import SubscriptionEventCallbacks
    except ImportError:
        from rclpy.qos_event import SubscriptionEventCallbacks
    return SubscriptionEventCallbacks(
        message_lost=lambda event: lose(event.total_count_change),
        incompatible_qos=lambda _: misfit(),
        use_default_callbacks=False,
    )


def one_line(error: Any) -> Any:
    """An error in one line."""
    return " ".join(str(error).split()) or type(error).__name__


def described(rclpy: Any) -> Any:
    """What this ROS is, for ``pytpc doctor``."""
    from rclpy.utilities import get_rmw_implementation_identifier

    return {
        "rmw": get_rmw_implementation_identifier(),
        "distro": os.environ.get("ROS_DISTRO", ""),
        "python": sys.executable,
        "rclpy": os.path.dirname(rclpy.__file__),
    }


def main() -> None:
    """Serve the process that has started this one, until it ends."""
    frames = os.dup(1)
    # What ROS prints must not come between frames.
    os.dup2(2, 1)
    commands = os.fdopen(os.dup(0), "rb")
    writer = Writer(frames)
    if not os.environ.get("HOME"):
        os.environ.setdefault("ROS_LOG_DIR", tempfile.gettempdir())
    try:
        import rclpy

        agent = Agent(writer, rclpy)
        writer.put(dict(described(rclpy), ev="ready"))
    except BaseException as error:
        missing = isinstance(error, ImportError)
        writer.put({"ev": "failed", "error": one_line(error), "missing": missing})
        writer.close()
        os._exit(1)

    def read() -> None:
        while True:
            found = read_frame(commands)
            agent.commands.put(found or ({"op": "end"}, b""))
            agent.wake.trigger()
            if found is None:
                return

    threading.Thread(target=read, daemon=True).start()
    try:
        agent.run()
        writer.put({"ev": "ended"})
    finally:
        writer.close()
    # Destroying a node takes a second with some middleware; the graph learns by the closed socket.
    agent.close()
