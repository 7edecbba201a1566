"""The sink ``rosout`` hands lines to the program's log, whose handlers may themselves compare."""

from __future__ import annotations

import threading
from types import SimpleNamespace

from pytpc.pyhook import ros_state
from pytpc.pyhook.config import Config
from pytpc.pyhook.policies import Caps, Edges
from pytpc.pyhook.ros_sinks import RosoutSink
from pytpc.pyhook.sites import Reported


def test_a_log_may_wait_for_a_thread_that_compares(monkeypatch) -> None:
    # As where another thread holds a log's lock while it makes the text of an object.
    sink, config = RosoutSink(), Config(policy="edges")
    take = Edges(config, sink, Caps(config, sink)).take
    one, other = Reported("one", 1, False), Reported("other", 2, False)
    lines, ended = [], []

    def loginfo(line: str) -> None:
        lines.append(line)
        thread = threading.Thread(target=take, args=(other, True, 1.0, 0.0, True), daemon=True)
        thread.start()
        thread.join(10)
        ended.append(not thread.is_alive())

    node = SimpleNamespace(is_shutdown=lambda: False, loginfo=loginfo)
    monkeypatch.setattr(ros_state, "rospy", lambda: node)
    take(one, True, 5.0, 3.0, True)
    assert lines[0] == "threshold_information:one,True,cmp:5,thresh:3,res:True"
    assert ended
    assert all(ended)
