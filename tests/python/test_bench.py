"""`make bench` runs each benchmark, so each starts without arguments, and nothing else counts."""

from __future__ import annotations

import ast
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BENCHMARKS = {
    path.stem: path
    for path in (ROOT / "benchmarks").glob("*.py")
    if "from figures import" in path.read_text()
}


def bench(word: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [ROOT / "tools/bench", word], capture_output=True, text=True, check=False, timeout=60
    )


def test_help_runs_nothing_and_lists_every_benchmark():
    ran = bench("--help")
    assert ran.returncode == 0 and "FIGURE score" not in ran.stdout
    assert set(ran.stdout.partition("NAME is one of: ")[2].split()) == set(BENCHMARKS)


def test_a_benchmark_that_is_not_there_is_named():
    ran = bench("speed")
    assert ran.returncode == 1
    assert ran.stderr == "bench: error: no benchmark 'speed': see tools/bench --help\n"


@pytest.mark.parametrize("path", BENCHMARKS.values(), ids=BENCHMARKS)
def test_a_benchmark_needs_no_argument(path):
    """Its options may be left out, and a word is asked for before it is taken."""
    tree = ast.parse(path.read_text())
    main = tree.body[-1]
    assert isinstance(main, ast.If) and ast.unparse(main.test) == "__name__ == '__main__'"
    words = [ast.unparse(node) for node in ast.walk(main)]
    assert "sys.argv[1]" not in words or "len(sys.argv) > 1" in words
    for call in (node for node in ast.walk(tree) if isinstance(node, ast.Call)):
        # Those of `options` are a browser's.
        if ast.unparse(call.func).endswith("add_argument") and "options" not in ast.dump(call.func):
            assert ast.literal_eval(call.args[0]).startswith("--")
            assert not any(keyword.arg == "required" for keyword in call.keywords)
