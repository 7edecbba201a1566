"""A problem that a check found, and how bad it is."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from enum import Enum
from functools import partial


class Severity(Enum):
    """How bad a problem is, the worst first."""

    ERROR = "error"  # a build does not work
    WARNING = "warning"  # it works, with less than could be
    NOTE = "note"  # good to know


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that is wrong.

    ``where`` is a file (with ``:line``), a folder or a variable, ``mend`` a command, or what to do.
    """

    severity: Severity
    what: str
    where: str | None = None
    mend: str | None = None

    def to_json(self) -> dict[str, str | None]:
        """The fields, the severity by its name."""
        return {**asdict(self), "severity": self.severity.value}


def _finding(
    severity: Severity, what: str, where: object = None, mend: str | None = None
) -> Finding:
    return Finding(severity, what, None if where is None else str(where), mend)


error = partial(_finding, Severity.ERROR)
warning = partial(_finding, Severity.WARNING)
note = partial(_finding, Severity.NOTE)


def by_severity(findings: list[Finding]) -> list[Finding]:
    """The worst first, otherwise in the order in which they were found, each once."""
    order = list(Severity)
    return sorted(dict.fromkeys(findings), key=lambda found: order.index(found.severity))
