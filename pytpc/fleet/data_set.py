"""A fleet's data set in a folder, or in a store that fsspec reaches (S3, GS, HTTP, SFTP).

Each file appears as a whole or not at all, and the row of ``missions`` comes last, so that readers
see whole missions only, whoever writes beside them or was killed. The same mission has the same
path and the same bytes, so that two who add it do no harm. A mission that is replaced by another
version of it, with new marks for example, does not exist meanwhile.
"""

from __future__ import annotations

import io
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, NamedTuple
from urllib.parse import quote, unquote

import pyarrow as pa
import pyarrow.parquet as pq

from pytpc.base.errors import InputError
from pytpc.base.wording import plain
from pytpc.fleet.store import PATIENCE_S, Store
from pytpc.fleet.tables import COMMIT, SCHEMA, SCHEMAS, TABLES, Table

FLEET_FILE = "fleet.json"
_BUILDS = "builds"
_PART = "part.parquet"
_PLACE = re.compile(r"robot=([^/]+)/day=([^/]+)/mission=([^/]+)/part\.parquet$")
_BUILD = re.compile(r"[A-Za-z0-9_-]{1,64}")
_LARGEST_BUILD = 1 << 28
_TRIES = 5


class Place(NamedTuple):
    """Where a mission is: its robot, its day (``2026-11-30``, by UTC) and its name there."""

    robot: str
    day: str
    mission: str

    @property
    def folder(self) -> str:
        """Below that of a table; characters that paths or readers take otherwise are escaped."""
        parts = zip(("robot", "day", "mission"), self, strict=True)
        return "/".join(f"{name}={quote(value, safe='')}" for name, value in parts)


