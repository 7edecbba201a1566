"""Answers of CMake's file API for tests."""

import json
from pathlib import Path
from typing import Any

# What a cmake of version 3.25 leaves, cut down to what is read.
INDEX: dict[str, Any] = {"objects": [{"kind": "codemodel", "jsonFile": "codemodel-v2-1.json"}]}
PROJECTS = [{"name": "face"}, {"name": "inner"}]


def reply(folder: Path, targets: list[dict[str, Any]], index: dict[str, Any] = INDEX) -> None:
    """Write an answer of the file API; the last target belongs to the inner project."""
    answer = folder / ".cmake/api/v1/reply"
    answer.mkdir(parents=True, exist_ok=True)
    listed = []
    for number, target in enumerate(targets):
        name = f"target-{number}.json"
        (answer / name).write_text(json.dumps(target), encoding="utf-8")
        listed.append({"jsonFile": name, "projectIndex": int(number == len(targets) - 1)})
    model = {
        "paths": {"source": str(folder / "source"), "build": str(folder)},
        "configurations": [{"targets": listed, "projects": PROJECTS}],
    }
    (answer / "codemodel-v2-1.json").write_text(json.dumps(model), encoding="utf-8")
    (answer / "index-2026-01-02.json").write_text(json.dumps(index), encoding="utf-8")


def target(
    name: str,
    kind: str,
    language: str = "CXX",
    artifact: str = "",
    *,
    sources: tuple[str, ...] = (),
    needs: tuple[str, ...] = (),
) -> dict[str, Any]:
    return {
        "name": name,
        "type": kind,
        "compileGroups": [{"language": language}],
        "artifacts": [{"path": artifact or f"devel/{name}"}],
        "sources": [{"path": path, "compileGroupIndex": 0} for path in sources],
        "dependencies": [{"id": f"{each}::@6890427a1f51a3e7e1df"} for each in needs],
    }
