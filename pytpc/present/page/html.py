"""The report page as one HTML file that asks the network for nothing.

Each figure is in it twice: as SVG, for paper and for readers without scripts, and as numbers from
which the page's script draws with Bokeh (docs/explanation/decisions.md).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import cache

from bokeh.resources import Resources
from markupsafe import Markup

from pytpc.present.page.environment import environment, page_script, script_hash
from pytpc.present.page.reported_mission import ReportedMission
from pytpc.present.page.terms import TERMS, explained, term
from pytpc.present.page.view import ROWS, mission_view

_OWN = ("theme.js", "report-figures.js", "report-timeline.js", "report.js")


def page_text(
    missions: Iterable[ReportedMission], title: str, on_figure: Callable[[], None]
) -> str:
    """The page as text. Whatever comes from the robot is escaped.

    The answers of missions are large: no more than two of them are held at once.
    """
    views = [mission_view(mission, n, on_figure) for n, mission in enumerate(missions, start=1)]
    scripts = _scripts()
    made = environment()
    made.filters["explained"] = explained
    made.globals["term"] = term
    return made.get_template("report.html.j2").render(
        title=title,
        missions=views,
        rows=ROWS,
        terms=TERMS,
        scripts=scripts,
        hashes=[script_hash(script) for script in scripts],
    )


@cache
def _scripts() -> tuple[Markup, ...]:
    """Bokeh's scripts and ours, in order."""
    # A third script only sets the level of the console's log, and logs that.
    bokeh = Resources(mode="inline", components=["bokeh", "bokeh-api"]).js_raw[:2]
    own = [page_script(name) for name in _OWN]
    return tuple(Markup(text) for text in (*bokeh, *own))
