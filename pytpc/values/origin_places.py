"""From what roslaunch's loader did to the line that set a value."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from pytpc.values.installed import source_of
from pytpc.values.launch_xml import inner_text, read_tags
from pytpc.values.origins import Origin
from pytpc.values.trace import Trace
from pytpc.values.yaml_tree import Setting, read_yaml, settings

_ONE_ARGUMENT = re.compile(r"\s*\$\(arg\s+([^)\s]+)\s*\)\s*")
_COMMAND_LINE = "command line"


class Places:
    """Turns the settings of a trace into origins; each file is read once."""

    def __init__(self, trace: Trace) -> None:
        """See the class."""
        self._trace = trace
        self._bytes: dict[Path, bytes] = {}
        self._yaml: dict[tuple[Path, int], Mapping[tuple[str, ...], Setting]] = {}

    def origins(self) -> dict[str, Origin]:
        """The origin of all that the launch file sets, by full name as in the launch file."""
        found: dict[str, Origin] = {}
        for name, all_settings in self._trace.settings.items():
            placed = [self._origin(name, setting) for setting in all_settings]
            earlier = tuple(dict.fromkeys(o.words() for o in placed[:-1] if o.path is not None))
            last = placed[-1]
            # The same file may be loaded twice, and a key stand twice in one file.
            own = tuple(f"{last.path}:{n}" for n in self._earlier_lines(last))
            found[name] = replace(
                last, overridden=(*(e for e in earlier if e != last.words()), *own)
            )
        return found

    def _origin(self, name: str, setting: Mapping[str, Any]) -> Origin:
        value = setting.get("value")
        if "file" not in setting:
            return Origin(name, "unknown", value, None, None, "")
        launch = Path(setting["file"])
        way = tuple(setting.get("via", ()))
        if setting["tag"] == "rosparam":
            return self._from_rosparam(name, setting, launch, way)
        lineno = int(setting["lineno"])
        origin = Origin(name, "launch", value, launch, lineno, self._line(launch, lineno), way)
        return self._from_param(origin, setting)

    def _from_rosparam(
        self, name: str, setting: Mapping[str, Any], launch: Path, way: tuple[str, ...]
    ) -> Origin:
        value = setting.get("value")
        below = keys_below(name, str(setting.get("base", "/")))
        if setting.get("from") == "file":
            path = Path(setting["yaml"])
            found = _of_keys(self._settings(path, 0), below)
            way = (*way, f"{launch}:{setting['lineno']}")
            kind, first = "yaml", 0
        else:
            path = launch
            span = self._text_of(launch, int(setting["offset"]))
            found = None if span is None else _of_keys(self._settings(path, *span), below)
            kind = "launch"
            first = int(setting["lineno"]) - 1
            if span is not None:
                first = self._data(path)[: span[0]].count(b"\n")
        if found is None:
            lineno = None if kind == "yaml" else int(setting["lineno"])
            return Origin(
                name, "yaml" if kind == "yaml" else "launch", value, path, lineno,
                "" if lineno is None else self._line(path, lineno), way,
                note="the line in it is not known", source=source_of(path),
            )  # fmt: skip
        lineno = first + found.node.lineno
        note = ""
        if found.shared:
            note = f"it is written for more than this place ({found.shared})"
        elif setting.get("substituted") and "$(" in found.node.text:
            note = "roslaunch puts something in here (subst_value)"
        return Origin(
            name, "yaml" if kind == "yaml" else "launch", value, path, lineno,
            self._line(path, lineno), way, note, found.keys, source=source_of(path),
        )  # fmt: skip

    def _from_param(self, origin: Origin, setting: Mapping[str, Any]) -> Origin:
        written = str(setting.get("written", ""))
        kind = str(setting.get("type", "auto"))
        origin = replace(origin, source=source_of(origin.path), param_type=kind)
        if setting.get("from") != "value":
            what = {"command": "the output of a command", "textfile": "the text of a file"}
            note = what.get(str(setting.get("from")), "the bytes of a file")
            return replace(origin, note=f"{note}: {written}")
        name, place = "", setting
        while (one := _ONE_ARGUMENT.fullmatch(str(place.get("written", "")))) is not None:
            name = one[1]
            place = place.get("arguments", {}).get(name, {"tag": "unknown"})
        if place is setting:
            return replace(
                origin, note=f"roslaunch works it out: {written}" if "$(" in written else ""
            )
        if place["tag"] == _COMMAND_LINE:
            given = f"{name}:={place.get('value', '')} on roslaunch's command line"
            return replace(origin, kind="argument", argument=name, note=given)
        if place["tag"] != "arg":
            return origin
        path, lineno = Path(place["file"]), int(place["lineno"])
        way = (*origin.via, f"{origin.path}:{origin.lineno}")
        note = f"<arg> {name}, which may be used elsewhere, too"
        if "$(" in str(place.get("written", "")):
            note = f"roslaunch works out <arg> {name}: {place['written']}"
        return replace(
            origin, path=path, lineno=lineno, text=self._line(path, lineno), via=way, note=note,
            argument=name, source=source_of(path),
        )  # fmt: skip

    def _earlier_lines(self, origin: Origin) -> Sequence[int]:
        if origin.kind != "yaml" or origin.path is None or not origin.keys:
            return ()
        found = self._settings(origin.path, 0).get(origin.keys)
        return () if found is None else found.earlier

    def _data(self, path: Path) -> bytes:
        if path not in self._bytes:
            try:
                self._bytes[path] = path.read_bytes()
            except OSError:
                self._bytes[path] = b""
        return self._bytes[path]

    def _line(self, path: Path, lineno: int) -> str:
        lines = self._data(path).split(b"\n")
        if not 0 < lineno <= len(lines):
            return ""
        return lines[lineno - 1].decode("utf-8", "replace").strip()

    def _text_of(self, launch: Path, offset: int) -> tuple[int, int] | None:
        data = self._data(launch)
        try:
            tag = next((tag for tag in read_tags(data) if tag.offset == offset), None)
        except ValueError:
            return None
        return None if tag is None else inner_text(tag, data)

    def _settings(
        self, path: Path, start: int, end: int | None = None
    ) -> Mapping[tuple[str, ...], Setting]:
        """What a YAML file, or a piece of a file, sets; nothing where it cannot be read."""
        place = (path, start)
        if place not in self._yaml:
            piece = self._data(path)[start:end]
            try:
                documents = read_yaml(piece.decode("utf-8-sig" if start == 0 else "utf-8"))
                self._yaml[place] = settings(documents[0]) if documents else {}
            except ValueError:
                self._yaml[place] = {}
        return self._yaml[place]


def keys_below(name: str, base: str) -> str | None:
    """The part of a full name that is below a namespace; empty where it is the name itself.

    >>> keys_below("/a/b/c", "/a"), keys_below("/a", "/a"), keys_below("/b", "/")
    ('b/c', '', 'b')
    """
    base = base.rstrip("/")
    if name == base:
        return ""
    return name[len(base) + 1 :] if name.startswith(f"{base}/") else None


def _of_keys(known: Mapping[tuple[str, ...], Setting], below: str | None) -> Setting | None:
    """The setting whose keys, joined as ROS joins names, are ``below``; a key may have slashes."""
    found = None
    for keys, setting in known.items():
        if below is not None and "/".join(k.strip("/") for k in keys if k.strip("/")) == below:
            found = setting
    return found
