"""Reads a launch file with roslaunch's own loader and says which line set which parameter.

A program of its own: it runs below ``pytpc.values.trace`` with the Python that roslaunch has (3.8
on Noetic), in the environment of the workspace, and needs nothing but roslaunch. Nothing is
started, and what a ``<param command=...>`` would run is not run: a command may do anything.

    python3 launch_tracer.py FILE [NAME:=VALUE]...

It prints one JSON object: ``parameters`` by full name, each a list of settings of which the last
holds; ``nodes`` as `pytpc.values.trace.LaunchNode` has them; ``absent`` the package and program of
those that roslaunch would not find on this machine; ``files`` with their SHA-256.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import re
import resource
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, cast
from xml.dom import expatbuilder

import yaml
from rosgraph.names import canonicalize_name, ns_join
from roslaunch.config import ROSLaunchConfig
from roslaunch.core import RLException
from roslaunch.xmlloader import XmlLoader, XmlParseException
from roslib.packages import find_node
from rospkg import ResourceNotFound, RosPack

_MOST_MEMORY = 1 << 30
_MOST_VALUES = 1000000
COMMAND_LINE = "command line"
ANONYMOUS = "__tpc_anon"
_PRIVATE = re.compile(r"(?:^|\s)_([A-Za-z][\w/]*):=(\S+)")
_ANON = re.compile(r"\$\(anon\s+([^)\s]+)\s*\)")

# roslaunch has no types. A tag is a minidom element, a context its LoaderContext.
_Tag = Any
_Context = Any
_Loaded = Any


class _Builder(expatbuilder.ExpatBuilderNS):
    """Keeps of each element the line and the byte at which it begins."""

    def start_element_handler(self, name: str, attributes: list[str]) -> None:
        super().start_element_handler(name, attributes)
        parser, tag = self.getParser(), cast(_Tag, self.curNode)
        tag.tpc_line = parser.CurrentLineNumber
        tag.tpc_offset = parser.CurrentByteIndex


class _Placed(str):
    """The value of an <arg> that knows where it was set; it survives roslaunch's copies."""

    place: dict[str, Any]


class _Config(ROSLaunchConfig):  # type: ignore[misc]
    """Notes for each parameter the tag that is being read."""

    def __init__(self) -> None:
        super().__init__()
        self.settings: dict[str, list[dict[str, Any]]] = {}
        self.place_of: Callable[[str], dict[str, Any]] = lambda _key: {"tag": "unknown"}
        self.replaced: dict[str, list[dict[str, Any]]] = {}

    def add_param(self, p: _Loaded, filename: str | None = None, verbose: bool = True) -> None:
        super().add_param(p, filename=filename, verbose=verbose)
        earlier = self.replaced.pop(p.key, [])
        place = {**self.place_of(p.key), "value": p.value}
        self.settings.setdefault(p.key, []).extend([*earlier, place])


