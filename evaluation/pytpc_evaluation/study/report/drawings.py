"""The figures of the page as files: 6.14 and 6.15 to 6.18 of each system, and the study's own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

from pytpc.base.errors import TpcError
from pytpc_evaluation.stats.bars import runtime_bars
from pytpc_evaluation.stats.drawing import save, style
from pytpc_evaluation.stats.figures import state_of, trial_figure
from pytpc_evaluation.stats.missions import Trial
from pytpc_evaluation.study.report.charts import reliability_chart, result_chart
from pytpc_evaluation.study.report.confidence import SAID, SURE_METHODS, calibration
from pytpc_evaluation.study.report.folder import FlownMission, FlownSystem
from pytpc_evaluation.study.report.original import KIND_NAMES, Original
from pytpc_evaluation.study.report.parts import Part
from pytpc_evaluation.study.report.positions import Position
from pytpc_evaluation.study.report.ranked import changed_rows
from pytpc_evaluation.study.report.systems import one_of_each

# Between sharp on a page and small in a repository.
DPI = 100
_NUMBERS = {"type1": "6.15", "type2": "6.16", "fault": "6.17", "clean": "6.18"}

Advance = Callable[[int, int], None]


@dataclass(frozen=True, slots=True)
class Drawing:
    """A figure that was drawn; ``system`` is empty where it is of the whole study."""

    file: str
    system: str
    caption: str


def draw_systems(
    originals: Sequence[Original],
    systems: Sequence[FlownSystem],
    folder: Path,
    halves: Sequence[str],
    on_progress: Advance | None = None,
) -> tuple[list[Drawing], list[str]]:
    """Draw the thesis's figures of each system.

    Missions of other halves are not drawn: their curves show how the changed parameter ranks.

    Returns:
        The figures, and a sentence for each that could not be drawn.

    Raises:
        TpcError: a file cannot be written.
    """
    drawn: list[Drawing] = []
    troubles: list[str] = []
    for number, (original, system) in enumerate(zip(originals, systems, strict=True), start=1):
        if on_progress is not None:
            on_progress(number, len(systems))
        changed = {flight.treatment.parameter for flight in system.flights} - {None}
        name = f"{system.name}-runtime.png"
        with style():
            figure = runtime_bars(original.runtime, sorted(filter(None, changed)))
            save(figure, folder / name, "png", DPI, palette=True)
        said = f"Figure 6.14 of {system.name}: how often each parameter is compared with."
        drawn.append(Drawing(name, system.name, said))
        for flight in shown_flights(system, halves):
            said = _caption(flight)
            name = f"{system.name}-{flight.treatment.type}.png"
            trial = Trial(_title(flight), flight.as_said())
            state = state_of(trial, on_trouble=lambda text: troubles.append(f"{text}."))
            with style():
                try:
                    figure = trial_figure(trial, system.static_info, state)
                except TpcError as error:
                    troubles.append(f"{_title(flight)} is not drawn: {error}.")
                    continue
                save(figure, folder / name, "png", DPI, palette=True)
            number_of = _NUMBERS[flight.treatment.type]
            drawn.append(Drawing(name, system.name, f"Figure {number_of} of {said}"))
    return drawn, troubles


def draw_results(rows: Sequence[Position], folder: Path, parts: Sequence[Part]) -> list[Drawing]:
    """Draw the main result of each part, and the calibration of each half.

    Raises:
        TpcError: a file cannot be written.
    """
    drawn = []
    with style():
        for part in parts:
            if changed_rows(rows, part):
                name = f"top3-{part.name}.png"
                save(result_chart(rows, part), folder / name, "png", DPI, palette=True)
                said = f"Top 3 by method and labels, the {part.title}; lines are 95 % intervals."
                drawn.append(Drawing(name, "", said))
        for half, method in product(dict.fromkeys(part.half for part in parts), SURE_METHODS):
            found = calibration(rows, half, method)
            if found.drawn:
                name = f"confidence-{half}-{method.replace('+', '-')}.png"
                save(reliability_chart(found, method), folder / name, "png", DPI, palette=True)
                said = f"How often verdicts of {method} are right, by confidence; {SAID} marks"
                drawn.append(Drawing(name, "", f"{said}, the {half} half."))
    return drawn


def shown_flights(system: FlownSystem, halves: Sequence[str]) -> list[FlownMission]:
    """The first treatment of each type by name with marks, else the first: nothing is picked."""
    shown: dict[str, FlownMission] = {}
    flights = [flight for flight in system.flights if flight.half in halves]
    for flight in one_of_each(flights):
        kind = flight.treatment.type
        if kind not in shown or (flight.said and not shown[kind].said):
            shown[kind] = flight
    return list(shown.values())


def _title(flight: FlownMission) -> str:
    return f"{flight.system}, {KIND_NAMES[flight.treatment.type]}, seed {flight.seed}"


def _caption(flight: FlownMission) -> str:
    kind = KIND_NAMES[flight.treatment.type]
    return f"{flight.system}, {kind}: {flight.treatment.name}, seed {flight.seed}."
