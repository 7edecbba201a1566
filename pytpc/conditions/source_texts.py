"""Texts in the sources of a package that may be names of parameters."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from pytpc.base.source_bytes import source_bytes
from pytpc.conditions.parameter_calls import without_comments

_CPP = (".cpp", ".cc", ".cxx", ".c", ".h", ".hpp", ".hh", ".hxx", ".ipp", ".tpp")
_TEXT = re.compile(r"\"((?:\\.|[^\"\\\n]){1,120})\"|'((?:\\.|[^'\\\n]){1,120})'")
_NAME = re.compile(r"[~/]?[A-Za-z][\w./-]*")
# What takes the place of another text in a text.
_HOLE = re.compile(r"%(?:\(\w+\))?[-+ #0-9.]*[a-zA-Z]|\{[^{}]*\}|%\d+%")
# A text beside which another one is added, in C++ and in Python.
_ADDED = re.compile(
    r"(?:\+|<<)\s*(?:std::string\s*\(\s*)?[\"']([\w~/.-]{2,120})[\"']"
    r"|[\"']([\w~/.-]{2,120})[\"'](?:\s*\)|s)?\s*(?:\+|<<)"
)
_SHORTEST_PIECE = 2
_SETS = re.compile(r"\b(?:setParam|set_param|param::set|set_parameters?)\s*\(\s*[\"']([\w~/.]+)")
# Calls that read, or list, all parameters of a namespace.
_READS_ALL = re.compile(
    r"\b(?:getParamNames|get_param_names|list_parameters|get_parameter_overrides"
    r"|automatically_declare_parameters_from_overrides)\b"
)
_DEGREES = re.compile(
    r"from_degrees|\bradians\s*\(|deg2rad|DEG2RAD|to_?rad(?:ians)?\s*\(|deg_to_rad|degToRad"
    r"|(?:M_PI|math\.pi|\bpi|PI)\s*/\s*180|/\s*180(?:\.0*)?f?\s*\*\s*(?:M_PI|math\.pi|pi)",
    re.IGNORECASE,
)
# Functions that take an angle in radians.
_RADIANS = re.compile(
    r"\b(?:sin|cos|tan|sinf|cosf|setRPY|setEuler|setYaw|createQuaternion\w*|quaternion_from_euler"
    r"|normalize_angle\w*|shortest_angular_distance|AngleAxis\w?)\s*\("
)
# A variable or a member, with a sign.
_ALONE = re.compile(r"\s*[-+]?\s*(?:\w+(?:\.|->|::))*([A-Za-z]\w*)\s*")
_RENAMER = re.compile(
    r"\b(\w*(?:eprecat|enamed|bsolete)\w*)\s*(?:<[^<>()]*>\s*)?\(([^;{}()]{1,400})"
)
_OLD = re.compile(r"\b(?:old|deprecated|obsolete)_?\w*\s*$", re.IGNORECASE)
_NOT_SOURCES = frozenset({"build", "devel", "install", "log", "test", "tests", "__pycache__"})
_LARGEST = 4 << 20
_BESIDE = 2
_FIRST_LINE = 200


class Renaming(NamedTuple):
    """A call of a function of old names: the texts that it is given, and its place.

    ``namespace`` is the last part of that of the handle that it is given, as
    ``NodeHandle nh("~/planner")`` before it says; empty where it is not known.
    """

    function: str
    texts: tuple[str, ...]
    path: str
    lineno: int
    namespace: str = ""


@dataclass(frozen=True, slots=True)
class SourceTexts:
    """The texts of a package.

    ``texts`` has for each text, without its namespace, its places: file and line. ``sets`` are the
    names, without namespaces, of parameters that code sets. ``reads_all`` says that code reads all
    parameters of a namespace. ``converted`` are lines in which an angle in degrees is converted,
    ``turned`` what is handed, as it is, to a function that takes one in radians.
    ``renamings`` are calls of functions that deal with old names, ``renamers`` the functions of
    this kind that are defined here: which of their texts, from 0, is the old name.
    ``files`` are all of its files.
    """

    texts: dict[str, list[tuple[str, int]]]
    sets: frozenset[str]
    reads_all: bool
    converted: tuple[str, ...]
    turned: frozenset[str] = frozenset()
    renamings: tuple[Renaming, ...] = ()
    renamers: Mapping[str, tuple[int, str]] = field(default_factory=dict)
    files: frozenset[str] = frozenset()

    def unread(self, reads: Collection[tuple[str, int]], *, python: bool) -> frozenset[str]:
        """The texts in the files of a language at other places than beside one of these reads."""
        beside = {(file, line + step) for file, line in reads for step in range(-1, _BESIDE + 1)}
        return frozenset(
            text
            for text, places in self.texts.items()
            if any(place not in beside for place in places if place[0].endswith(_CPP) is not python)
        )

    def pieces(self, file: str) -> frozenset[str]:
        """The texts in a file that others are added to, or that have places for others."""
        return _pieces_in(file) if file in self.files else frozenset()

    def converts(self, name: str) -> bool:
        """Whether what has the name of a parameter is converted from degrees somewhere."""
        word = re.compile(rf"(?<![A-Za-z0-9_]){re.escape(name.rstrip('_'))}(?![A-Za-z0-9])")
        return any(word.search(line) for line in self.converted)

    def turns(self, name: str) -> bool:
        """Whether what has the name of a parameter goes to a function that takes radians.

        A name of one word may be that of something else.
        """
        return "_" in name and name.rstrip("_") in self.turned


@lru_cache(maxsize=256)
def source_texts(package: str) -> SourceTexts:
    """Read the sources in the folder of a package; those of its tests are left out."""
    texts: dict[str, list[tuple[str, int]]] = {}
    sets: set[str] = set()
    converted: list[str] = []
    turned: set[str] = set()
    reads_all = False
    renamings: list[Renaming] = []
    renamers: dict[str, tuple[int, str]] = {}
    paths = list(_sources(package))
    for path in paths:
        lines = _read(path)
        for lineno, line in enumerate(lines, start=1):
            for one, other in _TEXT.findall(line):
                text = one or other
                if _NAME.fullmatch(text):
                    texts.setdefault(_last(text), []).append((str(path), lineno))
            sets.update(_last(name) for name in _SETS.findall(line))
            reads_all = reads_all or _READS_ALL.search(line) is not None
            if _DEGREES.search(line):
                converted.append(line)
            else:
                turned.update(_handed(line))
        if path.name.endswith(_CPP):
            _add_renamings("\n".join(lines), str(path), renamings, renamers)
    return SourceTexts(
        texts,
        frozenset(sets),
        reads_all,
        tuple(converted),
        frozenset(turned),
        tuple(renamings),
        renamers,
        frozenset(map(str, paths)),
    )


@lru_cache(maxsize=256)
def _pieces_in(file: str) -> frozenset[str]:
    return frozenset(piece for line in _read(Path(file)) for piece in _pieces(line))


def _pieces(line: str) -> Iterator[str]:
    """The texts in a line that names may be put together of.

    >>> sorted(_pieces('std::string("gain_") + axis; sprintf(a, "wheel%d_limit", n); f("rate");'))
    ['_limit', 'gain_', 'wheel']
    """
    found = [_last(one or other) for one, other in _ADDED.findall(line)]
    for one, other in _TEXT.findall(line):
        parts = _HOLE.split(one or other)
        if len(parts) > 1 and not any(character.isspace() for character in one or other):
            found += [_last(parts[0]), *parts[1:]]
    yield from (piece for piece in found if len(piece) >= _SHORTEST_PIECE)


def _add_renamings(
    text: str, path: str, renamings: list[Renaming], renamers: dict[str, tuple[int, str]]
) -> None:
    """Add calls and definitions of functions whose names say that they deal with old names."""
    for found in _RENAMER.finditer(text):
        name, given = found[1], found[2]
        texts = tuple(re.findall(r'"([\w~/.]+)"', given))
        if len(texts) > 1:
            lineno = text.count("\n", 0, found.start()) + 1
            handle = given.partition(",")[0].strip()
            namespace = _namespace_of(handle, text[: found.start()])
            renamings.append(Renaming(name, texts, path, lineno, namespace))
            continue
        strings = [one for one in given.split(",") if re.search(r"\bstring\b|\bchar\b", one)]
        old = [number for number, one in enumerate(strings) if _OLD.search(one)]
        if len(strings) > 1 and len(old) == 1:
            renamers[name] = old[0], path


def _namespace_of(handle: str, before: str) -> str:
    """The last part of the namespace with which a handle was made last; empty if not known."""
    if not re.fullmatch(r"\w+", handle):
        return ""
    made = re.findall(rf'\bNodeHandle\s+{handle}\s*[({{]\s*(?:"([\w~/]*)"\s*[)}}])?', before)
    return _last(made[-1]) if made else ""


def _handed(line: str) -> Iterator[str]:
    """The names of what a line hands, as it is, to functions that take an angle in radians.

    >>> list(_handed("q.setRPY(0, 0, -cfg.delta_yaw_); y = sim_time * cos(th + sim_step * 2);"))
    ['delta_yaw']
    """
    for call in _RADIANS.finditer(line):
        for argument in re.split(r"[,)]", line[call.end() :].partition(";")[0]):
            if named := _ALONE.fullmatch(argument):
                yield named[1].rstrip("_")


def _last(name: str) -> str:
    return name.rstrip("/").rpartition("/")[2].lstrip("~")


def _sources(package: str) -> Iterator[Path]:
    for folder, below, files in os.walk(package):
        below[:] = sorted(b for b in below if not b.startswith(".") and b not in _NOT_SOURCES)
        for name in sorted(files):
            path = Path(folder, name)
            if name.endswith((*_CPP, ".py")) or ("." not in name and _is_python(path)):
                yield path


def _is_python(path: Path) -> bool:
    try:
        return path.is_file() and b"python" in path.open("rb").readline(_FIRST_LINE)
    except OSError:
        return False


def _read(path: Path) -> Sequence[str]:
    try:
        if not path.is_file() or path.stat().st_size > _LARGEST:
            return ()
        text = source_bytes(path).decode("utf-8", "replace")
    except OSError:
        return ()
    return (without_comments(text) if path.name.endswith(_CPP) else text).splitlines()
