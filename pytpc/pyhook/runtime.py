"""What is chosen for this process, and what a report meets.

Nothing happens until the first report. There is no thread for the sink ``file``: what is due once a
second is done by the report that finds it due. A child after a fork goes on with the settings that
held and begins a file of its own.
"""

from __future__ import annotations

import atexit
import os
import threading
from time import monotonic_ns

from pytpc.pyhook import ros_state, sites
from pytpc.pyhook.config import Config, of_environment
from pytpc.pyhook.find import Place
from pytpc.pyhook.log_file import LogFile
from pytpc.pyhook.sites import Reported
from pytpc.pyhook.words import warn


class Runtime:
    """All that changes seldom. There is one, `RUNTIME`."""

    def __init__(self) -> None:
        """Nothing is started."""
        self._lock = threading.RLock()
        self._reported: dict[str, Reported] = {}
        self._config: Config | None = None
        self._is_started = False
        self._parent = 0
        self.file: LogFile | None = None
        sites.set_take(self._first)
        # Handlers run in the reverse order of their registration: this one is among the last.
        atexit.register(self.end)
        os.register_at_fork(
            before=self._before_fork,
            after_in_parent=self._parent_goes_on,
            after_in_child=self._child,
        )

    def register(self, place: Place) -> Reported:
        """The report of a place; one for each key and side."""
        key = place.listed.key
        with self._lock:
            known = self._reported.get(key)
            if known is None:
                known = Reported(key, len(self._reported) + 1, place.swapped)
                self._reported[key] = known
        if known.swapped == place.swapped:
            return known
        return Reported(key, known.number, place.swapped)

    def all_reported(self) -> list[Reported]:
        """Every key that may report."""
        with self._lock:
            return list(self._reported.values())

    @property
    def config(self) -> Config:
        """What holds."""
        with self._lock:
            if self._config is None:
                self._config = of_environment()
            return self._config

    def _first(self, one: Reported, result: bool, cmp: float, thresh: float, res: bool) -> None:
        """The first report, before anything is chosen."""
        self.start()
        if self._is_started:
            sites.take(one, result, cmp, thresh, res)

    def start(self) -> None:
        """Choose what the environment says, or what held before a fork."""
        with self._lock:
            if self._is_started:
                return
            self._is_started = True
            config = self.config
            if not self._choose(config):
                self._config = config._replace(sink="off")
                self._choose(self._config)

    def apply(self, config: Config) -> bool:
        """Let ``config`` hold from now on; False where its file cannot be had: nothing changes."""
        self.start()
        with self._lock:
            if config == self.config:
                return True
            if not self._choose(config):
                return False
            self._config = config
            return True

    def _choose(self, config: Config) -> bool:
        if config.sink == "file":
            if not self._open(config):
                return False
            assert self.file is not None
            self.file.write_policy(config)
            sites.set_take(self.file.take)
        else:
            sites.set_take(sites.nothing)
        return True

    def _open(self, config: Config) -> bool:
        """A file of these settings; the one that there is where it is that."""
        held = self.config
        same = (held.folder, held.file_limit) == (config.folder, config.file_limit)
        if self.file is not None and not self.file.is_stopped and same:
            return True
        try:
            new = LogFile(config, self._parent, ros_state.now)
        except OSError as error:
            place = error.filename or config.folder
            warn(f"{place}: {error.strerror or error}; no reports are written to a file")
            return False
        if self.file is not None:
            self.file.close()
        self.file = new
        return True

    def end(self) -> None:
        """The process ends by itself."""
        with self._lock:
            if self.file is not None:
                self.file.look(monotonic_ns())
                self.file.close()

    def _before_fork(self) -> None:
        self._lock.acquire()

    def _parent_goes_on(self) -> None:
        self._lock.release()

    def _child(self) -> None:
        """After a fork, in the child: the file is the parent's, and the locks are new."""
        self._lock = threading.RLock()
        if self.file is not None:
            # Never unmapped: its descriptors may be others' by now.
            _FORMER.append(self.file)
        self.file = None
        self._parent = os.getppid() if self._is_started else self._parent
        self._is_started = False
        for one in self.all_reported():
            one.last = -1
            one.lock = threading.Lock()
        sites.set_take(self._first)


_FORMER: list[LogFile] = []

RUNTIME = Runtime()