@dataclass(frozen=True)
class Fleet:
    """A data set.

    Attributes:
        url: a folder, or a URL such as ``s3://bucket/fleet``.
        patience_s: how long a request may take; a folder is not timed.
        options: for the store, as fsspec takes them.
    """

    url: str
    patience_s: float = PATIENCE_S
    options: Mapping[str, Any] = field(default_factory=dict)

    @cached_property
    def store(self) -> Store:
        """Where it is."""
        return Store(self.url, self.patience_s, self.options)

    def __reduce__(self) -> tuple[type[Fleet], tuple[str, float, dict[str, Any]]]:
        """Send only what it was made of to another process."""
        return Fleet, (self.url, self.patience_s, dict(self.options))

    # --- the whole

    def begin(self) -> None:
        """Make the data set, unless it is there.

        Raises:
            InputError: there is something else, or one of a newer TPC.
            TpcError: it cannot be written, or the store does not answer.
        """
        if self.store.has(FLEET_FILE):
            self.check()
            return
        if self._strangers():
            if self.store.has(FLEET_FILE):
                # Somebody else made it just now.
                self.check()
                return
            what = "is there and is no fleet's data set; give another name"
            raise InputError(what, self.store.shown)
        self.store.put(FLEET_FILE, json.dumps({"schema": SCHEMA}).encode() + b"\n")

    def check(self) -> None:
        """See that this is a data set that this version reads.

        Raises:
            InputError: it is not, or is not there.
            TpcError: the store does not answer.
        """
        content = self.store.get(FLEET_FILE)
        if content is None:
            what = "no fleet's data set here; make one with `pytpc fleet add`"
            raise InputError(what, self.store.shown)
        try:
            document = json.loads(content)
            schema = document["schema"]
            if not isinstance(schema, int):
                raise TypeError("no number")
        except (ValueError, KeyError, TypeError, RecursionError) as error:
            raise InputError(f"{FLEET_FILE} is broken: {error!r}", self.store.shown) from error
        if schema > SCHEMA:
            what = f"of format {schema}; this TPC reads {SCHEMA}: install a newer pytpc"
            raise InputError(f"is a fleet's data set {what}", self.store.shown)

    def places(self) -> list[Place]:
        """All missions, sorted.

        Raises:
            TpcError: the store does not answer.
        """
        return self._places_in(COMMIT)

    def unfinished(self) -> list[Place]:
        """Missions of which something was written, and that do not exist; somebody may add them."""
        known = set(self.places())
        found = {place for table in TABLES if table != COMMIT for place in self._places_in(table)}
        return sorted(found - known)

    def bytes_of(self) -> dict[str, int]:
        """How many bytes each table, and the builds, have."""
        return {folder: self.store.bytes_below(folder) for folder in (*TABLES, _BUILDS)}

    # --- one mission

    def has(self, place: Place) -> bool:
        """Whether a mission exists."""
        return self.store.has(_file(COMMIT, place))

    def write(self, place: Place, tables: Mapping[Table, pa.Table]) -> int:
        """Write a mission; its row of ``missions`` last. An empty table has no file.

        Args:
            place: of the mission; what was there is replaced.
            tables: all of it.

        Returns:
            How many bytes there are.

        Raises:
            TpcError: it cannot be written, or the store does not answer.
        """
        contents = {
            table: _parquet(rows) for table, rows in tables.items() if len(rows) or table == COMMIT
        }
        size = sum(map(len, contents.values()))
        before = self.store.get(_file(COMMIT, place))
        if before is not None:
            if all(self.store.get(_file(one, place)) == contents.get(one) for one in TABLES):
                return size
            # Whoever reads it, or finds it after we were killed, must not see half of each.
            self.store.remove(_file(COMMIT, place))
        for table in TABLES:
            if table != COMMIT and table in contents:
                self.store.put(_file(table, place), contents[table])
            elif table != COMMIT:
                self.store.remove(_file(table, place))
        self.store.put(_file(COMMIT, place), contents[COMMIT])
        for table, content in contents.items():
            # Somebody may have removed what was half written.
            if not self.store.has(_file(table, place)):
                self.store.put(_file(table, place), content)
        return size

    def read(self, place: Place, table: Table, columns: Sequence[str] | None = None) -> pa.Table:
        """A table of a mission; without rows where it has no file.

        Raises:
            InputError: the file is broken, or of a newer TPC.
            TpcError: the store does not answer.
        """
        schema = SCHEMAS[table]
        wanted = schema if columns is None else pa.schema([schema.field(name) for name in columns])
        content = self.store.get(_file(table, place))
        if content is None:
            return wanted.empty_table()
        path = self.store.path_of(_file(table, place))
        try:
            # `read_table` takes six times as long for a file of some hundred rows.
            file = pq.ParquetFile(pa.BufferReader(content))
            found = file.read(columns=wanted.names, use_threads=False).select(wanted.names)
            return found.cast(wanted).replace_schema_metadata(None)
        except (pa.ArrowException, KeyError, ValueError, OSError) as error:
            why = str(error).partition("\n")[0]
            raise InputError(f"not a table of a fleet: {plain(why)}", path) from error

    def drop(self, place: Place) -> None:
        """Remove a mission.

        Raises:
            TpcError: it cannot be removed, or the store does not answer.
        """
        for _ in range(_TRIES):
            for table in (COMMIT, *(one for one in TABLES if one != COMMIT)):
                self.store.remove(_file(table, place))
            # Who was adding it meanwhile may have lost a table.
            if not self.has(place):
                return

    # --- builds

    def put_build(self, name: str, content: bytes) -> None:
        """Keep the static information of a build, called after its hash; once is enough."""
        path = f"{_BUILDS}/{name}.json"
        if not self.store.has(path):
            self.store.put(path, content)
        else:
            self.store.tidy(path)

    def build(self, name: str) -> bytes:
        """The static information of a build.

        Raises:
            InputError: it is not there.
        """
        # A name from somebody else's data set.
        is_name = _BUILD.fullmatch(name) is not None
        content = self.store.get(f"{_BUILDS}/{name}.json") if is_name else None
        if content is None or len(content) > _LARGEST_BUILD:
            what = f"the static information of build {plain(name)} is missing"
            raise InputError(what, self.store.shown)
        return content

    # --- paths

    def _strangers(self) -> list[str]:
        """What is there that is not of a data set that somebody begins."""
        return [one for one in self.store.names() if not one.startswith(f".{FLEET_FILE}.")]

    def _places_in(self, table: str) -> list[Place]:
        return sorted(_parsed(self.store.files_below(table)))


def _parsed(paths: Sequence[str]) -> Iterator[Place]:
    for path in paths:
        found = _PLACE.search(path)
        if found is not None:
            yield Place(*map(unquote, found.groups()))


def _file(table: str, place: Place) -> str:
    return f"{table}/{place.folder}/{_PART}"


def _parquet(rows: pa.Table) -> bytes:
    stream = io.BytesIO()
    # Readers skip by times and numbers; of texts the statistics are as long as the texts.
    numbers = [one.name for one in rows.schema if pa.types.is_integer(one.type)]
    pq.write_table(rows, stream, compression="zstd", write_statistics=numbers)
    return stream.getvalue()
