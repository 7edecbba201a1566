"""`pytpc list` of 10,000 comparisons with all imports, next to Python parsing the same JSON.

Seconds are those of the processor, which other work on the machine changes least.
"""

from __future__ import annotations

import json
import sys
import tempfile
import uuid
from pathlib import Path

from figures import figure, measured

ROOT = Path(__file__).parents[1]
sys.path[:0] = [str(ROOT / "tests/python")]

from static_units import comparison, counts, step, unit  # noqa: E402

TOPIC = "list-speed"
COMPARISONS, UNITS, STEPS = 10_000, 50, 10
ROUNDS = 5


def write_static(path: Path) -> None:
    """Static information of 50 link units, each comparison with a way of 13 steps."""
    units = []
    for number in range(UNITS):
        found = []
        for line in range(1, COMPARISONS // UNITS + 1):
            name = f"limit_{number}_{line % 40}"
            kept = [step("store", 13 + n, f"kept in the field {n}_") for n in range(STEPS)]
            ends = [step("compare", line, "compared"), step("expose", line + 1, "published")]
            found.append(
                comparison(
                    key=str(uuid.uuid5(uuid.NAMESPACE_URL, f"{number} {line}")),
                    source=name,
                    name=f"{name}_",
                    file=f"src/unit{number}/node.cpp",
                    lineno=line,
                    path=[step("read", 12, f"{name} read"), *kept, *ends],
                )
            )
        units.append(
            unit(
                link_unit=f"node{number}",
                package=f"package{number % 17}",
                comparisons=found,
                counts=counts(comparisons=len(found)),
            )
        )
    path.write_text(json.dumps({"schema": 1, "units": units}, indent=1))


def seconds_of(*command: str) -> float:
    """The least that a command took: other work on the machine only adds to it."""
    return min(measured(*command)[0] for _ in range(ROUNDS))


def main() -> None:
    """Prints the figures."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "static.json"
        write_static(path)
        ours = seconds_of(sys.executable, "-m", "pytpc", "list", str(path))
        plain = seconds_of(
            sys.executable, "-c", f"import json; json.loads(open({str(path)!r}).read())"
        )
    figure(TOPIC, "list_10000", ours, unit="s", target="<1", hit=ours < 1)
    ratio = ours / plain
    figure(TOPIC, "list_to_json_loads", ratio, unit="ratio", target="<4", hit=ratio < 4)


if __name__ == "__main__":
    main()
