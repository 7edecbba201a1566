"""What the study found on the treatments that were held back, each with its target.

Names that end with ``-second-round`` are of its treatments that nobody had ever seen judged.

From the study's folder where there is one, else from the numbers of the page in docs/.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from figures import figure

from pytpc_evaluation.study.judge import POSITIONS_FILE
from pytpc_evaluation.study.report.making import FIGURES_FILE, ReportOptions, make_report
from pytpc_evaluation.study.report.parts import SECOND_ROUND

TOPIC = "study"
HALF = "held-back"
_ROOT = Path(__file__).parents[1]


def main(words: Sequence[str] | None = None) -> None:
    """Print the figures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=_ROOT / "out" / "study")
    parser.add_argument("--results", type=Path, default=_ROOT / "docs" / "study" / FIGURES_FILE)
    args = parser.parse_args(words)
    if (args.out / POSITIONS_FILE).is_file():
        print(f"# from the study in {args.out}", flush=True)
        figures = _figures_of(args.out)
    elif args.results.is_file():
        print(f"# from the numbers of the page, {args.results}", flush=True)
        figures = json.loads(args.results.read_text())
    else:
        print(f"# neither {args.out} nor {args.results} is there", flush=True)
        return
    for one in figures:
        if one["name"].endswith((f"-{HALF}", f"-{SECOND_ROUND.name}")):
            name = one["name"].removesuffix(f"-{HALF}")
            figure(
                TOPIC, name, one["value"], unit=one["unit"], target=one["target"], hit=one["hit"]
            )


def _figures_of(study: Path) -> list[dict[str, Any]]:
    """The figures of a study, whose page is not kept."""
    with tempfile.TemporaryDirectory() as folder:
        made = make_report(study, Path(folder) / "study.md", ReportOptions([HALF], draw=False))
    figures: list[dict[str, Any]] = made.numbers["figures"]
    return figures


if __name__ == "__main__":
    main()
