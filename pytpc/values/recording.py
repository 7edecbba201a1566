"""Records, with a mission, where the values of its parameters came from."""

from __future__ import annotations

import glob
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from pytpc.base.errors import InputError, TpcError
from pytpc.base.source_bytes import read_bytes
from pytpc.values.origin_places import Places
from pytpc.values.origins import (
    ORIGINS_FILE,
    PARAMS_FILE,
    START_FILE,
    Origin,
    split_name,
    write_origins,
)
from pytpc.values.ros2_trace import trace_any_launch
from pytpc.values.scalars import same_value
from pytpc.values.trace import Trace, name_on_server
from pytpc.values.yaml_tree import YamlNode, read_yaml, settings, value_of

# The parameters of roslaunch and the master themselves.
OF_ROS = ("/rosdistro", "/rosversion", "/run_id", "/roslaunch", "/tcp_keepalive")
NO_LAUNCH = "the graph was already running, and no launch file was given"
BY_A_NODE = (
    "set by a program, not by the launch file; a node with dynamic_reconfigure writes all of its"
    " values when it starts"
)
NOT_SEEN = (
    "no command line with --ros-args on this machine is that of its node; the default, unless"
    " the node runs elsewhere"
)
MISSION_PATIENCE_S = 20.0
_OF_ROS2 = "ros__parameters"
_ENV_NAMES = (
    "ROS_PACKAGE_PATH",
    "CMAKE_PREFIX_PATH",
    "AMENT_PREFIX_PATH",
    "ROS_DISTRO",
    "ROS_ROOT",
)


def params_file(mission: Path) -> Path | None:
    """The dump of the parameter server that belongs to a recording; None if there is none.

    It is ``params.yaml`` in a mission's folder, also if its ``mission.bag`` is given. Beside any
    other file it is ``FILE.params.yaml``, or ``params.yaml`` if no other bag could mean it.
    """
    if mission.is_dir():
        found = mission / PARAMS_FILE
        return found if found.is_file() else None
    beside = mission.with_name(f"{mission.name}.{PARAMS_FILE}")
    if beside.is_file():
        return beside
    found = mission.with_name(PARAMS_FILE)
    pattern = f"*{glob.escape(mission.suffix)}"
    bags = [*mission.parent.glob(pattern)] if mission.suffix else []
    return found if found.is_file() and len(bags) <= 1 else None


def read_parameters(path: Path) -> dict[str, object]:
    """A dump of the parameter server (``rosparam dump``) by full names; lists are values.

    Raises:
        InputError: it cannot be read, or is not such a dump.
    """
    try:
        documents = read_yaml(read_bytes(path).decode())
    except ValueError as error:
        raise InputError(str(error), path) from error
    found = settings(documents[0]) if documents else {}
    if () in found:
        raise InputError("not a dump of the parameter server: it has no names", path)
    return {_full_name(keys): _value(setting.node) for keys, setting in found.items()}


def _full_name(keys: tuple[str, ...]) -> str:
    """The full name of a parameter; ROS 2 has its node before ``ros__parameters``, and dots."""
    if _OF_ROS2 not in keys:
        return "/" + "/".join(keys)
    at = keys.index(_OF_ROS2)
    node = "/".join(part.strip("/") for part in keys[:at])
    return f"/{node}/{'.'.join(keys[at + 1 :])}"


def _value(node: YamlNode) -> object:
    try:
        return value_of(node)
    except ValueError:
        # Binary data and dates are shown as they are written.
        return node.text


def is_of_ros(name: str) -> bool:
    """Whether a parameter is one of roslaunch or the master themselves."""
    return any(name == own or name.startswith(f"{own}/") for own in OF_ROS)


def origins_of(
    trace: Trace | None, at_end: Mapping[str, object], at_start: Mapping[str, object] | None = None
) -> dict[str, Origin]:
    """The origins of all values that stood on the server.

    Args:
        trace: what the launch file sets; None where that is not known.
        at_end: the server at the end of the mission, by full names.
        at_start: the same right after the launch; None if it was not read.
    """
    launched: dict[str, Origin] = {}
    if trace is not None:
        placed = Places(trace).origins() if trace.placed is None else trace.placed
        for name, origin in placed.items():
            for full, value in leaves(name_on_server(name, at_end), origin.value):
                launched[full] = replace(origin, name=full, value=value)
    found = {}
    for name in sorted({*at_end, *launched}):
        if not is_of_ros(name):
            origin = _origin(name, launched.get(name), at_end, at_start, trace is not None)
            found[name] = _declared(origin, trace, at_start)
    return found