class _Tracer(XmlLoader):  # type: ignore[misc]
    """roslaunch's loader, which tells ``_Config`` where it is."""

    def __init__(self, config: _Config) -> None:
        super().__init__()
        # Whether an <arg> is missing is roslaunch's to say.
        self.ignore_unset_args = False
        self.files: dict[str, str] = {}
        self.nodes: list[dict[str, Any]] = []
        self.programs: dict[tuple[str, str], None] = {}
        self.of_nodes: list[tuple[str, dict[str, Any]]] = []
        self._via: list[str] = []
        self._tag_place: dict[str, Any] | None = None
        self._node_params: dict[str, dict[str, Any]] = {}
        self._in_node = False
        self._config = config
        config.place_of = self._place_of

    def resolve_args(self, args: str, context: _Context) -> str:
        # The random name of $(anon x) would not be that of the run.
        for name in _ANON.findall(args or ""):
            context.resolve_dict.setdefault("anon", {})[name] = name + ANONYMOUS
        resolved: str = super().resolve_args(args, context)
        return resolved

    def _place_of(self, key: str) -> dict[str, Any]:
        if self._tag_place is not None:
            return self._tag_place
        # roslaunch gives a node its private parameters when all of its tag was read.
        unknown: dict[str, Any] = {"tag": "unknown"}
        return self._node_params.get(key, unknown)

    def _parse_launch(self, filename: str, verbose: bool) -> _Tag:
        try:
            data = Path(filename).read_bytes()
            root = _Builder().parseString(data).getElementsByTagName("launch")
        except Exception as error:
            raise XmlParseException(f"Invalid roslaunch XML syntax: {error}") from error
        if len(root) != 1:
            raise XmlParseException("Invalid roslaunch XML syntax: no root <launch> tag")
        self.files[filename] = hashlib.sha256(data).hexdigest()
        return root[0]

    def _here(self, tag: _Tag, context: _Context) -> dict[str, Any]:
        return {
            "tag": tag.tagName,
            "file": context.filename,
            "lineno": tag.tpc_line,
            "offset": tag.tpc_offset,
            "via": list(self._via),
        }

    def _param_tag(self, tag: _Tag, context: _Context, *args: object, **options: object) -> _Loaded:
        place = self._here(tag, context)
        for name in ("value", "textfile", "binfile", "command"):
            if tag.hasAttribute(name):
                place["from"], place["written"] = name, tag.getAttribute(name)
        place["type"] = (tag.getAttribute("type") or "auto").lower().strip()
        self._note_arguments(place, context)
        self._tag_place = place
        try:
            param = super()._param_tag(tag, context, *args, **options)
        finally:
            self._tag_place = None
        if param is not None:
            param.tpc_place = place
            key = canonicalize_name(context.ns + param.key.lstrip("~"))
            if self._in_node and key in self._node_params:
                # Of two in one <node>, roslaunch forgets the first.
                self._config.replaced.setdefault(key, []).append(self._node_params[key])
            place["value"] = param.value
            self._node_params[key] = place
        return param

    def param_value(
        self, verbose: bool, name: str, ptype: str, value: str | None, *others: str | None
    ) -> _Loaded:
        if value is None:
            return None
        return super().param_value(verbose, name, ptype, value, *others)

    def load_rosparam(
        self,
        context: _Context,
        ros_config: _Config,
        cmd: str,
        param: str,
        file_: str | None,
        *text: str,
        **options: object,
    ) -> None:
        place = self._tag_place
        if place is not None:
            place["from"] = "file" if file_ else "text"
            place["base"] = ns_join(context.ns, param) if param else context.ns
            place["substituted"] = options.get("subst_function") is not None
            if file_:
                place["yaml"] = file_
        data = b""
        if file_:
            with contextlib.suppress(OSError):
                data = Path(file_).read_bytes()
                self.files[file_] = hashlib.sha256(data).hexdigest()
        else:
            data = str(text[0] if text else "").encode()
        _check_yaml(data)
        super().load_rosparam(context, ros_config, cmd, param, file_, *text, **options)

    def _rosparam_tag(
        self, tag: _Tag, context: _Context, *args: object, **options: object
    ) -> _Loaded:
        place = self._here(tag, context)
        if tag.hasAttribute("file"):
            place["written"] = tag.getAttribute("file")
            self._note_arguments(place, context)
        self._tag_place = place
        try:
            return super()._rosparam_tag(tag, context, *args, **options)
        finally:
            self._tag_place = None

    def _node_tag(self, tag: _Tag, context: _Context, *args: object, **options: object) -> _Loaded:
        (name, own_ns) = self.opt_attrs(tag, context, ("name", "ns"))
        below = context.child(own_ns).child(name or "").ns
        self._node_params = {
            canonicalize_name(below + param.key.lstrip("~")): param.tpc_place
            for param in context.params
            if hasattr(param, "tpc_place")
        }
        self._in_node = True
        self._config.replaced = {}
        try:
            node = super()._node_tag(tag, context, *args, **options)
        finally:
            self._in_node = False
        self._node_params = {}
        self._config.replaced = {}
        if node is not None:
            full = canonicalize_name(ns_join(node.namespace, node.name))
            here = self._here(tag, context)
            place = {"path": here["file"], "lineno": here["lineno"], "offset": here["offset"]}
            what = {"name": full, "package": node.package, "program": node.type}
            what["args"] = node.args or ""
            what["remaps"] = [[str(before), str(after)] for before, after in node.remap_args or ()]
            self.nodes.append({**what, **place})
            if not node.machine_name:
                self.programs[node.package, node.type] = None
            # The node sets these itself when it starts, so they come after all others.
            for name, value in _PRIVATE.findall(node.args or ""):
                written = f"_{name}:={value}"
                place = {**here, "from": "args", "written": written, "value": _guessed(value)}
                self.of_nodes.append((canonicalize_name(f"{full}/{name}"), place))
        return node

    def _arg_tag(self, tag: _Tag, context: _Context, *args: object, **options: object) -> _Loaded:
        name = tag.getAttribute("name")
        before = self._argument(context, name)
        place = {**self._here(tag, context), "name": name}
        for attribute in ("value", "default"):
            if tag.hasAttribute(attribute):
                place["from"], place["written"] = attribute, tag.getAttribute(attribute)
        self._note_arguments(place, context)
        result = super()._arg_tag(tag, context, *args, **options)
        after = self._argument(context, name)
        if after is None:
            return result
        if not isinstance(after, _Placed):
            if before is not None:
                # Only roslaunch's command line sets one before any tag.
                place = {"tag": COMMAND_LINE, "name": name, "declared": place}
            value = _Placed(after)
            value.place = {**place, "value": str(after)}
            self._arguments_of(context)[name] = value
        return result

    @staticmethod
    def _arguments_of(context: _Context) -> dict[str, str]:
        inner = context.include_resolve_dict
        chosen: dict[str, Any] = context.resolve_dict if inner is None else inner
        arguments: dict[str, str] = chosen.setdefault("arg", {})
        return arguments

    def _argument(self, context: _Context, name: str) -> str | None:
        return self._arguments_of(context).get(name)

    @staticmethod
    def _note_arguments(place: dict[str, Any], context: _Context) -> None:
        """Note where the arguments that stand in ``written`` were set."""
        written = place.get("written", "")
        known: dict[str, str] = context.resolve_dict.get("arg", {})
        places = {
            name: value.place if isinstance(value, _Placed) else {"tag": COMMAND_LINE}
            for name, value in known.items()
            if "$(" in written and name in written
        }
        if places:
            place["arguments"] = places

    def _include_tag(
        self, tag: _Tag, context: _Context, *args: object, **options: object
    ) -> _Loaded:
        self._via.append(f"{context.filename}:{tag.tpc_line}")
        try:
            return super()._include_tag(tag, context, *args, **options)
        finally:
            self._via.pop()


