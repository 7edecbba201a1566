"""Where a parameter's current value came from."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal, cast, get_args

from pytpc.base.atomic import write_atomic
from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError
from pytpc.static.parameters import DYNAMIC, resolved, same_parameter

ORIGINS_FILE = "origins.json"
PARAMS_FILE = "params.yaml"
START_FILE = "params_start.yaml"
SCHEMA = 1
IN_ARGS = "in the args of the node"
_QOS = "/qos_overrides."

OriginKind = Literal["yaml", "launch", "argument", "default", "runtime", "unknown"]


@dataclass(frozen=True, slots=True)
class Origin:
    """Where one value came from.

    ``name`` is the parameter's full name on the server (``/mission/min_coverage_limit``). ``kind``:
    a YAML file that a launch file loads, the launch file itself (``<param>``), an ``argument`` on
    roslaunch's command line, the default in the code (it is not set), set at ``runtime``.
    ``path`` and ``lineno`` are the place, ``text`` the source line; ``via`` the launch files on the
    way to it, ``note`` a sentence about an uncertainty. ``value`` is that of the server.

    ``keys`` are the keys in a YAML file from the top, ``argument`` the launch argument whose value
    this is, ``source`` the file that ``path`` is an installed copy of, ``overridden`` the places
    (``file:line``) that set it before and do not count, ``param_type`` the ``type`` of a
    ``<param>``.
    """

    name: str
    kind: OriginKind
    value: object
    path: Path | None
    lineno: int | None
    text: str
    via: tuple[str, ...] = ()
    note: str = ""
    keys: tuple[str, ...] = ()
    argument: str = ""
    source: Path | None = None
    overridden: tuple[str, ...] = ()
    param_type: str = ""

    def words(self) -> str:
        """``config/params.yaml:12``, ``default in the code``, ``set at runtime``."""
        if self.path is not None:
            return f"{self.path}:{self.lineno}" if self.lineno else str(self.path)
        if self.kind == "launch":
            return "args of the node" if self.note.startswith(IN_ARGS) else "launch file"
        return {"default": "default in the code", "runtime": "set at runtime"}.get(
            self.kind, "unknown"
        )


def split_name(parameter: str) -> tuple[str, str]:
    """The node and the name of a parameter; the node is empty where only a name is given.

    >>> split_name("/robot1/guard/limits.min"), split_name("min")
    (('/robot1/guard', 'limits.min'), ('', 'min'))
    >>> split_name("/guard/qos_overrides./scan.publisher.depth")
    ('/guard', 'qos_overrides./scan.publisher.depth')
    """
    node, qos, topic = parameter.partition(_QOS)
    if qos:
        return node, f"{qos[1:]}{topic}"
    node, _, name = parameter.rpartition("/")
    return node, name


def read_origins(mission: Path) -> Mapping[str, Origin]:
    """The origins that were recorded with a mission, by full name; empty if there are none.

    Args:
        mission: the folder of the mission, or its bag.

    Raises:
        InputError: origins.json is there and cannot be read.
    """
    path = origins_file(mission)
    if not path.is_file():
        return {}
    document = read_document(path)
    try:
        found = [_origin(name, entry) for name, entry in document["parameters"].items()]
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(f"not a file of origins: {error!r}", path) from error
    return {origin.name: origin for origin in found}


def origins_file(mission: Path) -> Path:
    """The file with the origins of a mission, given its folder or its bag."""
    return (mission if mission.is_dir() else mission.parent) / ORIGINS_FILE


def read_document(path: Path) -> dict[str, Any]:
    """origins.json as it is written.

    Raises:
        InputError: it cannot be read, or is of another version.
    """
    document = parse_json(path)
    if not isinstance(document, dict) or document.get("schema") != SCHEMA:
        raise InputError(f"not a file of origins of version {SCHEMA}", path)
    return document


def _origin(name: str, entry: Mapping[str, Any]) -> Origin:
    kind = entry["kind"]
    if kind not in get_args(OriginKind):
        raise ValueError(f"kind {kind!r}")
    path, source = entry.get("path"), entry.get("source")
    lineno = entry.get("lineno")
    return Origin(
        name=name,
        kind=cast(OriginKind, kind),
        value=from_json(entry["value"]),
        path=None if path is None else Path(path),
        lineno=None if lineno is None else int(lineno),
        text=str(entry.get("text", "")),
        via=tuple(map(str, entry.get("via", ()))),
        note=str(entry.get("note", "")),
        keys=tuple(map(str, entry.get("keys", ()))),
        argument=str(entry.get("argument", "")),
        source=None if source is None else Path(source),
        overridden=tuple(map(str, entry.get("overridden", ()))),
        param_type=str(entry.get("param_type", "")),
    )


def write_origins(document: Mapping[str, Any], origins: Mapping[str, Origin], path: Path) -> None:
    """Write origins.json: ``document`` with the origins in it.

    Raises:
        TpcError: the file cannot be written.
    """
    parameters = {name: as_json(origins[name]) for name in sorted(origins)}
    whole = {"schema": SCHEMA, **document, "parameters": parameters}
    write_atomic(path, json.dumps(whole, indent=1, allow_nan=False).encode() + b"\n")


def as_json(origin: Origin) -> dict[str, object]:
    """The fields of an origin except its name, without empty ones."""
    said = asdict(origin)
    kind, value = said.pop("kind"), said.pop("value")
    del said["name"]
    given = {field: text for field, text in said.items() if text not in (None, "", ())}
    shown = {field: str(x) if isinstance(x, Path) else x for field, x in given.items()}
    return {"kind": kind, "value": to_json(value), **shown}


def to_json(value: object) -> object:
    """A value in strict JSON: NaN and the infinities as ``{"yaml": ".nan"}``, dates as text."""
    if isinstance(value, float) and not math.isfinite(value):
        return {"yaml": ".nan" if math.isnan(value) else ".inf" if value > 0 else "-.inf"}
    if isinstance(value, list | tuple):
        return [to_json(item) for item in value]
    if isinstance(value, dict):
        return {str(key): to_json(item) for key, item in value.items()}
    return value if value is None or isinstance(value, bool | int | float | str) else str(value)


def from_json(value: object) -> object:
    """The reverse of ``to_json``."""
    if isinstance(value, dict):
        if set(value) == {"yaml"}:
            return float(str(value["yaml"]).replace(".", ""))
        return {key: from_json(item) for key, item in value.items()}
    if isinstance(value, list):
        return [from_json(item) for item in value]
    return value


def origin_for(
    origins: Mapping[str, Origin], source: str, node: str, default: object
) -> Origin | None:
    """The origin of a parameter as the source names it (``~limit``, ``limit``, ``/a/limit``).

    Args:
        origins: of a mission; empty if they are not known.
        source: the name in the source, with ``<dynamic>`` for what only the running node knows.
        node: the node's full name, whose namespace the name is in; empty where it is not known.
        default: the default in the code, which applies where no value is set.

    Returns:
        None where nothing is known: no origins, a name that is dynamic as a whole, or one that
        fits several parameters of several nodes.
    """
    if not origins or source == DYNAMIC:
        return None
    node = node.partition(" ")[0]
    own = node if node.startswith("/") and len(node) > 1 else ""
    if DYNAMIC not in source and (own or source.startswith("/")):
        name = resolved(source, own)
        return origins.get(name) or _default(name, default)
    fitting = [name for name in origins if same_parameter(name, source)]
    below = [name for name in fitting if own and name.startswith(f"{own}/")]
    chosen = below or fitting
    if len(chosen) == 1:
        return origins[chosen[0]]
    if not chosen and DYNAMIC not in source:
        return _default(source, default)
    return None


def _default(name: str, default: object) -> Origin:
    note = "" if default is not None else "the default is not known"
    return Origin(name, "default", default, None, None, "", note=note)
