"""Analyses all Python files of some folders as scripts; ``python -m oracle_python.sweep FOLDER``.

No file may end the analysis by an error of its own: what is no Python 3 is said, and what takes too
long is given up. Modules that a file finds beside itself belong to it, as for a node.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from collections import Counter
from pathlib import Path

from pytpc.base.errors import InputError
from pytpc.python_analysis.analysis import analyse_entry
from pytpc.python_analysis.rules_file import load_rules
from pytpc.python_analysis.sources.packages import entry_of

_SLOWEST = 10
_SAID_EVERY = 10.0


def sweep(files: list[Path], seconds: float, until: float) -> tuple[Counter[str], list[str]]:
    """Analyse the files, as many as come before ``until`` (`time.monotonic`).

    Returns:
        How many files ended how, and a line for each that failed otherwise than by its budget.
    """
    ends: Counter[str] = Counter()
    wrong: list[str] = []
    taken: list[tuple[float, Path]] = []
    began = said = time.monotonic()
    for path in files:
        at = time.monotonic()
        if at > until:
            break
        end = _ended(path, seconds)
        ends[end.split(":")[0]] += 1
        taken.append((time.monotonic() - at, path))
        if end.startswith("failed"):
            wrong.append(f"{path}: {end}")
            print(wrong[-1], flush=True)
        if time.monotonic() - said > _SAID_EVERY:
            said = time.monotonic()
            print(f"{len(taken)} of {len(files)}, {dict(ends)}", file=sys.stderr, flush=True)
    for spent, path in sorted(taken, reverse=True)[:_SLOWEST]:
        print(f"{spent:7.2f} s  {path}")
    print(f"{len(taken) / max(time.monotonic() - began, 1e-9):.2f} files/s")
    return ends, wrong


def _ended(path: Path, seconds: float) -> str:
    try:
        unit = analyse_entry(entry_of(path), load_rules(), seconds)
    except InputError:
        return "no Python 3"
    except Exception as error:  # what this looks for
        return f"failed: {type(error).__name__}: {error}"
    if unit.status == "ok":
        return "ok"
    failure = unit.failure or ""
    return "budget" if "more than" in failure else f"failed: {failure}"


def main() -> int:
    """Status 1 where the analysis of any file failed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", type=Path, nargs="+")
    parser.add_argument("--seconds", type=float, default=120, help="the budget of a file")
    parser.add_argument("--minutes", type=float, default=600, help="end after so many")
    parser.add_argument("--seed", type=int, help="in an order at random")
    options = parser.parse_args()
    files = [path for folder in options.folders for path in sorted(folder.rglob("*.py"))]
    if options.seed is not None:
        random.Random(options.seed).shuffle(files)
    ends, wrong = sweep(files, options.seconds, time.monotonic() + 60 * options.minutes)
    print(", ".join(f"{count} {name}" for name, count in sorted(ends.items())))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
