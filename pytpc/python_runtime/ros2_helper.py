"""The thread beside a node of ROS 2: it keeps the hidden node, and lets the sinks send."""

from __future__ import annotations

import _thread
import contextlib
import os
import time
from typing import TYPE_CHECKING

from pytpc.python_runtime import ros2_state
from pytpc.python_runtime.errors import warn
from pytpc.python_runtime.ros2_link import ContextShutDown, Link
from pytpc.python_runtime.ros2_settings import Settings

if TYPE_CHECKING:
    from pytpc.python_runtime.runtime import Runtime
    from pytpc.python_runtime.sinks import Sink

# How long it waits in one piece for somebody who asks for the settings.
_LONG_S = 3600.0
# While sinks are polled, those who ask for the settings wait so long at most.
_ANSWER_S = 0.1
# After a signal has shut the context down: usually the process ends now.
_AGAIN_S = 0.5
_END_S = 10.0
# To join the graph takes the interpreter some 10 ms: the program may use them to start.
_STARTING_S = 0.2
# How often signals may shut down the context that sends the rest.
_SIGNALS = 3


class Helper:
    """Not a thread of `threading`: programs count those, or wait for them."""

    def __init__(self, runtime: Runtime) -> None:
        self._runtime = runtime
        self._settings = Settings(runtime)
        self._process = os.getpid()
        self._is_stopping = False
        self._has_ended = False
        # Locked until the thread shall end, and until it has ended.
        self._stop = _thread.allocate_lock()
        self._stop.acquire()
        self._ended = _thread.allocate_lock()
        self._answered_at = 0.0
        self._lost: list[Link] = []
        self._told = ""
        self.link: Link | None = None

    def start(self) -> bool:
        """Apply the settings of files, and start the thread; False if the system has none."""
        self._settings.begin(ros2_state.name())
        self._ended.acquire()
        try:
            _thread.start_new_thread(self._run, ())
        except RuntimeError:
            self._ended.release()
            return False
        return True

    def _run(self) -> None:
        try:
            self._pause(_STARTING_S)
            while not self._is_stopping and os.getpid() == self._process:
                if self.link is not None:
                    self._turn(self.link)
                elif not self._opened():
                    break
        finally:
            self._ended.release()

    def _turn(self, link: Link) -> None:
        """Let the sink send, and answer those who ask for the settings."""
        try:
            wait_s = self._runtime.poll()
            if wait_s is None:
                link.serve(_LONG_S)
                return
            now = time.monotonic()
            if now - self._answered_at >= _ANSWER_S:
                self._answered_at = now
                link.serve(0)
            self._pause(wait_s)
        except Exception as error:
            if link.is_open():
                self._tell(f"the reports of {link.node_name} cannot be sent now: {error!r}")
            else:
                self._lose(link)
            self._pause(_AGAIN_S)

    def _tell(self, complaint: str) -> None:
        """Warn once of the same."""
        if complaint != self._told:
            self._told = complaint
            warn(complaint)

    def _lose(self, link: Link) -> None:
        """A signal has shut its context down; what it has sent may be on its way still."""
        self._lost.append(link)
        self.link = None

    def _pause(self, seconds: float) -> None:
        if self._stop.acquire(timeout=seconds):
            self._stop.release()

    def wake(self) -> None:
        """The sink has changed: it may have to be polled now."""
        if self.link is not None:
            self.link.wake()

    def _opened(self) -> bool:
        """Join the graph; False where that fails: then reports go to a file."""
        name = ros2_state.name()
        link: Link | None = None
        try:
            link = Link(name, ros2_state.domain(), self._settings.value)
            self._settings.declare(link.node)
        except Exception as error:
            if isinstance(error, ContextShutDown) or (link is not None and not link.is_open()):
                # Usually the process ends now.
                self._pause(_AGAIN_S)
                return True
            if not self._is_stopping:
                self._runtime.fall_back(f"{error}" or type(error).__name__)
            return False
        self.link = link
        return True

    def end(self) -> None:
        """The process ends: end the thread, so that it is not within rclpy when Python ends."""
        self._is_stopping = True
        if self._stop.locked():
            self._stop.release()
        self.wake()
        if not self._ended.acquire(timeout=_END_S):
            warn("the thread that sends reports hangs in ROS")
            self.link = None
            return
        self._ended.release()
        self._has_ended = True

    def send_rest(self, sink: Sink) -> None:
        """After `end`: let the sink send what it keeps.

        In a new context, where a signal has shut the other one down or the program ends as soon as
        it has begun. rclpy handles a signal in a thread of its own, so the context may be shut down
        while the sink sends.
        """
        for _ in range(_SIGNALS):
            if self.link is not None and not self.link.is_open():
                self._lose(self.link)
            if self.link is None and not (sink.wants_to_send() and self._opened_again()):
                return
            with contextlib.suppress(Exception):
                sink.finish()
            if self.link is not None and self.link.is_open():
                return

    def _opened_again(self) -> bool:
        if not self._has_ended:
            return False
        try:
            self.link = Link(ros2_state.name(), ros2_state.domain(), None)
        except ContextShutDown:
            return True
        except Exception as error:
            self._runtime.fall_back(f"{error}" or type(error).__name__)
            return False
        return True

    def close(self) -> None:
        """Leave the graph, after the last batch."""
        for link in (*self._lost, self.link):
            if link is not None:
                link.close()
        self._lost.clear()
        self.link = None
