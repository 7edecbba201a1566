"""Programs and shared libraries: what they need, and which plugins their code asks for."""

from __future__ import annotations

import mmap
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path

from elftools.common.exceptions import ELFError
from elftools.elf.dynamic import DynamicSegment
from elftools.elf.elffile import ELFFile
from elftools.elf.sections import SymbolTableSection

from pytpc.workspace.packages import find_cycle

# `pluginlib::ClassLoader<` of the Itanium C++ ABI, as it is in names of symbols and types.
_LOADER = re.compile(rb"9pluginlib11ClassLoaderI")
_COMPONENT_MANAGER = re.compile(rb"17rclcpp_components16ComponentManager")
_PART = re.compile(rb"(\d{1,3})")
_LITERAL = re.compile(rb"(?<=\0)[!-~]{3,200}(?=\0)")
_LONGEST_NAME = 1024
COMPONENT = "rclcpp_components::NodeFactory"
"""What a container of components asks for, as if it were a base class."""


@dataclass(frozen=True, slots=True)
class Binary:
    """A program or shared library.

    ``needed`` are the names of the libraries that the dynamic linker loads with it, in its order,
    and ``searched`` the folders that it names for them. ``asks`` are the base classes of the
    plugins that its code may load: types that `pluginlib::ClassLoader` is made for.
    """

    path: Path
    soname: str
    is_program: bool
    needed: tuple[str, ...]
    searched: tuple[Path, ...] = ()
    asks: frozenset[str] = frozenset()

    def texts(self, wanted: Iterable[str]) -> frozenset[str]:
        """Those of these texts that are string literals of its code."""
        return literals(self.path).intersection(wanted)


@lru_cache(maxsize=4096)
def literals(path: Path) -> frozenset[str]:
    """The string literals of a program or library that may be names; none if it cannot be read.

    Of those that a linker has merged with the end of a longer one, the longer one counts.
    """
    try:
        with path.open("rb") as stream:
            parts = [
                section.data()
                for section in ELFFile(stream).iter_sections("SHT_PROGBITS")
                if section.name.startswith(".rodata")
            ]
    except (OSError, ValueError, ELFError):
        return frozenset()
    return frozenset(
        text.decode("ascii") for part in parts for text in _LITERAL.findall(b"\0" + part)
    )


@lru_cache(maxsize=4096)
def symbols(path: Path) -> tuple[frozenset[str], frozenset[str]]:
    """The names that a file defines for others, and those that it takes from others."""
    defined: set[str] = set()
    taken: set[str] = set()
    try:
        with path.open("rb") as stream:
            for section in ELFFile(stream).iter_sections("SHT_DYNSYM"):
                if isinstance(section, SymbolTableSection):
                    for symbol in section.iter_symbols():
                        is_taken = symbol["st_shndx"] == "SHN_UNDEF"
                        (taken if is_taken else defined).add(symbol.name)
    except (OSError, ValueError, ELFError):
        pass
    return frozenset(defined), frozenset(taken)


@lru_cache(maxsize=4096)
def may_have_class(path: Path, name: str) -> bool:
    """Whether a library may define a class; true where its name does not tell.

    Args:
        path: the library.
        name: the class with its scopes.
    """
    parts = name.removeprefix("::").split("::")
    if not all(part.isidentifier() for part in parts):
        return True
    # In names of symbols and types, each part has its length before it.
    mangled = [f"{len(part.encode())}{part}".encode() for part in parts]
    try:
        with _mapped(path) as content:
            found = [content.find(part) >= 0 for part in mangled]
            return all(found) or content.find(f"\0{name}\0".encode()) >= 0
    except (OSError, ValueError):
        return True


def read_binary(path: Path) -> Binary | None:
    """Read an ELF file; None if it is another kind of file, or broken."""
    try:
        with path.open("rb") as stream:
            elf = ELFFile(stream)
            if elf["e_type"] not in ("ET_EXEC", "ET_DYN"):
                return None
            tags: dict[str, list[str]] = {}
            for segment in elf.iter_segments("PT_DYNAMIC"):
                if isinstance(segment, DynamicSegment):
                    _read_tags(segment, tags)
            is_program = elf["e_type"] == "ET_EXEC" or any(
                one["p_type"] == "PT_INTERP" for one in elf.iter_segments()
            )
        searched = [*tags.get("runpath", ()), *tags.get("rpath", ())]
        folders = [one for text in searched for one in text.split(":")]
        with _mapped(path) as content:
            asks = frozenset(_asked(content))
    except (OSError, ValueError, ELFError):
        return None
    origin = str(path.parent)
    return Binary(
        path,
        next(iter(tags.get("soname", ())), path.name),
        is_program,
        tuple(tags.get("needed", ())),
        tuple(Path(one.replace("$ORIGIN", origin)) for one in folders if one),
        asks,
    )


