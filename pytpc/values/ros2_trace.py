"""The values that a launch file of ROS 2 gives to nodes, each with the file and line.

``pytpc.values.tracer.ros2_launch_tracer`` runs launch itself under ROS's Python and says what each
node would be started with. What a node then takes of it, `ParamsStore` works out as rcl does.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from pytpc.base.errors import InputError, MissingToolError
from pytpc.base.source_bytes import read_bytes
from pytpc.values.installed import source_of
from pytpc.values.launch_kinds import is_ros2_launch
from pytpc.values.origins import IN_ARGS, Origin
from pytpc.values.rcl_params import Held, NodeEntry, ParamsError, ParamsStore, Written
from pytpc.values.trace import (
    LaunchNode,
    Trace,
    TracerError,
    interpreter_of,
    pairs,
    run_tracer,
    trace_launch,
)
from pytpc.values.yaml_tree import value_of
from pytpc.workspace.ros2 import SYSTEM_PYTHON, likely_pythons, named_python

_TRACER = Path(__file__).with_name("tracer") / "ros2_launch_tracer.py"
_PATIENCE_S = 60.0
OF_ROS2 = "ros2"
"""The ``param_type`` of what stands in a launch file of ROS 2."""
_COMMAND_LINE = "command line"
_COMMAND_OUTPUT = "__tpc_output_of_a_command"
Fields = Mapping[str, Any]


def trace_ros2_launch(
    env: Mapping[str, str],
    launch: Path,
    args: Mapping[str, str],
    *,
    patience_s: float = _PATIENCE_S,
    python: str = "",
) -> Trace:
    """Read a launch file as `ros2 launch` would, and start nothing.

    Args:
        env: the environment of the workspace, in which packages are found.
        launch: the launch file: Python (which is run), XML or YAML.
        args: its arguments, as on the command line of `ros2 launch`.
        patience_s: how long it may take.
        python: the interpreter that has launch; empty: that of `ros2`, or of the PATH.

    Raises:
        InputError: launch would not take the file, or rcl a params file.
        MissingToolError: launch_ros is not installed for the Python of ROS 2.
        RunError: it does not end.
    """
    if not launch.is_file():
        raise InputError("no such launch file", launch)
    python = python or _launch_python(env)
    try:
        answer = run_tracer([python, str(_TRACER)], env, launch, args, patience_s=patience_s)
    except TracerError as error:
        if error.why.startswith("ModuleNotFoundError"):
            raise MissingToolError(
                f"{python} cannot import launch_ros ({error.why.partition(': ')[2]}); source ROS 2:"
                " source /opt/ros/DISTRO/setup.bash"
            ) from None
        raise InputError(f"launch cannot read it: {error.short}", launch) from None
    placed = NodeOrigins().of_nodes(answer["nodes"])
    settings = {name: [{"value": origin.value}] for name, origin in placed.items()}
    nodes = [_launch_node(node) for node in answer["nodes"]]
    return Trace(
        launch.absolute(),
        dict(args),
        settings,
        nodes,
        answer["files"],
        placed=placed,
        unknown=tuple(map(str, answer["unknown"])),
    )


def trace_any_launch(
    env: Mapping[str, str],
    launch: Path,
    args: Mapping[str, str],
    *,
    patience_s: float = _PATIENCE_S,
    ros2_python: str = "",
) -> Trace:
    """What a launch file of either ROS sets, as roslaunch or launch reads it.

    Args:
        env: the environment of the workspace, in which packages are found.
        launch: the launch file.
        args: its arguments.
        patience_s: how long it may take.
        ros2_python: the interpreter that has launch, if it is known to be a file of ROS 2.

    Raises:
        TpcError: as `trace_launch` and `trace_ros2_launch`.
    """
    if is_ros2_launch(launch) or ros2_python:
        return trace_ros2_launch(env, launch, args, patience_s=patience_s, python=ros2_python)
    return trace_launch(env, launch, args, patience_s=patience_s)


def _launch_python(env: Mapping[str, str]) -> str:
    """The Python that has launch: that of the user, of the program ros2, or of rclpy."""
    path = env.get("PATH")
    if named_python(env) is None and shutil.which("ros2", path=path) is not None:
        return interpreter_of("ros2", path)
    return str(next(iter(likely_pythons(env)), SYSTEM_PYTHON))


def _launch_node(node: Fields) -> LaunchNode:
    place = node["place"]
    return LaunchNode(
        node["name"],
        node["package"],
        node["program"],
        Path(place.get("file", "")),
        int(place.get("lineno", 0)),
        0,
        container=node.get("container", ""),
        remaps=pairs(node.get("remaps", ())),
    )


class NodeOrigins:
    """Turns what nodes are started with into origins."""

    def __init__(self) -> None:
        self._lines = cache(lambda path: _bytes_of(path).split(b"\n"))
        self._source = cache(source_of)

    def of_nodes(self, nodes: Iterable[Fields]) -> dict[str, Origin]:
        """The origins of all values, by full name.

        Raises:
            InputError: rcl refuses a params file or a rule.
        """
        found: dict[str, Origin] = {}
        entries: dict[str, NodeEntry] = {}
        for node in nodes:
            for held in self._held(node).values():
                holds = held.slot.holds
                if holds is None:
                    continue
                name = f"{node['name']}/{held.slot.name}"
                entries[name] = held.entry
                found[name] = self._origin(node, name, held, holds)
        return self._with_counts(found, entries)

    def _with_counts(
        self, found: dict[str, Origin], entries: Mapping[str, NodeEntry]
    ) -> dict[str, Origin]:
        """The origins, with a note where an entry of a params file is for several nodes."""
        at: dict[object, int] = {}
        for one in found.values():
            place = (one.path, one.lineno, one.keys)
            at[place] = at.get(place, 0) + 1
        for name, one in found.items():
            if one.kind == "yaml" and entries[name].is_wildcard:
                count = at[one.path, one.lineno, one.keys]
                who = f"{count} nodes" if count > 1 else "every node that it fits, here one"
                note = f"{entries[name].written} sets it for {who}"
                found[name] = replace(one, note="; ".join(filter(None, (note, one.note))))
        return found

    def _held(self, node: Fields) -> dict[str, Held]:
        store = ParamsStore()
        composed: dict[str, Held] = {}
        for number, step in enumerate(node["steps"]):
            place = step.get("place", {})
            in_file = "file" in step and not step.get("inline")
            where = Path(step["file"] if in_file else place.get("file", ""))
            try:
                if node["composed"]:
                    _compose(composed, node["name"], step, number)
                elif "rule" in step:
                    store.set_rule(step["rule"])
                else:
                    store.load(step["text"].removeprefix("\ufeff"))
            except ParamsError as error:
                lineno = error.lineno if in_file else place.get("lineno")
                raise InputError(str(error), where if where.name else None, lineno) from error
        return composed if node["composed"] else store.of_node(node["name"])

    def _origin(self, node: Fields, name: str, held: Held, holds: Written) -> Origin:
        origin = self._at(node["steps"][holds.step], name, held.slot.name, holds)
        others = (
            self._at(node["steps"][one.step], name, held.slot.name, one) for one in held.overridden
        )
        earlier = dict.fromkeys(one.words() for one in others if one.path is not None)
        notes = [origin.note]
        if held.slot.is_stale:
            notes.append("a later value of another type does not replace it")
        if not node["named"]:
            notes.append("the launch file does not name the node; its code does")
        note = "; ".join(filter(None, notes))
        kept = tuple(one for one in earlier if one != origin.words())
        return replace(origin, overridden=kept, note=note)

    def _at(self, step: Fields, name: str, own: str, written: Written) -> Origin:
        place = step.get("names", {}).get(own, step.get("place", {}))
        via = tuple(place.get("via", ()))
        if "file" in step and not step.get("inline"):
            path = Path(step["file"])
            note = ""
            text = self._line(path, written.lineno)
            if step.get("text", "").encode() != _bytes_of(path) and "$(" in text:
                note = "launch substitutes a part of it"
            return Origin(
                name, "yaml", written.value, path, written.lineno, text, (*via, *_words(place)),
                note, keys=written.keys, source=self._source(path),
            )  # fmt: skip
        return self._in_launch(step, name, written.value, place, via)

    def _in_launch(
        self, step: Fields, name: str, value: object, place: Fields, via: tuple[str, ...]
    ) -> Origin:
        argument = place.get("argument")
        origin = Origin(name, "launch", value, None, None, "", via, param_type=OF_ROS2)
        note = ""
        if argument is not None:
            source = argument["place"]
            origin = replace(origin, argument=argument["name"])
            if source.get("tag") == _COMMAND_LINE:
                note = f"{argument['name']}:={value} on the command line of ros2 launch"
                origin = replace(origin, kind="argument", note=note)
            elif source.get("file"):
                note = f"argument {argument['name']}, which may be used elsewhere, too"
                origin = replace(origin, via=(*source.get("via", via), *_words(place)))
                place = source
        elif "rule" in step and "names" not in step and "value" not in step and not place:
            note = f"{IN_ARGS}: {step['rule']}"
        elif place.get("vague"):
            note = "the line in it is not known"
        if _COMMAND_OUTPUT in str(value):
            note = "the output of a command, which is not run"
        if not place.get("file"):
            return replace(origin, note=note)
        path, lineno = Path(place["file"]), int(place["lineno"])
        text = self._line(path, lineno)
        return replace(
            origin, path=path, lineno=lineno, text=text, note=note, source=self._source(path)
        )

    def _line(self, path: Path, lineno: int | None) -> str:
        lines = self._lines(path)
        if lineno is None or not 0 < lineno <= len(lines):
            return ""
        return lines[lineno - 1].decode("utf-8", "replace").strip()


def _compose(held: dict[str, Held], node: str, step: Fields, number: int) -> None:
    """Take what launch itself sends to a container: `/**`, then the full name; later files win.

    Raises:
        ParamsError: the file is not as rcl reads it.
    """
    for entry, name, one in _sent(node, step, number):
        before = held.get(name)
        slot = NodeEntry(entry.written).slot(name)
        slot.by_type["string"] = one
        slot.all.append(one)
        earlier = [] if before is None else [*before.overridden, *before.slot.all]
        held[name] = Held(entry, slot, earlier)


def _sent(node: str, step: Fields, number: int) -> Iterator[tuple[NodeEntry, str, Written]]:
    if "values" in step:
        for name, value in step["values"].items():
            yield NodeEntry(node), name, Written(value, number)
        return
    store = ParamsStore()
    store.load(step["text"].removeprefix("\ufeff"))
    for pattern in ("/**", node):
        for entry in store.entries:
            for slot in entry.slots if entry.pattern == pattern else ():
                if slot.all and slot.all[-1].node is not None:
                    last = slot.all[-1]
                    value = value_of(last.node) if last.node is not None else last.value
                    yield entry, slot.name, replace(last, step=number, value=value)


def _words(place: Fields) -> tuple[str, ...]:
    return (f"{place['file']}:{place['lineno']}",) if place.get("file") else ()


def _bytes_of(path: Path) -> bytes:
    try:
        return read_bytes(path)
    except InputError:
        return b""
