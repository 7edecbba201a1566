"""What commands print with --json fits the schema, in which one thing has one shape."""

from __future__ import annotations

import json
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from click.testing import CliRunner
from fix_samples import robot_environment
from jsonschema import Draft202012Validator, ValidationError

from pytpc.cli.main import main
from pytpc.values.origins import Origin, write_origins

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples/recorded_mission"
SCHEMA = json.loads((ROOT / "pytpc/base/schema/answers.schema.json").read_text())

# The definition in the schema, and what is typed.
ANSWERS: Sequence[tuple[str, str]] = [
    ("marks", "marks today"),
    ("ranked_marks", "rank today"),
    ("ranked_marks", "rank today --score thesis"),
    ("report", "report today -o report.html"),
    ("convert", "convert today -o out"),
    ("list", "list today/static.json"),
    ("list", "list today/static.json --constants"),
    ("show", "show today/static.json min_coverage_limit"),
    ("coverage", "coverage today/static.json"),
    ("origins", "origin today"),
    ("origins", "origin today limit"),
    ("doctor", "doctor today"),
    ("apply", "apply p.yaml limit 0.4 --dry-run"),
    ("fix", "fix today"),
    ("changes", "apply --list"),
]


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    shutil.copytree(EXAMPLE, tmp_path / "today")
    yaml = tmp_path / "p.yaml"
    yaml.write_text("limit: 0.5\n")
    set_by = Origin("/mission/limit", "yaml", 0.5, yaml, 1, "limit: 0.5", keys=("limit",))
    unset = Origin("/mission/other", "runtime", float("nan"), None, None, "")
    origins = {origin.name: origin for origin in (set_by, unset)}
    write_origins({"launch": None}, origins, tmp_path / "today/origins.json")
    return tmp_path


@pytest.fixture
def robot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    return robot_environment(tmp_path, monkeypatch)


def check(document: object, name: str) -> None:
    Draft202012Validator({**SCHEMA, "$ref": f"#/$defs/{name}"}).validate(document)


def answer(typed: str) -> Any:
    result = CliRunner().invoke(main, [*typed.split(), "--json"])
    assert result.stdout, result.stderr
    return json.loads(result.stdout)


@pytest.mark.parametrize(("name", "typed"), ANSWERS, ids=[typed for _, typed in ANSWERS])
def test_answers_fit_the_schema(name: str, typed: str, here: Path):
    assert here.is_dir()
    document = answer(typed)
    assert document or name == "changes"
    check(document, name)


def test_undo_and_the_list_of_changes(here: Path):
    check(answer("apply p.yaml limit 0.4"), "apply")
    check(answer("apply --list"), "changes")
    check(answer("apply --undo"), "undo")
    assert (here / "p.yaml").read_text() == "limit: 0.5\n"


def test_tries_of_a_fix(robot: Path):
    assert robot.is_dir()
    proposed = answer("fix today --static static.json --reference yesterday")
    assert proposed["proposal"]["file"]
    check(proposed, "fix")
    check(answer("fix --yes"), "fix")
    check(answer("fix --say same"), "fix")
    undone = answer("fix --undo")
    assert undone["tries"][0]["undone"]
    check(undone, "fix_undo")


def test_a_mark_is_the_same_object_everywhere(here: Path):
    assert here.is_dir()
    marks = answer("marks today")
    fields = SCHEMA["$defs"]["mark"]["required"]
    ranked = [{name: one[name] for name in fields} for one in answer("rank today")]
    (mission,) = answer("report today -o report.html")["missions"]
    reported = [{name: one[name] for name in fields} for one in mission["marks"]]
    assert ranked == reported == marks
    grouped = [mark for group in answer("suggest today")["groups"] for mark in group["marks"]]
    assert sorted(grouped, key=lambda mark: mark["time_ns"]) == marks


def test_the_schema_is_one_and_can_fail():
    Draft202012Validator.check_schema(SCHEMA)
    with pytest.raises(ValidationError):
        check([{"time_ns": 1}], "marks")
