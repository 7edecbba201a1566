"""All that is known about a TPC, in the words that ``show``, the page and SARIF share."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import TypeVar

from pytpc.base.wording import exact, tidy
from pytpc.conditions.cpp_conditions import Condition
from pytpc.conditions.lookup import Answer
from pytpc.static.across import across, processes_of, units_of
from pytpc.static.link_unit import Comparison, Default, LinkUnit, Transform
from pytpc.static.loops import loop_depth
from pytpc.static.places import Tpc
from pytpc.static.static_info import StaticInfo

_Item = TypeVar("_Item")


@dataclass(frozen=True, slots=True)
class ExposedDetails:
    """An exposing statement: ``FILE:LINE``, and its topic where it is known."""

    place: str
    topic: str | None


@dataclass(frozen=True, slots=True)
class Details:
    """A TPC with what its link units say of it.

    ``nearest`` is the comparison with the smallest distance. ``defaults``, ``reads``
    (``FILE:LINE``) and ``exposed`` have several entries if the link units differ. ``condition`` is
    None where only the source line is known; ``note`` says why, or what else to mind.
    ``loop_depth`` is the largest of the link units; None if none knows it. ``processes`` are those
    in whose analysis it was found.
    """

    tpc: Tpc
    nearest: Comparison
    unit: LinkUnit
    defaults: tuple[Default, ...]
    reads: tuple[str, ...]
    exposed: tuple[ExposedDetails, ...]
    condition: Condition | None
    note: str
    loop_depth: int | None = None
    processes: tuple[str, ...] = ()

    @property
    def title(self) -> str:
        """The parameter, or the constant."""
        return self.tpc.parameter or self.tpc.name or "?"

    @property
    def source_text(self) -> str:
        """The whole condition, else the line, else what is compared."""
        if self.condition is not None:
            return self.condition.text
        return self.nearest.source_code or f"{self.tpc.relation} {self.nearest.name or self.title}"

    @property
    def shown_defaults(self) -> tuple[str, ...]:
        """The defaults as the source has them."""
        python = self.unit.is_python
        return tuple(shown_default(each, python=python) for each in self.defaults)

    @property
    def across(self) -> str:
        """Which link unit reads, compares and exposes; empty if the path stays in one."""
        return across(self.nearest.path)

    @property
    def meaning(self) -> str:
        """The type in words."""
        return meaning(self.nearest)

    def to_json(self) -> dict[str, object]:
        """As ``pytpc show --json`` prints it."""
        return {
            **self.tpc.to_json(),
            "function": self.nearest.function,
            "condition": None if self.condition is None else asdict(self.condition),
            "note": self.note,
            "source_code": self.nearest.source_code,
            "variable": self.nearest.name,
            "meaning": self.meaning,
            "transform": None
            if self.nearest.transform is None
            else self.nearest.transform.to_json(),
            "other_thresholds": self.nearest.other_thresholds,
            "loop_depth": self.loop_depth,
            "defaults": self.defaults,
            "reads": self.reads,
            "exposed": [asdict(each) for each in self.exposed],
            "path": [step.to_json() for step in self.nearest.path],
            "processes": self.processes,
            "units": units_of(self.nearest.path),
        }


def details(static: StaticInfo, tpc: Tpc, answer: Answer) -> Details:
    """Gather what all link units of ``tpc`` say."""
    found = [(static.unit_of(each.key), static.comparisons[each.key]) for each in tpc.keys]
    unit, nearest = found[0]
    return Details(
        tpc=tpc,
        nearest=nearest,
        unit=unit,
        # 1, 1.0 and True are equal and not the same.
        defaults=tuple({repr(each.default): each.default for _, each in found}.values()),
        reads=_once(f"{at.file}:{at.lineno}" for _, each in found for at in each.param_reads),
        exposed=_once(
            ExposedDetails(f"{at.file}:{at.lineno}", each.topic)
            for _, each in found
            for at in (each.exposed_at, *each.publishes)
        ),
        condition=answer.condition,
        note=answer.note,
        loop_depth=loop_depth(static, tpc),
        processes=processes_of(static, tpc),
    )


def meaning(found: Comparison) -> str:
    """What a comparison's type says, in words."""
    if found.type == "flag":
        return "the parameter itself decides"
    if found.type == "constant":
        return "compared with a constant of the source"
    if found.transform is not None:
        return f"compared with {in_words(found.transform)}"
    return "compared with the parameter as it is"


def in_words(transform: Transform) -> str:
    """How the threshold comes from the parameter: ``0.5 times the parameter, minus 3``."""
    if transform.scale is None or transform.offset is None:
        return f"{transform.text}, where x is the parameter"
    words = {1.0: "the parameter", -1.0: "the negative of the parameter"}.get(
        transform.scale, f"{exact(transform.scale)} times the parameter"
    )
    if transform.offset:
        sign = "plus" if transform.offset > 0 else "minus"
        words += f", {sign} {exact(abs(transform.offset))}"
    return words


def shown_default(default: Default, *, python: bool = False) -> str:
    """A default as C++ or Python writes it, or a note that there is none."""
    if default is None:
        return "none in the source"
    if isinstance(default, bool):
        return str(default) if python else str(default).lower()
    return f'"{default}"' if isinstance(default, str) else exact(tidy(default))


def _once(items: Iterable[_Item]) -> tuple[_Item, ...]:
    return tuple(dict.fromkeys(items))
