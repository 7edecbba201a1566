"""Checks the parameters of a robot before it runs: the verb behind `pytpc lint`."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path

from pytpc.api.building import processes
from pytpc.api.lint_facts import Robot, settings_of
from pytpc.api.lint_mission import Recorded, recorded
from pytpc.base.closest import did_you_mean, path_hint
from pytpc.base.errors import InputError, TpcError
from pytpc.base.source_bytes import read_bytes
from pytpc.base.wording import listed, plain
from pytpc.build.nodes_env import nodes_env
from pytpc.lint.check import Checked, check, joined, without_ignored
from pytpc.lint.facts import Facts, Setting, last_part
from pytpc.lint.finding import KINDS, SEVERITIES, Evidence, Finding, Kind, Severity, Spot
from pytpc.processes.starts import files_of
from pytpc.ros.caller_env import with_callers
from pytpc.static.static_info import read_static
from pytpc.values.declared import declared_in
from pytpc.values.launch_kinds import is_of_ros2, is_yaml
from pytpc.values.ros2_arguments import origins_in_params
from pytpc.values.ros2_trace import trace_any_launch
from pytpc.values.trace import LaunchNode, Trace
from pytpc.values.yaml_tree import read_yaml, settings, value_of
from pytpc.workspace.packages import find_packages

__all__ = ["KINDS", "SEVERITIES", "Checked", "Evidence", "Finding", "Kind", "Linted", "Question"]
__all__ += ["Severity", "Spot", "lint"]

Progress = Callable[[int, int], None]
_IGNORED = re.compile(r"tpc-lint:\s*ignore\b(?P<kinds>[^>#]*)")
_LISTED = 8


@dataclass(frozen=True, slots=True)
class Question:
    """What is checked.

    ``workspace`` was built by `pytpc build`. ``launches`` are launch files, by their paths or by
    their names in the workspace, and YAML files of parameters, for ROS 1 as ``NODE=FILE``; empty:
    all launch files of the workspace's packages. ``args`` are launch arguments. ``missions`` are
    recordings of this robot.
    """

    workspace: Path
    launches: tuple[str, ...] = ()
    args: Mapping[str, str] = field(default_factory=dict)
    missions: tuple[Path, ...] = ()
    kinds: frozenset[Kind] = frozenset(KINDS)


@dataclass(frozen=True, slots=True)
class Linted:
    """The answer: what was found, in which files, and which launch files cannot be read, and why.

    ``is_all`` says that no file was named, so that all launch files of the workspace were checked
    that no other one includes.
    """

    checked: Checked
    files: tuple[Path, ...]
    unread: Mapping[Path, str] = field(default_factory=dict)
    is_all: bool = False


def lint(question: Question, on_progress: Progress | None = None) -> Linted:
    """Check the parameters of a robot; nothing is started.

    Args:
        question: what is checked.
        on_progress: called with (launch files read, all launch files).

    Raises:
        TpcError: the workspace is not built, or a file that was named cannot be read.
    """
    workspace = question.workspace
    env = with_callers(nodes_env(workspace), os.environ)
    static = read_static(workspace)
    packages = find_packages(workspace)
    folders = [package.path for package in packages]
    robot = Robot(static, processes(workspace), declared_in(static), env, folders)
    seen = recorded(question.missions, static) if question.missions else Recorded()
    files, params = _named(question)
    is_all = not question.launches
    if is_all:
        files = files_of(packages)[0]
    traces, unread = _traces(env, files, question.args, on_progress)
    if unread and not is_all:
        path, error = next(iter(unread.items()))
        raise InputError(error, path)
    if is_all:
        traces = _outermost(traces)
    started = robot.started | {node.name for trace in traces for node in trace.nodes}
    known = [replace(robot.facts(trace), elsewhere=started) for trace in traces]
    checks = [_check(one, seen, question.kinds) for one in known]
    for node, path in params:
        checks.append(_check(_facts_of_params(robot, node, path), seen, question.kinds))
    found = joined(checks)
    checked = without_ignored(found, _ignored(found.findings))
    read = [trace.launch for trace in traces if trace.launch is not None]
    return Linted(checked, (*read, *(path for _, path in params)), unread, is_all)


def _check(facts: Facts, seen: Recorded, kinds: Collection[Kind]) -> Checked:
    with_recorded = replace(facts, changes=seen.changes, crossings=seen.crossings)
    return check(with_recorded, kinds)


def _named(question: Question) -> tuple[list[Path], list[tuple[str, Path]]]:
    """The launch files that were named, and the files of parameters with their nodes."""
    launches: list[Path] = []
    params: list[tuple[str, Path]] = []
    for word in question.launches:
        node, equals, file = word.partition("=")
        if equals and not Path(word).exists():
            path = Path(file)
            if not path.is_file():
                raise InputError(f"no such file{path_hint(path)}", path)
            params.append((f"/{node.strip('/')}", path.absolute()))
        elif Path(word).is_file() and is_yaml(Path(word)):
            path = Path(word).absolute()
            if not is_of_ros2(path):
                raise InputError(
                    f"say which node reads it: /NODE={plain(word)}, or give the launch file", path
                )
            params.append(("", path))
        else:
            launches.append(_launch(question.workspace, word))
    return launches, params


def _launch(workspace: Path, word: str) -> Path:
    """The launch file that a word means: a path, or the name of a file in the workspace."""
    path = Path(word)
    if path.is_file():
        return path.absolute()
    files = files_of(find_packages(workspace))[0]
    meant = [one for one in files if f"/{one}".endswith(f"/{word}")]
    if len(meant) == 1:
        return meant[0]
    if meant:
        names = listed([str(one) for one in meant], _LISTED)
        raise InputError(f"several launch files are called {plain(word)}; give one: {names}")
    hint = did_you_mean(word, [one.name for one in files])
    raise InputError(f"no such launch file in the workspace{hint}", path)


def _traces(
    env: Mapping[str, str],
    files: Sequence[Path],
    args: Mapping[str, str],
    on_progress: Progress | None,
) -> tuple[list[Trace], dict[Path, str]]:
    """What launch files set, and why some cannot be read."""

    def traced(path: Path) -> Trace | TpcError:
        try:
            return trace_any_launch(env, path, args)
        except TpcError as error:
            return error

    found: list[Trace] = []
    unread: dict[Path, str] = {}
    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        for number, (path, read) in enumerate(zip(files, pool.map(traced, files), strict=True), 1):
            if on_progress is not None:
                on_progress(number, len(files))
            if isinstance(read, TpcError):
                unread[path] = read.message
            else:
                found.append(read)
    return found, unread


def _outermost(traces: Sequence[Trace]) -> list[Trace]:
    """Those that no other one includes: what an included one needs, the outer one may set."""
    inner = {
        Path(name).resolve()
        for trace in traces
        for name in trace.files
        if trace.launch is not None and Path(name).resolve() != trace.launch.resolve()
    }
    return [one for one in traces if one.launch is not None and one.launch.resolve() not in inner]


def _facts_of_params(robot: Robot, node: str, path: Path) -> Facts:
    """The facts of one file of parameters: of ROS 2, or of ROS 1 for a node."""
    if node and not is_of_ros2(path):
        found = list(_settings_in(path, node))
        names = [node]
    else:
        origins = origins_in_params(path, f"{node}/x" if node else None)
        trace = Trace(None, {}, {}, (), {}, placed=origins)
        found = settings_of(trace)
        names = sorted({one.name.rpartition("/")[0] for one in found})
    nodes = [_node_called(robot, name) for name in names]
    wanted = frozenset(last_part(one.name) for one in found)
    known = [robot.node(one, nodes, wanted) for one in nodes]
    return Facts(found, known, robot.declared, robot.set_by_code)


def _node_called(robot: Robot, name: str) -> LaunchNode:
    """The node of a name: one that a launch file starts so, or the program of that name."""
    last = last_part(name)
    for process in robot.processes.found:
        for start in process.starts:
            if start.node == name:
                package, _, program = process.program.partition("/")
                return LaunchNode(name, package, program, start.path, start.line, 0)
    for unit in robot.static.units:
        own = unit.link_unit.rpartition("/")[2].removesuffix(".py")
        if last == own:
            return LaunchNode(name, unit.package, unit.link_unit, Path(), 0, 0)
    return LaunchNode(name, "", last, Path(), 0, 0)


def _settings_in(path: Path, node: str) -> Iterator[Setting]:
    """The values of a YAML file that is loaded in the namespace of a node.

    Raises:
        InputError: it is not YAML.
    """
    try:
        documents = read_yaml(read_bytes(path).decode("utf-8-sig", "replace"))
        found = settings(documents[0]) if documents else {}
        for keys, one in found.items():
            name = "/".join((node, *keys))
            yield Setting(name, value_of(one.node), Spot(str(path), one.node.lineno))
    except ValueError as error:
        raise InputError(str(error), path) from error


def _ignored(findings: Iterable[Finding]) -> Iterator[Finding]:
    """The findings that a comment in their line takes back: ``tpc-lint: ignore KIND``."""
    for one in findings:
        said = _IGNORED.search(_line(one.spot))
        if said is not None:
            kinds = re.findall(r"[a-z][a-z-]*[a-z]", said["kinds"])
            if not kinds or one.kind in kinds:
                yield one


@lru_cache(maxsize=512)
def _lines(path: str) -> tuple[str, ...]:
    try:
        return tuple(read_bytes(Path(path)).decode("utf-8", "replace").splitlines())
    except InputError:
        return ()


def _line(spot: Spot) -> str:
    lines = _lines(spot.path)
    return lines[spot.lineno - 1] if 0 < spot.lineno <= len(lines) else ""
