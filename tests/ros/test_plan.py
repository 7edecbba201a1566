"""A link is repeated by what the linker writes, which fits its schema."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from pytpc.base.paths import installed
from pytpc.static.static_info import load_link_unit

ROOT = Path(__file__).parents[2]
INPUTS = ROOT / "tests/lit/Inputs"
NAMES = ROOT / "tests/lit/instrument/names-at-run-time.cpp"
COPIES = ROOT / "tests/lit/instrument/copies-beside-other-files.cpp"


def check(path: Path, schema: str) -> Any:
    document = json.loads(path.read_text(encoding="utf-8"))
    rules = json.loads((ROOT / "pytpc/base/schema" / schema).read_text(encoding="utf-8"))
    Draft202012Validator.check_schema(rules)
    Draft202012Validator(rules).validate(document)
    return document


@pytest.mark.parametrize("source", [INPUTS / "node.cpp", NAMES, COPIES])
def test_a_link_is_repeated_by_its_manifest_and_plan(tmp_path: Path, source: Path) -> None:
    compiler = installed("bin/tpc-clang++")
    headers = ("-isystem", str(INPUTS / "include"), "-fPIC", "-g", "-O2")
    subprocess.run([compiler, *headers, "-c", source, "-o", "a.o"], check=True, cwd=tmp_path)
    subprocess.run([compiler, "-shared", "a.o", "-o", "libunit.so"], check=True, cwd=tmp_path)
    first = (tmp_path / "libunit.so").read_bytes()
    link = check(tmp_path / "tpc/unit.link.json", "link.schema.json")
    plan = tmp_path / "unit.plan.json"
    for option in (f"-tpc-plan-out={plan}", f"-tpc-plan={plan}"):
        (tmp_path / "libunit.so").unlink()
        subprocess.run([*link["command"], "-mllvm", option], check=True, cwd=link["folder"])
        assert (tmp_path / "libunit.so").read_bytes() == first
    check(plan, "plan.schema.json")
    unit = load_link_unit(tmp_path / "tpc/unit.json")
    assert unit.processes == ("unit",)
    assert {each.processes for each in unit.comparisons} == {("unit",)}
