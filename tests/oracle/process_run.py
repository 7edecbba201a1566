"""Compares what TPC finds in programs of several link units with what their execution says.

A comparison with a parameter is true if a threshold changes with the parameter, and if the node
publishes something else when the comparisons with that threshold have the other outcome. Both are
tried by executing the program without TPC.

From the top folder: python -m tests.oracle.process_run --programs 100 --seed 1
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pytpc.base.checked_json import parse_json
from pytpc.build.reconcile import Recorded
from pytpc.processes.analysis import Budget, analyse_processes
from pytpc.processes.plugins import Plugin
from pytpc.processes.process import Choice, Process, Unit
from tests.oracle.process_generator import LIBRARIES, MAIN, PLUGINS, UNITS, Text, process
from tests.oracle.run import COMPILE, INPUTS, PLUGIN, TOP, Broken, tool

PACKAGE = "oracle"
NATIVE = ["clang++-19", "-std=c++17", "-Wno-everything", "-fPIC", f"-I{INPUTS / 'include'}"]
RUNTIME = """#include <cstdio>
#include <cstdlib>
static unsigned State = 1;
double sensed() {
  State = State * 1103515245 + 12345;
  return (State >> 16) % 100 / 10.0;
}
bool truth(int Site, double Value, double Threshold, bool Outcome) {
  int Number;
  double Of;
  const char *Other = std::getenv("OTHER");
  if (Other && std::sscanf(Other, "%d %lf", &Number, &Of) == 2 &&
      Number == Site && Of == Threshold)
    Outcome = !Outcome;
  std::printf("site %d %.17g %.17g %d\\n", Site, Value, Threshold, Outcome);
  return Outcome;
}
void log_one(char *Key, bool, double Value, double Threshold, bool Outcome) {
  std::printf("site %s %.17g %.17g %d\\n", Key, Value, Threshold, Outcome);
}
"""
SITE = re.compile(r"(?:SITE|FLAG)\((\d+),")
Place = tuple[str, int]
"""File and line."""
Evaluations = dict[str, list[tuple[str, ...]]]
"""By site, the compared value, the threshold and the outcome of each evaluation."""


@dataclass
class Ran:
    """What a run of the program printed."""

    published: list[str] = field(default_factory=list)
    sites: Evaluations = field(default_factory=dict)


@dataclass
class Compared:
    """What is true and what was found: (file, line, parameter).

    ``wrong`` are texts about reports of the running program that are not as they should be.
    """

    true: frozenset[tuple[str, int, str]]
    found: frozenset[tuple[str, int, str]]
    wrong: tuple[str, ...] = ()

    def difference(self) -> list[str]:
        missed = [f"missed: {one}" for one in sorted(self.true - self.found)]
        false = [f"false: {one}" for one in sorted(self.found - self.true)]
        return [*missed, *false, *self.wrong]


def places(text: Text) -> dict[str, Place]:
    """Where each site is."""
    return {
        number: (name, line)
        for name, content in text.files.items()
        if name.endswith(".cpp")
        for line, code in enumerate(content.splitlines(), start=1)
        for number in SITE.findall(code)
    }


def library(unit: str) -> str:
    return unit if unit == MAIN else f"lib{unit}.so"


def link(unit: str, folder: Path, compiler: Sequence[str], inputs: Sequence[str]) -> None:
    """Link a unit into a folder, with the libraries that are there."""
    kind = [] if unit == MAIN else ["-shared", f"-Wl,-soname,{library(unit)}"]
    needs = ["-lright", "-lleft"] if unit == MAIN else []
    out = str(folder / library(unit))
    tool([*compiler, *kind, *inputs, "-o", out, f"-L{folder}", *needs, "-lros"])


def ordered() -> list[str]:
    """The units, those first that others are linked with."""
    return [*LIBRARIES, *PLUGINS, MAIN]


def write(text: Text, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in text.files.items():
        (folder / name).write_text(content)


def run(folder: Path, parameters: Mapping[str, str], other: str | None = None) -> Ran:
    """Run the program in a folder; ``other`` are a site and a threshold.

    There, comparisons have the other outcome.
    """
    env = {f"PARAM_{name}": value for name, value in parameters.items()}
    env["LD_LIBRARY_PATH"] = str(folder)
    if other is not None:
        env["OTHER"] = other
    done = subprocess.run(
        [folder / MAIN], capture_output=True, text=True, timeout=60, env=env, check=False
    )
    if done.returncode:
        raise Broken(f"{folder / MAIN}: status {done.returncode}: {done.stderr}")
    found = Ran()
    for line in done.stdout.splitlines():
        kind, *words = line.split()
        if kind == "site":
            found.sites.setdefault(words[0], []).append(tuple(words[1:]))
        else:
            found.published.append(line)
    return found


def changed(value: str) -> str:
    """Another value of a parameter."""
    return "0" if value == "1" else str(float(value) + 1).removesuffix(".0")


def truth(text: Text, folder: Path) -> tuple[dict[str, set[str]], Ran]:
    """Of each site that is true the parameters, by executing the program; and its run."""
    plain = run(folder, text.parameters)
    thresholds = {site: {one[1] for one in seen} for site, seen in plain.sites.items()}
    acts = {
        (site, threshold)
        for site, known in thresholds.items()
        for threshold in known
        if run(folder, text.parameters, other=f"{site} {threshold}").published != plain.published
    }
    found: dict[str, set[str]] = {}
    for name, value in text.parameters.items():
        again = run(folder, {**text.parameters, name: changed(value)})
        for site, known in thresholds.items():
            gone = known - {one[1] for one in again.sites.get(site, ())}
            if any((site, threshold) in acts for threshold in gone):
                found.setdefault(site, set()).add(name)
    return found, plain


def built_native(folder: Path, runtime: Path) -> Path:
    """The program without TPC, with its sites."""
    made = folder / "native"
    made.mkdir(exist_ok=True)
    (made / "libros.so").symlink_to(runtime)
    for unit in ordered():
        link(unit, made, [*NATIVE, "-DTRUTH"], [str(folder / f"{unit}.cpp")])
    return made


def runtime_library(folder: Path) -> Path:
    """The part of ROS that programs use; made once."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "runtime.cpp").write_text(RUNTIME)
    made = folder / "libros.so"
    sources = [str(folder / "runtime.cpp"), str(INPUTS / "ros.cpp")]
    tool([*NATIVE, "-DNO_LOG_ONE", "-shared", "-Wl,-soname,libros.so", *sources, "-o", str(made)])
    return made.absolute()


