"""The files of a data set: in a folder, or in a store that fsspec reaches (S3, GS, HTTP, SFTP).

Each appears as a whole or not at all. What others write meanwhile is seen; an answer has its time.
"""

from __future__ import annotations

import contextlib
import re
import secrets
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar
from urllib.parse import quote, unquote

from pytpc.base.atomic import leftovers, stage_beside
from pytpc.base.errors import InputError, TpcError
from pytpc.base.wording import plain

Answer = TypeVar("Answer")

PATIENCE_S = 60.0
"""How long one request to a store may take."""
_TRIES = 5
_RENAMES = frozenset({"sftp", "ssh"})
"""Stores that show a file while it is written."""
_MOST_REQUESTS = 64
_SECRET = re.compile(r"(?<=://)[^/\s]*@")


@dataclass(frozen=True)
class Store:
    """A folder or a store, opened when it is asked for the first time.

    All methods raise TpcError where it does not answer in time, or cannot.

    Attributes:
        url: a folder, or a URL such as ``s3://bucket/fleet``.
        patience_s: how long a request may take; a folder is not timed.
        options: for the store, as fsspec takes them.
    """

    url: str
    patience_s: float = PATIENCE_S
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def shown(self) -> str:
        """Its URL for a person."""
        return shown_url(self.url)

    def path_of(self, name: str) -> str:
        """Where a file is, for a person."""
        return f"{self.shown.rstrip('/')}/{name}"

    def names(self) -> list[str]:
        """What is directly in it; nothing, where it does not exist."""

        def names() -> list[str]:
            self._fs.invalidate_cache()
            if not self._fs.exists(self._root):
                return []
            found = [one.rstrip("/") for one in self._fs.ls(self._root, detail=False)]
            # Stores list a folder that somebody made by hand as a thing in it.
            return [one.rpartition("/")[2] for one in found if one != self._root.rstrip("/")]

        try:
            return self._asked(names)
        except FileNotFoundError:
            return []

    def files_below(self, folder: str) -> list[str]:
        """The paths of all files below a folder, in the store's own words; it need not exist."""

        def find() -> list[str]:
            # What others wrote counts, too.
            self._fs.invalidate_cache()
            return list(self._fs.find(self._at(folder)))

        try:
            paths = self._asked(find)
        except FileNotFoundError:
            return []
        return [unquote(path) for path in paths] if self._is_web else paths

    def bytes_below(self, folder: str) -> int:
        """How many bytes the files below a folder have; it need not exist."""
        try:
            return int(self._asked(lambda: self._fs.du(self._at(folder))))
        except FileNotFoundError:
            return 0

    def has(self, name: str) -> bool:
        """Whether there is a file."""

        def exists() -> bool:
            # What others wrote counts, too.
            self._fs.invalidate_cache()
            return bool(self._fs.exists(self._at(name)))

        return self._asked(exists)

    def get(self, name: str) -> bytes | None:
        """The content of a file; None where there is none."""
        try:
            return bytes(self._asked(lambda: self._fs.cat_file(self._at(name))))
        except FileNotFoundError:
            return None

    def put(self, name: str, content: bytes) -> None:
        """Write a file, in the place of what was there."""
        path = self._at(name)
        try:
            self._asked(lambda: self._written(path, content))
        except FileNotFoundError as error:
            why = shown_url(f"{error.strerror or error}")
            raise TpcError(f"cannot be written: {why}", self.path_of(name)) from error

    def remove(self, name: str) -> None:
        """Remove a file, unless there is none."""
        path = self._at(name)
        with contextlib.suppress(FileNotFoundError):
            self._asked(lambda: self._fs.rm_file(path))
        if self._is_local:
            _tidy(Path(path))
            # Up to the table's own folder, which others may be writing to.
            for folder in list(Path(path).parents)[:3]:
                with contextlib.suppress(OSError):
                    folder.rmdir()

    def tidy(self, name: str) -> None:
        """Remove what one who was killed left of a file."""
        if self._is_local:
            _tidy(Path(self._at(name)))

    @cached_property
    def _opened(self) -> tuple[Any, str]:
        from fsspec.core import url_to_fs  # noqa: PLC0415 - only fleets need it

        try:
            fs, root = url_to_fs(self.url, **self.options)
        except (ImportError, ValueError) as error:
            why = shown_url(str(error).partition("\n")[0])
            raise InputError(f"no such store: {plain(why)}", self.shown) from error
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

    def _at(self, name: str) -> str:
        """The path of a file or table; in that of a web server the escapes are escaped again."""
        return f"{self._root}/{quote(name, safe='/=') if self._is_web else name}"

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
            raise TpcError(shown_url(f"{error.strerror or error}"), self.shown) from error
        except TpcError:
            raise
        except Exception as error:  # each store has errors of its own
            why = shown_url(str(error).partition("\n")[0]) or type(error).__name__
            raise TpcError(f"the store says: {plain(why)}", self.shown) from error

    def _in_time(self, request: Callable[[], Answer]) -> Answer:
        """Wait for the answer in a thread that may be left behind."""
        answers: list[Answer] = []
        errors: list[BaseException] = []
        silent = TpcError(f"the store does not answer within {self.patience_s:.0f} s", self.shown)
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

    def _written(self, path: str, content: bytes) -> None:
        if self._is_local:
            _write(Path(path), content)
            return
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
            # Of many who write the same at once, each takes away what the others have begun.
            if _is_there(target, content):
                break
            if not left:
                raise
    _tidy(target)


def _is_there(target: Path, content: bytes) -> bool:
    try:
        return target.read_bytes() == content
    except OSError:
        return False


def _tidy(target: Path) -> None:
    """Remove what somebody who was killed left of a file; who still writes it begins again.

    What is not ours to remove stays: the file itself is whole, or gone.
    """
    for path in leftovers(target):
        with contextlib.suppress(OSError):
            path.unlink()
