"""Debuggers, profilers and coverage see only the program."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

from test_python_runtime_run import comparison, unit

ROOT = Path(__file__).parents[2]
SCRIPT = """\
import sys
limit = 2
def f(x):
    for i in range(limit):
        if x > limit: x -= 1
    return 1 < x < limit
{begin}
print(f(9), f("9" if len(sys.argv) > 1 else 4))
{end}
"""


def outputs(folder: Path, begin: str, end: str = "", said: str = "", python: str = "") -> list[str]:
    """The output of the script, without and with the hook."""
    script = folder / "node.py"
    script.write_text(SCRIPT.format(begin=begin, end=end))
    places = [
        {**comparison("loop", "node.py", 4, 14, "for i in range(limit):"), "relation": "<"},
        comparison("if", "node.py", 5, 12, "if x > limit: x -= 1"),
        comparison("chain", "node.py", 6, 12, "return 1 < x < limit"),
    ]
    static = folder / "static.json"
    static.write_text(json.dumps({"schema": 1, "units": [unit(folder, "node", *places)]}))
    python = python or sys.executable
    run = [python, str(ROOT / "pytpc/python_runtime/run.py"), "--static", str(static)]
    env = {**os.environ, "TPC_SINK": "off"}
    done = [
        subprocess.run(
            [*command, str(script)], input=said, capture_output=True, text=True, env=env,
            check=False, timeout=60,
        )
        for command in ([python], run)
    ]  # fmt: skip
    return [one.stdout + one.stderr for one in done]


def test_step_of_pdb(tmp_path, python):
    # It goes into f and through its loop.
    said = "step\n" * 14 + "p x\nup\ncontinue\n"
    plain, hooked = outputs(tmp_path, "breakpoint()", said=said, python=python)
    assert hooked == plain
    assert "--Call--" in plain
    assert "python_runtime" not in hooked


def test_a_debugger_that_begins_within_a_loop(tmp_path):
    begin = "for i in range(limit):\n    if i == 0: breakpoint()"
    plain, hooked = outputs(tmp_path, begin, said="step\n" * 6 + "continue\n")
    assert hooked == plain


def test_a_profiler(tmp_path):
    begin = "import cProfile, pstats\nprofile = cProfile.Profile()\nprofile.enable()"
    end = (
        "profile.disable()\n"
        "print(sorted(key[2] for key in pstats.Stats(profile).stats if '/' in key[0]))"
    )
    plain, hooked = outputs(tmp_path, begin, end)
    assert hooked == plain
    assert "'f'" in plain


def test_a_tracer_of_the_programs_own(tmp_path, python):
    begin = (
        "def trace(frame, event, _):\n"
        "    seen.append((event, frame.f_code.co_name, frame.f_lineno))\n"
        "    return trace\n"
        "seen = []\nsys.settrace(trace)"
    )
    plain, hooked = outputs(tmp_path, begin, "sys.settrace(None)\nprint(seen)", python=python)
    assert hooked == plain
    assert "'call', 'f'" in plain
