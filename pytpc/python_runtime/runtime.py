"""The settings of this process, and the sink and policy that follow from them.

Nothing happens until the first report. If the program has imported rospy, one helper thread then
waits for its node, applies its parameters, and sends what the sinks keep. For the sink ``file``
this thread then ends: the first report of each second does the periodic work. With a node of rclpy
another thread does this until the end (``ros2_helper``). After a fork the child keeps the settings
and begins a file of its own.
"""

from __future__ import annotations

import _thread
import atexit
import os
import threading
import time
from time import monotonic_ns
from typing import TYPE_CHECKING

from pytpc.python_runtime import ros1_state, ros2_sinks, ros2_state, ros_state, sites
from pytpc.python_runtime.config import Config, of_environment
from pytpc.python_runtime.errors import warn
from pytpc.python_runtime.light import Light
from pytpc.python_runtime.log_file import LogFile
from pytpc.python_runtime.policies import Caps, Edges
from pytpc.python_runtime.ring import BesideSink, Ring, Statements
from pytpc.python_runtime.ros1_control import Control
from pytpc.python_runtime.ros1_sinks import AutoSink, RosoutSink, TopicSink
from pytpc.python_runtime.ros2_helper import Helper
from pytpc.python_runtime.ros2_nodes import Split
from pytpc.python_runtime.sinks import FileSink, Sink
from pytpc.python_runtime.sites import Reported
from pytpc.python_runtime.waiting import WaitingSink

if TYPE_CHECKING:
    from pytpc.python_runtime.find import ListedPlace
    from pytpc.python_runtime.ros2_link import Link

_LATE_S = 0.25


_OF_ROS1 = {"auto": AutoSink, "rosout": RosoutSink, "topic": TopicSink}
_OF_ROS2 = {
    "auto": ros2_sinks.AutoSink,
    "rosout": ros2_sinks.RosoutSink,
    "topic": ros2_sinks.TopicSink,
}


