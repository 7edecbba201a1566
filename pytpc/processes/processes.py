"""The processes of a built workspace: which code runs in one address space.

A parameter may be read in one library, compared in a second and act in a third. What belongs
together is known from the built files (which libraries each needs, which base classes it loads
plugins of), from the declarations of plugins, and from what launch files and parameters name.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pytpc.base.closest import no_folder
from pytpc.base.errors import WorkspaceError
from pytpc.base.paths import ROS_PREFIXES
from pytpc.build.build import workspace_env
from pytpc.build.nodes_env import with_devel_space
from pytpc.build.reconcile import Recorded, build_folders, recorded_units
from pytpc.processes.binaries import (
    COMPONENT,
    Binary,
    Libraries,
    cyclic_needs,
    symbols,
    system_folders,
)
from pytpc.processes.corrections import Corrected, Corrections
from pytpc.processes.plugins import Plugin, declared_plugins
from pytpc.processes.process import Choice, Process, Processes, Unit
from pytpc.processes.starts import Start, read_starts
from pytpc.static.link_unit import LinkUnit
from pytpc.static.static_info import StaticInfo
from pytpc.workspace.colcon import Bases
from pytpc.workspace.packages import find_packages

_PATHS = ("CMAKE_PREFIX_PATH", "AMENT_PREFIX_PATH")
# With it, class_loader lets all libraries use what it opens (RTLD_GLOBAL).
_OPENS_FOR_ALL = "libPocoFoundation.so"
_Units = tuple[Unit, ...]
Progress = Callable[[int, int], None]
Read = tuple[str, str]
"""A parameter and its default, a text."""
Reads = Mapping[tuple[str, str], Sequence[Read]]


def find_processes(
    workspace: Path,
    bases: Bases | None = None,
    corrections: Corrections | None = None,
    on_progress: Progress | None = None,
) -> Processes:
    """The processes of a workspace that `pytpc build` has built.

    Args:
        workspace: the folder of the workspace.
        bases: where it was built; None: in its folder ``.tpc``.
        corrections: what the user says of some programs.
        on_progress: called with (launch files read, all launch files).

    Raises:
        WorkspaceError: it is not built, or has no packages.
        InputError: a file of the build is broken, or a correction names what is not there.
    """
    workspace = workspace.absolute()
    bases = Bases.of(workspace) if bases is None else bases
    if not workspace.is_dir():
        raise WorkspaceError(no_folder(workspace), workspace)
    if not bases.static_info.is_file():
        raise WorkspaceError("not built with TPC yet; build it with: pytpc build", workspace)
    units = StaticInfo.load(bases.static_info).units
    search = Search.begin(workspace, bases, units, on_progress)
    reads = {(one.package, one.link_unit): defaults_of(one) for one in units}
    return search.found(reads, corrections or Corrections())


def defaults_of(unit: LinkUnit) -> list[Read]:
    """The parameters that a unit reads with a text as default."""
    return [(read.name, read.default) for read in unit.parameters if isinstance(read.default, str)]


@dataclass(frozen=True, slots=True)
class Search:
    """What is known of a built workspace, however often its processes are asked for."""

    libraries: Libraries
    built: Mapping[Path, Unit]
    plugins: Sequence[Plugin]
    starts: Sequence[Start]
    prefixes: Sequence[Path]
    faults: Sequence[str]
    unread: Mapping[Path, str]

    @classmethod
    def begin(
        cls,
        workspace: Path,
        bases: Bases,
        units: Iterable[LinkUnit],
        on_progress: Progress | None = None,
    ) -> Search:
        """Read the files of a build: programs and libraries, and what declares and starts them.

        Args:
            workspace, bases, on_progress: as `find_processes` has them.
            units: what is known of the link units, by this build or an earlier one.

        Raises:
            WorkspaceError, InputError: as `find_processes`.
        """
        packages = find_packages(workspace)
        env = with_devel_space(workspace_env(bases.install), bases.devel)
        built = _built(bases, units)
        prefixes = _prefixes(env)
        libraries = Libraries(folders=system_folders(env, prefixes))
        libraries.ours, doubled = _by_name(built, libraries)
        declared = declared_plugins(packages, prefixes, libraries.ours)
        wanted = frozenset(name for plugin in declared.plugins for name in plugin.names)
        starts: tuple[Start, ...] = ()
        unread: Mapping[Path, str] = {}
        if wanted:
            read = read_starts(env, packages, wanted, on_progress)
            starts, unread = read.found, read.unread
        faults = [*doubled, *declared.faults]
        cycle = cyclic_needs(one for path in built if (one := libraries.binary(path)))
        if cycle:
            faults.append(f"libraries need one another in a circle: {' -> '.join(cycle)}")
        return cls(libraries, built, declared.plugins, starts, prefixes, faults, unread)

    def found(self, reads: Reads, corrections: Corrections) -> Processes:
        """The processes.

        Args:
            reads: of units (package and name), the parameters with a text as default.
            corrections: what the user says of some programs.

        Raises:
            InputError: a correction names what is not there.
        """
        finder = _Finder(
            self.libraries, self.built, reads, self.plugins, self.starts, self.prefixes
        )
        return Processes(tuple(finder.all(corrections)), tuple(self.faults), self.unread)


def _built(bases: Bases, units: Iterable[LinkUnit]) -> dict[Path, Unit]:
    """The files of the workspace's link units, without tests."""
    counts = {
        (one.package, one.link_unit): one.counts.functions
        for one in units
        if one.status == "ok" and not one.is_python
    }
    found = {}
    for recorded in recorded_of(bases):
        key = recorded.package, recorded.name
        unit = Unit(*key, recorded.artifact.absolute(), recorded, counts.get(key))
        is_wanted = unit.is_known or not recorded.left_out.startswith("it is a test")
        if recorded.artifact.is_file() and is_wanted:
            found[unit.path] = unit
    return found


