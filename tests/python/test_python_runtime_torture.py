"""The tests of the standard library have the same results when every comparison reports."""

from __future__ import annotations

import json
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import cast

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
    "test_ipaddress", "test_graphlib", "test_deque", "test_opcodes",
    "test_augassign", "test_binop", "test_contains", "test_decorators", "test_enumerate",
    "test_property", "test_weakset", "test_sys_settrace", "test_sys_setprofile", "test_bdb",
    "test_cprofile",
]  # fmt: skip


# It leaves ten calls of the recursion limit, and a comparison that reports needs more.
LEAVE_TEN_CALLS = {"test_recursion_in_except_handler"}


def results(*words: str) -> dict[str, object]:
    program = Path(__file__).with_name("hook_torture.py")
    done = subprocess.run(
        [sys.executable, "-W", "ignore", str(program), *words, str(program.parents[2]), *TESTS],
        check=False,
        capture_output=True,
        text=True,
        timeout=1200,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    answer: dict[str, object] = json.loads(done.stdout.splitlines()[-1])
    return answer


@pytest.mark.skipif(
    find_spec("test.test_patma") is None, reason="apt-get install libpython3.11-testsuite"
)
def test_the_librarys_own_tests() -> None:
    plain, instrumented = results("--plain"), results()
    reports = instrumented.pop("reports")
    assert plain.pop("reports") == 0
    assert isinstance(reports, int)
    assert reports > 100_000
    assert {name: _judged(one) for name, one in instrumented.items()} == {
        name: _judged(one) for name, one in plain.items()
    }


def _judged(result: object) -> tuple[int, list[str], int]:
    run, failed, skipped = cast("tuple[int, list[str], int]", result)
    return run, [case for case in failed if case.split()[0] not in LEAVE_TEN_CALLS], skipped
