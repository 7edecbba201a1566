"""Fuzzes the passes by any number of runs, or for some seconds: ``tools/fuzz``.

Each run has a number, from which everything that is random in it comes. What goes wrong is kept, in
a folder with the run's name, and told at the end with status 1.
"""

from __future__ import annotations

import argparse
import random
import shutil
import tempfile
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from fuzz import modules, programs

# One in so many runs is a program: it takes as long as many modules.
PROGRAM_EVERY, STRESS_EVERY = 10, 4


@dataclass(slots=True)
class Account:
    """What was run: counts by kind, and the findings by run."""

    counts: Counter[str] = field(default_factory=Counter)
    findings: dict[int, str] = field(default_factory=dict)

    def __str__(self) -> str:
        """A few lines for a person."""
        counts = ", ".join(f"{name} {count}" for name, count in sorted(self.counts.items()))
        lines = [f"run {seed}: {text}" for seed, text in self.findings.items()]
        return "\n".join([*lines, f"{counts}; findings {len(self.findings)}"])


class Fuzzer:
    """Runs with one corpus; ``kept`` gets the folders of the runs with findings."""

    def __init__(self, folder: Path, kept: Path, further: Sequence[Path] = ()) -> None:
        """``further`` are more modules for the corpus, as bitcode."""
        self.account = Account()
        self._work, self._kept = folder / "work", kept
        texts = folder / "corpus"
        texts.mkdir()
        self._corpus = modules.Corpus(texts, further)

    def run(self, seed: int) -> None:
        """One run."""
        shutil.rmtree(self._work, ignore_errors=True)
        self._work.mkdir()
        finding = self._program(seed) if seed % PROGRAM_EVERY == 0 else self._module(seed)
        if finding:
            self.account.findings[seed] = finding
            self._kept.mkdir(parents=True, exist_ok=True)
            shutil.rmtree(self._kept / str(seed), ignore_errors=True)
            shutil.copytree(self._work, self._kept / str(seed))

    def _program(self, seed: int) -> str:
        compared = programs.compare(seed, self._work)
        self.account.counts["programs"] += 1
        self.account.counts["programs with reports"] += compared.reports > 0
        self.account.counts["reports"] += compared.reports
        if compared.skipped:
            self.account.counts[f"programs without ({compared.skipped})"] += 1
        return compared.finding

    def _module(self, seed: int) -> str:
        draw = random.Random(seed)
        text = self._work / "module.ll"
        if seed % STRESS_EVERY == 0:
            kind, origin = "stress modules", "llvm-stress"
            modules.stress(seed, text)
        else:
            kind = "mutated modules"
            source = self._corpus.draw(draw)
            origin = source.stem
            shutil.copyfile(source, text)
        done = modules.mutate(text, seed)
        checked = modules.check(text, seed)
        self.account.counts[kind] += 1
        self.account.counts["modules with comparisons"] += checked.comparisons > 0
        if checked.skipped:
            self.account.counts[f"{kind} without ({checked.skipped})"] += 1
        return checked.finding and f"{origin}, {', '.join(done)}: {checked.finding}"


def main() -> None:
    """Run, and tell."""
    parser = argparse.ArgumentParser(prog="fuzz", description=__doc__)
    parser.add_argument("--runs", type=int, default=1000, help="how many")
    parser.add_argument("--seconds", type=float, help="end after so long, whatever --runs says")
    parser.add_argument("--seed", type=int, default=1, help="number of the first run")
    parser.add_argument("--kept", type=Path, default=Path("out/fuzz"), help="folder of findings")
    parser.add_argument(
        "--corpus", type=Path, action="append", default=[], help="more modules: folders of *.o"
    )
    arguments = parser.parse_args()
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="tpc-fuzz-") as folder:
        further = sorted(unit for place in arguments.corpus for unit in place.rglob("*.o"))
        fuzzer = Fuzzer(Path(folder), arguments.kept, further)
        for seed in range(arguments.seed, arguments.seed + arguments.runs):
            if arguments.seconds and time.monotonic() - began > arguments.seconds:
                break
            fuzzer.run(seed)
    print(fuzzer.account)
    raise SystemExit(bool(fuzzer.account.findings))


if __name__ == "__main__":
    main()
