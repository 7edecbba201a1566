"""The plugins that the packages of a workspace declare, and the library of each.

pluginlib and nodelet: an XML file that the package.xml of ROS 1 exports, or that is registered in
the index of resources of ROS 2. Components of rclcpp: the same index.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

from pytpc.base.errors import InputError
from pytpc.base.source_bytes import read_bytes
from pytpc.processes.binaries import COMPONENT, may_have_class
from pytpc.workspace.packages import MANIFEST, Package, exported_plugins

_INDEX = Path("share/ament_index/resource_index")
_PLUGIN_ENDING = "__pluginlib__plugin"
_COMPONENTS = "rclcpp_components"
_IN_PYTHON = "_py::"


@dataclass(frozen=True, slots=True)
class Plugin:
    """A class that a process can load by name.

    ``name`` is what pluginlib looks it up by, ``kind`` its C++ class, ``base`` the class that it is
    loaded as. ``library`` is the file of the workspace that has it. It is declared at ``path`` and
    ``line``.
    """

    name: str
    kind: str
    base: str
    package: str
    library: Path
    path: Path
    line: int

    @property
    def names(self) -> frozenset[str]:
        """What parameters and launch files may call it."""
        return frozenset((self.name, self.kind))


@dataclass(frozen=True, slots=True)
class Declared:
    """The plugins, and what is wrong with declarations: a line for each fault."""

    plugins: tuple[Plugin, ...]
    faults: tuple[str, ...]


@dataclass(slots=True)
class _Reader:
    """Gathers the plugins of all packages; the first of a name and base class counts."""

    libraries: Mapping[str, Path]
    found: dict[tuple[str, str], Plugin] = field(default_factory=dict)
    faults: dict[str, None] = field(default_factory=dict)

    def fault(self, text: str, path: Path, line: int | None = None) -> None:
        self.faults[str(InputError(text, path, line))] = None

    def add(self, plugin: Plugin) -> None:
        # It counts all the same: only the names in the library say so.
        if not may_have_class(plugin.library, plugin.kind):
            self.fault(
                f"{plugin.library.name} has no class {plugin.kind}; correct its name, or build the"
                " library again",
                plugin.path,
                plugin.line,
            )
        key = plugin.name, plugin.base
        first = self.found.setdefault(key, plugin)
        is_same = (first.library, first.kind) == (plugin.library, plugin.kind)
        if first is not plugin and not is_same:
            self.fault(
                f"there is another plugin {plugin.name} for {plugin.base}, in"
                f" {first.path}:{first.line}; that one counts",
                plugin.path,
                plugin.line,
            )

    def library_at(self, written: str, path: Path, line: int) -> Path | None:
        """The library that a declaration names: with or without folder, ``lib`` and ``.so``."""
        name = written.rpartition("/")[2].removesuffix(".so")
        for file in (f"{name}.so", f"lib{name}.so"):
            if file in self.libraries:
                return self.libraries[file]
        self.fault(
            f"no library {written} was built; build its package, or correct the path", path, line
        )
        return None


def declared_plugins(
    packages: Sequence[Package],
    prefixes: Iterable[Path],
    libraries: Mapping[str, Path],
) -> Declared:
    """The plugins of the packages of a built workspace.

    Args:
        packages: those of the workspace.
        prefixes: where it is installed; ROS 2 keeps its index of resources there.
        libraries: the built libraries of the workspace, by the names of their files.

    Raises:
        InputError: a package.xml cannot be read.
    """
    reader = _Reader(libraries)
    for package in packages:
        if package.ros == "1":
            for base_package, written in exported_plugins(package.path):
                _read_export(reader, package, base_package, written)
    names = {package.name for package in packages}
    seen: set[tuple[str, str]] = set()
    for prefix in dict.fromkeys(prefixes):
        _read_index(reader, prefix, names, seen)
    return Declared(tuple(reader.found.values()), tuple(reader.faults))


def _read_export(reader: _Reader, package: Package, base_package: str, written: str) -> None:
    """An export such as ``<nav_core plugin="${prefix}/plugins.xml"/>``."""
    path = package.path / written.removeprefix("${prefix}").lstrip("/")
    if not path.is_file() and written.startswith("/"):
        path = Path(written)
    if not path.is_file():
        manifest = package.path / MANIFEST
        reader.fault(f"<{base_package} plugin=...> names {written}, which is not there", manifest)
        return
    _read_xml(reader, path, package.name)


def _read_index(
    reader: _Reader, prefix: Path, packages: set[str], seen: set[tuple[str, str]]
) -> None:
    """The resources of a prefix; those of a package count where they are found first."""
    index = prefix / _INDEX
    for kind in sorted(index.glob(f"*{_PLUGIN_ENDING}")):
        for package, lines in _resources(reader, kind, packages, seen):
            for written in lines:
                path = prefix / written
                if path.is_file():
                    _read_xml(reader, path, package)
                else:
                    reader.fault(f"names {written}, which is not there", kind / package)
    for package, lines in _resources(reader, index / _COMPONENTS, packages, seen):
        for number, line in enumerate(lines, start=1):
            kind_of, _, written = line.partition(";")
            path = index / _COMPONENTS / package
            library = reader.library_at(written, path, number)
            if library is not None:
                reader.add(Plugin(kind_of, kind_of, COMPONENT, package, library, path, number))


def _resources(
    reader: _Reader, folder: Path, packages: set[str], seen: set[tuple[str, str]]
) -> Iterator[tuple[str, list[str]]]:
    """The lines of the resources of this kind that packages of the workspace have."""
    if not folder.is_dir():
        return
    for path in sorted(folder.iterdir()):
        name = path.name
        if name in packages and (folder.name, name) not in seen:
            seen.add((folder.name, name))
            try:
                text = read_bytes(path).decode("utf-8", "replace")
            except InputError as error:
                reader.fault(error.message, path)
                continue
            yield name, [line.strip() for line in text.splitlines() if line.strip()]


def _read_xml(reader: _Reader, path: Path, package: str) -> None:
    parser = expat.ParserCreate()
    named: list[tuple[str, int]] = [("", 1)]

    def start(tag: str, given: dict[str, str]) -> None:
        line = parser.CurrentLineNumber
        if tag == "library":
            named[0] = given.get("path", ""), line
        elif tag == "class":
            missing = [name for name in ("type", "base_class_type") if not given.get(name)]
            if missing:
                reader.fault(f'<class> has no {missing[0]}; add {missing[0]}="..."', path, line)
                return
            kind = given["type"].strip()
            name = given.get("name", "").strip() or kind
            base = given["base_class_type"].strip().removeprefix("::")
            # Those of rqt and others in Python have no library.
            if _IN_PYTHON in base:
                return
            written, at = named[0]
            library = reader.library_at(written, path, at)
            if library is not None:
                reader.add(Plugin(name, kind, base, package, library, path, line))

    parser.StartElementHandler = start
    try:
        parser.Parse(read_bytes(path), True)
    except expat.ExpatError as error:
        reader.fault(f"not XML: {expat.ErrorString(error.code)}", path, error.lineno)
    except (ValueError, LookupError) as error:
        reader.fault(f"its encoding cannot be read ({error}); save it as UTF-8", path)
    except InputError as error:
        reader.fault(error.message, path)
