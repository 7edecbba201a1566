"""The report page as one HTML file that asks the network for nothing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import count
from pathlib import Path

from pytpc.atomic import write_atomic
from pytpc.report.environment import environment
from pytpc.report.view import MissionReport, figures, mission_view

__all__ = ["MissionReport", "render", "write_report"]

Progress = Callable[[int, int], None]


def write_report(
    path: Path,
    missions: Sequence[MissionReport],
    *,
    title: str = "Suspected parameters",
    on_progress: Progress | None = None,
) -> None:
    """Write the page, atomically. The same missions make the same bytes.

    Args:
        path: the HTML file.
        missions: in the order of the page.
        title: its heading.
        on_progress: called with (figures made, figures in all); a figure takes a tenth of a second.

    Raises:
        TpcError: the file cannot be written; what stood there before is untouched.
    """
    write_atomic(path, render(missions, title, on_progress).encode("utf-8", "replace"))


def render(
    missions: Sequence[MissionReport], title: str, on_progress: Progress | None = None
) -> str:
    """The page as text. Whatever comes from the robot is escaped."""
    total = sum(figures(mission) for mission in missions)
    made = count(1)

    def figure_made() -> None:
        number = next(made)
        if on_progress is not None:
            on_progress(number, total)

    views = [mission_view(mission, n, figure_made) for n, mission in enumerate(missions, start=1)]
    return environment().get_template("report.html.j2").render(title=title, missions=views)
