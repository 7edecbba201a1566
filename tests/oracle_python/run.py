"""Checks the analysis of Python on random programs; ``python -m oracle_python.run --runs 500``."""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

from oracle_python.generator import program
from oracle_python.judge import Key, Verdict, judge
from oracle_python.shrink import shrink


def main() -> int:
    """Print each program that differs, made smaller, and the totals."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--shrink-seconds", type=float, default=20)
    parser.add_argument("--most", type=int, default=3, help="programs to make smaller")
    parser.add_argument("--unseen", action="store_true", help="show what no run has seen")
    options = parser.parse_args()
    totals = {"programs": 0, "wanted": 0, "found": 0, "missed": 0, "mixed": 0, "unseen": 0}
    shown = 0
    with tempfile.TemporaryDirectory() as folder:
        for seed in range(options.seed, options.seed + options.runs):
            verdict = judge(program(seed), Path(folder))
            if not verdict.is_sound:
                continue
            totals["programs"] += 1
            for name in ("wanted", "found", "missed", "mixed", "unseen"):
                totals[name] += len(getattr(verdict, name))
            wrong = verdict.unseen if options.unseen else verdict.missed
            if wrong:
                print(f"seed {seed}: {len(wrong)}", flush=True)
                if shown < options.most:
                    shown += 1
                    _show(seed, Path(folder), options.shrink_seconds, options.unseen)
    print(", ".join(f"{count} {name}" for name, count in totals.items()))
    return 1 if totals["missed"] else 0


def _show(seed: int, folder: Path, seconds: float, unseen: bool) -> None:
    def wrong(verdict: Verdict) -> set[Key]:
        return verdict.unseen if unseen else verdict.missed

    small = shrink(program(seed), lambda each: bool(wrong(judge(each, folder))), seconds)
    for name, source in small.items():
        print(f"--- {name}.py")
        for number, line in enumerate(source.splitlines(), 1):
            print(f"{number:3} {line}")
    for key in sorted(wrong(judge(small, folder))):
        print(key, flush=True)


if __name__ == "__main__":
    sys.exit(main())
