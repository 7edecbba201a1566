"""Packages that build with the user's compiler but not with TPC.

clang rejects some code that gcc accepts. Instead of failing the build, such a package is configured
again without TPC and with the user's compiler. ``left-alone.json`` remembers it until the user asks
for another try.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterable, Sequence
from pathlib import Path

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import dump_json, parse_json
from pytpc.base.errors import InputError
from pytpc.base.paths import clang_release
from pytpc.workspace.colcon import Bases, BuildError
from pytpc.workspace.packages import Package

# gcc comes with OpenMP; for clang it is a separate package.
OPENMP_MEND = "clang's OpenMP may be missing: apt-get install libomp-{}-dev"
_OPENMP = re.compile(r"Could NOT find OpenMP|'omp\.h' file not found|unable to find library -lomp")
_CMAKE_ERROR = re.compile(r"^CMake Error(?: at (?P<place>[^\s:]+:\d+))?")
_ERRORS = tuple(
    re.compile(pattern)
    for pattern in (
        r"^\S.*:\d+(?::\d+)?: (?:fatal )?error: .*",
        r"^(?:\S*ld\.lld\S*|ld): error: .*",
        r"^(?:\S*/)?ld(?:\.\S+)?: .*(?:undefined|cannot|multiple).*",
        r"^clang\S*: error: .*",
        r"^\w*(?:Error|Exception)\b: .*",
        r"^.*\berror: .*",
        r"^g?make(?:\[\d+\])?: \*\*\* .*",
    )
)
_WARNING = ": warning: "
_LONGEST = 300
_FILE = "left-alone.json"
_ASIDE = "set-aside"


class LeftAlone:
    """The packages of one build that are built without TPC, each with the reason.

    A package is first tried: its build folder is set aside. The try ends with ``keep`` or
    ``give_up``; one that was interrupted is undone when the next build begins.
    """

    def __init__(self, bases: Bases, packages: Sequence[Package], *, retry: bool = False) -> None:
        """Read which of ``packages`` earlier builds built without TPC.

        Args:
            bases: of the build.
            packages: all of the workspace.
            retry: forget it, and the build folders with the other compiler.

        Raises:
            InputError: the file is broken.
            OSError: a folder cannot be written.
        """
        self._bases = bases
        self._folders = {package.name: package.path.absolute() for package in packages}
        self._tried: set[str] = set()
        self.reasons = self._read()
        for folder in sorted((bases.root / _ASIDE).glob("*")):
            self._put_back(folder.name)
        if retry:
            for name in self.reasons:
                shutil.rmtree(bases.build / name, ignore_errors=True)
            self.reasons = {}
            self._save()

    @property
    def folders(self) -> list[Path]:
        """The folders of the packages, including those that are being tried."""
        return [folder for name, folder in self._folders.items() if name in self.reasons]

    def can_try(self, error: BuildError) -> bool:
        """Whether the failed package was built with TPC."""
        return error.package in self._folders and error.package not in self.reasons

    def begin(self, error: BuildError) -> None:
        """Set the build folder of the package aside, so that the next build is without TPC."""
        self._keep(self._tried & error.finished)
        self._tried.add(error.package)
        self.reasons[error.package] = _reason(error)
        aside = self._bases.root / _ASIDE / error.package
        aside.parent.mkdir(parents=True, exist_ok=True)
        (self._bases.build / error.package).replace(aside)

    def keep(self) -> None:
        """Every package that was tried builds without TPC: remember that."""
        self._keep(set(self._tried))

    def give_up(self, error: BuildError) -> None:
        """A package fails without TPC, too: restore its build folder."""
        self._keep(self._tried & error.finished)
        for name in sorted(self._tried):
            del self.reasons[name]
            self._put_back(name)
        self._tried.clear()

    def _keep(self, names: set[str]) -> None:
        for name in names:
            shutil.rmtree(self._bases.root / _ASIDE / name)
        self._tried -= names
        self._save()

    def _put_back(self, name: str) -> None:
        folder = self._bases.build / name
        shutil.rmtree(folder, ignore_errors=True)
        (self._bases.root / _ASIDE / name).replace(folder)

    def _read(self) -> dict[str, str]:
        path = self._bases.root / _FILE
        if not path.is_file():
            return {}
        data = parse_json(path)
        if not isinstance(data, dict) or not all(isinstance(why, str) for why in data.values()):
            what = "not a list of packages with reasons; delete this file and build again"
            raise InputError(what, path)
        return {name: why for name, why in data.items() if name in self._folders}

    def _save(self) -> None:
        path = self._bases.root / _FILE
        known = {name: why for name, why in self.reasons.items() if name not in self._tried}
        if known:
            write_atomic(path, dump_json(known))
        else:
            path.unlink(missing_ok=True)


def _reason(error: BuildError) -> str:
    """The first error in the output, with a hint where clang lacks what gcc has."""
    text = "\n".join(error.tail)
    why = first_error(text) if text else error.message
    if _OPENMP.search(text):
        why += f"; {OPENMP_MEND.format(clang_release())}"
    return why


def first_error(output: str) -> str:
    """The first error in the output as one line; without one, the last line."""
    lines = [line.rstrip() for line in output.splitlines()]
    for at, line in enumerate(lines):
        cmake = _CMAKE_ERROR.match(line)
        if cmake is not None:
            said = _indented(lines[at + 1 :])
            where = f"{cmake['place']}: " if cmake["place"] else ""
            return _shortened(f"CMake: {where}{said or line}")
        if _WARNING not in line and any(pattern.match(line) for pattern in _ERRORS[:-1]):
            return _shortened(line)
    for line in lines:
        if _ERRORS[-1].match(line):
            return _shortened(line)
    return _shortened(next((line for line in reversed(lines) if line), "it says nothing"))


def _indented(lines: Iterable[str]) -> str:
    """The first paragraph of a message of CMake's, which is indented by two."""
    said: list[str] = []
    for line in lines:
        if line.startswith("  "):
            said.append(line.strip())
        elif line or said:
            break
    return " ".join(said)


def _shortened(text: str) -> str:
    one = " ".join(text.split())
    return one if len(one) <= _LONGEST else f"{one[: _LONGEST - 4]} ..."
