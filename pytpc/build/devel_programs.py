"""The programs of a package in the devel space of a build.

roslaunch and rosrun look for a program of a package in ``lib/PACKAGE`` of the first prefix that
knows the package, and then among the executable files of its sources.

- A program that was compiled is linked; the installed one if there is one.
- A script that was installed runs as it is in the sources, so that an edited script needs no build.
  roslaunch finds it there by itself if it is executable and has its own first line. Otherwise a
  relay runs it, like those that catkin makes: a script need not be executable in the sources to be
  installed, and ``catkin_install_python`` changes the first line.
- A script of which the source is not known runs as it was installed.
"""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from pytpc.base.regular_files import has_same_content
from pytpc.workspace.packages import MANIFEST

_HEAD_BYTES = 2048
_SCRIPT = b"#!"
_RELAYED = re.compile(rb"^python_script = '([^'\n]+)'$", re.MULTILINE)
# The runtime of Python nodes knows a relay by the second line (pytpc.python_runtime.instrument).
_RELAY = """{first_line}
# generated from catkin/cmake/template/script.py.in, by pytpc build
# runs a script of the sources in its place
python_script = {script!r}
__file__ = python_script
with open(python_script, 'rb') as fh:
    exec(compile(fh.read(), python_script, 'exec'), globals())
"""


class Sources:
    """The files of a package by their names, without hidden folders and other packages."""

    def __init__(self, root: Path) -> None:
        """Read the names when they are first needed."""
        self._root = root
        self._by_name: dict[str, list[Path]] | None = None

    def named(self, name: str) -> list[Path]:
        """The files of this name, sorted."""
        if self._by_name is None:
            self._by_name = {}
            for path in self._walk():
                self._by_name.setdefault(path.name, []).append(path)
        return self._by_name.get(name, [])

    def copied(self, copy: Path) -> Path | None:
        """The file that was copied; None if there is none, or if several may have been."""
        same = [one for one in self.named(copy.name) if has_same_content(one, copy)]
        return same[0] if len(same) == 1 else None

    def _walk(self) -> Iterator[Path]:
        for folder, below, names in os.walk(self._root, followlinks=False):
            is_other = MANIFEST in names and Path(folder) != self._root
            below[:] = [] if is_other else sorted(name for name in below if name[0] != ".")
            if not is_other:
                yield from (
                    path for name in sorted(names) if (path := Path(folder, name)).is_file()
                )


@dataclass(frozen=True)
class _Program:
    """A file in ``lib/PACKAGE``: as it was built or installed, and the source that it is of."""

    rest: Path
    path: Path
    source: Path | None = None
    head: bytes = field(default=b"", repr=False)

    @property
    def is_script(self) -> bool:
        return self.head.startswith(_SCRIPT)

    @property
    def is_python(self) -> bool:
        return b"python" in self.first_line

    @property
    def first_line(self) -> bytes:
        return self.head.split(b"\n", 1)[0].rstrip()


def place_programs(made: Path, installed: Path, sources: Sources, folder: Path) -> None:
    """Put the programs of a package into a folder.

    Args:
        made: ``lib/PACKAGE`` of catkin's own devel space.
        installed: ``lib/PACKAGE`` of the install space.
        sources: those of the package.
        folder: ``lib/PACKAGE`` of our devel space; not made where it would be empty.
    """
    built = {rest for rest in _names(made) if _is_executable(made / rest)}
    names = sorted({*built, *_names(installed)})
    programs = [_program(rest, made, installed, sources) for rest in names]
    relayed = [one for one in programs if _needs_relay(one, programs)]
    for program in programs:
        place = folder / program.rest
        place.parent.mkdir(parents=True, exist_ok=True)
        if program in relayed:
            place.write_bytes(_relay(program))
            place.chmod(0o755)
        elif program.source is None:
            place.symlink_to(program.path)
        elif relayed or sources.named(program.rest.name) != [program.source]:
            # A relay imports its modules from this folder.
            place.symlink_to(program.source)
    if folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()


def _names(folder: Path) -> list[Path]:
    return [
        Path(place, name).relative_to(folder)
        for place, _, names in os.walk(folder)
        for name in names
        if not name.endswith(".pyc")
    ]


def _program(rest: Path, made: Path, installed: Path, sources: Sources) -> _Program:
    relay = _RELAYED.search(_head(made / rest))
    path = installed / rest if (installed / rest).is_file() else made / rest
    source = None
    if relay is not None:
        named = Path(os.fsdecode(relay[1]))
        source = named if named.is_file() else None
    elif path == installed / rest:
        source = sources.copied(path)
    program = _Program(rest, path, source, _head(path))
    if source is not None and program.is_script and not program.is_python:
        # No relay could run it.
        return program if _is_executable(source) else replace(program, source=None)
    return program


def _needs_relay(program: _Program, programs: Sequence[_Program]) -> bool:
    """Whether a script cannot run in the sources as it stands there."""
    source = program.source
    if source is None or not (program.is_script and program.is_python):
        return False
    first_line = _head(source).split(b"\n", 1)[0].rstrip()
    is_other = first_line != program.first_line
    return is_other or not _is_executable(source) or _has_module(source, programs)


def _has_module(source: Path, programs: Sequence[_Program]) -> bool:
    """Whether a script imports a module that is beside it only where it was installed."""
    modules = {one.rest.stem for one in programs if one.rest.suffix == ".py"}
    absent = [name for name in modules if not (source.parent / f"{name}.py").is_file()]
    if not absent:
        return False
    names = "|".join(map(re.escape, sorted(absent)))
    imported = re.compile(rf"^\s*(?:from|import)\s+(?:{names})\b".encode(), re.MULTILINE)
    return imported.search(source.read_bytes()) is not None


def _relay(program: _Program) -> bytes:
    text = _RELAY.format(first_line=os.fsdecode(program.first_line), script=str(program.source))
    return os.fsencode(text)


def _is_executable(path: Path) -> bool:
    return bool(path.stat().st_mode & stat.S_IXUSR)


def _head(path: Path) -> bytes:
    try:
        with path.open("rb") as stream:
            return stream.read(_HEAD_BYTES)
    except OSError:
        return b""
