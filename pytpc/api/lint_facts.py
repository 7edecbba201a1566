"""What is known of a robot for `lint`: the values of a launch file, and what its nodes read."""

from __future__ import annotations

import os
import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from pathlib import Path

from pytpc.api.lint_system import of_libraries, of_python_modules
from pytpc.base.errors import InputError
from pytpc.base.source_bytes import read_bytes
from pytpc.conditions.parameter_calls import call_text
from pytpc.conditions.source_texts import SourceTexts, source_texts
from pytpc.lint.facts import (
    Angle,
    Earlier,
    Facts,
    Node,
    NodeRead,
    Renamed,
    Setting,
    is_anything,
    last_part,
    own_part,
    words_in,
)
from pytpc.lint.finding import Spot
from pytpc.processes.binaries import Libraries, system_folders
from pytpc.processes.process import Process, Processes
from pytpc.processes.starts import loaded_by
from pytpc.recording.declaration import Declared
from pytpc.static.angles import angle_of
from pytpc.static.link_unit import LinkUnit, ParameterRead
from pytpc.static.parameters import DYNAMIC, resolved
from pytpc.static.static_info import StaticInfo
from pytpc.values.known import package_folder
from pytpc.values.origin_places import Places
from pytpc.values.origins import Origin
from pytpc.values.recording import is_of_ros, leaves
from pytpc.values.trace import LaunchNode, Trace
from pytpc.values.yaml_tree import YamlSetting, read_yaml, settings

_TABLES = ("XmlRpc", "map<", "unordered_map<", "dict")
_PYTHON_ROS1 = ("rospy", "rosparam")
_PREFIX = "get_parameters_by_prefix"
_OF_SERVER = "dynamic_reconfigure"
# The name of a plugin or a nodelet, as values have it; not a topic.
_CLASS = re.compile(r"[A-Za-z]\w*(?:/|::)(?:\w+::)*[A-Z]\w*")
_OF_MESSAGES = ("_msgs/", "_srvs/", "_msgs::", "_srvs::", "/msg/", "/srv/")


