"""The Python nodes of a workspace: its packages, their programs, and where modules are found."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from pytpc.base.errors import InputError
from pytpc.python_analysis.rules_file import Rules, load_rules
from pytpc.python_analysis.sources.cmake_programs import Programs, read_programs
from pytpc.python_analysis.sources.scripts import Entry, Scripts, is_python, python_files
from pytpc.python_analysis.sources.setup_files import Installed, read_setup
from pytpc.python_analysis.sources.source_files import module_files
from pytpc.workspace.packages import MANIFEST, package_folders, read_manifest

OnFault = Callable[[InputError], None]


class NameFault(InputError):
    """A package.xml that cannot be read: the package gets the name of its folder."""


def entries(
    path: Path,
    on_fault: OnFault | None = None,
    rules: Rules | None = None,
    beside: Iterable[Path] = (),
) -> list[Entry]:
    """The programs that ``path`` means: the script itself, or all nodes of a folder's packages.

    Nodes are entry points, programs that a CMakeLists.txt or setup.py installs, scripts with a
    ``__main__`` guard, and scripts with a shebang that initialise a node. In a folder only those
    count that use ROS, themselves or through modules of the workspace that they import.

    Args:
        path: a script, or a folder.
        on_fault: called with scripts of a folder that cannot be read, which are left out, and, by a
            `NameFault`, with a package.xml that cannot be read.
        rules: what reads and exposes; by default the built-in rules.
        beside: further folders with packages that may be imported.

    Raises:
        InputError: there is no such file or folder.
        MissingToolError: catkin_pkg is not installed.
    """
    path = path.absolute()
    if not path.is_file() and not path.is_dir():
        raise InputError("no such file or folder", path)
    places = _Places(on_fault)
    for folder in (path, *(each.absolute() for each in beside)):
        places.add_below(folder)
    if path.is_file():
        return [places.entry(path)]
    return _named_apart(list(_Nodes(places, rules or load_rules()).below(path)))


def entry_of(script: Path, on_fault: OnFault | None = None) -> Entry:
    """A script with its package: the nearest folder above with a package.xml, else its own."""
    return _Places(on_fault).entry(script.absolute())


def _named_apart(found: list[Entry]) -> list[Entry]:
    """Programs of one package with the same name get their folder into their name."""
    known: dict[tuple[str, str], int] = {}
    for entry in found:
        known[entry.package, entry.name] = known.get((entry.package, entry.name), 0) + 1
    return [
        replace(entry, name=str(entry.script.relative_to(entry.root)).removesuffix(".py"))
        if known[entry.package, entry.name] > 1 and entry.script.is_relative_to(entry.root)
        else entry
        for entry in found
    ]


@dataclass(frozen=True)
class _Package:
    """A package and what its installation makes of its files; ``modules`` as `Entry.packages`."""

    name: str
    root: Path
    setup: Installed
    programs: Programs
    modules: Mapping[str, Path]


class _Places:
    """The known packages."""

    def __init__(self, on_fault: OnFault | None) -> None:
        self.on_fault = on_fault or (lambda _: None)
        self._known: dict[Path, _Package] = {}
        self._roots: dict[Path, Path | None] = {}

    def add_below(self, folder: Path) -> None:
        """Read the packages of a folder."""
        for root in package_folders(folder):
            self.package(root)

    def package(self, root: Path) -> _Package:
        """The package of a folder, read once."""
        if root not in self._known:
            setup, programs = Installed(), Programs()
            if (root / MANIFEST).is_file():
                setup = read_setup(root, self.on_fault)
                programs = read_programs(root, self.on_fault)
            modules = {**dict(_modules(root, setup)), **programs.packages}
            self._known[root] = _Package(self._name(root), root, setup, programs, modules)
        return self._known[root]

    def _name(self, root: Path) -> str:
        if (root / MANIFEST).is_file():
            try:
                return read_manifest(root).name
            except InputError as error:
                what = f"{error.message}; using the folder's name as the package's"
                self.on_fault(NameFault(what, error.path, error.line))
        return root.name

    def root_of(self, script: Path) -> Path:
        """The nearest folder above with a package.xml, else the script's own."""
        folder = script.parent
        way: list[Path] = []
        found: Path | None = None
        for above in (folder, *folder.parents):
            if above in self._roots:
                found = self._roots[above]
                break
            way.append(above)
            if (above / MANIFEST).is_file():
                found = above
                break
        self._roots.update(dict.fromkeys(way, found))
        return found or folder

    def entry(self, script: Path) -> Entry:
        """A script as a program."""
        root = self.root_of(script)
        folders = tuple(
            dict.fromkeys(each for each in (script.parent, root / "src", root) if each.is_dir())
        )
        name = script.name.removesuffix(".py")
        package = self.package(root)
        return Entry(script, name, package.name or name, root, folders, self.modules(package))

    def modules(self, package: _Package) -> Mapping[str, Path]:
        """The modules that a program of ``package`` may import; its own hide the others."""
        found: dict[str, Path] = {}
        for other in (package, *self._known.values()):
            for name, place in other.modules.items():
                found.setdefault(name, place)
        return found


