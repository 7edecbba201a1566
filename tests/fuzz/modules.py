"""Random modules: llvm-stress's, and damaged ones of the project's own tests.

Every module is valid IR, however little sense it makes: what LLVM's verifier does not take is
thrown away. The passes have to leave a valid module and a valid file of static information, without
a crash inside, in limited time.
"""

from __future__ import annotations

import json
import random
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from fuzz.tools import BIN, LIT_INPUTS, ROOT, compile_unit, opt, run
from pytpc.base.errors import InputError
from pytpc.static.link_unit import LinkUnit

HERE = Path(__file__).parent

# What may happen to a module before it is linked, in this project or elsewhere.
_PASSES = """
default<O1> default<O2> default<O3> default<Os> sroa mem2reg reg2mem instcombine simplifycfg
jump-threading gvn early-cse loop-rotate loop(loop-unroll-full) loop-unroll break-crit-edges
mergereturn lower-switch lower-invoke structurizecfg fix-irreducible loop-simplify lcssa
tailcallelim speculative-execution flatten-cfg ipsccp deadargelim argpromotion inline globalopt
mergefunc hotcoldsplit partial-inliner scalarizer function-attrs constmerge strip-nondebug
debugify internalize attributor called-value-propagation sink licm adce slp-vectorizer
loop-vectorize reassociate correlated-propagation constraint-elimination
"""
PASSES = tuple(_PASSES.split())


@dataclass(frozen=True, slots=True)
class Checked:
    """One module that went through the passes; ``finding`` is empty where all was right."""

    finding: str
    comparisons: int = 0
    skipped: str = ""


class Corpus:
    """The modules of the lit tests, unoptimised as a link sees them, and further ones.

    Each becomes text when it is drawn for the first time: all of them take longer than many runs.

    Args:
        folder: for the texts.
        further: more modules, as bitcode.
    """

    def __init__(self, folder: Path, further: Sequence[Path] = ()) -> None:
        self._folder = folder
        sources = sorted([*(ROOT / "tests/lit").glob("[!I]*/*.cpp"), LIT_INPUTS / "node.cpp"])
        self._modules = [(source, level) for source in sources for level in ("-O0", "-O2")]
        self._modules += [(unit, "") for unit in further]
        self._texts: dict[tuple[Path, str], Path] = {}

    def draw(self, draw: random.Random) -> Path:
        """One of them, as text; what does not compile is no module."""
        while True:
            source, level = entry = draw.choice(self._modules)
            if entry not in self._texts:
                self._texts[entry] = self._text(source, level)
            if self._texts[entry].is_file():
                return self._texts[entry]

    def _text(self, source: Path, level: str) -> Path:
        text = self._folder / f"{source.parent.name}-{source.stem}{level}.ll"
        if not level:
            disassemble(source, text)
            return text
        unit = text.with_suffix(".o")
        flags = [level, "-std=c++17", "-isystem", LIT_INPUTS / "include"]
        if compile_unit(source, unit, flags).status == 0:
            disassemble(unit, text)
        unit.unlink(missing_ok=True)
        return text


def disassemble(unit: Path, text: Path) -> None:
    """Write a module as text."""
    run([BIN / "llvm-dis", unit, "-o", text])


