"""The rooms of the source tree: an import that breaks a contract fails `make lint`."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import tomllib

ROOT = Path(__file__).parents[2]
LINT_IMPORTS = Path(sys.executable).with_name("lint-imports")
# For each contract a line, and the file that may not have it.
BREAKS = {
    "rooms": ("pytpc/base/errors.py", "import pytpc.workspace.colcon"),
    "python-analysis": (
        "pytpc/python_analysis/sources/scripts.py",
        "from pytpc.python_analysis.flow import reaching",
    ),
    "product": ("pytpc/values/scalars.py", "import pytpc_evaluation.study.plan"),
    "inside-a-node": ("pytpc/python_runtime/errors.py", "from pytpc.base import errors"),
    "pure-diagnosis": (
        "pytpc/diagnosis/ranking/mark_ranking.py",
        "from pytpc.ingest import reading",
    ),
    "no-files-in-diagnosis": ("pytpc/diagnosis/scores/scores.py", "import pathlib"),
    "no-diagnosis-in-present": (
        "pytpc/present/ranking_tables.py",
        "from pytpc.diagnosis.ranking import blame",
    ),
    "one-door": ("pytpc/cli/options.py", "from pytpc.ingest import reading"),
}


def contracts() -> dict[str, str]:
    """The name of each contract by its id."""
    linter = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]
    return {contract["id"]: contract["name"] for contract in linter["contracts"]}


def lint(folder: Path) -> tuple[int, dict[str, str]]:
    """The exit status, and KEPT or BROKEN for each contract's name."""
    paths = os.pathsep.join([str(folder), str(folder / "evaluation")])
    done = subprocess.run(
        [LINT_IMPORTS, "--no-cache"],
        cwd=folder,
        env={"PATH": os.environ["PATH"], "PYTHONPATH": paths, "COLUMNS": "200"},
        capture_output=True,
        text=True,
        check=False,
    )
    lines = [line.rsplit(" ", 1) for line in done.stdout.splitlines() if " " in line]
    return done.returncode, {name: word for name, word in lines if word in ("KEPT", "BROKEN")}


def test_each_contract_is_broken_by_an_import(tmp_path: Path) -> None:
    ignored = shutil.ignore_patterns("__pycache__", "*.egg-info")
    for name in ("pytpc", "evaluation"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=ignored)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    for path, line in BREAKS.values():
        with (tmp_path / path).open("a") as stream:
            stream.write(f"\n{line}\n")

    status, verdicts = lint(tmp_path)

    assert status == 1
    assert verdicts == dict.fromkeys(contracts().values(), "BROKEN")
    assert set(BREAKS) == set(contracts())


def test_lint_asks_for_the_contracts() -> None:
    assert "lint-imports" in (ROOT / "tools" / "lint").read_text()