def _guessed(text: str) -> bool | int | float | str:
    """The value of ``_name:=text`` as roscpp and rospy read it."""
    for kind in (int, float):
        with contextlib.suppress(ValueError):
            return kind(text)
    return {"true": True, "false": False}.get(text.lower(), text)


def _absent(programs: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    """The programs that are not there."""
    packages, absent = RosPack(), []
    for package, program in programs:
        try:
            if find_node(package, program, packages):
                continue
        except (ResourceNotFound, OSError):
            pass
        absent.append((package, program))
    return absent


def _check_yaml(data: bytes) -> None:
    """Check that aliases do not multiply the values of a YAML text beyond all use.

    Raises:
        ValueError: they do.
    """
    sizes: dict[int, int] = {}

    def size(node: yaml.Node) -> int:
        if id(node) not in sizes:
            # One that contains itself ends here.
            sizes[id(node)] = 1
            below = node.value if isinstance(node, yaml.CollectionNode) else []
            parts = [part for one in below for part in (one if isinstance(one, tuple) else (one,))]
            sizes[id(node)] += sum(size(part) for part in parts)
        return sizes[id(node)]

    try:
        documents = list(yaml.compose_all(data, yaml.SafeLoader))
        most = max((size(one) for one in documents if one is not None), default=0)
    except (yaml.YAMLError, RecursionError, ValueError):
        # roslaunch says what is wrong.
        return
    if most > _MOST_VALUES:
        raise ValueError(f"YAML with more than {_MOST_VALUES:,} values, with its aliases")


def main(argv: list[str]) -> None:
    """See the module; status 1 and a line on standard error where roslaunch would not start."""
    # A kilobyte of YAML aliases can stand for billions of values.
    resource.setrlimit(resource.RLIMIT_AS, (_MOST_MEMORY, _MOST_MEMORY))
    config = _Config()
    tracer = _Tracer(config)
    try:
        # What roslaunch says on the way is not part of the answer.
        with contextlib.redirect_stdout(sys.stderr):
            tracer.load(argv[0], config, argv=argv, verbose=False)
    except (RLException, ResourceNotFound, ValueError, OSError, KeyError) as error:
        raise SystemExit(" ".join(f"{error}".split())) from error
    except MemoryError:
        raise SystemExit(f"it needs more than {_MOST_MEMORY >> 20} MB of memory") from None
    for name, place in tracer.of_nodes:
        config.settings.setdefault(name, []).append(place)
    answer = {
        "parameters": config.settings,
        "nodes": tracer.nodes,
        "absent": _absent(tracer.programs),
        "files": tracer.files,
    }
    # What JSON has no form for (binary data, dates) is null.
    json.dump(answer, sys.stdout, default=lambda _value: None)


if __name__ == "__main__":
    main(sys.argv[1:])