def _read_tags(dynamic: DynamicSegment, tags: dict[str, list[str]]) -> None:
    for tag in dynamic.iter_tags():
        for name in ("needed", "soname", "runpath", "rpath"):
            if tag.entry.d_tag == f"DT_{name.upper()}":
                tags.setdefault(name, []).append(getattr(tag, name))


def _mapped(path: Path) -> mmap.mmap:
    with path.open("rb") as stream:
        return mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ)


def _asked(content: mmap.mmap) -> Iterator[str]:
    for found in _LOADER.finditer(content):
        name = _class_name(content[found.end() : found.end() + _LONGEST_NAME])
        if name:
            yield name
    if _COMPONENT_MANAGER.search(content):
        yield COMPONENT


def _class_name(mangled: bytes) -> str:
    """The class at the beginning of a mangled name; empty if it is none, or one of a template."""
    is_nested = mangled.startswith(b"N")
    at, parts = int(is_nested), []
    while number := _PART.match(mangled, at):
        end = number.end() + int(number[1])
        parts.append(mangled[number.end() : end].decode("utf-8", "replace"))
        at = end
        if not is_nested:
            break
    # After the class, the arguments of the loader end.
    end_of_all = b"EE" if is_nested else b"E"
    return "::".join(parts) if parts and mangled[at:].startswith(end_of_all) else ""


@dataclass(slots=True)
class Libraries:
    """Finds the libraries of programs, those of the workspace first, and reads each once.

    Args:
        ours: the libraries of the workspace, by what others may call them.
        folders: where others are looked for.
    """

    ours: Mapping[str, Path] = field(default_factory=dict)
    folders: tuple[Path, ...] = ()
    _read: dict[Path, Binary | None] = field(default_factory=dict)
    _found: dict[tuple[str, tuple[Path, ...]], Path | None] = field(default_factory=dict)

    def binary(self, path: Path) -> Binary | None:
        """The file, read; None if it is no program or library."""
        if path not in self._read:
            self._read[path] = read_binary(path)
        return self._read[path]

    def all_of(self, first: Iterable[Path]) -> list[Binary]:
        """These files and all libraries that they need, as the dynamic linker orders them."""
        wanted, found = list(first), dict[Path, Binary]()
        for path in wanted:
            binary = None if path in found else self.binary(path)
            if binary is None:
                continue
            found[path] = binary
            wanted += [one for name in binary.needed if (one := self.find(name, binary.searched))]
        return list(found.values())

    def find(self, name: str, searched: tuple[Path, ...] = ()) -> Path | None:
        """The library of that name; None if there is none."""
        if name in self.ours:
            return self.ours[name]
        key = (name, searched)
        if key not in self._found:
            places = (folder / name for folder in (*searched, *self.folders))
            # One file has many names: links to it.
            self._found[key] = next((one.resolve() for one in places if one.is_file()), None)
        return self._found[key]


def system_folders(environment: Mapping[str, str], prefixes: Iterable[Path]) -> tuple[Path, ...]:
    """Where the dynamic linker looks for libraries that are not the workspace's."""
    listed = [Path(one) for one in environment.get("LD_LIBRARY_PATH", "").split(os.pathsep) if one]
    of_machine = [Path("/usr/local/lib"), Path("/lib"), Path("/usr/lib")]
    return tuple(
        dict.fromkeys(
            folder
            for place in (*listed, *(prefix / "lib" for prefix in prefixes), *of_machine)
            for folder in (place, *place.glob("*-linux-gnu*"))
            if folder.is_dir()
        )
    )


def cyclic_needs(binaries: Iterable[Binary]) -> list[str]:
    """Names of libraries that need one another in a circle, the first one again at the end."""
    return find_cycle({binary.soname: binary.needed for binary in binaries})
