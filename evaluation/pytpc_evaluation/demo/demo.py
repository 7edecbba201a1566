"""The study in small: treated missions are run, recorded and ranked, and the result is judged.

The observer in these missions sees only what the robot does. Whether the diagnosis names the
parameter that the treatment changed is the question; a mission that did not go as its treatment
demands answers nothing, and is a failure of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rich.table import Table
from rich.text import Text

from pytpc.api.comparing import RecordedRun, beside
from pytpc.api.diagnosing import AskedMission
from pytpc.api.missions import with_names_of
from pytpc.api.report import CARDS, MissionReport
from pytpc.base.errors import RunError
from pytpc.diagnosis.question import PLAIN, Question
from pytpc.diagnosis.ranking.mark_ranking import rank_marks
from pytpc.diagnosis.results.diagnosis import Diagnosis
from pytpc.diagnosis.results.suspects import MarkRanking
from pytpc.diagnosis.suggestion.smallest_change import At, smallest_change
from pytpc.ingest.reading import read
from pytpc.recording.marks import Mark
from pytpc.recording.mission import EVENTS_FILE, MARKS_FILE, Recording, save_recording
from pytpc.ros.mission_run import MISSION_DONE, MissionRun, Progress, RecordOptions
from pytpc.ros.ros1.record_mission import run_mission
from pytpc.static.parameters import same_parameter
from pytpc.static.static_info import StaticInfo
from pytpc.values.origins import read_origins
from pytpc_evaluation.demo.demo_examples import Example
from pytpc_evaluation.treatment import Treatment, save_treatment

FIRST = 3
"""Without good runs, the changed parameter has to be among so many first suspects."""


@dataclass(frozen=True)
class TreatedMission:
    """A mission that was run under a treatment, with the suspects at its marks."""

    example: Example
    treatment: Treatment
    seed: int
    run: MissionRun
    recording: Recording
    rankings: list[MarkRanking]

    @property
    def judged(self) -> list[MarkRanking]:
        """The rankings at the rightly typed marks; empty where no parameter was changed."""
        wanted = self.treatment.mark_type
        return [r for r in self.rankings if wanted is not None and r.mark.type == wanted]

    @property
    def recorded(self) -> RecordedRun:
        """The recording and its folder."""
        return RecordedRun(self.recording, self.run.bag.parent)

    def question(self, static_info: StaticInfo, good: Sequence[TreatedMission]) -> Question:
        """What a user would ask who has the recordings of good missions."""
        named = with_names_of(self.recording, static_info, self.run.bag)
        runs = [one.recorded for one in good if one is not self]
        return beside(PLAIN, runs, self.recorded, static_info, named)

    def diagnosis(self, static_info: StaticInfo, good: Sequence[TreatedMission]) -> Diagnosis:
        """The answer that a user gets."""
        question = self.question(static_info, good)
        return AskedMission.of(self.recorded, static_info, question).diagnosis

    def report(self, static_info: StaticInfo, good: Sequence[TreatedMission]) -> MissionReport:
        """What the report page needs of it: no more than a user could know."""
        return MissionReport(
            self.treatment.name,
            self.recording,
            static_info,
            self.rankings,
            origins=read_origins(self.run.bag),
            question=replace(self.question(static_info, good), top=CARDS),
            source=self.run.bag.parent,
        )


def run_treatment(
    example: Example,
    treatment: Treatment,
    out_dir: Path,
    *,
    seed: int,
    install_env: Mapping[str, str],
    static_info: StaticInfo,
    timeout_s: float,
    launch_args: Mapping[str, str] | None = None,
    on_progress: Callable[[Progress], None] | None = None,
) -> TreatedMission:
    """Run one mission under a treatment, record it, and rank the parameters at its marks.

    Args:
        example: the robot.
        treatment: its overlay and launch arguments are handed to the launch file.
        out_dir: for the recording and what was read from it.
        seed: for all noise of the simulation and for the observer.
        install_env: see ``run_mission``.
        static_info: of the build that runs, and of its nodes in Python.
        timeout_s: wall time after which the mission is ended.
        launch_args: more arguments for the launch file.
        on_progress: see ``run_mission``.

    Raises:
        RunError: the mission could not be run.
        InputError: the recording cannot be read.
    """
    for stale in (EVENTS_FILE, MARKS_FILE):
        (out_dir / stale).unlink(missing_ok=True)
    args = {
        "seed": str(seed),
        "treatment": str(treatment.overlay.absolute()),
        **treatment.launch,
        **(launch_args or {}),
    }
    options = RecordOptions(
        out_dir,
        example.launch,
        args,
        timeout_s,
        until=MISSION_DONE,
        topics=example.watched,
        on_progress=on_progress,
        static_info=static_info,
    )
    run = run_mission(install_env, options)
    recording = read(run.bag)
    return treated(
        example, treatment, seed=seed, run=run, recording=recording, static_info=static_info
    )


def treated(
    example: Example,
    treatment: Treatment,
    *,
    seed: int,
    run: MissionRun,
    recording: Recording,
    static_info: StaticInfo,
) -> TreatedMission:
    """Keep what was recorded under a treatment, and rank the parameters at its marks.

    Raises:
        RunError: no node reported anything.
    """
    out_dir = run.bag.parent
    save_treatment(treatment, out_dir)
    if not len(recording.events):
        raise RunError("no node reported a comparison: was the workspace built with TPC?", run.bag)
    save_recording(recording, out_dir)
    rankings = rank_marks(recording, static_info)
    return TreatedMission(example, treatment, seed, run, recording, rankings)


def gone_wrong(mission: TreatedMission) -> list[str]:
    """Where a mission did not go as its treatment demands, in sentences."""
    example, treatment, run = mission.example, mission.treatment, mission.run
    reached = run.messages.get(example.goal_topic, 0) > 0
    found = []
    if run.ended != "done":
        found.append(f"{treatment.name}: the mission did not end in {run.wall_s:.0f} s")
    if treatment.type == "clean":
        if mission.rankings:
            found.append(f"{treatment.name}: the observer set {len(mission.rankings)} marks")
    elif treatment.mark_type is not None and not mission.judged:
        kind = treatment.mark_type
        found.append(f"{treatment.name}: the observer set no mark of type {kind}")
    for remark in example.goal_remarks(treatment, reached=reached):
        found.append(f"{treatment.name}: {remark}")
    lost = sum(run.lost.values())
    if lost:
        found.append(f"{treatment.name}: {lost} log messages were lost by the recorder")
    return found


def not_named(mission: TreatedMission, diagnosis: Diagnosis) -> list[str]:
    """A sentence where the changed parameter is not named; empty where it is, or nothing changed.

    Beside good runs it has to be the first suspect, without them one of the first ones.
    """
    parameter = mission.treatment.parameter
    if parameter is None or not mission.judged:
        return []
    first = FIRST if diagnosis.differences is None else 1
    named = [one.parameter for one in diagnosis.blame.suspects[:first]]
    if any(same_parameter(parameter, name) for name in named):
        return []
    return [f"{mission.treatment.name}: {parameter} is not named, but {diagnosis.headline}"]


def result_table(missions: Sequence[TreatedMission], static_info: StaticInfo) -> Table:
    """One row for each mark: the changed parameter's position and rank, what is suggested."""
    table = Table(title="The changed parameter at each mark")
    for name in ("Treatment", "Changed"):
        table.add_column(name, overflow="fold")
    table.add_column("Mark", justify="right")
    for name in ("Type", "Position", "Rank"):
        table.add_column(name, justify="right")
    table.add_column("Suggestion for it", overflow="fold")
    table.add_column("Named first")
    for mission in missions:
        treatment = mission.treatment
        head = [treatment.name, treatment.change]
        if not mission.rankings:
            table.add_row(*head, "none", "", "", "", "", "")
        for ranking in mission.rankings:
            table.add_row(*head, *_cells(mission, ranking, static_info))
            head = ["", ""]
        table.add_section()
    return table


def _cells(
    mission: TreatedMission, ranking: MarkRanking, static_info: StaticInfo
) -> list[str | Text]:
    treatment, mark = mission.treatment, ranking.mark
    kind: str = mark.type or "none"
    time = f"{_seconds(mission, mark):.1f} s"
    if treatment.parameter is None:
        return [time, kind, "", "", "", ""]
    rightly = mark.type == treatment.mark_type
    found = ranking.suspect_of(treatment.parameter)
    if not rightly:
        kind += " (wrong type)"
    if found is None:
        return [time, kind, f"- of {ranking.parameters}", "0", "", "no" if rightly else ""]
    at = At(mark.time_ns, found.type)
    advice = smallest_change(mission.recording, static_info, found.comparison, at)
    first = Text("yes", style="bold green") if found.position == 1 else Text("no")
    return [
        time,
        kind,
        f"{found.position} of {ranking.parameters}",
        f"{found.rank:.2f}",
        advice.text if rightly else "",
        first if rightly else "",
    ]


def _seconds(mission: TreatedMission, mark: Mark) -> float:
    return (mark.time_ns - mission.recording.start_ns) / 1e9