@dataclass
class Instrumented:
    """Builds the program as `pytpc build` does: two links of each unit."""

    text: Text
    folder: Path
    runtime: Path

    def static_info(self, unit: str) -> Path:
        return self.folder / "tpc" / f"{unit}.json"

    def link_all(self, out: Path, more: Mapping[str, Sequence[str]]) -> None:
        out.mkdir(exist_ok=True)
        (out / "libros.so").symlink_to(self.runtime)
        options = [f"-tpc-package={PACKAGE}", f"-tpc-source-root={self.folder}"]
        options.append(f"-tpc-exclude={INPUTS / 'include'}")
        for unit in ordered():
            words = [f"-tpc-link-unit={unit}", *options, *more[unit]]
            passed = [f"-Wl,-mllvm,{word}" for word in words]
            linker = ["clang++-19", "-flto=full", "-fuse-ld=lld-19", "-O2"]
            linker += [f"-Wl,--load-pass-plugin={PLUGIN}", f"-Wl,-mllvm,-load={PLUGIN}", *passed]
            link(unit, out, linker, [str(self.folder / f"{unit}.o")])

    def process(self) -> Process:
        units = {}
        for unit in UNITS:
            recorded = Recorded(PACKAGE, unit, self.folder / unit, self.static_info(unit), "")
            units[unit] = Unit(PACKAGE, unit, self.folder / unit, recorded)
        loaded = tuple(self.plugin(name.capitalize()) for name in PLUGINS)
        others = tuple(self.plugin(name) for name in self.text.without)
        needed = tuple(units[unit] for unit in (MAIN, "right", "left"))
        opened = tuple(units[unit] for unit in PLUGINS)
        return Process(
            "oracle/robot",
            "oracle/robot",
            None,
            (*needed, *opened),
            (Choice("Plugin", loaded, "code", others),),
            (needed, *((unit,) for unit in opened)),
        )

    def plugin(self, kind: str) -> Plugin:
        return Plugin(kind, kind, "Plugin", PACKAGE, self.folder, self.folder, 1)

    def build(self) -> Path:
        """The folder of the program that reports."""
        (self.folder / "tpc").mkdir(exist_ok=True)
        for unit in UNITS:
            source, made = self.folder / f"{unit}.cpp", self.folder / f"{unit}.o"
            include = ["-isystem", str(INPUTS / "include")]
            tool([*COMPILE, "-O2", "-fPIC", *include, "-c", str(source), "-o", str(made)])
        manifests = {
            unit: [
                "-tpc-analyse=false",
                f"-tpc-manifest={self.static_info(unit).with_suffix('.link.json')}",
            ]
            for unit in UNITS
        }
        self.link_all(self.folder / "first", manifests)
        (analysed,) = analyse_processes([self.process()], self.folder, Budget(600))
        if analysed.plan is None or analysed.left_out:
            raise Broken(f"{self.folder}: {analysed.failure} {analysed.left_out}")
        plans = {
            unit: [f"-tpc-plan={analysed.plan}", f"-tpc-static-info={self.static_info(unit)}"]
            for unit in UNITS
        }
        made = self.folder / "second"
        self.link_all(made, plans)
        return made

    def comparisons(self) -> list[dict[str, Any]]:
        found: list[dict[str, Any]] = []
        for unit in UNITS:
            static: Any = parse_json(self.static_info(unit))
            if static["failure"] is not None:
                raise Broken(f"{unit}: {static['failure']}")
            found += [one for one in static["comparisons"] if one["type"] != "constant"]
        return found


