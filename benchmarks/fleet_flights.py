"""How often the ranking of a fleet has the wrong parameter first, from flown missions.

From the verdicts of ``pytpc study fleet judge``, in the folder of fleets. ``mixed`` questions have
bad missions of all robots, ``one-robot`` ones of one; each by half of the treatments, too.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from figures import figure

from pytpc_evaluation.study.fleet_judge import RESULTS_FILE, FleetVerdict, load_verdicts
from pytpc_evaluation.study.fleet_questions import BAD, GOOD, SHAPES
from pytpc_evaluation.study.plan import HALVES
from pytpc_evaluation.study.report.fleets import FLEET, TARGET, first_share

TOPIC = "fleet"
_ROOT = Path(__file__).parents[1]


def main(words: Sequence[str] | None = None) -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=_ROOT / "out" / "fleet")
    args = parser.parse_args(words)
    if not (args.out / RESULTS_FILE).is_file():
        print(f"# {args.out} has no verdicts: pytpc study fleet judge", flush=True)
        return
    own = [one for one in load_verdicts(args.out) if one.method == FLEET and one.good == GOOD]
    for shape in SHAPES:
        asked = [one for one in own if one.shape == shape and one.bad <= BAD]
        _print(f"first-{shape}", asked)
        for half in HALVES:
            _print(f"first-{shape}-{half}", [one for one in asked if one.half == half])


def _print(name: str, verdicts: Sequence[FleetVerdict]) -> None:
    if not verdicts:
        return
    found = first_share(verdicts)
    low, high = 100 * found.low, 100 * found.high
    print(f"# {name}: {found.treatments} treatments, 95 % interval [{low:.0f}, {high:.0f}]")
    figure(
        TOPIC,
        name,
        100 * found.value,
        unit="%",
        target=f">={100 * TARGET:.0f}",
        hit=found.value >= TARGET,
    )


if __name__ == "__main__":
    main()