def _declared(origin: Origin, trace: Trace | None, at_start: Mapping[str, object] | None) -> Origin:
    """The origin; of a node of ROS 2, which declares its parameters, it may be the default."""
    if trace is None or origin.note not in ("", BY_A_NODE) or origin.path is not None:
        return origin
    if origin.kind not in ("runtime", "unknown") or trace.placed is None:
        return origin
    before = (at_start or {}).get(origin.name, origin.value)
    if not same_value(before, origin.value):
        note = f"it was {before!r} when the recording began"
        return replace(origin, kind="runtime", note=note)
    if split_name(origin.name)[0] in trace.declaring:
        return replace(origin, kind="default", note="")
    return replace(origin, kind="unknown", note=NOT_SEEN)


def leaves(name: str, value: object) -> list[tuple[str, object]]:
    """A ``<param type="yaml">`` may be a map: below the name there are several parameters."""
    if not isinstance(value, dict) or not value:
        return [(name, value)]
    return [leaf for key, below in value.items() for leaf in leaves(f"{name}/{key}", below)]


def _origin(
    name: str,
    launched: Origin | None,
    at_end: Mapping[str, object],
    at_start: Mapping[str, object] | None,
    traced: bool,
) -> Origin:
    value = at_end.get(name)
    if launched is None:
        changed = at_start is not None and at_start.get(name, value) != value
        if traced or changed:
            return Origin(name, "runtime", value, None, None, "", note=BY_A_NODE)
        return Origin(name, "unknown", value, None, None, "")
    if name not in at_end:
        # A node has taken it away.
        note = f"{launched.words()} set it, and it was deleted at runtime"
        return Origin(name, "runtime", None, None, None, "", note=note)
    if launched.value is None or same_value(launched.value, value):
        return replace(launched, value=value)
    note = f"{launched.words()} set it to {launched.value!r}"
    return Origin(name, "runtime", value, None, None, "", launched.via, note)


def try_trace(
    env: Mapping[str, str], launch: Path, args: Mapping[str, str], ros2_python: str = ""
) -> tuple[Trace | None, str]:
    """``trace_any_launch``, or why it is not possible: no mission fails or waits long for that."""
    try:
        trace = trace_any_launch(
            env, launch, args, patience_s=MISSION_PATIENCE_S, ros2_python=ros2_python
        )
        return trace, ""
    except TpcError as error:
        return None, str(error)
    except Exception as error:
        # A mission matters more than its origins.
        return None, f"{launch} cannot be read: {error!r}"


def save_origins(
    folder: Path, params: Path, trace: Trace | None, reason: str, env: Mapping[str, str]
) -> None:
    """Write origins.json of a mission whose parameters were dumped.

    Args:
        folder: of the mission; ``params_start.yaml`` in it, the dump right after the launch, may
            be missing.
        params: the dump at the end; origins are written only where it is there.
        trace: what the launch file sets.
        reason: why there is no trace, empty where there is one.
        env: in which the launch file was read.

    An error becomes the ``reason`` why no origin is known: the mission was flown.

    Raises:
        TpcError: the file cannot be written.
    """
    if not params.is_file():
        return
    params_start = folder / START_FILE
    origins: dict[str, Origin] = {}
    try:
        at_start = read_parameters(params_start) if params_start.is_file() else None
        origins = origins_of(trace, read_parameters(params), at_start)
    except InputError as error:
        reason = str(error)
    except Exception as error:
        # The mission was flown.
        reason = f"where the values came from cannot be worked out: {error!r}"
    document: dict[str, object] = {
        "launch": None if trace is None or trace.launch is None else str(trace.launch),
        "args": {} if trace is None else dict(sorted(trace.args.items())),
        "env": {name: env[name] for name in _ENV_NAMES if name in env},
        "reason": reason,
        "files": {} if trace is None else dict(sorted(trace.files.items())),
        "nodes": [] if trace is None else [node.to_json() for node in trace.nodes],
    }
    write_origins(document, origins, folder / ORIGINS_FILE)
