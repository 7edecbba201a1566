"""The missions that TPC is shown and tested on: where they are, and when one went right."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pytpc.paths import project_root
from pytpc.treatment import Treatment, TreatmentType, load_treatment

SHARED_PACKAGE = project_root() / "examples" / "simulated_world"
"""The catkin package that the robots' simulators and observers share."""


@dataclass(frozen=True)
class Example:
    """A robot in ``examples/``.

    ``goal_topic`` is the topic on which there is a message for each time that the robot did what
    the mission is for; ``reached`` and ``missed`` say so in a sentence's end. ``missed_under`` are
    the types of treatment that keep it from it. ``shown`` are the treatments of the demonstration.
    """

    name: str
    title: str
    watched: tuple[str, ...]
    goal_topic: str
    reached: str
    missed: str
    missed_under: frozenset[TreatmentType]
    shown: tuple[str, ...]

    @property
    def folder(self) -> Path:
        """The catkin package."""
        return project_root() / "examples" / self.name

    @property
    def launch(self) -> Path:
        """Its launch file; it has the arguments ``seed`` and ``treatment``."""
        return self.folder / "launch" / f"{self.name}.launch"

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


IMAGE_CAPTURE = Example(
    name="image_capture",
    title="Image capture",
    watched=("/truth/uav", "/truth/person", "/mission/state", "/camera/picture"),
    goal_topic="/camera/picture",
    reached="a picture was taken",
    missed="no picture was taken",
    # With the treatment of type I there is a picture, of nobody.
    missed_under=frozenset({"type2", "fault"}),
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
    shown=(
        "clean",
        "type1_goal_tolerance",
        "type1_return_voltage",
        "type2_heading_tolerance_deg",
        "type2_min_start_quality",
    ),
)
