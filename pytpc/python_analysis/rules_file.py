"""The tables that drive the analysis of Python: ``rules/python.json`` and the user's own file."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Any

from pytpc.base.checked_json import PYTHON_RULES_SCHEMA, check_schema, parse_json

_OWN = Path(__file__).parent / "rules" / "python.json"


@dataclass(frozen=True)
class Argument:
    """The place of an argument (None: only by keyword) and its keyword."""

    place: int | None
    keyword: str | None = None


@dataclass(frozen=True)
class ReadRule:
    """A call that reads a parameter: its arguments for the name and the default.

    ``callback``: the value is not its result, but what this callback gets. ``node``: the argument
    that names the node whose parameter it is. ``separator``: the result is a table of the
    parameters whose names begin with the name and this. ``is_object``: the value of the parameter
    is an attribute of the result (``values``).
    """

    name: Argument
    default: Argument
    callback: Argument = Argument(None)
    node: Argument = Argument(None)
    separator: str = ""
    is_object: bool = False


@dataclass(frozen=True)
class ListRule:
    """A call that returns parameter objects, or passes a list of them to ``callback``.

    ``names`` is the argument with their names, which ``namespace`` comes before.
    """

    names: Argument
    callback: Argument
    namespace: Argument = Argument(None)


@dataclass(frozen=True)
class ConfigRule:
    """A call whose ``callback`` gets an object of parameters as its argument number ``config``.

    ``namespace`` names them; if ``is_private``, it is below the node's own name.
    """

    callback: Argument
    config: int
    namespace: Argument
    is_private: bool


@dataclass(frozen=True)
class LibraryComparison:
    """The comparison inside a library function.

    ``relation``: it compares its first two arguments and returns the outcome; ``within`` is the
    keyword of a bound on their distance. ``chooses``: it returns one of its arguments, the
    ``smallest`` or the ``largest``, or clamps the first one to the two others (``clip``).
    """

    relation: str | None = None
    chooses: str | None = None
    within: str | None = None


@dataclass(frozen=True)
class Rules:
    """The tables by dotted name; see ``rules/python.json``.

    ``arithmetic``: the name of an operation; ``units``: the factor of an argument with a keyword.
    ``values``: attributes and methods that give the value of a parameter object, and their factor.
    ``topics``, ``types``: the arguments that name a topic and the class of its messages.
    ``subscriptions``: the callbacks that get the messages.
    ``services``: the callbacks whose results are exposed; ``overriding``: the same for the methods
    of a program's classes, by the class that they are derived from. ``hands``: a callback, and the
    class of the object that it gets. ``tidy``: classes whose methods neither keep what they get nor
    return what others got.
    """

    profile: str
    constants: bool = False
    reads: dict[str, ReadRule] = field(default_factory=dict)
    exposing: set[str] = field(default_factory=set)
    topics: dict[str, Argument] = field(default_factory=dict)
    types: dict[str, Argument] = field(default_factory=dict)
    subscriptions: dict[str, Argument] = field(default_factory=dict)
    makes: dict[str, str] = field(default_factory=dict)
    configs: dict[str, ConfigRule] = field(default_factory=dict)
    services: dict[str, list[Argument]] = field(default_factory=dict)
    overriding: dict[str, list[str]] = field(default_factory=dict)
    hands: dict[str, list[tuple[Argument, str]]] = field(default_factory=dict)
    lists: dict[str, ListRule] = field(default_factory=dict)
    tidy: set[str] = field(default_factory=set)
    units: dict[str, float] = field(default_factory=dict)
    values: dict[str, float] = field(default_factory=dict)
    comparisons: dict[str, LibraryComparison] = field(default_factory=dict)
    waiting: set[str] = field(default_factory=set)
    arithmetic: dict[str, str] = field(default_factory=dict)
    outcomes: set[str] = field(default_factory=set)
    filters: set[str] = field(default_factory=set)

    def waits(self, method: str) -> bool:
        """True where a function or method of that name waits."""
        return any(
            method == word or f"{word}_" in method or f"_{word}" in method for word in self.waiting
        )

    @property
    def paths(self) -> list[str]:
        """All dotted names in the tables."""
        tables = (
            *(self.reads, self.topics, self.makes, self.configs),
            *(self.services, self.hands, self.lists),
        )
        named = [name for table in tables for name in table]
        named += [kind for rows in self.hands.values() for _, kind in rows]
        return [*named, *self.exposing, *self.makes.values()]

    def class_of(self, path: str) -> str:
        """The class of what a call of ``path`` returns, by the one name that the rules use."""
        return self.makes.get(path, path)


@lru_cache(maxsize=16)
def load_rules(profile: str = "default", own: Path | None = None) -> Rules:
    """The built-in tables for ``profile``, and the rows of the user's file.

    Raises:
        InputError: the user's file cannot be read, is not JSON, or breaks the schema
            ``python_rules.schema.json``; with the place.
    """
    rules = Rules(profile)
    for path in (_OWN, own):
        if path is not None:
            data: Any = parse_json(path)
            check_schema(data, path, PYTHON_RULES_SCHEMA)
            for name, table in data.items():
                _add(rules, name, table)
    return rules


def _add(rules: Rules, name: str, table: Any) -> None:  # noqa: ANN401
    match name:
        case "$schema" | "schema" | "comment":
            pass
        case "arithmetic" | "waiting" | "outcomes" | "filters" | "tidy" | "units":
            getattr(rules, name).update(table)
        case _:
            for row in table:
                if rules.profile in row.get("profiles", [rules.profile]):
                    _add_row(rules, name, row)


def _add_row(rules: Rules, name: str, row: dict[str, Any]) -> None:
    function = row.get("function", "")
    match name:
        case "reads":
            rules.reads[function] = ReadRule(
                Argument(row.get("name"), row.get("name_keyword")),
                Argument(row.get("default"), row.get("default_keyword")),
                Argument(row.get("callback"), row.get("keyword")),
                Argument(row.get("node"), row.get("node_keyword")),
                row.get("separator", ""),
                row.get("object", False),
            )
        case "exposing":
            rules.exposing.add(function)
        case "topics" | "subscriptions":
            rules.topics[function] = Argument(row["name"], row.get("keyword"))
            if "type" in row:
                rules.types[function] = Argument(row["type"], row.get("type_keyword"))
            if name == "subscriptions":
                rules.subscriptions[function] = Argument(
                    row["callback"], row.get("callback_keyword")
                )
        case "makes":
            rules.makes[function] = row["class"]
        case "configs":
            rules.configs[function] = ConfigRule(
                Argument(row["callback"], row.get("keyword")),
                row.get("config", 0),
                Argument(row.get("namespace"), row.get("namespace_keyword")),
                row.get("private", False),
            )
        case "services":
            given = Argument(row.get("callback"), row.get("keyword"))
            rules.services.setdefault(function, []).append(given)
        case "overriding":
            rules.overriding.setdefault(row["class"], []).extend(row["methods"])
        case "hands":
            given = Argument(row.get("callback"), row.get("keyword"))
            rules.hands.setdefault(function, []).append((given, row["class"]))
        case "lists":
            rules.lists[function] = ListRule(
                Argument(row.get("names"), row.get("names_keyword")),
                Argument(row.get("callback"), row.get("keyword")),
                Argument(row.get("namespace"), row.get("namespace_keyword")),
            )
        case "comparisons":
            rules.comparisons[function] = LibraryComparison(
                row.get("relation"), row.get("chooses"), row.get("within")
            )
        case _:
            given_name = row.get("attribute") or row["method"]
            rules.values[given_name] = float(row.get("scale", 1.0))
