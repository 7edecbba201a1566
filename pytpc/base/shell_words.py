"""Changes of an environment as text for a shell."""

from __future__ import annotations

import json
import shlex
from collections.abc import Mapping
from dataclasses import dataclass

SHELLS = ("sh", "fish")


@dataclass(frozen=True, slots=True)
class EnvChange:
    """Variables that get a value, and those that are removed."""

    values: Mapping[str, str]
    gone: tuple[str, ...]

    @classmethod
    def between(cls, before: Mapping[str, str], after: Mapping[str, str]) -> EnvChange:
        """The changes from ``before`` to ``after``."""
        values = {name: value for name, value in after.items() if before.get(name) != value}
        return cls(dict(sorted(values.items())), tuple(sorted(before.keys() - after.keys())))

    def text(self, shell: str) -> str:
        """Lines for a shell of `SHELLS`; ``sh`` is for all similar ones. Empty without changes."""
        if shell == "fish":
            lines = [f"set -gx {name} {_for_fish(value)}" for name, value in self.values.items()]
            lines += [f"set -e {name}" for name in self.gone]
        else:
            lines = [f"export {name}={shlex.quote(value)}" for name, value in self.values.items()]
            lines += [f"unset {name}" for name in self.gone]
        return "".join(f"{line}\n" for line in lines)

    def json(self) -> str:
        """A JSON object with ``set`` and ``unset``."""
        return json.dumps({"set": dict(self.values), "unset": list(self.gone)}, indent=1) + "\n"


def _for_fish(value: str) -> str:
    escaped = value.replace("\\", "\\\\").replace("'", "\\'")
    return f"'{escaped}'"
