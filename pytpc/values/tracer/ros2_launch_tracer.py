"""Reads a launch file of ROS 2 with launch itself and says which line set which parameter.

A program of its own: it runs below ``pytpc.values.ros2_trace`` with the Python that launch has, and
needs nothing but launch and launch_ros. Nothing is started: what starts a process, waits or talks
to a graph is replaced. A launch file in Python is a program, which is run.

    python3 ros2_launch_tracer.py FILE [NAME:=VALUE]...

It prints one JSON object: ``nodes``, each with the parameters that it is started with in the order
of its command line; ``files`` with their SHA-256; ``unknown`` with what could not be followed.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import resource
import sys
import traceback
from pathlib import Path
from typing import Any

import launch
import launch.actions
import launch.substitutions
import launch_ros.actions
import launch_ros.descriptions
from launch.utilities import perform_substitutions
from launch_places import (
    Elements,
    Given,
    Place,
    argument_place,
    parameters_in_python,
    passed_in_python,
)
from launch_replaced import log_folder, replace_methods
from launch_ros.parameter_descriptions import Parameter, ParameterFile, ParameterValue
from launch_ros.utilities import evaluate_parameters

_MOST_MEMORY = 4 << 30
COMMAND_LINE = "command line"


class _Placed(str):
    """The value of a launch argument that knows where it was set; it survives launch's copies."""

    place: Place


class _PlacedPair(tuple):  # type: ignore[type-arg]
    """A parameter of SetParameter that knows where it was set."""

    place: Place
    names: dict[str, Place]


