"""The missions that TPC is shown and tested on: where they are, and when one went right."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from pytpc.base.errors import WorkspaceError
from pytpc.base.paths import project_root
from pytpc_evaluation.treatment import TREATMENT_FILE, Treatment, TreatmentType, load_treatment

SHARED_PACKAGE = project_root() / "examples" / "simulated_world"
"""The catkin package that the robots' simulators and observers share."""


@dataclass(frozen=True)
class Example:
    """A robot in ``examples/``.

    ``goal_topic`` is the topic on which there is a message for each time that the robot did what
    the mission is for; ``reached`` and ``missed`` say so in a sentence's end. ``missed_under`` are
    the types of treatment that keep it from it, all but those in ``reached_under``, by name, where
    it is late or fails after it. ``shown`` are the treatments of the demonstration.
    ``simulator`` is the node that is the world, not the robot. ``study_rate`` is how many simulated
    seconds the study flies in a second of the wall. ``ros2_types`` are the types of the messages on
    ``watched``, if its nodes are of ROS 2.
    """

    name: str
    title: str
    watched: tuple[str, ...]
    goal_topic: str
    reached: str
    missed: str
    missed_under: frozenset[TreatmentType]
    shown: tuple[str, ...]
    reached_under: frozenset[str] = frozenset()
    simulator: str = "/uav_simulator"
    study_rate: float = 12.0
    ros2_types: tuple[tuple[str, str], ...] = ()

    @property
    def folder(self) -> Path:
        """The package, of catkin or ament."""
        return project_root() / "examples" / self.name

    @property
    def launch(self) -> Path:
        """The launch file of a robot of ROS 1.

        Its arguments: ``rate`` (of the simulated time), ``seed``, ``treatment`` and ``overlay2``
        (files of parameters, loaded one after the other), ``fault``, ``observer``.
        """
        return self.folder / "launch" / f"{self.name}.launch"

    @property
    def parameters(self) -> Path:
        """The file with the parameters with which its mission goes right."""
        return self.folder / "config" / "params.yaml"

    @property
    def study(self) -> Path:
        """The file with what the study sets and asks: harmless changes, and places of errors."""
        return self.folder / "study.json"

    @property
    def observer(self) -> Path:
        """The program that sees what a person beside the robot sees."""
        return self.folder / "scripts" / "observer.py"

    def treatment(self, name: str) -> Treatment:
        """One of its treatments.

        Raises:
            InputError: see ``load_treatment``.
        """
        return load_treatment(self.folder / "treatments" / name)

    def treatments(self, names: Sequence[str] = ()) -> list[Treatment]:
        """Those of the demonstration, or ``names``.

        Raises:
            InputError: see ``load_treatment``.
        """
        return [self.treatment(name) for name in names or self.shown]

    def goal_remarks(self, treatment: Treatment, *, reached: bool) -> list[str]:
        """A sentence where the goal was reached against what the treatment demands, or missed."""
        if treatment.type == "clean" and not reached:
            return [self.missed]
        to_miss = treatment.type in self.missed_under and treatment.name not in self.reached_under
        return [self.reached] if to_miss and reached else []

    def all_treatments(self) -> list[Treatment]:
        """All that there are, by name.

        Raises:
            InputError: see ``load_treatment``.
        """
        files = (self.folder / "treatments").glob(f"*/{TREATMENT_FILE}")
        return [load_treatment(path.parent) for path in sorted(files)]


IMAGE_CAPTURE = Example(
    name="image_capture",
    title="Image capture",
    watched=("/truth/uav", "/truth/person", "/mission/state", "/camera/picture"),
    goal_topic="/camera/picture",
    reached="a picture was taken",
    missed="no picture was taken",
    # With treatments of type I, and with one of the faults, there is a picture, of nobody.
    missed_under=frozenset({"type2"}),
    shown=("clean", "type1_face_detection_threshold", "type2_min_coverage_limit"),
)

WATER_SAMPLER = Example(
    name="water_sampler",
    title="Water sampler",
    watched=("/truth/uav", "/truth/sampler", "/mission/state", "/truth/vial_filled"),
    goal_topic="/truth/vial_filled",
    reached="the vial was filled",
    missed="the vial was not filled",
    missed_under=frozenset({"type1", "type2", "fault"}),
    shown=(
        "clean",
        "type1_full_vial_volume",
        "type1_wet_readings_needed",
        "type2_min_conductivity",
        "type2_hold_radius",
    ),
    reached_under=frozenset(
        {
            "type1_flight_height",
            "type1_min_land_height",
            "type1_waypoint_tolerance",
            "type2_hold_time",
            "type2_max_climb_rate",
            "type2_max_sink_rate",
            "type2_max_velocity",
            "type2_start_delay",
        }
    ),
)

NAVIGATION = Example(
    name="navigation",
    title="Navigation",
    watched=(
        "/truth/robot",
        "/truth/goal",
        "/truth/events",
        "/truth/goal_signalled",
        "/mission/state",
    ),
    goal_topic="/truth/goal_signalled",
    reached="the lamp was lit at the goal",
    missed="the lamp was not lit at the goal",
    # With some treatments of type I the robot gets there, and touches something on the way.
    missed_under=frozenset({"type2", "fault"}),
    # It gets there late.
    reached_under=frozenset({"type2_replan_period", "type2_retry_period", "type2_settle_time"}),
    shown=(
        "clean",
        "type1_goal_tolerance",
        "type1_return_voltage",
        "type2_heading_tolerance_deg",
        "type2_min_start_quality",
    ),
    simulator="/ground_simulator",
)

IMAGE_CAPTURE_ROS2 = Example(
    name="image_capture_ros2",
    title="Image capture on ROS 2",
    watched=("/camera/picture",),
    goal_topic="/camera/picture",
    reached="a picture was taken",
    missed="no picture was taken",
    missed_under=frozenset({"type2"}),
    shown=("clean", "type1_face_detection_threshold", "type2_min_coverage_limit"),
    ros2_types=(("/camera/picture", "sensor_msgs/CompressedImage"),),
)

EXAMPLES = (IMAGE_CAPTURE, WATER_SAMPLER, NAVIGATION)
"""The robots of the study, in its order."""


def link_package(example: Example, workspace: Path) -> None:
    """Put links to the example, and to what the examples share, into a workspace.

    Raises:
        WorkspaceError: one cannot be made.
    """
    link_packages((example.folder, SHARED_PACKAGE), workspace)


def link_packages(packages: Iterable[Path], workspace: Path) -> None:
    """Put links to these folders into a workspace, in place of those that lead elsewhere.

    Raises:
        WorkspaceError: one cannot be made.
    """
    for package in packages:
        link = workspace / "src" / package.name
        if link.resolve() == package:
            continue
        # An earlier checkout left its link there.
        try:
            link.parent.mkdir(parents=True, exist_ok=True)
            link.unlink(missing_ok=True)
            link.symlink_to(package)
        except OSError as error:
            raise WorkspaceError(f"cannot be made: {error.strerror}", link) from error
