"""What the sources and recordings say of a parameter: who reads it, and its declared range."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePath

from pytpc.base.wording import Number, listed, plain, show
from pytpc.recording.declaration import Declared
from pytpc.static.parameters import DYNAMIC, same_parameter
from pytpc.static.static_info import StaticInfo
from pytpc.values.new_value import Refused
from pytpc.values.scalars import type_of

_LISTED = 8
_DECLARES = "declare_parameter"
_KINDS = frozenset(("bool", "int", "double", "string"))


@dataclass(frozen=True, slots=True)
class Read:
    """A parameter that a node reads: its name in the source, and the absolute file.

    ``kind`` is the type that a node of ROS 2 declares; empty where it is not known.
    """

    name: str
    file: str
    kind: str = ""
    lineno: int = 0


@dataclass(frozen=True, slots=True)
class Known:
    """The parameters that the nodes read, and the declarations of parameters.

    ``is_complete`` says that no node puts the name of a parameter together: one that is not among
    ``reads`` is read by nobody.
    """

    reads: tuple[Read, ...] = ()
    declared: Sequence[Declared] = ()
    is_complete: bool = False

    @classmethod
    def of(cls, static_info: StaticInfo | None, declared: Sequence[Declared]) -> Known:
        """What the static information says, if there is any, with the declarations."""
        if static_info is None:
            return cls(declared=declared)
        reads = tuple(
            Read(
                read.name,
                unit.absolute(read.file),
                read.type if _DECLARES in read.api else "",
                read.lineno,
            )
            for unit in static_info.units
            for read in unit.parameters
            if read.file
        )
        dynamic = any(DYNAMIC in read.name for read in reads)
        analysed = all(unit.trouble is None for unit in static_info.units)
        return cls(reads, declared, bool(reads) and analysed and not dynamic)

    def is_read(self, name: str) -> bool:
        """Whether a node reads a parameter of this full name; not where its name is unknown."""
        return any(read.name != DYNAMIC and same_parameter(name, read.name) for read in self.reads)

    def names(self) -> Collection[str]:
        """The names of all parameters that nodes read, as far as they are known."""
        return {read.name for read in self.reads if DYNAMIC not in read.name}

    def declarations(self, name: str) -> list[Declared]:
        """The declarations of a parameter.

        What a node published counts before what a file says. A file has the name of the field
        alone, so it counts only for parameters that its package reads, if the readers are known.
        """
        full = [one for one in self.declared if one.parameter.startswith("/")]
        said = [one for one in full if same_parameter(one.parameter, name)]
        if said:
            return said
        field = name.rpartition("/")[2]
        fitting = [one for one in self.declared if one.parameter == field]
        if not self.reads:
            return fitting
        readers = [PurePath(read.file) for read in self.reads if same_parameter(name, read.name)]
        above = {str(folder) for file in readers for folder in file.parents}
        return [one for one in fitting if one.package in above]

    def check_type(self, names: Iterable[str], value: object) -> None:
        """Check that a value has the type with which a node of ROS 2 declares each parameter.

        Raises:
            Refused: it has another one, and the node would refuse it.
        """
        one = value[0] if isinstance(value, list) and value else value
        kind = type_of(one)
        for name in names:
            declared = [
                read
                for read in self.reads
                if read.kind in _KINDS and same_parameter(name, read.name)
            ]
            if declared and not isinstance(value, list) and kind not in {r.kind for r in declared}:
                first = declared[0]
                how = f"give {value}.0 with --force" if kind == "int" else "--force writes it"
                raise Refused(
                    f"{first.file}:{first.lineno} declares {plain(first.name)} as {first.kind}, so"
                    f" the node would refuse the {kind} {plain(str(value))}; {how}"
                )

    def check_range(self, names: Iterable[str], value: object) -> None:
        """Check that a value is in the declared range of each parameter.

        A value counts as known to be wrong only if every declaration of a parameter excludes it.

        Raises:
            Refused: it is outside of one.
        """
        if not isinstance(value, bool | int | float):
            return
        for name in names:
            found = self.declarations(name)
            if found and not any(_holds(one, value) for one in found):
                raise Refused(
                    f"{show(value)} is outside of what {plain(found[0].place)} declares for"
                    f" {plain(found[0].parameter)}: {_range(found[0])}; --force writes it all the"
                    " same"
                )


NOTHING = Known()
"""Nothing is known: there is no static information, and no declaration."""


def package_folder(path: Path) -> Path | None:
    """The folder of the package that a file belongs to; None if it is in none."""
    above = (up for up in path.absolute().parents if (up / "package.xml").is_file())
    return next(above, None)


def _holds(one: Declared, value: Number) -> bool:
    if one.choices:
        return any(value == choice for _, choice in one.choices)
    low, high = one.low, one.high
    # Ends in the wrong order say nothing.
    if isinstance(value, bool) or (low is not None and high is not None and low > high):
        return True
    return (low is None or low <= value) and (high is None or value <= high)


def _range(one: Declared) -> str:
    if one.choices:
        return listed([f"{choice} ({plain(name)})" for name, choice in one.choices], _LISTED)
    low, high = one.low, one.high
    if low is None:
        return f"at most {show(high)}"
    return f"at least {show(low)}" if high is None else f"{show(low)} to {show(high)}"