class Tracer:
    """Visits the actions of a launch file as launch would, and notes what nodes are given."""

    def __init__(self) -> None:
        self.files: dict[str, None] = {}
        self.nodes: list[dict[str, Any]] = []
        self.unknown: list[str] = []
        self.elements = Elements(self.files)
        self.context = launch.LaunchContext(argv=[])
        self._via: list[str] = []
        self._given: dict[str, str] = {}

    def read(self, path: str, words: list[str]) -> None:
        """Read a launch file; what launch raises is raised."""
        pairs = [tuple(word.split(":=", 1)) for word in words]
        self._given = dict(pairs)  # type: ignore[arg-type]
        for name, value in pairs:
            placed = _Placed(value)
            placed.place = {"tag": COMMAND_LINE, "name": name}
            self.context.launch_configurations[name] = placed
        source = launch.launch_description_sources.AnyLaunchDescriptionSource(path)
        include = launch.actions.IncludeLaunchDescription(source, launch_arguments=pairs)
        self.visit(include)

    def visit(self, entity: Given) -> None:
        """Execute an action and all that it leads to."""
        before = dict(self.context.launch_configurations)
        below = entity.visit(self.context) or []
        self._note_configurations(entity, before)
        way = []
        if isinstance(entity, launch.actions.IncludeLaunchDescription):
            here = self.place_of(entity)
            way = [f"{here['file']}:{here['lineno']}"] if here else []
            for one in below:
                if isinstance(one, launch.actions.SetLaunchConfiguration):
                    one.tpc_include = entity
        if isinstance(entity, launch.actions.RegisterEventHandler):
            below = [*below, *_of_handler(entity.event_handler)]
        self._via += way
        try:
            for one in below:
                self.visit(one)
        finally:
            if way:
                self._via.pop()

    def place_of(self, action: Given) -> Place | None:
        """Where an action is written."""
        element = getattr(action, "tpc_element", None)
        if element is not None:
            return self.elements.place(element)
        frame = getattr(action, "tpc_frame", None)
        return None if frame is None else {"file": frame[0], "lineno": frame[1]}

    def _value_place(self, action: Given, attribute: str, keyword: str, number: int) -> Place:
        """Where the value of an action is written; without a line if that is not known."""
        element, frame = getattr(action, "tpc_element", None), getattr(action, "tpc_frame", None)
        place = None
        if element is not None:
            place = self.elements.place(element, attribute)
        elif frame is not None:
            place = argument_place(frame, type(action).__name__, keyword, number)
        return {**(place or self.place_of(action) or {}), "via": list(self._via)}

    def _note_configurations(self, entity: Given, before: dict[str, str]) -> None:
        """Note where a launch argument got its value."""
        now = self.context.launch_configurations
        if isinstance(entity, launch.actions.DeclareLaunchArgument):
            name = entity.name
            if name in before or name not in now:
                return
            place = self._value_place(entity, "default", "default_value", 1)
            written = entity.default_value
        elif isinstance(entity, launch.actions.SetLaunchConfiguration):
            name = perform_substitutions(self.context, entity.name)
            if isinstance(now[name], _Placed):
                return
            include = getattr(entity, "tpc_include", None)
            place = self._value_place(entity, "value", "value", 1)
            if include is not None:
                place = {**self._passed_place(include, name), "via": list(self._via)}
            elif not place.get("file"):
                place = {"tag": COMMAND_LINE, "name": name}
            written = entity.value
        else:
            return
        passed = self.argument_in(written)
        if self._given.get(name) == now[name] and not place.get("file"):
            place = {"tag": COMMAND_LINE}
        value = _Placed(now[name])
        value.place = {"tag": "arg", **place, "name": name}
        if passed is not None:
            value.place = passed["place"]
        now[name] = value

    def _passed_place(self, include: Given, name: str) -> Place:
        """Where an include sets an argument."""
        element, frame = getattr(include, "tpc_element", None), getattr(include, "tpc_frame", None)
        place = None
        if element is not None:
            place = self.elements.passed(element, name)
        elif frame is not None:
            place = passed_in_python(frame, name)
        return place or self.place_of(include) or {}

    def argument_in(self, written: Given) -> dict[str, Given] | None:
        """The launch argument that is all of a value, and where it was set."""
        if isinstance(written, ParameterValue):
            # Its property has the value itself once that was worked out.
            written = written._ParameterValue__value
        if not isinstance(written, (list, tuple)) or len(written) != 1:
            return None
        if not isinstance(written[0], launch.substitutions.LaunchConfiguration):
            return None
        name = perform_substitutions(self.context, list(written[0].variable_name))
        value = self.context.launch_configurations.get(name)
        place = value.place if isinstance(value, _Placed) else {"tag": "unknown"}
        return {"name": place.get("name", name), "place": place}

    def set_parameter(self, action: Given, before: int) -> None:
        """Note where the parameters were set that SetParameter and others have added."""
        given = self.context.launch_configurations.get("global_params", [])
        for number in range(before, len(given)):
            pair = given[number]
            attribute = "filename" if isinstance(pair, str) else "value"
            place = self._value_place(
                action, attribute, attribute, 0 if isinstance(pair, str) else 1
            )
            if isinstance(pair, str):
                placed: Any = _Placed(pair)
            else:
                placed = _PlacedPair(pair)
                argument = self.argument_in(getattr(action, "value", None))
                if argument is not None:
                    place = {**place, "argument": argument}
            placed.place = place
            given[number] = placed

    def process(self, action: Given) -> None:
        """Note what a process would be started with."""
        is_node = isinstance(action, launch_ros.actions.Node)
        words = []
        # The program itself may not be built yet.
        for part in action.cmd[1:]:
            try:
                words.append(perform_substitutions(self.context, part))
            except Exception as error:
                self.unknown.append(f"an argument of a process: {error}")
        own = self._own(action) if is_node else []
        steps, names = _ros_arguments(words)
        if not is_node and "node" not in names:
            return
        given = list(self.context.launch_configurations.get("global_params", [])) if is_node else []
        tail = [*({"place": one.place} if hasattr(one, "place") else {} for one in given), *own]
        first = len(steps) - len(tail)
        for step, more in zip(steps[first:] if first >= 0 else [], tail):
            step.update(more)
        for step in steps:
            step.setdefault("place", self._value_place(action, "args", "ros_arguments", -1))
            self._read_file(step)
        self._add(action, self._name_of(action, names), steps)
        self.nodes[-1]["remaps"] = _remaps(words)

    def _name_of(self, action: Given, names: dict[str, str]) -> tuple[str, bool]:
        if isinstance(action, launch_ros.actions.Node) and "node" not in names:
            namespace = action.node_name.rpartition("/")[0]
            program = action.node_executable
            if not isinstance(program, str):
                program = perform_substitutions(self.context, list(program))
            return f"{namespace}/{Path(program).stem}".replace(
                "<node_namespace_unspecified>", ""
            ), False
        namespace = names.get("ns", "/").rstrip("/")
        return f"{namespace}/{names['node']}", True

    def _add(self, action: Given, name: tuple[str, bool], steps: list[dict[str, Given]]) -> None:
        place = self.place_of(action) or {"file": "", "lineno": 0}
        package = getattr(action, "node_package", None) or getattr(action, "package", "")
        program = getattr(action, "node_executable", None) or getattr(action, "node_plugin", "")
        full = name[0] if name[0].startswith("/") else f"/{name[0]}"
        self.nodes.append(
            {
                "name": full,
                "named": name[1],
                "package": self._text(package),
                "program": self._text(program),
                "place": {**place, "via": list(self._via)},
                "composed": isinstance(action, launch_ros.descriptions.ComposableNode),
                "steps": steps,
            }
        )

    def _text(self, given: Given) -> str:
        if isinstance(given, (list, tuple)):
            given = perform_substitutions(self.context, list(given))
        return str(given or "")

    def _own(self, action: Given) -> list[dict[str, Given]]:
        """The places of the parameters of a node, one for each that its command line has."""
        element, frame = getattr(action, "tpc_element", None), getattr(action, "tpc_frame", None)
        described: Any = getattr(action, "_Node__parameters", None)
        if described is None:
            described = getattr(action, "parameters", None) or []
        places: list[Any] = []
        if element is not None:
            places = self.elements.parameters(element)
        elif frame is not None:
            places = parameters_in_python(frame, type(action).__name__)
        found = []
        for number, one in enumerate(described):
            place, named = places[number] if number < len(places) else (None, {})
            place = {**(place or self.place_of(action) or {}), "via": list(self._via)}
            step: dict[str, Any] = {"place": place, "names": {}}
            if isinstance(one, ParameterFile):
                path = one.evaluate(self.context)
                if not path.is_file():
                    self.unknown.append(f"{path} is no file")
                    continue
                written = one._ParameterFile__param_file
                if isinstance(written, list):
                    written = perform_substitutions(self.context, written)
                step["written"] = str(Path(os.fsdecode(written)).absolute())
            elif isinstance(one, Parameter):
                name, _ = one.evaluate(self.context)
                step["names"] = {
                    name: self._named(named.get(name), place, one._Parameter__parameter_value)
                }
            else:
                for key, value in one.items():
                    name = perform_substitutions(self.context, list(key))
                    step["names"][name] = self._named(named.get(name), place, value)
                step["inline"] = True
            found.append(step)
        return found

    def _named(self, place: Place | None, other: Place, value: Given) -> Place:
        chosen = {**(place or {**other, "vague": True}), "via": list(self._via)}
        argument = self.argument_in(value)
        return chosen if argument is None else {**chosen, "argument": argument}

    def _read_file(self, step: dict[str, Given]) -> None:
        """Give a step with a file its text, which may be that of a file that launch has made."""
        if "file" not in step:
            return
        path = str(Path(step["file"]).absolute())
        step["text"] = Path(path).read_bytes().decode("utf-8", "replace")
        if step.get("inline"):
            Path(path).unlink()
        step["file"] = step.get("written", path)
        if not step.get("inline"):
            self.files[step["file"]] = None

    def container_of(self, given: Given) -> str:
        """The full name of a container, which is an action or a name."""
        name = getattr(given, "node_name", None)
        name = self._text(given) if name is None else str(name)
        name = name.replace("<node_namespace_unspecified>", "")
        return name if name.startswith("/") else f"/{name}"

    def composed(self, description: Given, container: str) -> None:
        """Note what a node in a container is given; launch itself reads its params files."""
        condition = description.condition()
        if condition is not None and not condition.evaluate(self.context):
            return
        name = self._text(description.node_name) if description.node_name else ""
        own = self._text(description.node_namespace) if description.node_namespace else ""
        base = self.context.launch_configurations.get("ros_namespace", "")
        namespace = own if own.startswith("/") else f"{base.rstrip('/')}/{own}".rstrip("/")
        steps: list[dict[str, Any]] = []
        for one in self.context.launch_configurations.get("global_params", []):
            place = getattr(one, "place", {})
            if isinstance(one, tuple):
                steps.append({"values": {one[0]: one[1]}, "place": place, "names": {one[0]: place}})
            else:
                steps.append({"file": str(one), "place": place})
        given = description.parameters or []
        for step, value in zip(self._own(description), evaluate_parameters(self.context, given)):
            known = {"values": value} if isinstance(value, dict) else {"file": str(value)}
            steps.append({**step, "inline": False, **known})
        for step in steps:
            self._read_file(step)
        plugin = self._text(description.node_plugin).rpartition("::")[2]
        self._add(description, (f"{namespace}/{name or plugin}", bool(name)), steps)
        self.nodes[-1]["container"] = container
        self.nodes[-1]["remaps"] = [
            [self._text(before), self._text(after)]
            for before, after in description.remappings or ()
        ]


