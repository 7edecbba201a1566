"""A ROS graph of one node inside this process: enough of rospy to run the suite, and no network.

Messages and times are ROS's own. All that the node exposes is kept, in order. Samples come while
the node spins or sleeps; after each one, every timer fires and every service is asked once.
"""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import io
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from types import ModuleType, SimpleNamespace
from typing import Any

import rospy as real
from rospy.msg import args_kwds_to_message
from std_msgs.msg import Float64, String

RECONFIGURED = {"enabled": True, "lower": -4.0, "upper": 4.0, "gain": 1.0}
# How long the node's own threads have to be silent.
_QUIET_S = 0.2


def bytes_of(message: Any) -> bytes:
    """A message as it would be sent."""
    out = io.BytesIO()
    message.serialize(out)
    return out.getvalue()


class FakeRos:
    """The graph; ``exposed`` has (where, bytes) of all that the node let others see."""

    def __init__(self, params: Mapping[str, Any], samples: Mapping[str, list[Any]]) -> None:
        self.params = dict(params)
        self.exposed: list[tuple[str, bytes]] = []
        self.subscribers: list[tuple[str, Callable[..., Any], tuple[Any, ...]]] = []
        self.services: dict[str, tuple[Any, Callable[[Any], Any]]] = {}
        self.timers: list[Callable[[Any], Any]] = []
        self.actions: dict[str, Any] = {}
        self._lock = threading.RLock()
        self._threads = threading.active_count()
        self._rounds = self._feed(samples)
        self._is_over = False

    def _feed(self, samples: Mapping[str, list[Any]]) -> Iterator[None]:
        kinds = {"input": Float64, "aux": Float64, "text": String}
        for at in range(len(samples["input"])):
            for topic, kind in kinds.items():
                self.deliver(topic, kind(samples[topic][at]))
            for timer in self.timers:
                self._quietly(timer, None)
            for name in self.services:
                with contextlib.suppress(real.ServiceException):
                    kind, _ = self.services[name]
                    asked = {"data": True} if hasattr(kind._request_class(), "data") else {}
                    self.ask(name, kind._request_class(**asked))
            yield

    def deliver(self, topic: str, message: Any) -> None:
        """Hand a message to whoever subscribed to the topic."""
        for name, callback, extra in list(self.subscribers):
            if name == topic:
                self._quietly(callback, message, *extra)

    def _quietly(self, callback: Callable[..., Any], *arguments: Any) -> None:
        # rospy logs what a callback raises, and goes on.
        with contextlib.suppress(Exception):
            callback(*arguments)

    def expose(self, where: str, message: Any) -> None:
        """Keep what the node let others see."""
        with self._lock:
            self.exposed.append((where, bytes_of(message)))

    def ask(self, name: str, request: Any) -> Any:
        """Call a service; the answer is exposed."""
        kind, handler = self.services[name]
        response = handler(request)
        if not isinstance(response, kind._response_class):
            response = args_kwds_to_message(kind._response_class, (response,), {})
        self.expose(f"answer of {name}", response)
        return response

    def sleep(self) -> None:
        """One sample comes."""
        if next(self._rounds, self) is self:
            self._is_over = True

    def spin(self) -> None:
        """All samples that are left come, and the node's threads do their work."""
        while not self._is_over:
            self.sleep()
        before = -1
        while threading.active_count() > self._threads and before != len(self.exposed):
            before = len(self.exposed)
            time.sleep(_QUIET_S)

    def is_shutdown(self) -> bool:
        """Whether no sample is left."""
        return self._is_over

    def get_param(self, name: str, default: Any = KeyError) -> Any:
        """A parameter that the suite sets, else the default."""
        if name in self.params:
            return self.params[name]
        if default is KeyError:
            raise KeyError(name)
        return default

    def modules(self) -> dict[str, ModuleType]:
        """The modules that a node may import."""
        made: dict[str, dict[str, Any]] = {
            "rospy": _rospy(self),
            "tf2_ros": {"TransformBroadcaster": lambda: _Broadcaster(self)},
            "actionlib": {
                "SimpleActionServer": lambda *a, **k: _ActionServer(self, *a, **k),
                "SimpleActionClient": lambda name, kind: _ActionClient(self, name),
            },
            "dynamic_reconfigure": {},
            "dynamic_reconfigure.server": {"Server": _reconfigure},
            "python_nodes.cfg": {"ReadReconfigureConfig": None},
        }
        found = {}
        if importlib.util.find_spec("actionlib"):
            found["actionlib.msg"] = importlib.import_module("actionlib.msg")
        for name, content in made.items():
            found[name] = ModuleType(name)
            found[name].__dict__.update(content)
        return found


