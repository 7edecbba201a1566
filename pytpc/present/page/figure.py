"""The figure of a comparison at a mark: its SVG, its legend, and its numbers for the script."""

from __future__ import annotations

from dataclasses import dataclass

from markupsafe import Markup

from pytpc.base.wording import Number, exact, show
from pytpc.diagnosis.results.mission_answer import Spans
from pytpc.diagnosis.results.suspects import Accused, Suspect
from pytpc.present.as_json import finite
from pytpc.present.page.payload import series_of
from pytpc.present.page.plots import (
    EvidenceStyle,
    beyond_text,
    evidence_svg,
    times_beyond,
    value_span,
)
from pytpc.present.page.reported_mission import ReportedMission
from pytpc.present.page.series import PlotData, plot_data
from pytpc.recording.declaration import Declared
from pytpc.recording.marks import Mark
from pytpc.static.measures import parameter_unit, threshold_unit


@dataclass(frozen=True)
class Wanted:
    """The value whose threshold a figure shows, and which thresholds would do.

    ``what`` is what the legend calls the value, ``value`` is in the parameter's unit, and
    ``threshold`` is what it gives; None if there is none to draw.
    """

    what: str
    value: Number | None
    threshold: float | None
    feasible: Spans


@dataclass(frozen=True)
class FigureView:
    """A figure with its legend; ``ident`` names it in the page.

    ``suggested`` is the suggested value in words; empty if none is drawn. ``unit`` is that of the
    axis; empty if it is not known. ``beyond`` says which compared values are beyond the plot.
    """

    ident: str
    plot: Markup
    alone: str
    is_flag: bool
    kept: bool
    limit_name: str
    suggested: str
    would: bool
    window: bool
    unit: str
    changed: bool
    beyond: str


class PageFigures:
    """The data of one mission's figures for the page's script: cards, and series by TPC."""

    def __init__(self, mission: ReportedMission) -> None:
        self._mission = mission
        self._numbers: dict[str, int] = {}
        self.series: list[dict[str, object]] = []
        self.cards: dict[str, dict[str, object]] = {}

    def draw(
        self,
        suspect: Suspect | Accused,
        mark: Mark,
        wanted: Wanted,
        declared: Declared | None,
        ident: str,
    ) -> FigureView:
        """Draw the comparison of a suspect around a mark, and keep its numbers."""
        mission, found = self._mission, suspect.comparison
        at = mission.seconds(mark.time_ns)
        description = "" if declared is None else declared.description
        unit = threshold_unit(found, description)
        style = EvidenceStyle(
            mark=at,
            mark_type=mark.type,
            window=at - mission.answer.question.window_s if suspect.type == "II" else None,
            suggested=wanted.threshold,
            culprit=mission.is_changed(suspect.parameter, suspect.key),
            feasible=wanted.feasible,
            unit=unit,
            flag=found.relation == "flag",
        )
        data = plot_data(mission.recording, suspect.key, mark.time_ns)
        label = (
            f"{suspect.parameter}: compared value and threshold around the mark at {at:.1f} s;"
            f" {data.evaluations} evaluations, {data.flops.size} changes of the result"
        )
        self._keep(ident, suspect.key, _numbers(data, style))
        told = _suggested(wanted, parameter_unit(found, description), unit)
        return FigureView(
            ident=ident,
            # Made of matplotlib's own XML, in which it escapes every text.
            plot=Markup(evidence_svg(data, style, ident, label)),
            alone=label,
            is_flag=style.flag,
            kept=bool(data.kept.size),
            limit_name=found.name or suspect.parameter,
            suggested=told,
            would=bool(wanted.feasible),
            window=style.window is not None,
            unit=unit,
            changed=style.culprit,
            beyond=beyond_text(data, style),
        )

    def _keep(self, ident: str, key: str, card: dict[str, object]) -> None:
        """Keep a figure's numbers, and the evaluations of its TPC if they are new."""
        if key not in self._numbers:
            self._numbers[key] = len(self.series)
            self.series.append(series_of(self._mission.recording, key))
        self.cards[ident] = {**card, "series": self._numbers[key]}


def _suggested(wanted: Wanted, own: str, unit: str) -> str:
    """``to try: 30 °, here 0.524 rad``; empty if nothing is drawn."""
    value, threshold = wanted.value, wanted.threshold
    if value is None or threshold is None or finite(threshold) is None:
        return ""
    text = f"{wanted.what}: {exact(value)}{own and f' {own}'}"
    # A parameter in a C++ float is not another value.
    if show(float(value)) == show(threshold):
        return text
    return f"{text}, here {show(threshold)}{unit and f' {unit}'}"


def _numbers(data: PlotData, style: EvidenceStyle) -> dict[str, object]:
    low, high, beyond = value_span(data, style)
    return {
        "begin": data.begin,
        "end": data.end,
        "low": low,
        "high": high,
        "beyond": beyond,
        "edges": [times.tolist() for times in times_beyond(data, style)],
        "mark": style.mark,
        "type": style.mark_type or "",
        "window": style.window,
        "suggested": finite(style.suggested),
        "feasible": [[finite(low), finite(high)] for low, high in style.feasible],
        "culprit": style.culprit,
        "kept": bool(data.kept.size),
        "flag": style.flag,
        "label": style.axis,
    }
