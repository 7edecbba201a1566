"""Compares the passes with the checker on random programs.

From the top folder: python -m tests.oracle.run --programs 1000 --seed 1
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

from tests.oracle.checker import check
from tests.oracle.generator import Program, program, prologue

TOP = Path(__file__).resolve().parents[2]
INPUTS = TOP / "tests/lit/Inputs"
PLUGIN = TOP / "build/install/lib/tpc/TpcPasses.so"
BATCH = 20
# What the check does grows faster than the file.
EXTENDED_BATCH = 1
COMPILE = [
    "clang++-19",
    "-std=c++17",
    "-g",
    "-Wno-everything",
    "-Werror=return-type",
    "-flto=full",
    "-Xclang",
    "-disable-llvm-passes",
]
LINE = re.compile(
    r"  (?P<type>parameter|flag|derived) '(?P<parameter>[^']*)' relation (?P<relation>\S+) as .*"
    r" distance (?P<distance>\d+) others .* at (?P<line>\d+):(?P<column>\d+)"
)
Found = dict[tuple[int, int, str, str, str], int]


class Broken(Exception):
    """A tool failed on a program."""


@dataclass
class Answers:
    """What both find: (line, column, parameter, type, relation) -> distance.

    ``data`` are those of the checker that the passes may leave out.
    """

    passes: Found
    checker: Found
    data: frozenset[tuple[int, int, str, str, str]] = frozenset()

    def lines(self, first: int, last: int) -> Answers:
        """The part between two lines, counted from the first."""

        def part(found: Found) -> Found:
            inside = {k: d for k, d in found.items() if first <= k[0] <= last}
            return {(k[0] - first, *k[1:]): d for k, d in inside.items()}

        data = part(dict.fromkeys(self.data, 0))
        return Answers(part(self.passes), part(self.checker), frozenset(data))

    def difference(self) -> list[str]:
        """A line for each place that the two disagree about."""
        one, other = by_place(self.passes), by_place(self.checker)
        sure = by_place({k: d for k, d in self.checker.items() if k not in self.data})
        out = []
        for place in sorted(one.keys() | other.keys()):
            passes, checker = one.get(place, {}), other.get(place, {})
            allowed = place in other and (other_side(place, one) or as_flag(place, one, other))
            # Allowed difference DATA (README).
            agreed = agree(passes, checker) or agree(passes, sure.get(place, {}))
            if not agreed and not allowed:
                out.append(f"{' '.join(map(str, place))}: passes {passes}, checker {checker}")
        return out


Kinds = dict[tuple[str, str], int]


def by_place(found: Found) -> dict[tuple[int, int, str], Kinds]:
    """(line, column, parameter) -> (type, relation) -> distance."""
    out: dict[tuple[int, int, str], Kinds] = {}
    for (line, column, parameter, type_, relation), distance in found.items():
        out.setdefault((line, column, parameter), {})[type_, relation] = distance
    return out


def agree(passes: Kinds, checker: Kinds) -> bool:
    """True where two answers about one place and parameter are the same.

    Allowed difference MIXED (README): where a parameter comes to a place in several ways,
    the passes may name any of them, and the nearest is as near. LOOP: arithmetic in a loop may
    come to anything, also to the parameter itself.
    """
    ways = set(checker)
    for type_, relation in checker:
        if type_ == "repeated":
            ways |= {("parameter", relation), ("derived", relation), ("flag", "flag")}
    if len(ways) > 1 and passes:
        return passes.keys() <= ways and min(passes.values()) == min(checker.values())
    return passes == checker


def other_side(place: tuple[int, int, str], passes: dict[tuple[int, int, str], Kinds]) -> bool:
    """True where the passes say that another parameter is the threshold there, and this one is not.

    Allowed difference SIDES (README): both operands have a parameter's value, and one of them is
    something else on another way.
    """
    return place not in passes and any(
        line == place[0] and column == place[1] for line, column, _ in passes
    )


def as_flag(
    place: tuple[int, int, str],
    passes: dict[tuple[int, int, str], Kinds],
    checker: dict[tuple[int, int, str], Kinds],
) -> bool:
    """True where a derived comparison with zero is, for both, also a flag that is as near.

    Allowed difference FLAG (README): a flag stands at its branch, a derived comparison where it
    compares, and of several ways to one condition the passes name one.
    """
    kinds = checker[place]
    if place in passes or any(t == "parameter" or r not in ("==", "!=") for t, r in kinds):
        return False
    line, _, parameter = place
    flag = ("flag", "flag")
    distance = min(kinds.values())
    return any(
        (at[0], at[2]) == (line, parameter)
        and found.get(flag) == distance == checker.get(at, {}).get(flag)
        for at, found in passes.items()
    )


def ask(source: str, folder: Path, level: str = "-O2") -> Answers:
    """Both answers for a C++ file."""
    folder.mkdir(parents=True, exist_ok=True)
    cpp, bitcode, prepared = (folder / f"unit.{e}" for e in ("cpp", "o", "ll"))
    cpp.write_text(source)
    include = str(INPUTS / "include")
    tool([*COMPILE, level, "-isystem", include, "-c", str(cpp), "-o", str(bitcode)])
    # What is left of a formula with variables is a matter of taste, which lit tests.
    taste = "-tpc-max-variables=0"
    load = [f"-load={PLUGIN}", f"-load-pass-plugin={PLUGIN}", f"-tpc-exclude={include}", taste]
    passes = "-passes=tpc-prepare,print<tpc-gather-results>"
    printed = tool(["opt-19", *load, passes, "-S", str(bitcode), "-o", str(prepared)])
    found: Found = {}
    for line in printed.splitlines():
        if m := LINE.match(line):
            key = (int(m["line"]), int(m["column"]), m["parameter"], m["type"], m["relation"])
            found[key] = min(int(m["distance"]), found.get(key, 1 << 30))
    own, data = {}, set()
    for f in check(prepared.read_text(), str(INPUTS)):
        key = (f.line, f.column, f.parameter, f.type, f.relation)
        own[key] = f.distance
        if f.is_data:
            data.add(key)
    return Answers(found, own, frozenset(data))


def tool(command: list[str]) -> str:
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    except subprocess.TimeoutExpired as e:
        raise Broken(f"{command[0]}: no end after {e.timeout} s") from e
    if done.returncode:
        raise Broken(f"{command[0]}: {done.stderr[:2000]}")
    return done.stdout


def compare(programs: list[Program], folder: Path, level: str = "-O2") -> list[Answers]:
    """The answers for each of the programs, which are compiled as one file."""
    source, ranges = prologue(programs), []
    for p in programs:
        first = source.count("\n") + 1
        source += p.text()
        ranges.append((first, source.count("\n")))
    answers = ask(source, folder, level)
    return [answers.lines(*r) for r in ranges]


def shrink(p: Program, differs: Callable[[Program], bool], seconds: float = 120) -> Program:
    """A smaller program that still differs: what can be taken out is, until nothing can."""
    end = time.monotonic() + seconds
    position, again = 0, False
    while True:
        candidate = next(islice(p.smaller(), position, None), None)
        if time.monotonic() > end or (candidate is None and not again):
            return p
        if candidate is None:
            position, again = 0, False
        elif differs(candidate):
            p, again = candidate, True
        else:
            position += 1


def batches(seeds: range, extended: bool) -> Iterator[range]:
    """The seeds of programs that are compiled as one file."""
    size = EXTENDED_BATCH if extended else BATCH
    for begin in range(0, len(seeds), size):
        yield seeds[begin : begin + size]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--programs", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--level", default="-O2")
    parser.add_argument("--extended", action="store_true", help="programs with more kinds of code")
    parser.add_argument("--out", type=Path, default=TOP / "build/oracle")
    parser.add_argument("--shrink-seconds", type=float, default=60)
    parser.add_argument("--most", type=int, default=10, help="disagreements to make smaller")
    options = parser.parse_args()
    folder, level = options.out, options.level
    findings, differing = 0, []
    seeds = range(options.seed, options.seed + options.programs)
    for batch in batches(seeds, options.extended):
        programs = [program(s, f"p{s}", options.extended) for s in batch]
        try:
            compared = compare(programs, folder, level)
        except Broken as e:
            print(f"seeds {batch.start} to {batch.stop - 1}: {e}", flush=True)
            differing += [(len(p.text()), s, p) for s, p in zip(batch, programs, strict=True)]
            continue
        for seed, p, answers in zip(batch, programs, compared, strict=True):
            findings += len(answers.checker)
            if difference := answers.difference():
                differing.append((len(p.text()), seed, p))
                print(f"seed {seed}: {len(difference)} differences", flush=True)
    for _, seed, p in sorted(differing, key=lambda d: d[:2])[: options.most]:
        report_smaller(p, folder / f"seed-{seed}", level, options.shrink_seconds)
    print(f"{len(seeds)} programs, {findings} findings, {len(differing)} programs differ")
    return 1 if differing else 0


def report_smaller(p: Program, kept: Path, level: str, seconds: float) -> None:
    """Makes a differing program smaller and shows it with both answers."""
    kept.mkdir(exist_ok=True)
    (kept / "program.cpp").write_text(prologue([p]) + p.text())

    def differs(candidate: Program) -> bool:
        try:
            return bool(compare([candidate], kept / "try", level)[0].difference())
        except Broken:
            return False

    if not differs(p):
        print("  agrees when it is alone")
        return
    small = shrink(p, differs, seconds)
    (kept / "small.cpp").write_text(prologue([small]) + small.text())
    difference = compare([small], kept / "try", level)[0].difference()
    (kept / "small.txt").write_text("\n".join([*difference, ""]))
    numbered = [f"  {n:3} {line}" for n, line in enumerate(small.text().splitlines())]
    numbered = [line for line in numbered if line[6:].strip() not in "{};"]
    print("\n".join([*numbered, *[f"  {d}" for d in difference]]), flush=True)


if __name__ == "__main__":
    sys.exit(main())