def _rospy(ros: FakeRos) -> dict[str, Any]:
    def subscribe(
        topic: str, kind: Any, callback: Any = None, callback_args: Any = None, **_: Any
    ) -> Any:
        extra = () if callback_args is None else (callback_args,)
        ros.subscribers.append((topic, callback, extra))
        return SimpleNamespace(name=topic)

    def timer(period: Any, callback: Callable[[Any], Any], oneshot: bool = False) -> None:
        ros.timers.append(callback)

    def service(name: str, kind: Any, handler: Callable[[Any], Any]) -> None:
        ros.services[name] = (kind, handler)

    logs = {f"log{level}" for level in ("debug", "info", "warn", "err", "fatal")}
    return {
        **{log + end: lambda *_, **__: None for log in logs for end in ("", "_throttle")},
        **{name: getattr(real, name) for name in ("Time", "Duration", "ServiceException")},
        "Publisher": lambda topic, kind, **_: _Publisher(ros, topic, kind),
        "Subscriber": subscribe,
        "Service": service,
        "ServiceProxy": lambda name, kind: _Proxy(ros, name, kind),
        "Timer": timer,
        "Rate": lambda hz: ros,
        "get_name": lambda: "/node",
        "init_node": lambda *_, **__: None,
        "spin": ros.spin,
        "is_shutdown": ros.is_shutdown,
        "get_param": ros.get_param,
        "get_param_cached": ros.get_param,
        "set_param": ros.params.__setitem__,
        "has_param": ros.params.__contains__,
        "search_param": lambda name: None,
    }


class _Publisher:
    def __init__(self, ros: FakeRos, topic: str, kind: Any) -> None:
        self._ros, self.name, self._kind = ros, topic, kind

    def publish(self, *words: Any, **fields: Any) -> None:
        self._ros.expose(self.name, args_kwds_to_message(self._kind, words, fields))


class _Proxy:
    def __init__(self, ros: FakeRos, name: str, kind: Any) -> None:
        self._ros, self._name, self._kind = ros, name, kind

    def __call__(self, *words: Any, **fields: Any) -> Any:
        request = args_kwds_to_message(self._kind._request_class, words, fields)
        self._ros.expose(f"call of {self._name}", request)
        return self._ros.ask(self._name, request)

    call = __call__


class _Broadcaster:
    def __init__(self, ros: FakeRos) -> None:
        self._ros = ros

    def sendTransform(self, transform: Any) -> None:
        self._ros.expose("/tf", transform)
        self._ros.deliver("/tf", SimpleNamespace(transforms=[transform]))


class _ActionServer:
    def __init__(
        self, ros: FakeRos, name: str, kind: Any, execute_cb: Any = None, auto_start: bool = True
    ) -> None:
        self._ros, self._name, self.execute = ros, name, execute_cb
        ros.actions[name] = self

    def start(self) -> None:
        """Runs already."""

    def set_succeeded(self, result: Any = None, text: str = "") -> None:
        self._ros.expose(f"{self._name} succeeded", result or String(text))

    def set_aborted(self, result: Any = None, text: str = "") -> None:
        self._ros.expose(f"{self._name} aborted", result or String(text))

    def publish_feedback(self, feedback: Any) -> None:
        self._ros.expose(f"{self._name} feedback", feedback)


class _ActionClient:
    def __init__(self, ros: FakeRos, name: str) -> None:
        self._ros, self._name = ros, name

    def wait_for_server(self, timeout: Any = None) -> bool:
        return True

    def send_goal(self, goal: Any) -> None:
        self._ros.expose(f"{self._name} goal", goal)
        self._ros.actions[self._name].execute(goal)

    def cancel_all_goals(self) -> None:
        self._ros.expose(f"{self._name} cancel", String(""))

    def get_goal_status_text(self) -> str:
        return ""


class _Config(dict[str, Any]):
    def __getattr__(self, name: str) -> Any:
        return self[name]


def _reconfigure(kind: Any, callback: Callable[[Any, int], Any]) -> None:
    callback(_Config(RECONFIGURED), 0)
