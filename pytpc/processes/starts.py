"""How launch files start programs, and which plugins they and YAML files name."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path

from pytpc.base.errors import InputError, TpcError
from pytpc.base.source_bytes import read_bytes
from pytpc.processes.corrections import FILE
from pytpc.values.launch_kinds import is_ros2_launch
from pytpc.values.ros2_trace import trace_any_launch
from pytpc.values.trace import LaunchNode, Trace
from pytpc.values.yaml_tree import YamlNode, read_yaml
from pytpc.workspace.packages import PRODUCTS, Package

_LAUNCH = (".launch", ".launch.xml", ".launch.py", ".launch.yaml", ".launch.yml")
_YAML = (".yaml", ".yml")
_WORD = re.compile(r"[A-Za-z_][\w/:.-]*")
_NODELET = "nodelet"
_CONTAINER = "rclcpp_components/component_container"
_OF_FILES = " files"
_XML_COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)
_COMMENT = re.compile(r"#.*")
_LARGEST = 4 << 20


@dataclass(frozen=True, slots=True)
class Start:
    """A node that a launch file starts.

    ``names`` are all words in the values of its parameters, each with the parameter, relative to
    the node; those of the nodes that are loaded into it, and of the namespaces that it is in, are
    among them. ``loads`` are the plugins that launch files load into it: nodelets and components.
    A file that no launch file reads has its words in ``names``, and no node.
    """

    program: str
    node: str
    path: Path
    line: int
    names: Mapping[str, frozenset[str]] = field(default_factory=dict)
    loads: frozenset[str] = frozenset()

    @property
    def words(self) -> frozenset[str]:
        """All words in the values of its parameters."""
        return frozenset().union(*self.names.values())

    def sets(self, parameter: str) -> bool:
        """Whether it sets a parameter, by its name in the code: the end of its name counts."""
        wanted = parameter.lstrip("~/").rpartition(">/")[2]
        ends = ("/" + wanted, "." + wanted)
        return any(name == wanted or name.endswith(ends) for name in self.names)


@dataclass(frozen=True, slots=True)
class Starts:
    """What the launch files of a workspace start; ``unread`` has those that fail, and why."""

    found: tuple[Start, ...]
    unread: Mapping[Path, str]


def read_starts(
    env: Mapping[str, str],
    packages: Sequence[Package],
    wanted: frozenset[str],
    on_progress: Callable[[int, int], None] | None = None,
) -> Starts:
    """Read all launch files as roslaunch and launch do, with their arguments' defaults.

    Launch files that cannot be read so, for example because an argument has no default, and YAML
    files that no launch file reads, are searched for the names of plugins.

    Args:
        env: the environment of the workspace.
        packages: those of the workspace.
        wanted: the names of plugins.
        on_progress: called with (files read, all files).
    """
    launches, yamls = files_of(packages)
    found: list[Start] = []
    unread: dict[Path, str] = {}
    known: set[Path] = set()

    def traced(path: Path) -> Trace | TpcError:
        try:
            return trace_any_launch(env, path, {})
        except TpcError as error:
            return error

    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        for number, (path, read) in enumerate(
            zip(launches, pool.map(traced, launches), strict=True), start=1
        ):
            if on_progress is not None:
                on_progress(number, len(launches))
            if isinstance(read, TpcError):
                unread[path] = read.message
                continue
            known |= {path.resolve(), *(Path(name).resolve() for name in read.files)}
            found += starts_of(read)
    for path in (*unread, *yamls):
        words = wanted & words_in(path) if path.resolve() not in known else frozenset()
        if words:
            found.append(Start("", "", path, 0, {"": words}))
    # A file that others include is read with each of them.
    once = {(one.program, one.node, one.path, one.line, one.words, one.loads): one for one in found}
    return Starts(tuple(_joined(once.values())), unread)


def _joined(starts: Iterable[Start]) -> Iterator[Start]:
    """The starts; what is loaded into a node of another launch file is loaded there."""
    hosts: list[Start] = []
    loose: dict[str, list[Start]] = {}
    for one in starts:
        if one.node and one.loads and not one.line:
            loose.setdefault(one.node, []).append(one)
        else:
            hosts.append(one)
    started = {one.node for one in hosts if one.line}
    yield from (one for node, ones in loose.items() if node not in started for one in ones)
    for one in hosts:
        names, loads = dict(one.names), one.loads
        for each in loose.get(one.node, ()):
            names.update(each.names)
            loads |= each.loads
        yield replace(one, names=names, loads=loads)


def loaded_by(node: LaunchNode) -> str:
    """The full name of the node into which a nodelet or component is loaded; empty if none."""
    words = node.args.split() if node.program == _NODELET else []
    if words[:1] == ["load"] and len(words) > 2:
        return _resolved(words[2], node.name)
    return node.container


def starts_of(trace: Trace) -> Iterator[Start]:
    """The nodes that a launch file starts, with the plugins that it loads into them."""
    loads: dict[str, set[str]] = {}
    loaded: dict[str, list[LaunchNode]] = {}
    others: list[LaunchNode] = []
    for node in trace.nodes:
        words = node.args.split() if node.program == _NODELET else []
        host, plugin = loaded_by(node), node.program
        if words[:1] == ["load"] and len(words) > 2:
            plugin = words[1]
        if host:
            loads.setdefault(host, set()).add(plugin)
            loaded.setdefault(host, []).append(node)
        elif words[:1] not in (["load"], ["unload"]):
            others.append(node)
            if words[:1] == ["standalone"]:
                loads.setdefault(node.name, set()).update(words[1:2])
    inside = _Words(trace)
    for node in others:
        names = inside.of([node, *loaded.pop(node.name, ())])
        plugins = frozenset(loads.get(node.name, ()))
        program = f"{node.package}/{node.program}"
        yield Start(program, node.name, node.path, node.lineno, names, plugins)
    for host, nodes in loaded.items():
        # Another launch file starts it.
        program = _CONTAINER if nodes[0].container else f"{_NODELET}/{_NODELET}"
        names = inside.of(nodes)
        yield Start(program, host, nodes[0].path, 0, names, frozenset(loads[host]))


@dataclass(slots=True)
class _Words:
    """Finds the words in the last values of the parameters that nodes may read."""

    trace: Trace

    def of(self, nodes: Sequence[LaunchNode]) -> dict[str, frozenset[str]]:
        """Those of the nodes, and those of the namespaces that they are in, by parameter."""
        others = {one.name + "/" for one in self.trace.nodes} - {one.name + "/" for one in nodes}
        found: dict[str, frozenset[str]] = {}
        for name, settings in self.trace.settings.items():
            if settings and not any(name.startswith(other) for other in others):
                short = next(
                    (_below(name, node.name) for node in nodes if _below(name, node.name)), ""
                )
                if short or any(_is_around(name, node.name) for node in nodes):
                    words = frozenset(_words(settings[-1].get("value")))
                    found[short or name.lstrip("/")] = words
        if self.trace.placed is not None:
            # A process may make further nodes, whose parameters are in the same files.
            files = [Path(one) for one in self.trace.files if one.endswith(_YAML)]
            found[_OF_FILES] = frozenset().union(*map(words_in, files))
        return found


def _below(name: str, node: str) -> str:
    """The name of a parameter relative to a node; empty if it is not below that."""
    below = node.rstrip("/") + "/"
    return name.removeprefix(below) if name.startswith(below) else ""


def _is_around(name: str, node: str) -> bool:
    """Whether a parameter is in a namespace that a node is in."""
    return node.startswith(name.rpartition("/")[0] + "/")


def _words(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield from _WORD.findall(value)
    elif isinstance(value, Mapping):
        for one in value.values():
            yield from _words(one)
    elif isinstance(value, (list, tuple)):
        for one in value:
            yield from _words(one)


@lru_cache(maxsize=1024)
def words_in(path: Path) -> frozenset[str]:
    """The words of a file that is not too large to be written by hand, without its comments."""
    try:
        if path.stat().st_size > _LARGEST:
            return frozenset()
        text = read_bytes(path).decode("utf-8", "replace")
    except (OSError, InputError):
        return frozenset()
    if path.suffix in _YAML:
        try:
            return frozenset(_WORD.findall("\n".join(_scalars(read_yaml(text)))))
        except ValueError:
            return frozenset()
    without = _XML_COMMENT.sub("", text) if path.suffix != ".py" else _COMMENT.sub("", text)
    return frozenset(_WORD.findall(without))


def _scalars(nodes: Iterable[YamlNode]) -> Iterator[str]:
    for node in nodes:
        if node.kind == "scalar":
            yield node.text
        yield from _scalars(node.items)
        yield from _scalars(value for _, value in node.pairs)


def _resolved(name: str, node: str) -> str:
    """A name as a node of ROS 1 means it."""
    return name if name.startswith("/") else f"{node.rpartition('/')[0]}/{name}"


def files_of(packages: Iterable[Package]) -> tuple[list[Path], list[Path]]:
    """The launch files and the YAML files below the folders of packages, each sorted."""
    launches, yamls = set(), set()
    for package in packages:
        for folder, below, files in os.walk(package.path):
            below[:] = [one for one in below if not one.startswith(".") and one not in PRODUCTS]
            for name in files:
                path = Path(folder, name)
                if name.endswith(_LAUNCH) or _is_launch(path):
                    launches.add(path)
                elif path.suffix in _YAML and name != FILE:
                    yamls.add(path)
    return sorted(launches), sorted(yamls)


def _is_launch(path: Path) -> bool:
    """Whether a file in a folder ``launch`` is a launch file by what is in it."""
    is_there = path.parent.name == "launch" and path.suffix in (".xml", *_YAML)
    return is_there and is_ros2_launch(path)