@dataclass(frozen=True)
class Robot:
    """The analysed code of a workspace, for as many launch files as are checked.

    ``folders`` are those of its packages, also of such as have headers only.
    """

    static: StaticInfo
    processes: Processes
    declared: Sequence[Declared]
    env: Mapping[str, str] = field(default_factory=dict)
    folders: Sequence[Path] = ()

    @cached_property
    def _programs(self) -> Mapping[str, list[Process]]:
        found = defaultdict(list)
        for process in self.processes.found:
            found[process.program].append(process)
        return found

    @cached_property
    def _units(self) -> Mapping[str, list[LinkUnit]]:
        """The link units by the programs that they are, and by their full names."""
        found = defaultdict(list)
        for unit in self.static.units:
            names = {unit.link_unit}
            if unit.script is not None:
                names |= {unit.script.rpartition("/")[2], unit.link_unit.rpartition("/")[2]}
            for name in names:
                found[f"{unit.package}/{name}"].append(unit)
        return found

    @cached_property
    def _libraries(self) -> Libraries:
        return Libraries(folders=system_folders(self.env, ()))

    @cached_property
    def started(self) -> frozenset[str]:
        """The nodes that launch files of the workspace start."""
        starts = (start for process in self.processes.found for start in process.starts)
        return frozenset(start.node for start in starts if start.node)

    @cached_property
    def _ours(self) -> frozenset[Path]:
        """The programs and libraries of the workspace."""
        return frozenset(unit.path for one in self.processes.found for unit in one.units)

    @cached_property
    def set_by_code(self) -> frozenset[str]:
        """The last parts of the names that code of the workspace sets."""
        roots = {unit.source_root for unit in self.static.units}
        return frozenset[str]().union(*(source_texts(root).sets for root in sorted(roots)))

    @cached_property
    def _read_places(self) -> frozenset[tuple[str, int]]:
        """The files and lines of all known reads."""
        return frozenset(
            (unit.absolute(read.file), read.lineno)
            for unit in self.static.units
            for read in unit.parameters
        )

    def facts(self, trace: Trace, wanted: frozenset[str] | None = None) -> Facts:
        """The facts of one launch file.

        Args:
            trace: what it sets and starts.
            wanted: names that are looked for in libraries; None: those that it sets.
        """
        settings = settings_of(trace)
        names = frozenset(last_part(one.name) for one in settings) if wanted is None else wanted
        nodes = [
            self.node(node, trace.nodes, names, _classes_in(settings, node.name))
            for node in trace.nodes
        ]
        return Facts(settings, nodes, self.declared, self.set_by_code)

    def node(
        self,
        node: LaunchNode,
        beside: Sequence[LaunchNode],
        wanted: frozenset[str],
        classes: frozenset[str] = frozenset(),
    ) -> Node:
        """What a node reads.

        Args:
            node: it.
            beside: all nodes that are started with it.
            wanted: last parts of names that are looked for in code of the system.
            classes: names in the node's values that are like those of plugins.
        """
        host = loaded_by(node)
        started = next((one for one in beside if one.name == host), None) if host else node
        program = f"{node.package}/{node.program}"
        if started is None:
            return Node(node.name, program, unjudged=f"{host}, which loads a node, is not started")
        run = f"{started.package}/{started.program}"
        classes |= _loaded_class(node)
        processes = self._processes(run, started.name, classes)
        units = [self._unit(one.full_name) for process in processes for one in process.units]
        units += [unit for unit in self._units.get(run, ()) if unit not in units]
        known = [unit for unit in units if unit is not None]
        why = self._why_unjudged(run, processes, units)
        reads = [read for unit in known for read in self._reads(unit, node)]
        why = why or _why_unknown_plugin(run, processes, classes)
        texts = self._texts(known)
        files = [process.host for process in processes if process.host is not None]
        files += [unit.path for process in processes for unit in process.units]
        texts |= of_libraries(self._libraries, dict.fromkeys(files), self._ours, wanted)
        texts |= of_python_modules(_python_files(known), self.env, wanted)
        return Node(
            node.name,
            program,
            tuple(dict.fromkeys(reads)),
            why,
            texts,
            self._renamed(known),
            _pieces(known, reads),
            frozenset(words_in(node.args)),
        )

    @cached_property
    def _renamers(self) -> Mapping[str, tuple[int, str]]:
        """The functions that deal with old names: which text is the old one, and their files."""
        roots = {str(folder) for folder in self.folders}
        roots |= {unit.source_root for unit in self.static.units}
        return {
            name: place
            for root in sorted(roots)
            for name, place in source_texts(root).renamers.items()
        }

    def _renamed(self, units: Iterable[LinkUnit]) -> Mapping[str, Renamed]:
        """The old names of parameters in the code of units, with the new ones."""
        found: dict[str, Renamed] = {}
        for root in sorted({unit.source_root for unit in units}):
            for call in source_texts(root).renamings:
                at, reader = self._renamers.get(call.function, (-1, ""))
                if 0 <= at < len(call.texts):
                    new = call.texts[1 if at == 0 else 0]
                    spot = Spot(call.path, call.lineno)
                    found[call.texts[at]] = Renamed(new, spot, reader, call.namespace)
        return found

    def _processes(
        self, program: str, node: str, classes: frozenset[str] = frozenset()
    ) -> list[Process]:
        """The processes that a node may be: those that a launch file starts under its name.

        All, if none of these has a plugin that the node's values name, and another one has it.
        """
        found = self._programs.get(program, [])
        own = [one for one in found if any(start.node == node for start in one.starts)]
        there = _plugins_of(own)
        is_other = any(name not in there for name in classes & _plugins_of(found))
        return list(found) if is_other or not own else own

    def _unit(self, full_name: str) -> LinkUnit | None:
        found = self._units.get(full_name, ())
        return found[0] if found else None

    def _why_unjudged(
        self, program: str, processes: Sequence[Process], units: Sequence[LinkUnit | None]
    ) -> str:
        """Why not all reads of a program are known; empty where they are."""
        if not units:
            return f"{program} was not analysed"
        if any(unit is None for unit in units):
            return f"a library of {program} was not analysed"
        for unit in units:
            assert unit is not None
            if unit.trouble is not None:
                return f"{program} was not analysed as a whole"
            if source_texts(unit.source_root).reads_all:
                return f"{program} reads whole namespaces"
        failed = next((one for one in processes if one.outcome and one.outcome.failure), None)
        return "" if failed is None else f"{program} was not analysed as a whole"

    def _reads(self, unit: LinkUnit, node: LaunchNode) -> Iterator[NodeRead]:
        texts = source_texts(unit.source_root)
        for read in unit.parameters:
            found = self._read(unit, read, node, texts)
            yield found
            if found.is_reconfigured:
                yield from self._fields(unit, found)

    @staticmethod
    def _read(
        unit: LinkUnit, read: ParameterRead, node: LaunchNode, texts: SourceTexts
    ) -> NodeRead:
        path = unit.absolute(read.file) if read.file else ""
        said = call_text(path, read.lineno, read.api, read.function)
        name = _full_name(read, node)
        angle: Angle = angle_of(unit, read)
        if not angle and texts.converts(own_part(name)):
            angle = "degrees"
        elif not angle and texts.turns(own_part(name)):
            angle = "radians"
        return NodeRead(
            name,
            read.api,
            read.type,
            read.default,
            Spot(path, read.lineno),
            _is_table(read),
            said.needed,
            None if said.deprecation is None else Spot(path, said.deprecation),
            said.at_start and _OF_SERVER not in read.api,
            angle,
            said.is_converted,
        )

    def _fields(self, unit: LinkUnit, read: NodeRead) -> Iterator[NodeRead]:
        """The fields beside one that dynamic_reconfigure hands over: its server reads them all."""
        package = package_folder(Path(read.spot.path)) if read.spot.path else None
        before, _, end = read.name.rpartition("/")
        declared = [one for one in self.declared if one.package == str(package)]
        files = {one.place.rpartition(":")[0] for one in declared if one.parameter == end}
        for one in declared:
            if one.place.rpartition(":")[0] in files and one.parameter != end:
                name = f"{before}/{one.parameter}"
                yield replace(read, name=name, type=_type_of(one), default=one.default, angle="")

    def _texts(self, units: Iterable[LinkUnit]) -> frozenset[str]:
        """Texts in the sources of units beside which no known read stands."""
        roots = {(unit.source_root, unit.is_python) for unit in units}
        found = (
            source_texts(root).unread(self._read_places, python=is_python)
            for root, is_python in sorted(roots)
        )
        return frozenset[str]().union(*found)


