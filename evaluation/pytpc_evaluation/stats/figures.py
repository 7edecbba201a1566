"""The figures of a study as files: ``runtime`` (6.14) and one for each trial (6.15 to 6.18)."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from pathlib import Path

from matplotlib.figure import Figure

from pytpc.base.errors import TpcError
from pytpc.diagnosis.full_names import with_full_names
from pytpc.diagnosis.question import WINDOW_S, Question
from pytpc.diagnosis.scores.score_tables import STEP_S, rank_curves
from pytpc.static.static_info import StaticInfo
from pytpc_evaluation.stats.bars import runtime_bars
from pytpc_evaluation.stats.curves import mission_figure
from pytpc_evaluation.stats.drawing import save, style
from pytpc_evaluation.stats.figure_choice import Figures
from pytpc_evaluation.stats.missions import StudyMission, Trial, in_order
from pytpc_evaluation.stats.runtime import runtime_statistics
from pytpc_evaluation.stats.states import RobotState, robot_state, seen_state

# More points than a page is wide would only be drawn over each other.
_POINTS = 1500


def draw_study(
    missions: Sequence[StudyMission],
    static_info: StaticInfo,
    wanted: Figures,
    on_progress: Callable[[int, int], None] | None = None,
    on_trouble: Callable[[str], None] | None = None,
) -> list[Path]:
    """Draw all figures of a study.

    Args:
        missions: in any order.
        static_info: of the build that flew them.
        wanted: what is drawn, where and how.
        on_progress: called with (figures drawn, figures in all).
        on_trouble: called with a sentence where something of a mission cannot be drawn.

    Returns:
        The files.

    Raises:
        TpcError: a file cannot be written, or a mission is too long for its curves.
    """
    trials = in_order(missions)
    names = _file_names([trial.label for trial in trials])
    written: list[Path] = []
    with style():
        found = runtime_statistics([trial.mission.recording for trial in trials], static_info)
        figure = runtime_bars(found, _changed(missions))
        for form in wanted.formats:
            written.append(wanted.folder / f"runtime.{form}")
            save(figure, written[-1], form)
        for number, (trial, name) in enumerate(zip(trials, names, strict=True), start=1):
            if on_progress is not None:
                on_progress(number, len(trials) + 1)
            state = state_of(trial, wanted.states, on_trouble)
            figure = trial_figure(trial, static_info, state, wanted.window_s)
            for form in wanted.formats:
                written.append(wanted.folder / f"{name}.{form}")
                save(figure, written[-1], form)
    return written


def trial_figure(
    trial: Trial, static_info: StaticInfo, state: RobotState, window_s: float = WINDOW_S
) -> Figure:
    """The figure of one trial; call it within `drawing.style`.

    Raises:
        TpcError: the mission is too long for its curves.
    """
    recording, treatment = trial.mission.recording, trial.mission.treatment
    step_s = max(STEP_S, recording.seconds / _POINTS)
    named = with_full_names(static_info, recording, {})
    curves = rank_curves(recording, named, Question(window_s=window_s), step_s=step_s)
    changed = None if treatment is None else treatment.parameter
    return mission_figure(_title(trial), recording, curves, state, changed)


def state_of(
    trial: Trial,
    states: Sequence[str] = (),
    on_trouble: Callable[[str], None] | None = None,
) -> RobotState:
    """What the robot did; nothing where it cannot be read: the ranks are drawn all the same.

    Sights are taken where nothing of a bag is asked for, or there is none.

    Args:
        trial: the mission.
        states: fields of the bag, see `pytpc_evaluation.stats.states`.
        on_trouble: called with a sentence where the state cannot be read.
    """
    bag, sights = trial.mission.bag, trial.mission.sights
    start_ns = trial.mission.recording.start_ns
    if sights is not None and not states:
        try:
            return seen_state(sights, start_ns)
        except TpcError as error:
            if on_trouble is not None:
                on_trouble(f"{trial.label}: {error}")
    if bag is None:
        if states and on_trouble is not None:
            on_trouble(f"{trial.label}: without a bag nothing is known of the robot")
        return RobotState()
    try:
        return robot_state(bag, start_ns, states)
    except TpcError as error:
        if on_trouble is not None:
            on_trouble(f"{trial.label}: {error}")
        return RobotState()


def _title(trial: Trial) -> str:
    treatment = trial.mission.treatment
    if treatment is None or treatment.parameter is None:
        return trial.label
    return f"{trial.label}: {treatment.change}"


def _changed(missions: Sequence[StudyMission]) -> list[str]:
    found = (mission.treatment for mission in missions)
    return sorted({t.parameter for t in found if t is not None and t.parameter is not None})


def _file_names(labels: Sequence[str]) -> list[str]:
    """Names of files that no two labels share, whatever is in them."""
    names: list[str] = []
    for label in labels:
        name = re.sub(r"[^0-9A-Za-z._-]+", "-", label).strip("-.") or "mission"
        name, plain_name, count = name[:100], name[:100], 1
        while name in {*names, "runtime"}:
            count += 1
            name = f"{plain_name}-{count}"
        names.append(name)
    return names