def _ros_arguments(words: list[str]) -> tuple[list[dict[str, Given]], dict[str, str]]:
    """The files and rules of a command line in its order, and the new names of the node."""
    steps: list[dict[str, Any]] = []
    names: dict[str, str] = {}
    inside = False
    for word, following in zip(words, [*words[1:], ""]):
        if word == "--ros-args":
            inside = True
        elif word == "--":
            inside = False
        elif inside and word == "--params-file":
            steps.append({"file": following})
        elif inside and word in ("-p", "--param"):
            steps.append({"rule": following})
        elif inside and word in ("-r", "--remap"):
            what, assigned, name = following.partition(":=")
            if assigned and what in ("__node", "__name"):
                names.setdefault("node", name)
            elif assigned and what == "__ns":
                names.setdefault("ns", name)
    return steps, names


def _remaps(words: list[str]) -> list[list[str]]:
    """The new names of topics and services on a command line, in pairs."""
    found = []
    for word, following in zip(words, [*words[1:], ""]):
        before, assigned, after = following.partition(":=")
        # Names with two underscores are those of the node itself.
        if word in ("-r", "--remap") and assigned and not before.startswith("__"):
            found.append([before, after])
    return found


def _of_handler(handler: Given) -> list[Any]:
    """The actions of an event handler, as far as no function makes them."""
    for name in ("_OnActionEventBase__actions_on_event", "_EventHandler__entities"):
        actions = getattr(handler, name, None)
        if isinstance(actions, (list, tuple)):
            return list(actions)
    return []


def main(argv: list[str]) -> None:
    """See the module; status 1 and a line on standard error where launch would not start."""
    resource.setrlimit(resource.RLIMIT_AS, (_MOST_MEMORY, _MOST_MEMORY))
    tracer = Tracer()
    replace_methods(tracer)
    try:
        with contextlib.redirect_stdout(sys.stderr), log_folder():
            tracer.read(argv[0], argv[1:])
    except MemoryError:
        raise SystemExit(f"it needs more than {_MOST_MEMORY >> 20} MB of memory") from None
    except Exception as error:
        if os.environ.get("TPC_TRACEBACK"):
            traceback.print_exc()
        raise SystemExit(" ".join(f"{error or type(error).__name__}".split())) from error
    digests = {}
    for name in tracer.files:
        with contextlib.suppress(OSError):
            digests[name] = hashlib.sha256(Path(name).read_bytes()).hexdigest()
    answer = {"nodes": tracer.nodes, "files": digests, "unknown": tracer.unknown}
    json.dump(answer, sys.stdout, default=lambda _value: None)


if __name__ == "__main__":
    main(sys.argv[1:])