class Runtime:
    """The state of the process. There is one instance, `RUNTIME`."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._reported: dict[str, Reported] = {}
        self._config: Config | None = None
        self._is_started = False
        self._is_starting = False
        self._parent = 0
        self._was_node = False
        self._has_helper = False
        self._has_ring_thread = False
        self._is_served = False
        self._is_split = False
        self._ros2: Helper | None = None
        self._sink = Sink()
        self._caps = Caps(Config(), self._sink)
        self._edges: Edges | Light | None = None
        self.file: LogFile | None = None
        self._ring: Ring | None = None
        self._to_file: FileSink | None = None
        sites.set_take(self._first)
        ros2_state.tell(self._node_came)
        # Handlers run in the reverse order of their registration: this one is among the last.
        atexit.register(self.end)
        os.register_at_fork(
            before=self._before_fork,
            after_in_parent=self._parent_goes_on,
            after_in_child=self._child,
        )

    def register(self, place: ListedPlace) -> Reported:
        """The report of a place; there is one for each key and side."""
        return self.instance(place.listed.key, place.swapped)

    def instance(self, key: str, swapped: bool) -> Reported:
        """The report of one of several nodes that report under a key."""
        with self._lock:
            known = self._reported.get(key)
            if known is None:
                known = Reported(key, len(self._reported) + 1, swapped)
                self._reported[key] = known
        if known.swapped == swapped:
            return known
        return Reported(key, known.number, swapped)

    def all_reported(self) -> list[Reported]:
        """Every key that may report."""
        with self._lock:
            return list(self._reported.values())

    @property
    def config(self) -> Config:
        """The current settings."""
        with self._lock:
            if self._config is None:
                self._config = of_environment()
            return self._config

    def _first(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """Take the first report: choose sink and policy before."""
        self.start()
        if self._is_started:
            sites.take(one, result, cmp, thresh, res)

    def start(self) -> None:
        """Apply the settings of the environment, or those from before a fork."""
        with self._lock:
            # A signal handler may report, or raise, in the middle of this.
            if self._is_started or self._is_starting:
                return
            self._is_starting = True
            try:
                config = self.config
                if not self._choose(config):
                    self._config = config._replace(sink="off")
                    self._choose(self._config)
                self._is_started = True
            finally:
                self._is_starting = False
            if ros2_state.has_node():
                self._begin_ros2()
            elif ros1_state.is_imported() and not self._is_served and not self._has_helper:
                self._start_helper()

    def apply(self, config: Config) -> bool:
        """Apply ``config``; False, and no change, if its file cannot be made."""
        self.start()
        with self._lock:
            if config == self.config:
                return True
            if not self._choose(config):
                return False
            self._config = config
            if self._ros2 is not None:
                self._ros2.wake()
            elif self._sink.is_polled and not self._has_helper and not self._was_node:
                self._start_helper()
            return True

    def _choose(self, config: Config) -> bool:
        """Build sink and policy of ``config``; False if its file cannot be made."""
        config = config.filled_in()
        self._flush()
        sink = self._sink_of(config)
        if sink is None:
            return False
        former, self._sink = self._sink, sink
        if isinstance(former, WaitingSink) and isinstance(sink, WaitingSink) and former is not sink:
            sink.take_over(former)
        if former is not sink and not isinstance(former, FileSink):
            former.end()
        is_on = config.sink != "off"
        all_sinks = self._with_ring(config, sink)
        self._caps = Caps(config, all_sinks)
        self._edges = None
        ring = self._to_file if self._ring is not None else None
        statements = None if ring is None else Statements(ring)
        if config.policy == "edges" and is_on:
            file = None if self._to_file is None else self._to_file.file
            self._edges = Edges(config, all_sinks, self._caps, file, statements)
        elif config.policy == "light" and is_on:
            self._edges = Light(config, all_sinks, self._caps, statements)
        sink.flush = self._flush
        if self._edges is not None:
            for one in self.all_reported():
                one.last = -1
            sites.set_take(self._edges.take)
        elif (config.site_cap or config.process_cap) and is_on:
            sites.set_take(self._caps.take)
        else:
            sites.set_take(all_sinks.take)
        if self._ring is not None and is_on:
            self._start_ring()
        return True

    def _with_ring(self, config: Config, sink: Sink) -> Sink:
        """What takes all reports: ``sink``, and the ring beside it if there is one."""
        self._to_file = sink if isinstance(sink, FileSink) else None
        if not config.ring_ns or config.sink in ("file", "off"):
            return sink
        beside = self._file_sink(config)
        if beside is None:
            return sink
        self._to_file = beside
        return BesideSink(sink, beside)

    def _sink_of(self, config: Config) -> Sink | None:
        """The sink for these settings; the current one if it fits."""
        if config.sink == "file":
            return self._file_sink(config)
        if self.file is not None and not config.ring_ns:
            self.file.close()
            self.file = None
        if config.sink == "off":
            return Sink()
        is_ros2 = ros_state.is_ros2()
        if self._was_node:
            is_rosout = config.sink == "rosout" or (config.sink == "auto" and not is_ros2)
            topic = "/rosout" if is_rosout else "/threshold_information"
            warn(
                f"process {os.getpid()} was forked from a node: its reports do not reach {topic};"
                " the sink file records them"
            )
            return Sink()
        if is_ros2:
            kind2 = _OF_ROS2[config.sink]
            is_it = type(self._sink) is kind2
            return self._sink if is_it else kind2(self._link, self.all_reported)
        kind = _OF_ROS1[config.sink]
        return self._sink if type(self._sink) is kind else kind()

    def _file_sink(self, config: Config) -> FileSink | None:
        if self.file is None or self.file.is_stopped:
            try:
                new = self._new_file(config)
            except OSError as error:
                if self._ring is not None:
                    self._ring.failed(error)
                    return None
                place = error.filename or config.folder
                warn(f"{place}: {error.strerror or error}; no reports are written to a file")
                return None
            if self._ring is not None:
                self._ring.turned(self.file)
            elif self.file is not None:
                self.file.close()
            self.file = new
        self.file.write_policy(config)
        if isinstance(self._sink, FileSink) and self._sink.file is self.file:
            return self._sink
        return FileSink(self.file)

    def _new_file(self, config: Config) -> LogFile:
        """A new file, the next one of the ring if there is one.

        Raises:
            OSError: it cannot be made.
        """
        if not config.ring_ns:
            return LogFile(config, self._parent, self._look)
        if self._ring is None:
            self._ring = Ring(config)
        return self._ring.next(
            self.file, lambda name: LogFile(config, self._parent, self._look, name)
        )

    def _flush(self) -> None:
        """Send what is still kept to its sink."""
        if self._edges is not None:
            self._edges.flush(all_of_them=True)
        self._caps.account()

    def _look(self) -> None:
        """Once a second, in a report to the file: start the helper if rospy is imported by now."""
        if not self._has_helper and not self._is_served and ros1_state.is_imported():
            self._start_helper()

    # --- the ring

    def _start_ring(self) -> None:
        """Start the thread of the ring, which goes on until the process ends."""
        if self._has_ring_thread:
            return
        self._has_ring_thread = True
        try:
            _thread.start_new_thread(self._turn_ring, (os.getpid(),))
        except RuntimeError:
            warn("cannot start a thread: the ring has one file, which is as large as its budget")

    def _turn_ring(self, process: int) -> None:
        while os.getpid() == process:
            ring = self._ring
            if ring is None:
                break
            ring.wait()
            with self._lock:
                if not self._has_ring_thread or self._ring is not ring:
                    break
                self._turn(ring)

    def _turn(self, ring: Ring) -> None:
        """Begin the next file of the ring if it is time; the lock is held."""
        ring.settle()
        config = self.config.filled_in()
        old, to_file = self.file, self._to_file
        if config.sink == "off":
            ring.rest()
            return
        if to_file is None:
            # It could not be begun with the sink, which goes on as it is until it can.
            if ring.is_due(None):
                try:
                    self.file = self._new_file(config)
                except OSError as error:
                    ring.failed(error)
                else:
                    self._choose(self.config)
            return
        if old is not None:
            old.look(monotonic_ns())
        if self._edges is not None and not self._has_helper and self._ros2 is None:
            # Nobody else ends the periods.
            self._edges.flush(all_of_them=False)
        if not ring.is_due(old):
            return
        try:
            new = self._new_file(config)
        except OSError as error:
            ring.failed(error)
            return
        new.write_policy(config)

        def turn() -> None:
            self.file = new
            to_file.go_on_in(new)

        if self._edges is not None:
            self._edges.turn(new, turn)
        else:
            turn()
            if to_file is self._sink and not (config.site_cap or config.process_cap):
                sites.set_take(new.take)
        ring.turned(old)

    # --- the helper thread

    def _start_helper(self) -> None:
        """Start the helper, but not by `threading`: programs count its threads or wait for them."""
        self._has_helper = True
        try:
            _thread.start_new_thread(self._help, ())
        except RuntimeError:
            warn("cannot start a thread: settings cannot be changed while the node runs")

    def _help(self) -> None:
        """Serve the node's settings, and poll the sinks, as long as needed."""
        process = os.getpid()
        retry_at = 0.0
        while self._has_helper and os.getpid() == process:
            ros = ros1_state.rospy()
            if ros is not None and not self._is_served and time.monotonic() >= retry_at:
                try:
                    Control(self, ros).begin()
                    self._is_served = True
                except Exception as error:
                    retry_at = time.monotonic() + 2.0
                    if not ros.is_shutdown():
                        warn(f"the settings of {ros.get_name()} cannot be read yet: {error}")
            wait_s = self.poll()
            if self._is_served and wait_s is None:
                break
            is_late = wait_s is None and ros is None
            time.sleep(_LATE_S if is_late else self._sink.poll_s)
        self._has_helper = False

    def poll(self) -> float | None:
        """Let policy and sink do what is due; the seconds until the next time, None for never."""
        sink, edges = self._sink, self._edges
        has_periods = edges is not None and (
            not isinstance(sink, FileSink) or isinstance(edges, Light)
        )
        if edges is not None and has_periods:
            edges.flush(all_of_them=False)
        sink.poll()
        return sink.poll_s if sink.is_polled or has_periods else None

    # --- ROS 2

    def _link(self) -> Link | None:
        return None if self._ros2 is None else self._ros2.link

    def _node_came(self) -> None:
        """The program has made a node of rclpy."""
        with self._lock:
            if ros2_state.has_several() and not self._is_split:
                self._is_split = True
                sites.put_over(Split(self.instance).over)
            if not self._is_started:
                return
            if self.file is not None:
                self.file.look_again()
            self._begin_ros2()

    def _begin_ros2(self) -> None:
        """Use the graph from now on: by the sinks of ROS 2, and a thread."""
        if self._ros2 is not None or self._was_node:
            return
        self._ros2 = Helper(self)
        if self._config is not None:
            self._choose(self._config)
        if not self._ros2.start():
            warn("cannot start a thread: settings cannot be changed while the node runs")

    def fall_back(self, why: str) -> None:
        """The graph cannot be used: write a file from now on, with what waits for the graph."""
        # rcl goes on with what its developers may do.
        why = why.partition("\n")[0]
        with self._lock:
            former, config = self._sink, self.config.filled_in()
            if not isinstance(former, WaitingSink):
                warn(f"ROS 2 cannot be used, so settings cannot be changed: {why}")
                return
            waiting = former.drain()
            if not self._choose(config._replace(sink="file")) or self.file is None:
                return
            self._config = config._replace(sink="file")
            take = self._sink.edge if config.policy != "every" else self._sink.take
            for one in waiting:
                if one.one is not None and one.report is not None:
                    take(one.one, *one.report)
            folder = os.path.dirname(self.file.path)
            warn(f"ROS 2 cannot be used, so reports are written to files in {folder}: {why}")

    def status(self) -> str:
        """The settings in effect as ``name=value`` words, as C++ nodes answer."""
        with self._lock:
            config = self.config.filled_in()
            words = [f"sink={config.sink}", f"policy={config.policy}"]
            if config.policy != "every":
                words.append(f"period={config.period_ns / 1e9:.6f}")
            if config.site_cap:
                words.append(f"site_cap={config.site_cap}")
            if config.process_cap:
                words.append(f"process_cap={config.process_cap}")
            words += [f"sites={len(self._reported)}", f"dropped={self._caps.dropped_in_all}"]
            words.append(self._sink.status())
            if self._ring is not None and config.sink != "off":
                words.append(self._ring.status(self.file))
            return " ".join(word for word in words if word)

    def end(self) -> None:
        """Called when the process ends by itself."""
        with self._lock:
            self._has_helper = self._has_ring_thread = False
            self._flush()
            helper, sink = self._ros2, self._sink
        if helper is not None:
            helper.end()
            sink.is_last = True
            helper.send_rest(sink)
        with self._lock:
            self._sink.end()
            if self._ring is not None:
                if self._to_file is not None and self._to_file is not self._sink:
                    self._to_file.end()
                self._ring.end()
        if helper is not None:
            helper.close()

    # --- fork

    def _before_fork(self) -> None:
        self._lock.acquire()

    def _parent_goes_on(self) -> None:
        self._lock.release()

    def _child(self) -> None:
        """In the child: the file belongs to the parent, other threads are gone, locks are new."""
        self._lock = threading.RLock()
        if self.file is not None:
            # Never unmapped: its descriptors may belong to other files by now.
            _FORMER.append(self.file)
        self._was_node = self._was_node or ros_state.has_node()
        if self._ros2 is not None:
            _FORMER.append(self._ros2)
        self._ros2 = None
        if self._is_started:
            self._parent = os.getppid()
        self.file = None
        # What is in it is the parent's.
        self._ring = None
        self._to_file = None
        self._has_ring_thread = False
        self._sink = Sink()
        self._edges = None
        self._caps = Caps(Config(), self._sink)
        self._has_helper = False
        # A child has no node, and keeps its settings.
        self._is_served = self._is_served or self._was_node
        self._is_started = self._is_starting = False
        for one in self.all_reported():
            one.last = -1
            one.meter[:] = [0, 0]
            one.file = None
        sites.set_take(self._first)


# What only the parent may close.
_FORMER: list[LogFile | Helper] = []

RUNTIME = Runtime()
