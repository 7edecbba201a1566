"""Random programs: csmith's, with parameters put in, run with and without the passes.

csmith writes C without undefined behaviour that prints a checksum of its global variables. Here
each global number is read from a parameter first, and the checksum is an exposing statement, so
that most predicates compare a parameter and many are reported.
"""

from __future__ import annotations

import random
import re
from dataclasses import dataclass
from pathlib import Path

from fuzz.tools import BIN, compile_unit, plugin_link_flags, run

HERE = Path(__file__).parent
SECONDS = 5
_INCLUDES = ["-I/usr/include/csmith"]
_GLOBAL = re.compile(
    r"^static (?:volatile )?(u?int(?:8|16|32|64)_t|float) (g_\d+) = ", re.MULTILINE
)
_DECLARATIONS = "".join(
    f"{kind} __attribute__((overloadable)) fuzz_get(const char *, {kind});\n"
    for kind in [f"{sign}int{bits}_t" for bits in (8, 16, 32, 64) for sign in ("", "u")]
    + ["float", "double"]
)
_OPTIONS = ["structs", "unions", "bitfields", "packed-struct", "volatiles", "jumps", "longlong"]
_OPTIONS += ["inline-function", "float", "arrays", "pointers"]


@dataclass(frozen=True, slots=True)
class Compared:
    """One program run both ways; ``finding`` is empty where both did the same."""

    finding: str
    reports: int = 0
    skipped: str = ""


def with_parameters(text: str) -> str:
    """csmith's program with its global numbers read from parameters."""
    reads = "".join(
        f'    {name} = fuzz_get("{name}", ({kind}){name});\n'
        for kind, name in _GLOBAL.findall(text)
    )
    head, include, rest = text.partition('#include "csmith.h"\n')
    return (
        head + include + _DECLARATIONS + rest.replace("    func_1();\n", reads + "    func_1();\n")
    )


def compare(seed: int, folder: Path) -> Compared:
    """Make, build and run one program both ways; what it was made of stays in ``folder``."""
    draw = random.Random(seed)
    flags = [f"--{draw.choice(['', 'no-'])}{option}" for option in _OPTIONS]
    made = run(
        ["csmith", "--seed", str(seed), "--max-funcs", str(draw.randint(2, 8)), *flags], seconds=20
    )
    if made.status != 0:
        return Compared("", skipped="csmith")
    source, unit, stubs = folder / "program.c", folder / "program.o", folder / "stubs.o"
    source.write_text(with_parameters(made.output.decode()), encoding="utf-8")
    level = f"-O{draw.randint(0, 3)}"
    compiled = compile_unit(source, unit, [level, *_INCLUDES])
    if compiled.status != 0:
        return Compared("", skipped="clang")
    run([BIN / "clang++", "-O1", "-c", HERE / "stubs.cpp", "-o", stubs])
    link = [BIN / "clang++", "-flto=full", level, f"--ld-path={BIN / 'ld.lld'}", unit, stubs, "-o"]
    run([*link, folder / "plain"])
    options = [f"-tpc-rules={HERE / 'rules.json'}", f"-tpc-static-info={folder / 'unit.json'}"]
    linked = run([*link, folder / "instrumented", *plugin_link_flags(*options)])
    if linked.status != 0 or "warning" in linked.errors:
        return Compared(f"link at {level}: {linked.status} {linked.errors[:500]}")
    return _run_both(source, stubs, folder, level)


def _is_defined(source: Path, stubs: Path, program: Path) -> bool:
    """False where the program does what C leaves open: csmith is not free of mistakes."""
    checks = ["-fsanitize=undefined", "-fsanitize-trap=undefined"]
    flags = ["-w", "-O1", *checks, *_INCLUDES, source, stubs, "-lstdc++"]
    run([BIN / "clang", *flags, "-o", program])
    return run([program], seconds=20 * SECONDS).status == 0


def _run_both(source: Path, stubs: Path, folder: Path, level: str) -> Compared:
    plain = run([folder / "plain"], seconds=SECONDS)
    if plain.status is None:
        return Compared("", skipped="endless")
    counted = folder / "reports"
    # Reports cost time; a program that ended just in time does not have to.
    env = {"FUZZ_REPORTS": str(counted)}
    other = run([folder / "instrumented"], seconds=20 * SECONDS, env=env)
    reports = int(counted.read_text()) if counted.exists() else 0
    if other != plain and not _is_defined(source, stubs, folder / "checked"):
        return Compared("", skipped="undefined")
    if other != plain:
        return Compared(f"at {level}: {plain.output!r} became {other.output!r} ({other.status})")
    return Compared("", reports)
