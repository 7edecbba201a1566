"""A fleet's data set in a folder, or in a store that fsspec reaches (S3, GS, HTTP, SFTP).

Each file appears as a whole or not at all, and the row of ``missions`` comes last, so that readers
see whole missions only, whoever writes beside them or was killed. The same mission has the same
path and the same bytes, so that two who add it do no harm. A mission that is replaced by another
version of it, with new marks for example, does not exist meanwhile.
"""

from __future__ import annotations

import contextlib
import io
import json
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

from pytpc.base.atomic import leftovers, stage_beside
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
_BUILD = re.compile(r"[A-Za-z0-9_-]{1,64}")
_LARGEST_BUILD = 1 << 28
_TRIES = 5
_RENAMES = frozenset({"sftp", "ssh"})
"""Stores that show a file while it is written."""
_MOST_REQUESTS = 64
_SECRET = re.compile(r"(?<=://)[^/\s]*@")


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
        if self._strangers():
            if self._has(FLEET_FILE):
                # Somebody else made it just now.
                self.check()
                return
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
        contents = {
            table: _parquet(rows) for table, rows in tables.items() if len(rows) or table == COMMIT
        }
        size = sum(map(len, contents.values()))
        before = self._get(_file(COMMIT, place))
        if before is not None:
            if all(self._get(_file(one, place)) == contents.get(one) for one in TABLES):
                return size
            # Whoever reads it, or finds it after we were killed, must not see half of each.
            self._remove(_file(COMMIT, place))
        for table in TABLES:
            if table != COMMIT and table in contents:
                self._put(_file(table, place), contents[table])
            elif table != COMMIT:
                self._remove(_file(table, place))
        self._put(_file(COMMIT, place), contents[COMMIT])
        for table, content in contents.items():
            # Somebody may have removed what was half written.
            if not self._has(_file(table, place)):
                self._put(_file(table, place), content)
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
                self._remove(_file(table, place))
            # Who was adding it meanwhile may have lost a table.
            if not self.has(place):
                return

    # --- builds

    def put_build(self, name: str, content: bytes) -> None:
        """Keep the static information of a build, called after its hash; once is enough."""
        path = f"{_BUILDS}/{name}.json"
        if not self._has(path):
            self._put(path, content)
        elif self._is_local:
            _tidy(Path(self._at_store(path)))

    def build(self, name: str) -> bytes:
        """The static information of a build.

        Raises:
            InputError: it is not there.
        """
        # A name from somebody else's data set.
        is_name = _BUILD.fullmatch(name) is not None
        content = self._get(f"{_BUILDS}/{name}.json") if is_name else None
        if content is None or len(content) > _LARGEST_BUILD:
            what = f"the static information of build {plain(name)} is missing"
            raise InputError(what, self._at)
        return content

    # --- the store

    @property
    def _at(self) -> str:
        return shown_url(self.url)

    def _path_of(self, name: str) -> str:
        return f"{self._at.rstrip('/')}/{name}"

    @cached_property
    def _opened(self) -> tuple[Any, str]:
        from fsspec.core import url_to_fs  # noqa: PLC0415 - only fleets need it

        try:
            fs, root = url_to_fs(self.url, **self.options)
        except (ImportError, ValueError) as error:
            why = shown_url(str(error).partition("\n")[0])
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
        return "file" in _protocols(self._fs)

    @property
    def _is_web(self) -> bool:
        return not _protocols(self._fs).isdisjoint({"http", "https"})

    def _at_store(self, name: str) -> str:
        """The path of a file or table; in that of a web server the escapes are escaped again."""
        return f"{self._root}/{quote(name, safe='/=') if self._is_web else name}"

    def _strangers(self) -> list[str]:
        """What is there that is not of a data set that somebody begins."""

        def names() -> list[str]:
            self._fs.invalidate_cache()
            if not self._fs.exists(self._root):
                return []
            found = [one.rstrip("/") for one in self._fs.ls(self._root, detail=False)]
            # Stores list a folder that somebody made by hand as a thing in it.
            return [one.rpartition("/")[2] for one in found if one != self._root.rstrip("/")]

        try:
            found = self._asked(names)
        except FileNotFoundError:
            return []
        return [one for one in found if not one.startswith(f".{FLEET_FILE}.")]

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
            raise TpcError(shown_url(f"{error.strerror or error}"), self._at) from error
        except TpcError:
            raise
        except Exception as error:  # each store has errors of its own
            why = shown_url(str(error).partition("\n")[0]) or type(error).__name__
            raise TpcError(f"the store says: {plain(why)}", self._at) from error

    def _in_time(self, request: Callable[[], Answer]) -> Answer:
        """Wait for the answer in a thread that may be left behind."""
        answers: list[Answer] = []
        errors: list[BaseException] = []
        silent = TpcError(f"the store does not answer within {self.patience_s:.0f} s", self._at)
        turn = _turn_of(self._fs)
        if not turn.acquire(timeout=self.patience_s):
            raise silent

        def ask() -> None:
            try:
                answers.append(request())
            except BaseException as error:
                errors.append(error)
            finally:
                turn.release()

        thread = threading.Thread(target=ask, daemon=True, name="store")
        thread.start()
        thread.join(self.patience_s)
        if errors:
            raise errors[0]
        if not answers:
            raise silent
        return answers[0]

    def _has(self, name: str) -> bool:
        def exists() -> bool:
            # What others wrote counts, too.
            self._fs.invalidate_cache()
            return bool(self._fs.exists(self._at_store(name)))

        return self._asked(exists)

    def _get(self, name: str) -> bytes | None:
        try:
            return bytes(self._asked(lambda: self._fs.cat_file(self._at_store(name))))
        except FileNotFoundError:
            return None

    def _put(self, name: str, content: bytes) -> None:
        path = self._at_store(name)
        self._asked(lambda: self._written(path, content))

    def _written(self, path: str, content: bytes) -> None:
        if not self._is_local:
            folder, _, name = path.rpartition("/")
            with contextlib.suppress(NotImplementedError):
                self._fs.makedirs(folder, exist_ok=True)
            if not _protocols(self._fs) & _RENAMES:
                # Such a store shows an object when it is whole.
                self._fs.pipe_file(path, content)
                return
            new = f"{folder}/.{name}.{secrets.token_hex(4)}"
            try:
                self._fs.pipe_file(new, content)
                self._fs.mv(new, path)
            except BaseException:
                with contextlib.suppress(Exception):
                    self._fs.rm_file(new)
                raise
            return
        _write(Path(path), content)

    def _remove(self, name: str) -> None:
        path = self._at_store(name)
        with contextlib.suppress(FileNotFoundError):
            self._asked(lambda: self._fs.rm_file(path))
        if self._is_local:
            _tidy(Path(path))
            # Up to the table's own folder, which others may be writing to.
            for folder in list(Path(path).parents)[:3]:
                with contextlib.suppress(OSError):
                    folder.rmdir()

    def _places_in(self, table: str) -> list[Place]:
        def find() -> list[str]:
            # What others wrote counts, too.
            self._fs.invalidate_cache()
            return list(self._fs.find(self._at_store(table)))

        try:
            paths = self._asked(find)
        except FileNotFoundError:
            return []
        if self._is_web:
            paths = [unquote(path) for path in paths]
        return sorted(self._parsed(paths))

    def _parsed(self, paths: Sequence[str]) -> Iterator[Place]:
        for path in paths:
            found = _PLACE.search(path)
            if found is not None:
                yield Place(*map(unquote, found.groups()))


