"""The Python programs and packages that a CMakeLists.txt installs.

It reads ``catkin_install_python(PROGRAMS ...)``, ``install(PROGRAMS ...)`` and
``ament_python_install_package``, also in the folders of ``add_subdirectory``
(``catkin_python_setup`` is for setup.py). It knows variables that ``set``, ``list(APPEND)``,
``file(GLOB)`` or ``foreach`` set to constants. Both branches of an ``if`` count; but an ``install``
in a branch within a loop is ignored, because it chooses among the loop's files.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path

from pytpc.base.errors import InputError
from pytpc.workspace.cmake_syntax import CmakeArgument, Command, commands, find_fault

_VARIABLE = re.compile(r"\$\{([^${}]*)\}")
_ENDING = frozenset(
    {"DESTINATION", "PERMISSIONS", "CONFIGURATIONS", "COMPONENT", "OPTIONAL", "RENAME", "TYPE"}
)
_DEEPEST = 8
# Both branches and all former values of a variable count, so that appending would double it.
_MOST_VALUES = 2000


@dataclass
class Programs:
    """``python``: files that are declared as Python; ``others``: programs of any kind.

    ``packages``: name of a Python package -> its folder.
    """

    python: list[Path] = field(default_factory=list)
    others: list[Path] = field(default_factory=list)
    packages: dict[str, Path] = field(default_factory=dict)


def read_programs(root: Path, on_fault: Callable[[InputError], None]) -> Programs:
    """What the CMakeLists.txt of the package in ``root`` installs; nothing if it has none.

    Args:
        root: the package's folder.
        on_fault: called with a file that CMake cannot parse, which is then ignored.
    """
    found = Programs()
    known = {"PROJECT_SOURCE_DIR": [str(root)], "CMAKE_SOURCE_DIR": [str(root)]}
    _Reader(root, known, found, on_fault).run(0)
    return found


class _Reader:
    """Reads the list file of one folder."""

    def __init__(
        self,
        folder: Path,
        variables: dict[str, list[str]],
        found: Programs,
        on_fault: Callable[[InputError], None],
    ) -> None:
        self._folder = folder
        self._variables = {**variables, "CMAKE_CURRENT_SOURCE_DIR": [str(folder)]}
        self._variables["CMAKE_CURRENT_LIST_DIR"] = [str(folder)]
        self._found = found
        self._on_fault = on_fault
        self._blocks: list[str] = []

    def run(self, depth: int) -> None:
        path = self._folder / "CMakeLists.txt"
        try:
            data = path.read_bytes()
        except OSError:
            return
        fault = find_fault(data)
        if fault is not None:
            text = f"CMake cannot parse this file: {fault.message}"
            self._on_fault(InputError(text, path, fault.line))
            return
        for command in commands(data):
            words = self._words(command)
            self._enter(command.name)
            if command.name == "add_subdirectory" and words and depth < _DEEPEST:
                below = self._folder / words[0]
                _Reader(below, self._variables, self._found, self._on_fault).run(depth + 1)
            else:
                self._command(command.name, words)

    def _enter(self, name: str) -> None:
        if name in ("foreach", "while", "if"):
            self._blocks.append(name)
        elif name in ("endforeach", "endwhile", "endif"):
            self._blocks.pop()

    def _chooses(self) -> bool:
        """True in a branch within a loop."""
        loops = [place for place, name in enumerate(self._blocks) if name != "if"]
        return bool(loops) and "if" in self._blocks[loops[0] :]

    def _command(self, name: str, words: list[str]) -> None:
        match name, words:
            case "project", [project, *_]:
                self._variables["PROJECT_NAME"] = [project]
            case "set", [variable, *values]:
                # Both branches of an `if` may set it.
                self._add(variable, [] if variable in values else values)
            case "list", ["APPEND" | "PREPEND", variable, *values]:
                self._add(variable, values)
            case "foreach", [variable, "IN", *rest]:
                self._variables[variable] = list(self._listed(rest))
            case "foreach", [variable, *values]:
                self._variables[variable] = values
            case "file", ["GLOB" | "GLOB_RECURSE" as how, variable, *patterns]:
                self._add(variable, list(self._matching(how, patterns)))
            case (("catkin_install_python" | "install"), _) if self._chooses():
                pass
            case "catkin_install_python", _:
                self._found.python.extend(self._programs(words))
            case "install", ["PROGRAMS", *_]:
                self._found.others.extend(self._programs(words))
            case "ament_python_install_package", [package, *rest]:
                where = rest[1] if rest[:1] == ["PACKAGE_DIR"] and len(rest) > 1 else package
                self._found.packages[package] = self._folder / where
            case _:
                pass

    def _add(self, variable: str, values: list[str]) -> None:
        known = self._variables.get(variable, [])
        self._variables[variable] = list(dict.fromkeys([*known, *values]))[:_MOST_VALUES]

    def _words(self, command: Command) -> list[str]:
        return [word for argument in command.arguments for word in self._expanded(argument)]

    def _expanded(self, argument: CmakeArgument) -> list[str]:
        """The values of an argument: several where a variable is a list."""
        texts = [argument.text]
        for _ in range(_DEEPEST):
            if not any(_VARIABLE.search(text) for text in texts):
                break
            found = (further for text in texts for further in self._looked_up(text))
            texts = list(islice(found, _MOST_VALUES))
        if argument.is_quoted:
            return texts
        return [part for text in texts for part in text.split(";") if part]

    def _looked_up(self, text: str) -> Iterator[str]:
        match = _VARIABLE.search(text)
        if match is None:
            yield text
            return
        for value in self._variables.get(match[1], []):
            yield text[: match.start()] + value + text[match.end() :]

    def _listed(self, words: list[str]) -> Iterator[str]:
        is_list = False
        for word in words:
            if word in ("LISTS", "ITEMS"):
                is_list = word == "LISTS"
            elif is_list:
                yield from self._variables.get(word, [])
            else:
                yield word

    def _matching(self, how: str, patterns: list[str]) -> Iterator[str]:
        base = self._folder
        relative = Path("/")
        if patterns[:1] == ["RELATIVE"] and len(patterns) > 1:
            relative, patterns = Path(patterns[1]), patterns[2:]
        for pattern in patterns:
            if pattern == "CONFIGURE_DEPENDS":
                continue
            text = pattern.removeprefix(f"{base}/")
            if text.startswith("/") or ".." in text.split("/"):
                continue
            within = f"{text.rpartition('/')[0]}/**/{text.rpartition('/')[2]}".lstrip("/")
            try:
                paths = sorted(base.glob(within if how == "GLOB_RECURSE" else text))
            except (ValueError, NotImplementedError):
                # Python does not have all forms of CMake's patterns.
                continue
            for path in paths:
                is_below = path.is_relative_to(relative) and relative != Path("/")
                yield str(path.relative_to(relative) if is_below else path)

    def _programs(self, words: list[str]) -> Iterator[Path]:
        start = words.index("PROGRAMS") + 1 if "PROGRAMS" in words else len(words)
        for word in words[start:]:
            if word in _ENDING:
                return
            yield self._folder / word