def _pieces(units: Iterable[LinkUnit], reads: Iterable[NodeRead]) -> frozenset[str]:
    """The texts that names are put together of, in the files with reads of such names."""
    files = {read.spot.path for read in reads if is_anything(read)}
    roots = sorted({unit.source_root for unit in units}) if files else []
    found = (source_texts(root).pieces(file) for root in roots for file in sorted(files))
    return frozenset[str]().union(*found)


def _plugins_of(processes: Iterable[Process]) -> frozenset[str]:
    """The names and classes of the plugins that processes load."""
    return frozenset(name for one in processes for each in one.plugins for name in each.names)


def _why_unknown_plugin(program: str, processes: Sequence[Process], classes: frozenset[str]) -> str:
    """Why not all reads are known if values name a plugin whose code was not seen."""
    if not processes:
        return ""
    unknown = sorted(classes - _plugins_of(processes))
    return f"{program} may load {unknown[0]}, which was not analysed with it" if unknown else ""


def _loaded_class(node: LaunchNode) -> frozenset[str]:
    """The class of a nodelet or a component."""
    words = node.args.split()
    if node.container:
        return frozenset({node.program})
    is_nodelet = node.program == "nodelet" and words[:1] in (["load"], ["standalone"])
    return frozenset(words[1:2]) if is_nodelet else frozenset()


