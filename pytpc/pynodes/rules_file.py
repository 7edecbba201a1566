"""The tables that drive the analysis of Python: ``rules/python.json``, and the user's own file."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

from pytpc.errors import InputError

_OWN = Path(__file__).parent / "rules" / "python.json"
_LISTS = {
    "reads": {"function", "name", "name_keyword", "default", "default_keyword", "profiles"},
    "exposing": {"function", "profiles"},
    "topics": {"function", "name", "keyword"},
    "makes": {"function", "class"},
    "configs": {"function", "callback", "keyword", "config", "profiles"},
    "services": {"function", "callback", "keyword", "profiles"},
    "values": {"attribute", "method", "scale"},
}


@dataclass(frozen=True)
class Argument:
    """Where an argument stands: its place (None: keyword alone) and its keyword."""

    place: int | None
    keyword: str | None = None


@dataclass(frozen=True)
class Rules:
    """The tables by dotted name; see ``rules/python.json``.

    ``reads``: the arguments with the name and with the default. ``arithmetic``: the name of an
    operation. ``values``: attributes and methods that give the value of a parameter object, and
    what they multiply it by.
    """

    profile: str
    constants: bool = False
    reads: dict[str, tuple[Argument, Argument]] = field(default_factory=dict)
    exposing: set[str] = field(default_factory=set)
    topics: dict[str, Argument] = field(default_factory=dict)
    makes: dict[str, str] = field(default_factory=dict)
    configs: dict[str, tuple[Argument, int]] = field(default_factory=dict)
    services: dict[str, Argument] = field(default_factory=dict)
    values: dict[str, float] = field(default_factory=dict)
    waiting: set[str] = field(default_factory=set)
    arithmetic: dict[str, str] = field(default_factory=dict)
    outcomes: set[str] = field(default_factory=set)
    filters: set[str] = field(default_factory=set)

    @property
    def paths(self) -> list[str]:
        """All dotted names that the tables are about."""
        tables = (self.reads, self.topics, self.makes, self.configs, self.services)
        named = [name for table in tables for name in table]
        return [*named, *self.exposing, *self.makes.values()]

    def class_of(self, path: str) -> str:
        """The class of what calling ``path`` gives, by the one name that the rules use."""
        return self.makes.get(path, path)


@lru_cache(maxsize=16)
def load_rules(profile: str = "default", own: Path | None = None) -> Rules:
    """The built-in tables for ``profile``, and the rows of the user's file.

    Raises:
        InputError: the user's file cannot be read, is no JSON, or has a row that is not known.
    """
    rules = Rules(profile)
    _add(rules, _read(_OWN), _OWN)
    if own is not None:
        _add(rules, _read(own), own)
    return rules


def _read(path: Path) -> dict[str, Any]:
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(error.strerror or "cannot be read", path) from None
    except UnicodeDecodeError:
        raise InputError("not UTF-8", path) from None
    except json.JSONDecodeError as error:
        raise InputError(error.msg, path, error.lineno) from None
    if not isinstance(data, dict):
        raise InputError("/: not an object of tables", path)
    return data


def _add(rules: Rules, data: dict[str, Any], path: Path) -> None:
    for name, rows in data.items():
        if name == "arithmetic":
            _check(isinstance(rows, dict) and all(map(_is_text, rows.values())), name, path)
            rules.arithmetic.update(rows)
        elif name in ("waiting", "outcomes", "filters"):
            _check(isinstance(rows, list) and all(map(_is_text, rows)), name, path)
            getattr(rules, name).update(rows)
        else:
            _check(name in _LISTS and isinstance(rows, list), name, path)
            for index, row in enumerate(rows):
                place = f"{name}/{index}"
                _check(isinstance(row, dict) and row.keys() <= _LISTS[name], place, path)
                _check(name == "values" or _is_text(row.get("function")), place, path)
                if rules.profile in row.get("profiles", [rules.profile]):
                    _add_row(rules, name, row, place, path)


def _add_row(rules: Rules, name: str, row: dict[str, Any], place: str, path: Path) -> None:
    function = row.get("function", "")
    try:
        match name:
            case "reads":
                given = Argument(row.get("name"), row.get("name_keyword"))
                default = Argument(row.get("default"), row.get("default_keyword"))
                rules.reads[function] = (given, default)
            case "exposing":
                rules.exposing.add(function)
            case "topics":
                rules.topics[function] = Argument(row["name"], row.get("keyword"))
            case "makes":
                rules.makes[function] = row["class"]
            case "configs":
                callback = Argument(row["callback"], row.get("keyword"))
                rules.configs[function] = (callback, int(row.get("config", 0)))
            case "services":
                rules.services[function] = Argument(row["callback"], row.get("keyword"))
            case _:
                given_name = row.get("attribute") or row["method"]
                rules.values[given_name] = float(row.get("scale", 1.0))
    except (KeyError, TypeError, ValueError):
        _check(False, place, path)


def _is_text(value: object) -> bool:
    return isinstance(value, str)


def _check(holds: bool, place: str, path: Path) -> None:
    if not holds:
        raise InputError(f"/{place}: not a row of this table (see docs/python-nodes.md)", path)
