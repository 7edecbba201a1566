"""Which missions the study has, which half of it each is in, and what is set in each.

The halves are a rule that was fixed before anything was flown: whoever works on the ranking looks
at ``tuning`` alone, and ``held-back`` is judged once, at the end. What was added to the study after
its first judgement (rounds 2 and 3) is held back as a whole.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Literal

from pytpc.base.errors import InputError
from pytpc.recording.parameter_change import Change
from pytpc.values.recording import read_parameters
from pytpc.values.scalars import number_text
from pytpc_evaluation.demo.demo_examples import EXAMPLES, Example
from pytpc_evaluation.study.changes import drawn_changes, harmless_changes
from pytpc_evaluation.treatment import Treatment

Half = Literal["tuning", "held-back"]
HALVES: tuple[Half, ...] = ("held-back", "tuning")
Kind = Literal["mission", "reference", "good", "suggested"]

SEEDS = (1, 2)
REFERENCE_SEED = 0
GOOD_SEEDS = (11, 12, 13, 14)
"""Of the good runs with other settings than any mission's: clean ones, with decoys of their own."""
CLEAN = "clean"
_FOLDERS: Mapping[Kind, str] = {
    "mission": "missions",
    "reference": "reference",
    "good": "good",
    "suggested": "suggested",
}
_QUICK_SEEDS = (1,)
_QUICK_SYSTEM = "water_sampler"
_QUICK = frozenset({CLEAN, "type1_full_vial_volume", "type2_min_conductivity"})


@dataclass(frozen=True, slots=True)
class Setting:
    """A parameter that is set beside what a treatment and its decoys set.

    ``parameter`` is the name below the node, or on the parameter server where ``node`` is empty.
    """

    parameter: str
    node: str
    value: float

    @property
    def label(self) -> str:
        """``pump.max_current=1.9``, the name of a folder."""
        name = f"{self.node}/{self.parameter.lstrip('~')}".strip("/")
        return f"{name.replace('/', '.')}={number_text(self.value)}"


@dataclass(frozen=True)
class Flight:
    """One flight of the study.

    ``changes`` are newest last, the treatment's own among them. ``half`` is None for a good run.
    ``suggested`` is what is set in a flight that tries a suggestion: the last is new, the others
    were tried before and stay.
    """

    kind: Kind
    example: Example
    treatment: Treatment
    seed: int
    half: Half | None
    changes: tuple[Change, ...] = ()
    suggested: tuple[Setting, ...] = ()

    @property
    def name(self) -> str:
        """``water_sampler/clean/seed-1``; a good run is only called after its system and seed."""
        if self.kind == "reference":
            return self.example.name
        if self.kind == "good":
            return f"{self.example.name}/seed-{self.seed}"
        tried = [setting_label(self.suggested)] if self.suggested else []
        return "/".join([self.example.name, self.treatment.name, f"seed-{self.seed}", *tried])

    @property
    def label(self) -> str:
        """For a person: the folder below that of the study."""
        return f"{_FOLDERS[self.kind]}/{self.name}"

    def folder(self, out: Path) -> Path:
        """Where it is in the study's folder."""
        return out / self.label

    @property
    def overlay(self) -> Path:
        """The file of parameters that is loaded over the robot's own, before ``settings``."""
        return self.treatment.overlay

    @property
    def people(self) -> int:
        """The seed of those who look on: others in each mission, the same for a suggestion."""
        drawn = f"{self.example.name}/{self.treatment.name}/{self.seed}"
        return int(sha256(drawn.encode()).hexdigest()[:8], 16)

    def settings(self) -> dict[str, float | int | bool]:
        """What ``overlay2`` sets, by full names.

        Numbers have the type that they have in the robot's own file.

        Raises:
            InputError: the robot's file cannot be read, or has no such parameter.
        """
        decoys = [one for one in self.changes if one.parameter != self.treatment.parameter]
        wanted = [Setting(one.parameter, one.node, one.new) for one in decoys]
        return values_on(read_parameters(self.example.parameters), [*wanted, *self.suggested])


def values_on(
    own: Mapping[str, object], settings: Iterable[Setting]
) -> dict[str, float | int | bool]:
    """What is set on a robot, by full names: of one that is there twice, the later value.

    Numbers have the type that they have in the robot's own file.

    Args:
        own: what is in that file.
        settings: what is set.

    Raises:
        InputError: the robot has no such parameter.
    """
    found = {full_name(own, one.parameter, one.node): one.value for one in settings}
    return {name: _like(own[name], value) for name, value in sorted(found.items())}


def setting_label(settings: Sequence[Setting]) -> str:
    """The name of the folder in which what is set together was flown."""
    return "+".join(one.label for one in settings)


def full_name(own: Mapping[str, object], parameter: str, node: str) -> str:
    """The full name of a node's parameter, or of that of the only node which has it.

    Raises:
        InputError: there is none, or there are several.
    """
    name = parameter.lstrip("~")
    wanted = name if name.startswith("/") else f"{node.rstrip('/')}/{name}"
    meant = [full for full in own if full == wanted or (not node and full.endswith(f"/{name}"))]
    if len(meant) != 1:
        what = "no parameter of this robot" if not meant else f"several: {', '.join(meant)}"
        raise InputError(f"{node or 'any node'} {parameter}: {what}")
    return meant[0]