def _classes_in(settings: Iterable[Setting], node: str) -> frozenset[str]:
    """The texts in the values of a node that are like names of plugins."""
    values = [one.value for one in settings if one.name.startswith(f"{node}/")]
    found = set()
    while values:
        value = values.pop()
        if isinstance(value, str) and _CLASS.fullmatch(value):
            if not any(word in value for word in _OF_MESSAGES):
                found.add(value)
        elif isinstance(value, list | dict):
            values += value.values() if isinstance(value, dict) else value
    return frozenset(found)


def _python_files(units: Iterable[LinkUnit]) -> frozenset[str]:
    """The Python files that units are known to consist of."""
    return frozenset(
        path
        for unit in units
        if unit.is_python
        for path in (unit.script_path, *(unit.absolute(read.file) for read in unit.parameters))
        if path is not None
    )


def _full_name(read: ParameterRead, node: LaunchNode) -> str:
    """The full name of what a node reads, with ``<dynamic>`` for what is not known."""
    name = _own_name(read, node.name)
    if node.container or read.api.startswith(("rclcpp", "rclpy")):
        return name
    # roscpp and rospy give parameters other names as they do with topics.
    for old, new in node.remaps:
        if resolved(old, node.name) == name:
            return resolved(new, node.name)
    return name


def _own_name(read: ParameterRead, node: str) -> str:
    if read.api.startswith(("rclcpp", "rclpy")):
        name = read.name
        if name.startswith("/"):
            return name
        name = name.lstrip("~/")
        return f"{node}/{name}"
    name = read.name
    if name.startswith(DYNAMIC):
        # Its first part may be any namespace.
        return f"/{name}"
    return resolved(name, node).rstrip("/") or "/"


def _is_table(read: ParameterRead) -> bool:
    """Whether a call may read all parameters below a name."""
    if read.api.startswith(_PYTHON_ROS1):
        return not isinstance(read.default, bool | int | float | str)
    return _PREFIX in read.api or any(word in read.type for word in _TABLES)


def _type_of(one: Declared) -> str:
    return {"str": "std::string"}.get(one.type, one.type)


def settings_of(trace: Trace) -> list[Setting]:
    """The values that a launch file sets, without those of roslaunch itself."""
    if trace.placed is not None:
        twins = cache(_keys_of_file)
        return [
            _placed(origin, twins) for name, origin in trace.placed.items() if not is_of_ros(name)
        ]
    places = Places(trace)
    found: list[Setting] = []
    for name, placed in places.all_origins().items():
        last = placed[-1]
        earlier = [
            Earlier(_spot(one), one.value, True)
            for one in placed[:-1]
            if one.path is not None and _spot(one) != _spot(last)
        ]
        path = str(last.path)
        earlier += [
            Earlier(Spot(path, lineno), is_same_map=True) for lineno in places.same_keys(last)
        ]
        for full, value in leaves(name, last.value):
            if last.path is not None and not is_of_ros(full):
                found.append(Setting(full, value, _spot(last), tuple(earlier)))
    return found


_Twins = Callable[[Path], Mapping[tuple[str, ...], YamlSetting]]


def _keys_of_file(path: Path) -> Mapping[tuple[str, ...], YamlSetting]:
    """The values of a params file by their keys; none if it cannot be read."""
    try:
        documents = read_yaml(read_bytes(path).decode("utf-8-sig", "replace"))
    except (InputError, ValueError):
        return {}
    return settings(documents[0]) if documents else {}


def _placed(origin: Origin, twins: _Twins) -> Setting:
    twin = twins(origin.path).get(origin.keys) if origin.path and origin.keys else None
    same = {f"{origin.path}:{lineno}" for lineno in (() if twin is None else twin.earlier)}
    earlier = []
    for words in origin.overridden:
        path, _, lineno = words.rpartition(":")
        spot = Spot(path, int(lineno)) if path and lineno.isdigit() else Spot(words)
        earlier.append(Earlier(spot, is_same_map=words in same))
    return Setting(origin.name, origin.value, _spot(origin), tuple(earlier))


def _spot(origin: Origin) -> Spot:
    """The line of an origin, in the source where it is an installed copy."""
    path = origin.source or origin.path
    return Spot("" if path is None else os.path.normpath(path), origin.lineno or 0)