def shown_url(url: str) -> str:
    """A URL for a person: without the user and the password in it.

    >>> shown_url("sftp://ana:secret@host/fleet"), shown_url("fleet")
    ('sftp://host/fleet', 'fleet')
    """
    return _SECRET.sub("", url)


def _turn_of(fs: Any) -> threading.BoundedSemaphore:  # noqa: ANN401 - fsspec has no types
    """What a request to a store waits for: not all libraries can have two at a time."""
    many = threading.BoundedSemaphore(_MOST_REQUESTS if fs.async_impl else 1)
    found: threading.BoundedSemaphore = fs.__dict__.setdefault("_pytpc_turn", many)
    return found


def _protocols(fs: Any) -> set[str]:  # noqa: ANN401 - fsspec has no types
    return {fs.protocol} if isinstance(fs.protocol, str) else set(fs.protocol)


def _write(target: Path, content: bytes) -> None:
    """Write a file, in a folder from which others may remove what is no whole file."""
    for left in reversed(range(_TRIES)):
        try:
            target.parent.mkdir(parents=True, exist_ok=True)
            staged = stage_beside(target, content, mode=0o666)
            try:
                staged.replace(target)
            finally:
                staged.unlink(missing_ok=True)
            break
        except FileNotFoundError:
            if not left:
                raise
    _tidy(target)


def _tidy(target: Path) -> None:
    """Remove what somebody who was killed left of a file; who still writes it begins again."""
    for path in leftovers(target):
        path.unlink(missing_ok=True)


def _file(table: str, place: Place) -> str:
    return f"{table}/{place.folder}/{_PART}"


def _parquet(rows: pa.Table) -> bytes:
    stream = io.BytesIO()
    # Readers skip by times and numbers; of texts the statistics are as long as the texts.
    numbers = [one.name for one in rows.schema if pa.types.is_integer(one.type)]
    pq.write_table(rows, stream, compression="zstd", write_statistics=numbers)
    return stream.getvalue()
