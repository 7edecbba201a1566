"""Two real builds of a program, with an edit between them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from click.testing import CliRunner
from test_wrapper import HEADER, MAKEFILE, STEP, project, run

from pytpc.cli.main import main
from pytpc.static.static_info import collect

# Two lines more above; the operator and the default are others; a second comparison, which is
# returned before; the variable has another name.
EDITED = (
    STEP.replace("if (value > limit_)", "if (value < least_)\n    return;\n  if (value >= limit)")
    .replace('nh_.param("limit", limit_, 0.5);', 'nh_.param("limit", limit, 0.75);')
    .replace("pub_ =", 'nh_.getParam("least", least_);\n  pub_ =')
    .replace("#include <std", "\n\n#include <std")
)


def built(folder: Path, step: str, header: str) -> str:
    """The static information of a program, whose sources are gone afterwards."""
    project(folder)
    (folder / "step.cpp").write_text(step)
    (folder / "step.h").write_text(header)
    (folder / "Makefile").write_text(MAKEFILE)
    run(["make", "whole"], folder)
    file = folder / "static.json"
    collect(folder).save(file)
    (folder / "step.cpp").unlink()
    return str(file)


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, str]:
    folder = tmp_path_factory.mktemp("compared")
    header = HEADER.replace("limit_;", "limit, least_;")
    return built(folder / "old", STEP, HEADER), built(folder / "new", EDITED, header)


def test_an_edit_is_found_in_real_builds(both: tuple[str, str]) -> None:
    result = CliRunner().invoke(main, ["compare", *both, "--json", "--fail-on", "undeclared"])
    found = json.loads(result.stdout)
    assert found["missing_units"] == found["notes"] == []
    told = {
        one["parameter"]: (one["status"], {e["what"]: (e["old"], e["new"]) for e in one["edits"]})
        for one in found["comparisons"]
    }
    assert told == {
        "least": ("new", {}),
        "limit": ("changed", {"operator": (">", ">="), "default": ("0.5", "0.75")}),
    }
    assert [(one["kind"], one["parameter"]) for one in found["parameters"]] == [
        ("new", "least"),
        ("default", "limit"),
    ]
    # least is fetched without a default, and no .cfg file has it.
    assert result.exit_code == 1
    assert result.stderr.startswith("pytpc: error: --fail-on undeclared: ")


def test_a_build_is_as_itself(both: tuple[str, str]) -> None:
    for file in both:
        result = CliRunner().invoke(main, ["compare", file, file])
        assert result.stdout.endswith("none changed\n")