def _modules(root: Path, setup: Installed) -> Iterator[tuple[str, Path]]:
    """Dotted name -> place of the modules that installing a package makes importable."""
    if not setup.is_any:
        return
    named = {name: root / place for name, place in setup.folders.items() if name}
    tops = [root / setup.folders[""]] if "" in setup.folders else [root, root / "src"]
    yield from named.items()
    for top in tops:
        if setup.packages is None:
            names = [each.parent.name for each in sorted(top.glob("*/__init__.py"))]
        else:
            names = setup.packages
        for name in (*names, *setup.modules):
            place = top.joinpath(*name.split("."))
            if name not in named and any(module_files(place)):
                yield name, place


class _Nodes:
    """Finds the nodes of a folder."""

    def __init__(self, places: _Places, rules: Rules) -> None:
        self._places = places
        self._scripts = Scripts(rules)

    def below(self, folder: Path) -> Iterator[Entry]:
        """All nodes, by package and path."""
        files = list(python_files(folder, self._places.on_fault))
        roots = dict.fromkeys([*package_folders(folder), *map(self._places.root_of, files)])
        declared: set[Path] = set()
        begun: dict[Path, list[Entry]] = {}
        for root in roots:
            package = self._places.package(root)
            for entry in self._entry_points(package):
                if entry.script.is_relative_to(folder):
                    begun.setdefault(entry.script, []).append(entry)
            declared.update(_declared(package, folder))
        programs: list[Entry] = []
        installed: list[Entry] = []
        for script in sorted({*files, *declared, *begun}):
            entry = self._places.entry(script)
            try:
                is_run = self._scripts.is_run(entry)
            except InputError as error:
                self._places.on_fault(error)
                continue
            if script in begun or is_run:
                programs += begun.get(script, [entry])
            elif script in declared:
                installed.append(entry)
        programs += self._not_imported(installed, programs)
        programs.sort(key=lambda entry: entry.script)
        yield from filter(self._scripts.has_to_do_with_ros, programs)

    def _not_imported(self, installed: list[Entry], programs: list[Entry]) -> Iterator[Entry]:
        """The installed scripts that no other program imports as a module."""
        imported: set[Path] = set()
        for program in (*programs, *installed) if installed else ():
            imported.update(
                each for each in self._scripts.reached(program) if each != program.script
            )
        return (entry for entry in installed if entry.script not in imported)

    def _entry_points(self, package: _Package) -> Iterator[Entry]:
        modules = self._places.modules(package)
        folders = tuple(each for each in (package.root / "src", package.root) if each.is_dir())
        for name, target in package.setup.programs.items():
            module, _, begin = target.partition(":")
            entry = Entry(
                package.root, name, package.name, package.root, folders, modules,
                module.strip(), begin.strip(),
            )  # fmt: skip
            script = next(entry.places(entry.module), None)
            if script is None:
                what = f"the program {name} begins in {module}, which is not in this package"
                self._places.on_fault(InputError(what, package.root))
            else:
                yield replace(entry, script=script)


def _declared(package: _Package, folder: Path) -> Iterator[Path]:
    """The scripts that a package installs as programs."""
    scripts = [package.root / name for name in package.setup.scripts]
    others = [each for each in (*package.programs.others, *scripts) if is_python(each)]
    for path in (*package.programs.python, *others):
        found = Path(os.path.normpath(path))
        if found.is_file() and found.is_relative_to(folder):
            yield found
