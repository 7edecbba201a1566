"""The report page as one HTML file that asks the network for nothing.

Each figure is in it twice: as SVG, for paper and for readers without scripts, and as numbers from
which the page's script draws with Bokeh (docs/explanation/decisions.md).
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Callable, Sequence
from functools import cache
from importlib.resources import files
from itertools import count
from pathlib import Path

from bokeh.resources import Resources
from markupsafe import Markup

from pytpc.base.atomic import write_atomic
from pytpc.present.page.environment import environment
from pytpc.present.page.reported_mission import ReportedMission
from pytpc.present.page.view import ROWS, figures, mission_view

Progress = Callable[[int, int], None]
_OWN = ("report-figures.js", "report-timeline.js", "report.js")


def write_page(
    path: Path,
    missions: Sequence[ReportedMission],
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
    write_atomic(path, page_text(missions, title, on_progress).encode("utf-8", "replace"))


def page_text(
    missions: Sequence[ReportedMission], title: str, on_progress: Progress | None = None
) -> str:
    """The page as text. Whatever comes from the robot is escaped."""
    total = sum(figures(mission) for mission in missions)
    made = count(1)

    def figure_made() -> None:
        number = next(made)
        if on_progress is not None:
            on_progress(number, total)

    views = [mission_view(mission, n, figure_made) for n, mission in enumerate(missions, start=1)]
    scripts = _scripts()
    return (
        environment()
        .get_template("report.html.j2")
        .render(
            title=title,
            missions=views,
            rows=ROWS,
            scripts=scripts,
            hashes=[_hash(script) for script in scripts],
        )
    )


@cache
def _scripts() -> tuple[Markup, ...]:
    """Bokeh's scripts and ours, in the order in which they run."""
    templates = files("pytpc.present.page").joinpath("templates")
    # Behind the two stands one that only sets how much is said to the console, and says so there.
    bokeh = Resources(mode="inline", components=["bokeh", "bokeh-api"]).js_raw[:2]
    own = [templates.joinpath(name).read_text("utf-8") for name in _OWN]
    return tuple(Markup(text) for text in (*bokeh, *own))


def _hash(script: str) -> str:
    return f"sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}"
