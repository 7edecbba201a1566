"""A fleet's data set in a folder, or in a store that fsspec reaches (S3, GS, HTTP, SFTP).

Each file appears as a whole or not at all, and the row of ``missions`` comes last, so that readers
see whole missions only, whoever writes beside them or was killed. The same mission has the same
path and the same bytes, so that two who add it do no harm. Nothing is ever changed in place.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import secrets
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple, TypeVar
from urllib.parse import quote, unquote

import pyarrow as pa
import pyarrow.parquet as pq

from pytpc.base.errors import InputError, TpcError
from pytpc.base.wording import plain
from pytpc.fleet.tables import COMMIT, SCHEMA, SCHEMAS, TABLES, Table

Answer = TypeVar("Answer")

PATIENCE_S = 60.0
"""How long one request to a store may take."""
FLEET_FILE = "fleet.json"
_BUILDS = "builds"
_PART = "part.parquet"
_PLACE = re.compile(r"robot=([^/]+)/day=([^/]+)/mission=([^/]+)/part\.parquet$")
_LARGEST_BUILD = 1 << 28


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
    """A data set. It opens its store when it is asked for the first time, in each process anew.

    Attributes:
        url: a folder, or a URL such as ``s3://bucket/fleet``.
        patience_s: how long a request may take; a folder is not timed.
        options: for the store, as fsspec takes them.
    """

    url: str
    patience_s: float = PATIENCE_S
    options: Mapping[str, Any] = field(default_factory=dict)

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
        if self._has(FLEET_FILE):
            self.check()
            return
        if self._asked(lambda: self._fs.exists(self._root) and bool(self._fs.ls(self._root))):
            raise InputError("is there and is no fleet's data set; give another name", self._at)
        self._put(FLEET_FILE, json.dumps({"schema": SCHEMA}).encode() + b"\n")

    def check(self) -> None:
        """See that this is a data set that this version reads.

        Raises:
            InputError: it is not, or is not there.
            TpcError: the store does not answer.
        """
        content = self._get(FLEET_FILE)
        if content is None:
            raise InputError("no fleet's data set here; make one with `pytpc fleet add`", self._at)
        try:
            document = json.loads(content)
            schema = document["schema"]
            if not isinstance(schema, int):
                raise TypeError("no number")
        except (ValueError, KeyError, TypeError, RecursionError) as error:
            raise InputError(f"{FLEET_FILE} is broken: {error!r}", self._at) from error
        if schema > SCHEMA:
            what = f"of format {schema}; this TPC reads {SCHEMA}: install a newer pytpc"
            raise InputError(f"is a fleet's data set {what}", self._at)

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
        found = {}
        for table in (*TABLES, _BUILDS):
            folder = f"{self._root}/{table}"
            try:
                found[table] = int(self._asked(lambda folder=folder: self._fs.du(folder)))  # type: ignore[misc]
            except FileNotFoundError:
                found[table] = 0
        return found

    # --- one mission

    def has(self, place: Place) -> bool:
        """Whether a mission exists."""
        return self._has(_file(COMMIT, place))

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
        size = 0
        for table in sorted(TABLES, key=lambda one: one == COMMIT):
            rows = tables.get(table)
            if rows is not None and (len(rows) or table == COMMIT):
                content = _parquet(rows)
                size += len(content)
                self._put(_file(table, place), content)
            else:
                self._remove(_file(table, place))
        return size

    def read(self, place: Place, table: Table, columns: Sequence[str] | None = None) -> pa.Table:
        """A table of a mission; without rows where it has no file.

        Raises:
            InputError: the file is broken, or of a newer TPC.
            TpcError: the store does not answer.
        """
        schema = SCHEMAS[table]
        wanted = schema if columns is None else pa.schema([schema.field(name) for name in columns])
        content = self._get(_file(table, place))
        if content is None:
            return wanted.empty_table()
        path = self._path_of(_file(table, place))
        try:
            found = pq.read_table(io.BytesIO(content), columns=wanted.names)
            return found.cast(wanted).replace_schema_metadata(None)
        except (pa.ArrowException, KeyError, ValueError, OSError) as error:
            why = str(error).partition("\n")[0]
            raise InputError(f"not a table of a fleet: {plain(why)}", path) from error

    def drop(self, place: Place) -> None:
        """Remove a mission.

        Raises:
            TpcError: it cannot be removed, or the store does not answer.
        """
        for table in (COMMIT, *(one for one in TABLES if one != COMMIT)):
            self._remove(_file(table, place))

    # --- builds

    def put_build(self, name: str, content: bytes) -> None:
        """Keep the static information of a build, called after its hash; once is enough."""
        path = f"{_BUILDS}/{name}.json"
        if not self._has(path):
            self._put(path, content)

    def build(self, name: str) -> bytes:
        """The static information of a build.

        Raises:
            InputError: it is not there.
        """
        content = self._get(f"{_BUILDS}/{name}.json")
        if content is None or len(content) > _LARGEST_BUILD:
            raise InputError(f"the static information of build {name} is missing", self._at)
        return content

    # --- the store

    @property
    def _at(self) -> Path:
        return Path(self.url)

    def _path_of(self, name: str) -> Path:
        return self._at / name

    @cached_property
    def _opened(self) -> tuple[Any, str]:
        from fsspec.core import url_to_fs  # noqa: PLC0415 - only fleets need it

        try:
            fs, root = url_to_fs(self.url, **self.options)
        except (ImportError, ValueError) as error:
            why = str(error).partition("\n")[0]
            raise InputError(f"no such store: {plain(why)}", self._at) from error
        return fs, root.rstrip("/")

    @property
    def _fs(self) -> Any:  # noqa: ANN401 - fsspec has no types
        return self._opened[0]

    @property
    def _root(self) -> str:
        return self._opened[1]

    @property
    def _is_local(self) -> bool:
        return bool(self._fs.protocol == "file" or "file" in self._fs.protocol)

    def _asked(self, request: Callable[[], Answer]) -> Answer:
        """The answer of the store; FileNotFoundError is one.

        Raises:
            TpcError: it does not answer in time, or cannot.
        """
        try:
            return request() if self._is_local else self._in_time(request)
        except FileNotFoundError:
            raise
        except OSError as error:
            raise TpcError(f"{error.strerror or error}", self._at) from error
        except TpcError:
            raise
        except Exception as error:  # each store has errors of its own
            why = str(error).partition("\n")[0] or type(error).__name__
            raise TpcError(f"the store says: {plain(why)}", self._at) from error

    def _in_time(self, request: Callable[[], Answer]) -> Answer:
        """Wait for the answer in a thread that may be left behind."""
        answers: list[Answer] = []
        errors: list[BaseException] = []

        def ask() -> None:
            try:
                answers.append(request())
            except BaseException as error:
                errors.append(error)

        thread = threading.Thread(target=ask, daemon=True, name="store")
        thread.start()
        thread.join(self.patience_s)
        if errors:
            raise errors[0]
        if not answers:
            raise TpcError(f"the store does not answer within {self.patience_s:.0f} s", self._at)
        return answers[0]

    def _has(self, name: str) -> bool:
        return bool(self._asked(lambda: self._fs.exists(f"{self._root}/{name}")))

    def _get(self, name: str) -> bytes | None:
        try:
            return bytes(self._asked(lambda: self._fs.cat_file(f"{self._root}/{name}")))
        except FileNotFoundError:
            return None

    def _put(self, name: str, content: bytes) -> None:
        path = f"{self._root}/{name}"
        self._asked(lambda: self._written(path, content))

    def _written(self, path: str, content: bytes) -> None:
        if not self._is_local:
            # A store shows an object when it is whole.
            with contextlib.suppress(NotImplementedError):
                self._fs.makedirs(path.rpartition("/")[0], exist_ok=True)
            self._fs.pipe_file(path, content)
            return
        target = Path(path)
        target.parent.mkdir(parents=True, exist_ok=True)
        staged = target.with_name(f".{target.name}.{secrets.token_hex(4)}")
        try:
            with staged.open("xb") as stream:
                stream.write(content)
                stream.flush()
                os.fsync(stream.fileno())
            staged.replace(target)
        finally:
            staged.unlink(missing_ok=True)

    def _remove(self, name: str) -> None:
        path = f"{self._root}/{name}"
        with contextlib.suppress(FileNotFoundError):
            self._asked(lambda: self._fs.rm_file(path))
        if self._is_local:
            # Up to the table's own folder, which others may be writing to.
            for folder in list(Path(path).parents)[:3]:
                with contextlib.suppress(OSError):
                    folder.rmdir()

    def _places_in(self, table: str) -> list[Place]:
        try:
            paths = self._asked(lambda: self._fs.find(f"{self._root}/{table}"))
        except FileNotFoundError:
            return []
        return sorted(self._parsed(paths))

    def _parsed(self, paths: Sequence[str]) -> Iterator[Place]:
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
