"""Those who look on: a robot's observer is run on what was recorded, as a program of its own.

It knows nothing of the treatment and imports nothing of TPC. What it is given is a bag with what a
person sees; what it gives are files: sights, causes, marks.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import pyarrow as pa
import pyarrow.compute as pc

from pytpc.base.columns import check_schema, read_table, write_table
from pytpc.base.errors import RunError
from pytpc.recording.marks import Mark
from pytpc_evaluation.demo.demo_examples import SHARED_PACKAGE, Example
from pytpc_evaluation.study.data import user_marks
from pytpc_evaluation.study.dataset import CAUSES_FILE, MARKED_FILE, SIGHTS_FILE

USERS = 4
_PATIENCE_S = 120.0
_MODULES = "PYTHONPATH"


def see(example: Example, env: Mapping[str, str], bag: Path, folder: Path) -> None:
    """Write what a person sees of a mission, ``sights.parquet``, into its folder.

    Args:
        example: the robot.
        env: an environment that knows the robot's messages.
        bag: with the topics of what can be seen and heard.
        folder: the mission's.

    Raises:
        RunError: the observer fails; one line, what it said last.
    """
    look_on(example.observer, env, ["--bag", str(bag), "--sights", str(folder / SIGHTS_FILE)])


def cut_sights(path: Path, end_s: float) -> None:
    """Leave what was seen until ``end_s`` (simulated s): the column ``time`` of any robot's sights.

    Raises:
        InputError: the file cannot be read, or has no such column.
        TpcError: it cannot be written.
    """

    def until_end(table: pa.Table) -> pa.Table:
        check_schema(table.schema, pa.schema([("time", pa.float64())]))
        return table.filter(pc.less_equal(table["time"], end_s))

    write_table(read_table(path, "sights", until_end), path)


def mark(example: Example, env: Mapping[str, str], folder: Path, seed: int) -> None:
    """Write what was wrong in a mission by its sights, and the marks that people set.

    Raises:
        RunError: see ``see``.
    """
    words = ["--sights", str(folder / SIGHTS_FILE), "--seed", str(seed), "--users", str(USERS)]
    words += ["--causes", str(folder / CAUSES_FILE), "--marks", str(folder / MARKED_FILE)]
    look_on(example.observer, env, words)


def look_on(program: Path, env: Mapping[str, str], words: Sequence[str]) -> None:
    """Run a program of those who look on, with what all of them share.

    Args:
        program: in Python.
        env: its environment.
        words: its command line.

    Raises:
        RunError: it fails; one line, what it said last.
    """
    command = [sys.executable, str(program), *words]
    modules = [str(SHARED_PACKAGE / "src"), *env.get(_MODULES, "").split(os.pathsep)]
    environment = {**env, _MODULES: os.pathsep.join(one for one in modules if one)}
    try:
        ended = subprocess.run(
            command,
            env=environment,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            check=False,
            timeout=_PATIENCE_S,
        )
    except subprocess.TimeoutExpired as error:
        raise RunError(f"does not end in {_PATIENCE_S:.0f} s", program) from error
    if ended.returncode:
        said = ended.stderr.decode("utf-8", "replace").strip().splitlines()[-1:]
        what = f"ended with status {ended.returncode}: {' '.join(said) or 'it says nothing'}"
        raise RunError(what, program)


def read_marked(path: Path) -> tuple[Mark, ...]:
    """The marks of all people, with the type that they would have if nobody confused any.

    Raises:
        InputError: the file cannot be read, or is not of marks.
    """
    return tuple(sorted((one.mark("typed") for one in user_marks(path)), key=Mark.order))
