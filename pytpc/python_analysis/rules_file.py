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

    ``reads``: the arguments for the name and the default. ``arithmetic``: the name of an operation.
    ``lists``: the argument with the names of the returned parameters, and the one with the callback
    that gets a list of parameters. ``values``: attributes and methods that give the value of a
    parameter object, and their factor.
    """

    profile: str
    constants: bool = False
    reads: dict[str, tuple[Argument, Argument]] = field(default_factory=dict)
    exposing: set[str] = field(default_factory=set)
    topics: dict[str, Argument] = field(default_factory=dict)
    makes: dict[str, str] = field(default_factory=dict)
    configs: dict[str, ConfigRule] = field(default_factory=dict)
    services: dict[str, Argument] = field(default_factory=dict)
    lists: dict[str, tuple[Argument, Argument]] = field(default_factory=dict)
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
        tables = (self.reads, self.topics, self.makes, self.configs, self.services, self.lists)
        named = [name for table in tables for name in table]
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
        case "arithmetic" | "waiting" | "outcomes" | "filters":
            getattr(rules, name).update(table)
        case _:
            for row in table:
                if rules.profile in row.get("profiles", [rules.profile]):
                    _add_row(rules, name, row)


def _add_row(rules: Rules, name: str, row: dict[str, Any]) -> None:
    function = row.get("function", "")
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
            rules.configs[function] = ConfigRule(
                Argument(row["callback"], row.get("keyword")),
                row.get("config", 0),
                Argument(row.get("namespace"), row.get("namespace_keyword")),
                row.get("private", False),
            )
        case "services":
            rules.services[function] = Argument(row["callback"], row.get("keyword"))
        case "lists":
            names = Argument(row.get("names"), row.get("names_keyword"))
            rules.lists[function] = (names, Argument(row.get("callback"), row.get("keyword")))
        case "comparisons":
            rules.comparisons[function] = LibraryComparison(
                row.get("relation"), row.get("chooses"), row.get("within")
            )
        case _:
            given_name = row.get("attribute") or row["method"]
            rules.values[given_name] = float(row.get("scale", 1.0))