def reports(
    comparisons: Sequence[Mapping[str, Any]], sites: Mapping[str, Place], ran: Ran, plain: Ran
) -> list[str]:
    """What the running program reports otherwise than its sites were evaluated."""
    at = {place: site for site, place in sites.items()}
    wrong = []
    for one in comparisons:
        site = at.get((Path(one["file"]).name, one["lineno"]), "")
        seen = ran.sites.get(one["key"], [])
        wanted = plain.sites.get(site, [])
        # What several objects compare there cannot always be told apart.
        if len({threshold for _, threshold, _ in wanted}) > 1:
            continue
        numbers = [[float(word) for word in words] for words in seen]
        if numbers != [[float(word) for word in words] for words in wanted]:
            wrong.append(
                f"reports: {one['file']}:{one['lineno']} {one['source']}:"
                f" {len(seen)}, evaluated {len(wanted)}"
            )
    return wrong


def compare(text: Text, folder: Path, runtime: Path) -> Compared:
    """What is true and what TPC finds in a program, in a new folder."""
    write(text, folder)
    sites = places(text)
    true, plain = truth(text, built_native(folder, runtime))
    made = Instrumented(text, folder, runtime)
    ran = run(made.build(), text.parameters)
    comparisons = made.comparisons()
    wrong = reports(comparisons, sites, ran, plain)
    if ran.published != plain.published:
        wrong.append("the program publishes something else than without TPC")
    return Compared(
        frozenset((*sites[site], name) for site, names in true.items() for name in names),
        frozenset((Path(one["file"]).name, one["lineno"], one["source"]) for one in comparisons),
        tuple(wrong),
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--programs", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--chains", type=int, default=12)
    parser.add_argument("--out", type=Path, default=TOP / "build/oracle-processes")
    options = parser.parse_args()
    runtime = runtime_library(options.out)
    true = differing = 0
    for seed in range(options.seed, options.seed + options.programs):
        folder = options.out / f"seed-{seed}"
        if folder.exists():
            print(f"{folder} is there; remove it, or choose another --out")
            return 2
        compared = compare(process(seed, options.chains), folder, runtime)
        true += len(compared.true)
        if difference := compared.difference():
            differing += 1
            print(f"seed {seed}:", *difference, sep="\n  ", flush=True)
    print(f"{options.programs} programs, {true} true comparisons, {differing} programs differ")
    return 1 if differing else 0


if __name__ == "__main__":
    sys.exit(main())
