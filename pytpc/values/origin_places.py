"""Finds the line that set a value, from what roslaunch's loader did."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from pytpc.base.errors import InputError
from pytpc.base.source_bytes import read_bytes
from pytpc.values.installed import source_of
from pytpc.values.launch_xml import inner_text, read_tags
from pytpc.values.origins import IN_ARGS, Origin
from pytpc.values.trace import Trace
from pytpc.values.yaml_tree import YamlSetting, read_yaml, settings

_ONE_ARGUMENT = re.compile(r"\s*\$\(arg\s+([^)\s]+)\s*\)\s*")
_COMMAND_LINE = "command line"


class _Files:
    """The files that a launch file reads; each is read once."""

    def __init__(self) -> None:
        self.data = cache(_bytes_of)
        self.source = cache(source_of)
        self.settings = cache(self._settings)
        self._lines = cache(lambda path: self.data(path).split(b"\n"))
        self._texts = cache(self._texts_of)

    def line(self, path: Path, lineno: int) -> str:
        """A line without the white space around it."""
        lines = self._lines(path)
        if not 0 < lineno <= len(lines):
            return ""
        return lines[lineno - 1].decode("utf-8", "replace").strip()

    def text_of(self, launch: Path, offset: int) -> tuple[int, int] | None:
        """The span of the text of the tag that begins at a byte."""
        return self._texts(launch).get(offset)

    def _texts_of(self, launch: Path) -> dict[int, tuple[int, int] | None]:
        data = self.data(launch)
        try:
            return {tag.offset: inner_text(tag, data) for tag in read_tags(data)}
        except ValueError:
            return {}

    def _settings(self, path: Path, start: int, end: int | None = None) -> dict[str, YamlSetting]:
        """The values that a YAML file, or a part of one, sets, by keys as ROS joins them.

        Nothing where it cannot be read.
        """
        piece = self.data(path)[start:end]
        try:
            documents = read_yaml(piece.decode("utf-8-sig" if start == 0 else "utf-8"))
        except ValueError:
            documents = []
        found = settings(documents[0]) if documents else {}
        return {_joined(keys): setting for keys, setting in found.items()}


def _bytes_of(path: Path) -> bytes:
    """The content of a file; empty if it cannot be read."""
    try:
        return read_bytes(path)
    except InputError:
        return b""


class Places:
    """Turns the settings of a trace into origins."""

    def __init__(self, trace: Trace) -> None:
        self._trace = trace
        self._files = _Files()

    def origins(self) -> dict[str, Origin]:
        """The origin of all that the launch file sets, by full name as in the launch file."""
        found: dict[str, Origin] = {}
        for name, placed in self.all_origins().items():
            earlier = tuple(dict.fromkeys(o.words() for o in placed[:-1] if o.path is not None))
            last = placed[-1]
            own = tuple(f"{last.path}:{lineno}" for lineno in self.same_keys(last))
            found[name] = replace(
                last, overridden=(*(e for e in earlier if e != last.words()), *own)
            )
        return found

    def all_origins(self) -> dict[str, list[Origin]]:
        """The origins of every value that a parameter is given, in this order: the last counts."""
        return {
            name: [self._origin(name, setting) for setting in all_settings]
            for name, all_settings in self._trace.settings.items()
        }

    def same_keys(self, origin: Origin) -> tuple[int, ...]:
        """The lines with the same keys in the YAML file of an origin, which it overrides."""
        known = (
            self._files.settings(origin.path, 0) if origin.kind == "yaml" and origin.path else {}
        )
        twice = known.get(_joined(origin.keys))
        return () if twice is None else twice.earlier

    def _origin(self, name: str, setting: Mapping[str, Any]) -> Origin:
        if "file" not in setting:
            return Origin(name, "unknown", setting.get("value"), None, None, "")
        launch = Path(setting["file"])
        if setting["tag"] == "rosparam":
            return self._from_rosparam(name, setting, launch)
        return self._from_param(self._at(name, launch, int(setting["lineno"]), setting), setting)

    def _at(self, name: str, path: Path, lineno: int | None, setting: Mapping[str, Any]) -> Origin:
        """An origin at a line, of a launch file unless stated otherwise."""
        return Origin(
            name=name,
            kind="launch",
            value=setting.get("value"),
            path=path,
            lineno=lineno,
            text="" if lineno is None else self._files.line(path, lineno),
            via=tuple(setting.get("via", ())),
            source=self._files.source(path),
        )

    def _from_rosparam(self, name: str, setting: Mapping[str, Any], launch: Path) -> Origin:
        below = keys_below(name, str(setting.get("base", "/")))
        of_tag = int(setting["lineno"])
        first = 0
        if setting.get("from") == "file":
            path = Path(setting["yaml"])
            known = self._files.settings(path, 0)
            unknown = self._at(name, path, None, setting)
            unknown = replace(unknown, kind="yaml", via=(*unknown.via, f"{launch}:{of_tag}"))
        else:
            path = launch
            span = self._files.text_of(launch, int(setting["offset"]))
            known = {} if span is None else self._files.settings(path, *span)
            if span is not None:
                first = self._files.data(path)[: span[0]].count(b"\n")
            unknown = self._at(name, path, of_tag, setting)
        found = known.get(below, known.get(name))
        if found is None:
            return replace(unknown, note="the line in it is not known")
        lineno = first + found.node.lineno
        note = ""
        if found.shared:
            note = f"it is written for more than this place ({found.shared})"
        elif setting.get("substituted") and "$(" in found.node.text:
            note = "roslaunch substitutes a part of it (subst_value)"
        text = self._files.line(path, lineno)
        return replace(unknown, lineno=lineno, text=text, note=note, keys=found.keys)

    def _from_param(self, origin: Origin, setting: Mapping[str, Any]) -> Origin:
        written = str(setting.get("written", ""))
        kind = str(setting.get("type", "auto"))
        origin = replace(origin, param_type=kind)
        if setting.get("from") == "args":
            return replace(origin, note=f"{IN_ARGS}: {written}")
        if setting.get("from") != "value":
            what = {"command": "the output of a command", "textfile": "the text of a file"}
            note = what.get(str(setting.get("from")), "the bytes of a file")
            return replace(origin, note=f"{note}: {written}")
        name, place, way = "", setting, origin.via
        while (one := _ONE_ARGUMENT.fullmatch(str(place.get("written", "")))) is not None:
            way = (*way, f"{place['file']}:{place['lineno']}")
            name = one[1]
            place = place.get("arguments", {}).get(name, {"tag": "unknown"})
        if place is setting:
            return replace(
                origin, note=f"roslaunch computes it: {written}" if "$(" in written else ""
            )
        if place["tag"] == _COMMAND_LINE:
            given = f"{name}:={place.get('value', '')} on roslaunch's command line"
            return replace(origin, kind="argument", argument=name, note=given)
        if place["tag"] != "arg":
            return origin
        path, lineno = Path(place["file"]), int(place["lineno"])
        note = f"<arg> {name}, which may be used elsewhere, too"
        if "$(" in str(place.get("written", "")):
            note = f"roslaunch computes <arg> {name}: {place['written']}"
        return replace(
            origin,
            path=path,
            lineno=lineno,
            text=self._files.line(path, lineno),
            via=way,
            note=note,
            argument=name,
            source=self._files.source(path),
        )


def _joined(keys: Sequence[str]) -> str:
    """Keys of YAML as ROS joins them to a name: one with a slash in front begins anew."""
    name = ""
    for key in keys:
        name = key if key.startswith("/") or not name else f"{name.rstrip('/')}/{key}"
    return name.rstrip("/")


def keys_below(name: str, base: str) -> str:
    """The part of a full name that is below a namespace; empty where it is the name itself.

    >>> keys_below("/a/b/c", "/a"), keys_below("/a", "/a"), keys_below("/b", "/")
    ('b/c', '', 'b')
    """
    base = base.rstrip("/")
    if name == base:
        return ""
    return name.removeprefix(f"{base}/")
