"""What is read off an example robot's sources, to hold beside what stands about them by hand."""

from __future__ import annotations

import ast
import json
import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

CPP = (".cpp", ".h")
PYTHON = (".py",)
CPP_READ = re.compile(r'\b(?:param(?:<[\w:]+>)?|getParam)\(\s*"(\w+)"')
PYTHON_READ = re.compile(r'rospy\.get_param\("~(\w+)"')
_CPP_DEFAULT = re.compile(r'\.param(?:<[\w:]+>)?\(\s*"(\w+)",\s*\w+,\s*([^)]+)\)')
_PYTHON_DEFAULT = re.compile(r'get_param\("~(\w+)", ([^)]+)\)')


def ident(entry: Mapping[str, Any]) -> str:
    """A name for a test of one entry."""
    return f"{entry['unit']}-{Path(entry['file']).name}:{entry['line']}-{entry['parameter']}"


@dataclass(frozen=True)
class RobotSources:
    """An example's catkin package, whose mission is in Python.

    ``cpp`` and ``python`` are its lists of what has to be found. ``other_names`` are the words by
    which the sources compare a parameter, where these are not its own name.
    """

    package: Path
    other_names: Mapping[str, str] = field(default_factory=dict)

    @property
    def cpp(self) -> dict[str, Any]:
        return json.loads((self.package / "expected_tpcs.json").read_text())

    @property
    def python(self) -> dict[str, Any]:
        return json.loads((self.package / "expected_python_tpcs.json").read_text())

    @property
    def configured(self) -> dict[str, dict[str, Any]]:
        """The parameters of each node with which the mission goes right."""
        return yaml.safe_load((self.package / "config/params.yaml").read_text())

    def files(self, endings: tuple[str, ...]) -> list[Path]:
        folders = ("include", "src", "nodes")
        found = (path for folder in folders for path in sorted((self.package / folder).rglob("*")))
        return [path for path in found if path.suffix in endings]

    def reads(self, pattern: re.Pattern[str], endings: tuple[str, ...]) -> set[str]:
        return {name for path in self.files(endings) for name in pattern.findall(path.read_text())}

    def line(self, entry: Mapping[str, Any]) -> str:
        return (self.package / entry["file"]).read_text().splitlines()[entry["line"] - 1]

    def assert_compares(self, entry: Mapping[str, Any]) -> None:
        """The entry's line names the parameter, and the relation unless a library has it."""
        line = self.line(entry)
        parameter = entry["parameter"].removeprefix("~")
        assert re.search(rf"(\b|_){self.other_names.get(parameter, parameter)}(\b|_)", line), line
        if entry["relation"] != "flag" and "std::min(" not in line:
            assert f" {entry['relation']} " in line, line

    def listed(self, document: Mapping[str, Any]) -> set[str]:
        """All parameters that a list names, those in its reasons, too."""
        entries = [*document["tpcs"], *document["not_tpcs"]]
        names = {entry["parameter"].removeprefix("~") for entry in entries}
        reasons = " ".join(entry["reason"] for entry in document["not_tpcs"])
        for together in re.findall(r"\(so (?:is|are) ([^)]*)\)", reasons):
            names |= set(together.split(", "))
        return names

    def cpp_defaults(self) -> dict[str, Any]:
        return {
            name: yaml.safe_load(text)
            for path in self.files((".cpp",))
            for name, text in _CPP_DEFAULT.findall(path.read_text())
        }

    def python_defaults(self) -> dict[str, Any]:
        return {
            name: ast.literal_eval(text)
            for path in self.files(PYTHON)
            for name, text in _PYTHON_DEFAULT.findall(path.read_text())
        }


def relations(document: Mapping[str, Any], unit: str) -> Counter[tuple[str, str]]:
    """How often a link unit compares each parameter by each relation."""
    entries = [entry for entry in document["tpcs"] if entry["unit"] == unit]
    return Counter((entry["parameter"], entry["relation"]) for entry in entries)