def recorded_of(bases: Bases) -> Iterator[Recorded]:
    """The link units of all packages."""
    for folder in build_folders(bases.build):
        yield from recorded_units(folder) or ()


def _by_name(built: Iterable[Path], reader: Libraries) -> tuple[dict[str, Path], list[str]]:
    """The files by what others may call them; and a text for each name that two have."""
    found: dict[str, Path] = {}
    faults = []
    for path in built:
        binary = reader.binary(path)
        names = [path.name, *([] if binary is None else [binary.soname])]
        # Declarations of plugins leave out the version.
        names.append(path.name.partition(".so.")[0] + ".so" if ".so." in path.name else path.name)
        for name in dict.fromkeys(names):
            first = found.setdefault(name, path)
            is_library = binary is not None and not binary.is_program
            if first != path and is_library:
                faults.append(f"{path}: another library has this name, {first}; that one counts")
    return found, faults


def _prefixes(env: Mapping[str, str]) -> list[Path]:
    named = [Path(one) for name in _PATHS for one in env.get(name, "").split(os.pathsep) if one]
    return list(dict.fromkeys((*named, *ROS_PREFIXES)))


@dataclass(slots=True)
class _Finder:
    """Puts programs, libraries, plugins and starts together."""

    libraries: Libraries
    built: Mapping[Path, Unit]
    reads: Reads
    plugins: Sequence[Plugin]
    starts: Sequence[Start]
    prefixes: Sequence[Path]

    def all(self, corrections: Corrections) -> list[Process]:
        """All processes, sorted by name."""
        hosts: dict[str, Path | None] = {
            f"{unit.package}/{path.name}": path
            for path, unit in self.built.items()
            if (binary := self.libraries.binary(path)) is not None and binary.is_program
        }
        own = {unit.package for unit in self.built.values()}
        for start in self.starts:
            if start.program and start.program.partition("/")[0] not in own:
                host = self._of_system(start.program)
                if host is not None or start.loads:
                    hosts[start.program] = host
        found = []
        for program, host in sorted(hosts.items()):
            corrected = corrections.of(program)
            if corrected is not None:
                given = [self._corrected(program, host, one, corrections) for one in corrected]
                found += _numbered(given)
            else:
                found += self._of(program, host)
        corrections.refuse_unknown(hosts)
        return sorted(map(self._with_others, found), key=lambda process: process.name)

    def _with_others(self, process: Process) -> Process:
        """The process, with the plugins that it could load and does not."""
        choices = []
        for choice in process.choices:
            others = [one for one in self.plugins if one.base == choice.base]
            kept = tuple(one for one in others if one not in choice.plugins)
            choices.append(replace(choice, others=kept))
        return replace(process, choices=tuple(choices))

    def _of_system(self, program: str) -> Path | None:
        places = (prefix / "lib" / program for prefix in self.prefixes)
        return next((one.resolve() for one in places if one.is_file()), None)

    def _of(self, program: str, host: Path | None) -> list[Process]:
        """The processes of a program: one for each set of plugins that it is started with."""
        own = [start for start in self.starts if start.program == program]
        files = [start for start in self.starts if not start.program]
        found: dict[frozenset[Plugin], Process] = {}
        ways: list[Start | None] = [*own] if own else [None]
        for start in ways:
            self._add(found, self._process(program, host, start))
        asked = {choice.base for process in found.values() for choice in process.choices}
        for file in files:
            names = {one for one in self.plugins if one.base in asked and one.names & file.words}
            if names:
                self._add(found, self._process(program, host, file))
        if not own and len(found) > 1:
            # What a file names takes the place of the defaults.
            found = {key: one for key, one in found.items() if one.starts}
        processes = [one for one in found.values() if host in self.built or one.units]
        return _named(processes, program)

    @staticmethod
    def _add(found: dict[frozenset[Plugin], Process], process: Process) -> None:
        key = frozenset(process.plugins)
        before = found.setdefault(key, process)
        if before is not process:
            found[key] = replace(before, starts=(*before.starts, *process.starts))

    def _process(self, program: str, host: Path | None, start: Start | None) -> Process:
        loads = frozenset[str]() if start is None else start.loads
        choices = {
            base: Choice(base, tuple(plugins), "launch")
            for base, plugins in self._by_base(loads).items()
        }

        def choose(binaries: Sequence[Binary]) -> Iterator[Path]:
            for base in sorted(self._asked(binaries, host)):
                if base not in choices:
                    choices[base] = self._choice(base, binaries, start)
            for choice in choices.values():
                yield from (plugin.library for plugin in choice.plugins)

        units, scopes = self._loaded(host, choose)
        kept = tuple(choice for choice in choices.values() if choice.plugins)
        starts = () if start is None else (start,)
        return Process(program, program, host, units, kept, scopes, starts)

    def _asked(self, binaries: Sequence[Binary], host: Path | None) -> set[str]:
        """The base classes that the code asks for.

        That of a library counts if others use it: many programs are linked with more than they
        need. Only a program that makes a manager of components is a container.
        """
        taken = {
            one.path: symbols(one.path)[1]
            for one in binaries
            if one.path in self.built or one.path == host
        }
        asked: set[str] = set()
        for binary in binaries:
            if not binary.asks:
                continue
            is_own = binary.path in taken
            if binary.path != host:
                used = frozenset().union(*(n for path, n in taken.items() if path != binary.path))
                if used.isdisjoint(symbols(binary.path)[0]) and not self._is_plugin(binary):
                    continue
            asked |= {base for base in binary.asks if is_own or base != COMPONENT}
        return asked

    def _is_plugin(self, binary: Binary) -> bool:
        return any(plugin.library == binary.path for plugin in self.plugins)

    def _by_base(self, names: frozenset[str]) -> dict[str, list[Plugin]]:
        found: dict[str, list[Plugin]] = {}
        for plugin in self.plugins:
            if plugin.names & names:
                found.setdefault(plugin.base, []).append(plugin)
        return found

    def _loaded(
        self, host: Path | None, more: Callable[[Sequence[Binary]], Iterable[Path]]
    ) -> tuple[_Units, tuple[_Units, ...]]:
        """The units of a process, and its scopes; ``more`` says what the code there opens."""
        opened: list[Path] = []
        while True:
            scopes = [self.libraries.all_of([] if host is None else [host])]
            scopes += [self.libraries.all_of([path]) for path in opened]
            binaries = list({one.path: one for scope in scopes for one in scope}.values())
            own = [one for one in binaries if one.path in self.built or one.path == host]
            named = {path for one in own for path in self._named_by(one)}
            there = {one.path for one in binaries}
            wanted = dict.fromkeys((*more(binaries), *sorted(named)))
            new = [path for path in wanted if path not in there]
            if not new:
                break
            opened += new
        if any(one.soname.startswith(_OPENS_FOR_ALL) for one in binaries):
            scopes = [binaries]
        return self._units(binaries), tuple(self._units(scope) for scope in scopes)

    def _units(self, binaries: Iterable[Binary]) -> _Units:
        return tuple(self.built[one.path] for one in binaries if one.path in self.built)

    def _named_by(self, binary: Binary) -> Iterator[Path]:
        """Libraries of the workspace that code loads by the names of their files."""
        names = self.libraries.ours.keys() - {binary.soname, binary.path.name, *binary.needed}
        for name in binary.texts(names):
            yield self.libraries.ours[name]

    def _choice(self, base: str, binaries: Sequence[Binary], start: Start | None) -> Choice:
        candidates = [plugin for plugin in self.plugins if plugin.base == base]
        words = frozenset() if start is None else start.words
        named = [plugin for plugin in candidates if plugin.names & words]
        # A file alone does not say which parameters it sets.
        is_file = start is not None and not start.program
        defaults = [] if named and is_file else self._defaults(candidates, binaries)
        if defaults:
            for plugin, parameter in defaults:
                if plugin not in named and not (start is not None and start.sets(parameter)):
                    named.append(plugin)
            why = "parameters" if any(one.names & words for one in named) else "code"
            return Choice(base, _in_order(candidates, named), why)
        if named:
            return Choice(base, _in_order(candidates, named), "parameters")
        texts = frozenset(name for plugin in candidates for name in plugin.names)
        of_code = [one for one in binaries if one.path in self.built]
        # A plugin's own library has its name, too.
        named = [
            plugin
            for plugin in candidates
            if any(one.texts(texts) & plugin.names for one in of_code if one.path != plugin.library)
        ]
        return Choice(base, tuple(named or candidates), "code" if named else "all")

    def _defaults(
        self, candidates: Sequence[Plugin], binaries: Sequence[Binary]
    ) -> list[tuple[Plugin, str]]:
        """Plugins that are defaults of parameters of this code, each with the parameter."""
        by_name = {name: plugin for plugin in candidates for name in plugin.names}
        units = [self.built[one.path] for one in binaries if one.path in self.built]
        return [
            (by_name[default], name)
            for unit in units
            for name, default in self.reads.get((unit.package, unit.name), ())
            if default in by_name
        ]

    def _corrected(
        self, program: str, host: Path | None, given: Corrected, corrections: Corrections
    ) -> Process:
        plugins = [corrections.plugin(one, self.plugins) for one in given.plugins]
        extra = [corrections.library(one, self.libraries.ours) for one in given.libraries]
        wanted = [*(plugin.library for plugin in plugins), *extra]
        units, scopes = self._loaded(host, lambda _binaries: wanted)
        bases = dict.fromkeys(plugin.base for plugin in plugins)
        choices = tuple(
            Choice(base, tuple(one for one in plugins if one.base == base), "corrected")
            for base in bases
        )
        name = given.name or program
        return Process(name, program, host, units, choices, scopes)


def _in_order(candidates: Sequence[Plugin], named: Sequence[Plugin]) -> tuple[Plugin, ...]:
    return tuple(plugin for plugin in candidates if plugin in named)


def _named(processes: Sequence[Process], program: str) -> list[Process]:
    """The processes of one program under names of their own: after what starts them."""
    if len(processes) < 2:
        return list(processes)
    found = []
    for process in processes:
        by = process.starts[0].path.name.partition(".")[0] if process.starts else "default"
        found.append(replace(process, name=f"{program}@{by}"))
    return _numbered(found)


def _numbered(processes: Iterable[Process]) -> list[Process]:
    """The processes; of a name that several have, all but the first get a number."""
    taken: dict[str, int] = {}
    found = []
    for process in processes:
        taken[process.name] = number = taken.get(process.name, 0) + 1
        name = process.name if number == 1 else f"{process.name}-{number}"
        found.append(replace(process, name=name))
    return found