def _like(old: object, value: float) -> float | int | bool:
    if isinstance(old, bool) and value in (0, 1):
        return bool(value)
    if isinstance(old, int) and not isinstance(old, bool) and float(value).is_integer():
        return int(value)
    return float(value)


def overlay_text(settings: Mapping[str, float | int | bool]) -> str:
    """A file for ``rosparam load``, which has maps below maps.

    >>> print(overlay_text({"/a/b": 1e-7, "/a/c/d": True}), end="")
    a:
      b: 1.0e-07
      c:
        d: true
    """
    lines: list[str] = []
    before: list[str] = []
    for name, value in sorted(settings.items(), key=lambda item: item[0].split("/")):
        *maps, last = name.strip("/").split("/")
        shared = 0
        while shared < min(len(maps), len(before)) and maps[shared] == before[shared]:
            shared += 1
        lines += [f"{'  ' * depth}{maps[depth]}:" for depth in range(shared, len(maps))]
        lines.append(f"{'  ' * len(maps)}{last}: {_text(value)}")
        before = maps
    return "".join(f"{line}\n" for line in lines)


def _text(value: float | int | bool) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return str(value) if isinstance(value, int) else number_text(value)


def halves(system: str, treatments: Sequence[Treatment]) -> dict[tuple[str, int], Half]:
    """The half of each mission of a system, by treatment and seed.

    Within each type the treatments of round 1 are sorted by SHA-256 of ``SYSTEM/NAME``; the first
    is ``tuning``, the second ``held-back``, and so on. Of the clean missions the first seed is
    ``tuning``. All treatments of later rounds are ``held-back``.
    """
    later = [one.name for one in treatments if one.round > 1]
    found: dict[tuple[str, int], Half] = {(name, s): "held-back" for name in later for s in SEEDS}
    first = [one for one in treatments if one.round == 1]
    for kind in sorted({one.type for one in first}):
        names = [one.name for one in first if one.type == kind]
        names.sort(key=lambda name: sha256(f"{system}/{name}".encode()).hexdigest())
        for place, name in enumerate(names):
            for number, seed in enumerate(SEEDS):
                turn = number if kind == CLEAN else place
                found[name, seed] = "held-back" if turn % 2 else "tuning"
    return found


@dataclass(frozen=True)
class FlightSelection:
    """What is to be flown; where nothing is named, all of it. ``quick`` is the part for CI."""

    systems: Collection[str] = ()
    treatments: Collection[str] = ()
    seeds: Collection[int] = ()
    quick: bool = False

    def examples(self, known: Sequence[Example] = EXAMPLES) -> list[Example]:
        """The robots.

        Raises:
            InputError: one is not known.
        """
        names = self.systems or ({_QUICK_SYSTEM} if self.quick else ())
        unknown = sorted(set(names) - {one.name for one in known})
        if unknown:
            there = ", ".join(one.name for one in known)
            raise InputError(f"there is no system {unknown[0]}, but {there}")
        return [one for one in known if not names or one.name in names]

    @property
    def is_part(self) -> bool:
        """Whether not all missions of a robot are wanted."""
        return bool(self.treatments or self.seeds or self.quick)

    def has(self, treatment: Treatment, seed: int) -> bool:
        """Whether a mission is among them."""
        names = self.treatments or (_QUICK if self.quick else ())
        seeds = self.seeds or (_QUICK_SEEDS if self.quick else ())
        return (not names or treatment.name in names) and (not seeds or seed in seeds)


def check_treatments(selection: FlightSelection, examples: Sequence[Example]) -> None:
    """See that each treatment that was named is one of a system that was chosen.

    Raises:
        InputError: one is not, or a treatment cannot be read.
    """
    known = {one.name for example in examples for one in example.all_treatments()}
    unknown = sorted(set(selection.treatments) - known)
    if unknown:
        raise InputError(
            f"there is no treatment {unknown[0]}; there are {', '.join(sorted(known))}"
        )


def flights_of(example: Example, selection: FlightSelection | None = None) -> list[Flight]:
    """The flights of a system: the good runs, then the missions by treatment and seed.

    If only some missions are wanted, the reference is the only good run.

    Args:
        example: the robot.
        selection: all where None.

    Raises:
        InputError: a treatment, or the list of decoys, cannot be read.
    """
    chosen = selection or FlightSelection()
    among = harmless_changes(example)
    treatments = example.all_treatments()
    half = halves(example.name, treatments)
    flights = [
        Flight(
            kind="mission",
            example=example,
            treatment=treatment,
            seed=seed,
            half=half[treatment.name, seed],
            changes=drawn_changes(example.name, treatment, seed, among),
        )
        for treatment in treatments
        for seed in SEEDS
        if chosen.has(treatment, seed)
    ]
    clean = example.treatment(CLEAN)
    good = [
        Flight("good", example, clean, seed, None, drawn_changes(example.name, clean, seed, among))
        for seed in GOOD_SEEDS
        if not chosen.is_part
    ]
    return [Flight("reference", example, clean, REFERENCE_SEED, None), *good, *flights]
