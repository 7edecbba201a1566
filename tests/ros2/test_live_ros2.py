"""`pytpc live` on a real ROS 2 graph: updates, and marks of observers that a recording has."""

from __future__ import annotations

import contextlib
from pathlib import Path

from test_record_ros2 import analysed, guard

from live_page import Live
from pytpc.ingest.reading import read
from ros2_commands import SOME_REPORTS, interrupted, read_until, recorder


# The page finds the recording that runs, and its static information, by itself.
def test_reports_are_shown_and_marks_are_recorded(env: dict[str, str], tmp_path: Path) -> None:
    key = analysed(env, tmp_path)
    with contextlib.ExitStack() as stack:
        process = stack.enter_context(recorder(env, tmp_path, "--static", "static.json"))
        node = stack.enter_context(guard(env, tmp_path, 50, 600.0, key))
        read_until(process, SOME_REPORTS)
        with Live(env, tmp_path) as live:
            live.until(lambda board: board["near"])
            (row,) = live.board["near"]
            assert row["parameter"].endswith("limits.speed")
            assert row["node"] == "/robot1/guard"
            assert row["threshold"] == "6.5"
            assert live.ask("2")["said"].startswith("marked: type II")
            assert live.ask("where", text="/robot1/stop")["ok"]
            live.until(lambda board: "ana: connected" in " ".join(board["state"]["lines"]))
            # The node goes: the last board stays, and the page says that nothing comes.
            node.kill()
            live.until(lambda board: board["state"]["quiet_since"])
            assert live.ask("1")["ok"]
        interrupted(process)
    marks = read(tmp_path / "mission").marks
    assert [(mark.type, mark.observer, mark.note) for mark in marks] == [
        ("II", "ana", "@/robot1/stop"),
        ("I", "ana", ""),
    ]
