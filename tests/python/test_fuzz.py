"""The fuzzer sees what it is there to see."""

import random
from pathlib import Path

import pytest

from fuzz import modules, programs
from fuzz.tools import LIT_INPUTS, Ran, compile_unit, opt

MODULE = "define i32 @f(i1 %c) {\n  br i1 %c, label %a, label %a\na:\n  ret i32 1\n}\n"


def test_globals_are_read_from_parameters() -> None:
    text = (
        '#include "csmith.h"\n'
        "static int32_t g_2 = 6L;\n"
        "static volatile uint8_t g_3 = 1UL;/* VOLATILE */\n"
        "static const int16_t g_4 = 1;\n"
        "static int32_t *g_5 = &g_2;\n"
        "int main (void)\n{\n    func_1();\n}\n"
    )
    changed = programs.with_parameters(text)
    assert '    g_2 = fuzz_get("g_2", (int32_t)g_2);\n' in changed
    assert '    g_3 = fuzz_get("g_3", (uint8_t)g_3);\n    func_1();\n' in changed
    assert changed.count(" = fuzz_get(") == 2


def test_same_seed_same_module(tmp_path: Path) -> None:
    made = []
    for name in ("a.ll", "b.ll"):
        modules.stress(7, tmp_path / name)
        done = modules.mutate(tmp_path / name, 7)
        text = (tmp_path / name).read_text("utf-8")
        made.append((done, text.replace(name, "")))
    assert made[0] == made[1]


def test_what_is_no_module_is_no_finding(tmp_path: Path) -> None:
    text = tmp_path / "module.ll"
    text.write_text("define i32 @f() {\n  ret i64 0\n}\n", encoding="utf-8")
    assert modules.check(text, 1) == modules.Checked("", skipped="no module")


def test_a_module_with_comparisons_is_checked(tmp_path: Path) -> None:
    unit, text = tmp_path / "node.o", tmp_path / "node.ll"
    compile_unit(LIT_INPUTS / "node.cpp", unit, ["-O2", "-isystem", LIT_INPUTS / "include"])
    modules.disassemble(unit, text)
    assert modules.check(text, 1) == modules.Checked("", comparisons=3)


@pytest.mark.parametrize("failure", ["crash", "time"])
def test_a_failure_inside_is_a_finding(
    failure: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def failing(*arguments: str | Path) -> Ran:
        return opt(*arguments, f"-tpc-inject-failure={failure}")

    monkeypatch.setattr(modules, "opt", lambda *arguments: failing(*_quick(arguments)))
    text = tmp_path / "module.ll"
    text.write_text(MODULE, encoding="utf-8")
    assert "the analysis" in modules.check(text, 1).finding


def _quick(arguments: tuple[str | Path, ...]) -> list[str | Path]:
    return ["-tpc-max-seconds=1" if word == "-tpc-max-seconds=20" else word for word in arguments]


def test_another_checksum_is_a_finding(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = programs.run

    def wrong(argv: list[str | Path], **more: object) -> Ran:
        ran = real(argv, **more)
        return Ran(ran.status, b"other", "") if Path(argv[0]).name == "instrumented" else ran

    monkeypatch.setattr(programs, "run", wrong)
    compared = programs.compare(5, tmp_path)
    assert "became b'other'" in compared.finding


# What compiles all modules before the first run has no time left for a run.
def test_a_module_is_compiled_when_it_is_drawn(tmp_path: Path) -> None:
    drawn = []
    for name in ("a", "b"):
        folder = tmp_path / name
        folder.mkdir()
        corpus = modules.Corpus(folder)
        assert list(folder.iterdir()) == []
        text = corpus.draw(random.Random(3))
        assert corpus.draw(random.Random(3)) == text
        assert list(folder.iterdir()) == [text]
        drawn.append(text.name)
    assert drawn[0] == drawn[1]
