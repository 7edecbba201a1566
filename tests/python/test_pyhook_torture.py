"""The standard library's own tests have the same results when every comparison in them reports."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

# Those of tracers see no call of the hook.
TESTS = [
    "test_bisect", "test_heapq", "test_dict", "test_float", "test_generators", "test_compare",
    "test_richcmp", "test_list", "test_tuple", "test_bool", "test_fractions", "test_dataclasses",
    "test_named_expressions", "test_patma", "test_coroutines", "test_contextlib", "test_functools",
    "test_range", "test_slice", "test_string", "test_traceback", "test_grammar", "test_iter",
    "test_class", "test_with", "test_scope", "test_super", "test_exceptions", "test_listcomps",
    "test_genexps", "test_setcomps", "test_dictcomps", "test_unpack", "test_raise",
    "test_userdict", "test_userlist", "test_textwrap", "test_shlex", "test_difflib", "test_copy",
    "test_ipaddress", "test_calendar", "test_graphlib", "test_deque", "test_opcodes",
    "test_augassign", "test_binop", "test_contains", "test_decorators", "test_enumerate",
    "test_property", "test_weakset", "test_sys_settrace", "test_sys_setprofile", "test_bdb",
    "test_trace", "test_cprofile",
]  # fmt: skip


def _python() -> str | None:
    """An interpreter that has the library's tests; distributions leave most of them out."""
    versions = Path.home() / ".pyenv/versions"
    here = [sys.executable, shutil.which("python3"), *map(str, versions.glob("3.11*/bin/python"))]
    for python in [*here, *map(str, sorted(versions.glob("3.*/bin/python"), reverse=True))]:
        if python is None:
            continue
        asked = [python, "-c", "import test.test_bisect, test.test_patma"]
        if subprocess.run(asked, check=False, capture_output=True, timeout=30).returncode == 0:
            return python
    return None


PYTHON = _python()


def results(*words: str) -> dict[str, object]:
    program = Path(__file__).with_name("hook_torture.py")
    done = subprocess.run(
        [str(PYTHON), "-W", "ignore", str(program), *words, str(program.parents[2]), *TESTS],
        check=False,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    answer: dict[str, object] = json.loads(done.stdout.splitlines()[-1])
    return answer


@pytest.mark.skipif(PYTHON is None, reason="no interpreter with the standard library's tests")
def test_the_librarys_own_tests() -> None:
    plain, instrumented = results("--plain"), results()
    reports = instrumented.pop("reports")
    assert plain.pop("reports") == 0
    assert isinstance(reports, int)
    assert reports > 100_000
    assert instrumented == plain
