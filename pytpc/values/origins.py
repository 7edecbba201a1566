"""Where a parameter's current value came from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

OriginKind = Literal["yaml", "launch", "argument", "default", "runtime", "unknown"]


@dataclass(frozen=True, slots=True)
class Origin:
    """Where one value came from.

    ``name`` is the parameter's full name on the server (``/mission/min_coverage_limit``). ``kind``:
    a YAML file that a launch file loads, the launch file itself (``<param>``), an ``argument`` on
    roslaunch's command line, the default in the code (nobody set it), set at ``runtime``.
    ``path`` and ``lineno`` are the place, ``text`` the source line; ``via`` the launch files on the
    way to it, ``note`` a sentence about what is not certain. ``value`` is as on the server.
    """

    name: str
    kind: OriginKind
    value: object
    path: Path | None
    lineno: int | None
    text: str
    via: tuple[str, ...] = ()
    note: str = ""

    def words(self) -> str:
        """``config/params.yaml:12``, ``default in the code``, ``set at runtime``."""
        if self.path is not None:
            return f"{self.path}:{self.lineno}" if self.lineno else str(self.path)
        return {"default": "default in the code", "runtime": "set at runtime"}.get(
            self.kind, "unknown"
        )


def read_origins(mission: Path) -> Mapping[str, Origin]:
    """The origins that were recorded with a mission (origins.json), by full name; empty if none."""
    raise NotImplementedError


def origin_for(
    origins: Mapping[str, Origin], source: str, node: str, default: object
) -> Origin | None:
    """The origin of a parameter as the source names it (``~limit``, ``limit``, ``/a/limit``).

    ``node`` is the node's full name, whose namespace the name is in. None where nothing is known.
    """
    raise NotImplementedError
