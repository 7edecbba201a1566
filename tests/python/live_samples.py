"""A board of a small recording, for the tests of `pytpc live`."""

from __future__ import annotations

from pathlib import Path

from mission_samples import comparison, events, ns, static_info

from pytpc.api.live_board import LiveBoard
from pytpc.api.live_mission import RecordedFeed, WatchedMission, fresh_watching
from pytpc.api.live_observers import ObserverMissions, Observers
from pytpc.diagnosis.question import Question
from pytpc.present.marking_terminal import RecordedMission
from pytpc.present.watch_screen import WatchOptions
from pytpc.recording.graph_places import Place
from pytpc.recording.marks_file import MarksFile
from pytpc.recording.marks_home import MarksHome
from pytpc.recording.mission import Recording

NAMES = ("~near", "~far", "~turns", "~on")


def mission(names=NAMES, seconds: int = 40):
    """40 s at 10 Hz. ``~near`` ends 0.5 below its limit of 10, with values from 0 on; ``~far`` 6
    below; ``~turns`` turns each 5 s, the last time at 35 s; ``~on`` is a flag that is on.
    """
    static = static_info(
        comparison(0, names[0], topic="/near"),
        comparison(1, names[1], topic="/far"),
        comparison(2, names[2], "<", topic=names[2]),
        comparison(3, names[3], "flag", topic=None),
    )
    rows = []
    for step in range(seconds * 10):
        t = step / 10
        rows += [
            (t, 0, False, 0 if step == 0 else 9.5, 10),
            (t, 1, False, 0 if step == 0 else 4, 10),
            (t, 2, step % 100 < 50, 20 if step % 100 < 50 else 30, 25),
            (t, 3, True, 1, 1),
        ]
    return static, Recording("flight", events(rows, node="/robot"), (), 0, ns(seconds))


def board_of(folder: Path, static, recording, places: tuple[Place, ...] = ()) -> LiveBoard:
    clock = RecordedMission("flight", recording.start_ns, recording.end_ns, places)
    feed = RecordedFeed(recording, fresh_watching(static, Question()))
    watched = WatchedMission(ObserverMissions(clock), feed, WatchOptions())
    observers = Observers(watched, MarksFile(MarksHome(folder / "marks.csv")))
    return LiveBoard(watched, observers, clock, 12.0)
