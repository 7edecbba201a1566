"""Runs every test file of a standard library plain and with all comparisons reporting.

    python hook_torture_all.py INTERPRETER [NAME...]

Takes about half an hour. Prints a line for each file whose results differ, and the sums. A file
whose plain results differ between two runs says nothing, and is counted by itself.
"""

from __future__ import annotations

import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

PROGRAM = Path(__file__).with_name("hook_torture.py")
ROOT = PROGRAM.parents[2]
SECONDS = 60
WORKERS = 2
NAMES = """
import pathlib, test
folder = pathlib.Path(test.__file__).parent
print(*sorted(path.stem for path in folder.glob("test_*")))
"""


def result(python: str, name: str, *words: str) -> object:
    """The result of one file; a text where it does not end."""
    command = [python, "-W", "ignore", str(PROGRAM), *words, str(ROOT), name]
    try:
        done = subprocess.run(
            command, check=False, capture_output=True, text=True, timeout=SECONDS, errors="replace",
            stdin=subprocess.DEVNULL,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return "no end"
    for line in reversed(done.stdout.splitlines()):
        if line.startswith('{"' + name):
            answer = json.loads(line)
            return [answer[name], answer["reports"]]
    return f"status {done.returncode}: " + " ".join(done.stderr.split())[-300:]


def judged(python: str, name: str) -> tuple[str, str, int]:
    """The name, ``same`` or what is wrong with it, and the number of reports."""
    plain = result(python, name, "--plain")
    if not isinstance(plain, list):
        return name, f"left out: {plain}", 0
    changed = result(python, name)
    for _ in range(2):
        if isinstance(changed, list) and plain[0] == changed[0]:
            return name, "same", changed[1]
        again = result(python, name, "--plain")
        if not isinstance(again, list) or again[0] != plain[0]:
            return name, "left out: its results vary", 0
        changed = result(python, name)
    if isinstance(changed, list) and plain[0] == changed[0]:
        return name, "same", changed[1]
    return name, f"differs: {plain[0]} / {changed}", 0


def main(python: str, names: list[str]) -> None:
    """Judge all files."""
    if not names:
        asked = subprocess.run([python, "-c", NAMES], check=True, capture_output=True, text=True)
        names = asked.stdout.split()
    same = reports = differing = 0
    with ThreadPoolExecutor(WORKERS) as pool:
        for name, what, count in pool.map(lambda name: judged(python, name), names):
            same += what == "same"
            differing += what.startswith("differs")
            reports += count
            if what != "same":
                print(f"{name}: {what}", flush=True)
    print(f"{len(names)} files, {same} the same, {differing} differ, {reports} reports")


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