def stress(seed: int, text: Path) -> None:
    """A module of llvm-stress, with a parameter going in and something exposed in its blocks."""
    draw = random.Random(seed)
    made = run([BIN / "llvm-stress", f"--seed={seed % 2**31}", f"--size={draw.randint(20, 900)}"])
    body = made.output.decode()
    name = re.search(r"define void (@\w+)\(([^)]*)\)", body)
    assert name is not None
    kinds = [argument.split()[0] for argument in name[2].split(",")]
    values = {"ptr": "%m", "i32": "%p", "i64": "%q", "i8": "%r"}
    lines = [
        f"  call void @fuzz_show(i32 {draw.randint(0, 9)})\n{line}"
        if line.startswith(("  br ", "  ret ")) and draw.random() < 0.5
        else line
        for line in body.splitlines()
    ]
    lines += [
        '@name = private constant [6 x i8] c"limit\\00"',
        "declare void @fuzz_show(i32)",
        "declare i32 @_Z8fuzz_getPKci(ptr, i32)",
        "define void @run() {",
        "  %m = alloca [64 x i64]",
        "  %p = call i32 @_Z8fuzz_getPKci(ptr @name, i32 7)",
        "  %q = sext i32 %p to i64",
        "  %r = trunc i32 %p to i8",
        f"  call void {name[1]}({', '.join(f'{kind} {values[kind]}' for kind in kinds)})",
        "  %c = icmp sgt i32 %p, 3",
        "  br i1 %c, label %yes, label %no",
        "yes:",
        "  call void @fuzz_show(i32 1)",
        "  br label %no",
        "no:",
        "  ret void",
        "}",
    ]
    text.write_text("\n".join(lines) + "\n", encoding="utf-8")
    if draw.random() < 0.7:
        run([BIN / "opt", "-S", "-passes=debugify", text, "-o", text])


def _each(pattern: str, replacement: str | Callable[[re.Match[str]], str], chance: float):
    """A mutation: each match is replaced, or not, by chance."""

    def mutate(text: str, draw: random.Random) -> str:
        def one(match: re.Match[str]) -> str:
            if draw.random() >= chance:
                return match[0]
            return match.expand(replacement) if isinstance(replacement, str) else replacement(match)

        return re.sub(pattern, one, text, flags=re.MULTILINE)

    return mutate


