"""The reports of a running graph, for `pytpc watch`.

It needs no ROS on the observer's machine; `live_reports` reads what it receives.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Sequence

from pytpc.api.live_reports import Item, Reports
from pytpc.base.errors import RunError
from pytpc.diagnosis.ranking.watching import Watching
from pytpc.diagnosis.results.live import Seen
from pytpc.recording.mission import ReadName
from pytpc.recording.summaries import Summary
from pytpc.ros.live_source import reports_at

_LOOK_S = 1.0
_POLL_S = 0.2
# Reports of several nodes are out of order by less than this; more means the clock was set back.
_BACK_NS = 5 * 10**9
# Kept while the graph has no time; older ones are dropped.
_MOST_WAITING = 200_000


class GraphFeed:
    """The reports of the graph of a master, which may come late, go and come again.

    Args:
        master: URI of the ROS master, or the address of the ROS 2 graph.
        fresh: a ranking without reports; where the clock is set back, a copy of it starts again.
    """

    live = True

    def __init__(self, master: str, fresh: Watching) -> None:
        """Listen in a thread of its own."""
        self._fresh = fresh
        self._watching = fresh.snapshot()
        self._source = reports_at(master)
        self._reports = Reports(self._source.decoders)
        self._items: deque[Item] = deque(maxlen=_MOST_WAITING)
        self._other_clock = 0
        # Not known before the first look.
        self._is_there: bool | None = None
        self._why_gone = ""
        self._is_heard = False
        self._first_report_until: float | None = None
        self._restarted = ""
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def stop(self, now_ns: int | None) -> int | None:
        """How far to `take` at a time: what waits is bounded."""
        return now_ns

    def take(self, now_ns: int | None) -> tuple[Watching, Sequence[Item]]:
        """What has arrived since; nothing while the graph has no time."""
        if now_ns is None:
            return self._watching, ()
        last_ns = self._watching.last_ns
        if last_ns is not None and now_ns < last_ns - 2 * _BACK_NS:
            # Another run of the simulator or of a bag begins.
            self._watching = self._fresh.snapshot()
            self._restarted = "the clock was set back, so the ranking started again"
        found: list[Item] = []
        for _ in range(len(self._items)):
            item = self._items.popleft()
            if isinstance(item, Seen) and item.time_ns == 0:
                # A node that has not heard of /clock yet.
                item = item._replace(time_ns=now_ns)
            if isinstance(item, ReadName):
                # A node tells it once in a while, whatever its clock says.
                self._fresh.take_name(item)
                found.append(item)
            elif _time_of(item) <= now_ns + _BACK_NS:
                found.append(item)
            else:
                self._other_clock += 1
        return self._watching, found

    @property
    def is_settled(self) -> bool:
        """Whether reports come, or none came in the time that those who are there may take."""
        until = self._first_report_until
        return self._is_heard or (until is not None and time.monotonic() >= until)

    @property
    def is_gone(self) -> bool:
        """Whether the graph did not answer the last time that it was asked."""
        return self._is_there is False

    def fault(self) -> str:
        """What is wrong with the connection, and what was broken."""
        words = [self._why_gone] if self._is_there is False else []
        words += [self._restarted] if self._restarted else []
        if self._reports.malformed:
            words.append(f"{self._reports.malformed:,} broken")
        if cut := sum(self._source.broken.values()):
            words.append(f"{cut:,} broken off")
        if self._other_clock:
            words.append(f"{self._other_clock:,} left out (another clock)")
        return ", ".join(words)

    def lost(self) -> int:
        """How many messages never arrived, by their sequence numbers."""
        return self._reports.lost

    def dropped(self) -> dict[tuple[str, str], int]:
        """How many reports processes dropped since this began, by node and why."""
        return dict(self._reports.dropped)

    def close(self) -> None:
        """Leave the graph."""
        self._ended.set()
        self._thread.join()

    def _listen(self) -> None:
        threading.Thread(target=self._keep_looking, daemon=True).start()
        try:
            while not self._ended.is_set():
                for source, data in self._source.poll(_POLL_S):
                    self._add(self._reports.read(source, data, time.monotonic()))
                self._add(self._reports.due(time.monotonic()))
        finally:
            self._ended.set()
            self._source.close()

    def _add(self, items: Sequence[Item]) -> None:
        self._items += items
        # A name may come long before the first report.
        if any(not isinstance(item, ReadName) for item in items):
            self._is_heard = True

    def _keep_looking(self) -> None:
        """Find new publishers, also at a master that was restarted."""
        while True:
            try:
                self._source.look()
                self._is_there = True
            except RunError as error:
                self._why_gone = str(error)
                self._is_there = False
            finally:
                # Whatever happened: somebody waits for it.
                if self._first_report_until is None:
                    patience_s = self._source.patience_s if self._is_there else 0.0
                    self._first_report_until = time.monotonic() + patience_s
            if self._ended.wait(_LOOK_S):
                return


def _time_of(item: Seen | Summary) -> int:
    return item.time_ns if isinstance(item, Seen) else item.end_ns
