"""The sink ``rosout`` never waits for a thread that compares."""

from __future__ import annotations

import sys
import threading
from types import SimpleNamespace

from pytpc.python_runtime import ros1_state
from pytpc.python_runtime.config import Config
from pytpc.python_runtime.policies import Caps, Edges
from pytpc.python_runtime.ros1_sinks import RosoutSink
from pytpc.python_runtime.sites import Reported


def test_a_publisher_may_wait_for_a_thread_that_compares(monkeypatch) -> None:
    # As where another thread holds the topic's lock while it compares.
    sink, config = RosoutSink(), Config(policy="edges").filled_in().filled_in()
    take = Edges(config, sink, Caps(config, sink)).take
    one, other = Reported("one", 1, False), Reported("other", 2, False)
    lines, ended = [], []

    def publish(message: SimpleNamespace) -> None:
        lines.append(message.msg)
        thread = threading.Thread(target=take, args=(other, True, 1.0, 0.0, True), daemon=True)
        thread.start()
        thread.join(10)
        ended.append(not thread.is_alive())

    def log(**fields: object) -> SimpleNamespace:
        return SimpleNamespace(header=SimpleNamespace(stamp=None), **fields)

    log.INFO = 2
    monkeypatch.setitem(sys.modules, "rosgraph_msgs.msg", SimpleNamespace(Log=log))
    node = SimpleNamespace(
        is_shutdown=lambda: False,
        get_name=lambda: "/node",
        Time=SimpleNamespace(now=lambda: 7.0),
        Publisher=lambda *_, **__: SimpleNamespace(publish=publish),
    )
    monkeypatch.setattr(ros1_state, "rospy", lambda: node)
    take(one, True, 5.0, 3.0, True)
    assert lines[0] == "threshold_information:one,True,cmp:5,thresh:3,res:True"
    assert ended
    assert all(ended)