def _rename(text: str, draw: random.Random) -> str:
    """Functions and globals get names that say something else, or nothing."""
    kinds = [
        lambda n: f"@f{n}",
        lambda n: f"@_Z{n}",
        lambda n: f"@_ZN{n}xE",
        lambda n: f'@"\\01odd {n}"',
        lambda n: f'@"\\C3{n}"',
        lambda n: f"@_ZN3ros9Publisher7publishEv.{n}",
    ]
    names = sorted({*re.findall(r'@[\w.$]+(?=[(, ])|@"[^"]+"', text)} - {"@llvm"})
    names = [name for name in names if not name.startswith("@llvm.")]
    if not names:
        return text
    chosen = {
        name: draw.choice(kinds)(n)
        for n, name in enumerate(draw.sample(names, max(1, len(names) // 5)))
    }
    return re.sub(r'@[\w.$]+|@"[^"]+"', lambda match: chosen.get(match[0], match[0]), text)


def _drop_bodies(text: str, draw: random.Random) -> str:
    """Functions lose their bodies."""

    def one(match: re.Match[str]) -> str:
        if draw.random() < 0.7:
            return match[0]
        head = re.sub(
            r"\b(internal|linkonce_odr|linkonce|weak_odr|weak|private|hidden|dso_local)\b ?|"
            r" (comdat(\([^)]*\))?|personality ptr @\w+|!dbg !\d+)",
            "",
            match[1],
        )
        return f"declare {head}"

    return re.sub(r"^define (.*) \{\n(?:.*\n)*?\}", one, text, flags=re.MULTILINE)


MUTATIONS: dict[str, Callable[[str, random.Random], str]] = {
    "unreachable": _each(r"br i1 %[\w.]+,", "br i1 true,", 0.3),
    "poison": _each(r"br i1 %[\w.]+,", "br i1 poison,", 0.2),
    "undef": _each(r"(call \w+ @[\w.]+\(.*)i32 (?:noundef )?%[\w.]+", r"\1i32 undef", 0.2),
    "null": _each(
        r"\bptr (?:noundef |nonnull |align \d+ |dereferenceable\(\d+\) )*%[\w.]+(?=[,)])",
        "ptr null",
        0.05,
    ),
    "stores": _each(r"^  store .*\n", "", 0.2),
    "calls": _each(r"^  call void .*\n", "", 0.2),
    "places": _each(r", !dbg !\d+$", "", 0.3),
    "all places": _each(r", !dbg !\d+$", "", 1),
    "lines": _each(r"(!DILocation\(line: )\d+", r"\g<1>0", 0.5),
    "huge lines": _each(r"(!DILocation\(line: )\d+", r"\g<1>4294967295", 0.5),
    "inlined": _each(r"(, scope: (!\d+))\)$", r"\1)", 0.5),
    "elements": _each(r", elements: !\d+", "", 0.3),
    "types": _each(r", baseType: !\d+", "", 0.3),
    "files": _each(r"!DIFile\(filename: \"[^\"]*\"", '!DIFile(filename: ""', 0.3),
    "odd files": _each(r"!DIFile\(filename: \"[^\"]*\"", r'!DIFile(filename: "\\FF\\0Ax"', 0.3),
    "members": _each(r"(tag: DW_TAG_member, name: )\"[^\"]*\"", r'\1"x"', 0.5),
    "relations": _each(r"icmp (eq|ne|s[lg][te])", "icmp ult", 0.3),
    "floats": _each(r"fcmp \w+", "fcmp uno", 0.3),
    "constants": _each(r"double \d\.\d+e[+-]\d+", "double 0x7FF8000000000000", 0.5),
    "infinite": _each(r"double \d\.\d+e[+-]\d+", "double 0x7FF0000000000000", 0.5),
    "numbers": _each(r"i32 (\d+)(?=[,)])", "i32 2147483647", 0.1),
    "strings": _each(r'(\[(\d+) x i8\]) c"[^"]*"', r"\1 zeroinitializer", 0.5),
    "bytes": _each(r'c"[a-z]', r'c"\\FF', 0.5),
    "rename": _rename,
    "bodies": _drop_bodies,
    "unoptimised": _each(
        r"^(attributes #\d+ = \{)(?!.*(optnone|alwaysinline))", r"\1 noinline optnone", 0.5
    ),
    "linkage": _each(r"^define (linkonce_odr|internal) ", "define ", 0.3),
    "types of classes": _each(r"%class\.", "%class.x.", 1),
}


def mutate(text: Path, seed: int) -> list[str]:
    """Damage a module in place by what ``seed`` says; returns what was done.

    What is no module afterwards is undone, step by step.
    """
    draw = random.Random(seed)
    done = []
    for _ in range(draw.randint(1, 5)):
        before = text.read_bytes()
        if draw.random() < 0.35:
            name = draw.choice(PASSES)
            ran = run([BIN / "opt", "-S", f"-passes={name}", text, "-o", text], seconds=20)
        elif draw.random() < 0.1:
            name = draw.choice(["strip-debug", "strip-named-metadata"])
            ran = run([BIN / "opt", "-S", f"-{name}", text, "-o", text])
        else:
            name = draw.choice(sorted(MUTATIONS))
            text.write_text(MUTATIONS[name](text.read_text("utf-8"), draw), encoding="utf-8")
            ran = run([BIN / "opt", "-S", "-passes=verify", text, "-o", text])
        if ran.status == 0:
            done.append(name)
        else:
            text.write_bytes(before)
    return done


def check(text: Path, seed: int) -> Checked:
    """Put a module through the passes, and what comes out through LLVM's own."""
    draw = random.Random(seed)
    if run([BIN / "opt", "-disable-output", "-passes=verify", text]).status != 0:
        return Checked("", skipped="no module")
    file = text.with_suffix(".json")
    file.unlink(missing_ok=True)
    after = draw.choice(["verify", "verify", "default<O2>"])
    ran = opt(
        f"-passes=tpc,verify,{after}",
        f"-tpc-rules={HERE / 'rules.json'}",
        "-tpc-link-unit=fuzzed",
        "-tpc-source-root=/",
        f"-tpc-exclude={LIT_INPUTS / 'include'}",
        f"-tpc-static-info={file}",
        "-tpc-max-seconds=20",
        text,
        "-o",
        text.with_suffix(".bc"),
    )
    if ran.status != 0:
        return Checked(f"opt ends with {ran.status}: {ran.errors[-1500:]}")
    try:
        unit = LinkUnit.from_json(json.loads(file.read_text("utf-8")), file)
    except (OSError, ValueError, InputError) as error:
        return Checked(f"static information: {error}")
    if unit.trouble is not None:
        return Checked(f"{unit.trouble} {ran.errors[:500]}")
    return Checked("", sum(found.type != "constant" for found in unit.comparisons))
