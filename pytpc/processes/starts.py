"""How launch files start programs, and which plugins they and YAML files name."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pytpc.base.errors import InputError, TpcError
from pytpc.base.source_bytes import read_bytes
from pytpc.values.launch_kinds import is_ros2_launch
from pytpc.values.ros2_trace import trace_any_launch
from pytpc.values.trace import LaunchNode, Trace
from pytpc.workspace.packages import PRODUCTS, Package

_LAUNCH = (".launch", ".launch.xml", ".launch.py", ".launch.yaml", ".launch.yml")
_YAML = (".yaml", ".yml")
_WORD = re.compile(r"[A-Za-z_][\w/:.-]*")
_NODELET = "nodelet"
_LARGEST = 4 << 20


@dataclass(frozen=True, slots=True)
class Start:
    """A node that a launch file starts.

    ``names`` are all words in the values of its parameters, each with the parameter, relative to
    the node. ``loads`` are the plugins that are loaded into it by the launch file itself: nodelets
    and components. A file that no launch file reads has its words in ``names``, and no node.
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


def launch_files(packages: Iterable[Package]) -> list[Path]:
    """The launch files below the folders of packages, sorted."""
    return sorted(_files(packages, _LAUNCH))


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
    paths = launch_files(packages)
    found: list[Start] = []
    unread: dict[Path, str] = {}
    known: set[Path] = set()
    for number, path in enumerate(paths):
        if on_progress is not None:
            on_progress(number, len(paths))
        try:
            trace = trace_any_launch(env, path, {})
        except TpcError as error:
            unread[path] = error.message
            continue
        known |= {path.resolve(), *(Path(name).resolve() for name in trace.files)}
        found += starts_of(trace)
    if on_progress is not None:
        on_progress(len(paths), len(paths))
    for path in (*unread, *sorted(_files(packages, _YAML))):
        words = wanted & _words_in(path) if path.resolve() not in known else frozenset()
        if words:
            found.append(Start("", "", path, 0, {"": words}))
    # A file that others include is read with each of them.
    once = {(one.program, one.node, one.path, one.line, one.words, one.loads): one for one in found}
    return Starts(tuple(once.values()), unread)


def starts_of(trace: Trace) -> Iterator[Start]:
    """The nodes that a launch file starts, with the plugins that it loads into them."""
    loads: dict[str, set[str]] = {}
    others: list[LaunchNode] = []
    for node in trace.nodes:
        words = node.args.split() if node.program == _NODELET else []
        if node.container:
            loads.setdefault(node.container, set()).add(node.program)
        elif words[:1] == ["load"] and len(words) > 2:
            loads.setdefault(_resolved(words[2], node.name), set()).add(words[1])
        elif words[:1] not in (["load"], ["unload"]):
            others.append(node)
            if words[:1] == ["standalone"]:
                loads.setdefault(node.name, set()).update(words[1:2])
    for node in others:
        yield Start(
            f"{node.package}/{node.program}",
            node.name,
            node.path,
            node.lineno,
            _names_of(trace, node.name),
            frozenset(loads.get(node.name, ())),
        )


def _names_of(trace: Trace, node: str) -> dict[str, frozenset[str]]:
    """The words in the last values of the parameters of a node."""
    below = node.rstrip("/") + "/"
    return {
        name.removeprefix(below): frozenset(_words(settings[-1].get("value")))
        for name, settings in trace.settings.items()
        if name.startswith(below) and settings
    }


def _words(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield from _WORD.findall(value)
    elif isinstance(value, Mapping):
        for one in value.values():
            yield from _words(one)
    elif isinstance(value, (list, tuple)):
        for one in value:
            yield from _words(one)


def _words_in(path: Path) -> frozenset[str]:
    """The words of a file that is not too large to be written by hand."""
    try:
        if path.stat().st_size > _LARGEST:
            return frozenset()
        return frozenset(_WORD.findall(read_bytes(path).decode("utf-8", "replace")))
    except (OSError, InputError):
        return frozenset()


def _resolved(name: str, node: str) -> str:
    """A name as a node of ROS 1 means it."""
    return name if name.startswith("/") else f"{node.rpartition('/')[0]}/{name}"


def _files(packages: Iterable[Package], endings: tuple[str, ...]) -> Iterator[Path]:
    for package in packages:
        for path in package.path.rglob("*"):
            parts = path.relative_to(package.path).parts
            if any(part.startswith(".") or part in PRODUCTS for part in parts[:-1]):
                continue
            is_named = path.name.endswith(endings)
            if (is_named or (endings is _LAUNCH and _is_launch(path, parts))) and path.is_file():
                yield path


def _is_launch(path: Path, parts: tuple[str, ...]) -> bool:
    """Whether a file in a folder ``launch`` is a launch file by what is in it."""
    return parts[0] == "launch" and path.suffix in (".xml", *_YAML) and is_ros2_launch(path)
