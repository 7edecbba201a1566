"""The store of a fleet beside others who write, on web servers, and with hostile content."""

from __future__ import annotations

import http.server
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar
from urllib.parse import quote

import fsspec
import pyarrow as pa
import pytest
from click.testing import CliRunner
from fsspec.implementations.memory import MemoryFileSystem
from recorded_fleet import mission

from pytpc.api.dask_engine import engine
from pytpc.api.fleet_adding import AddOptions, add
from pytpc.api.fleet_given import missions_at
from pytpc.api.fleet_missions import opened, write_folder
from pytpc.base.errors import InputError, TpcError
from pytpc.cli.main import main
from pytpc.fleet.data_set import Fleet, Place
from pytpc.fleet.store import Store, shown_url
from pytpc.fleet.tables import TABLES

pytestmark = pytest.mark.filterwarnings("ignore")


@pytest.fixture
def fleet(tmp_path: Path) -> Fleet:
    mission(tmp_path / "recorded/uav 1/m", 0, marks=1)
    made = Fleet(str(tmp_path / "fleet"))
    with engine(workers=1) as own:
        add(made, missions_at([tmp_path / "recorded"]), AddOptions(), own)
    return made


def tables_of(fleet: Fleet, place: Place) -> dict[str, pa.Table]:
    return {table: fleet.read(place, table) for table in TABLES}


# Killed between two tables: what is there is half of each version, and must not count.
def test_a_mission_that_is_replaced_does_not_exist_meanwhile(
    fleet: Fleet, monkeypatch: pytest.MonkeyPatch
):
    (place,) = fleet.places()
    tables = tables_of(fleet, place)
    real, seen = Store.put, []

    def put(self: Store, name: str, content: bytes) -> None:
        seen.append((name.partition("/")[0], fleet.has(place)))
        if name.startswith("values"):
            raise KeyboardInterrupt
        real(self, name, content)

    monkeypatch.setattr(Store, "put", put)
    with pytest.raises(KeyboardInterrupt):
        fleet.write(place, tables | {"marks": tables["marks"].slice(0, 0)})
    assert seen
    assert not any(exists for _, exists in seen)
    assert fleet.places() == []
    assert fleet.unfinished() == [place]


def test_the_same_again_touches_nothing(fleet: Fleet, monkeypatch: pytest.MonkeyPatch):
    (place,) = fleet.places()
    tables = tables_of(fleet, place)

    def put(self: Store, name: str, content: bytes) -> None:
        pytest.fail(f"{name} is written again")

    monkeypatch.setattr(Store, "put", put)
    assert fleet.write(place, tables) > 0


# Somebody drops what is half written just before its row comes.
def test_what_is_dropped_while_it_is_added_is_whole(fleet: Fleet, monkeypatch: pytest.MonkeyPatch):
    (place,) = fleet.places()
    tables = tables_of(fleet, place)
    fleet.drop(place)
    real = Store.put

    def put(self: Store, name: str, content: bytes) -> None:
        if name.startswith("missions"):
            monkeypatch.setattr(Store, "put", real)
            fleet.drop(place)
        real(self, name, content)

    monkeypatch.setattr(Store, "put", put)
    fleet.write(place, tables)
    assert tables_of(fleet, place) == tables


# Its row comes while its tables are removed: all of it goes.
def test_what_is_added_while_it_is_dropped_is_gone(fleet: Fleet, monkeypatch: pytest.MonkeyPatch):
    (place,) = fleet.places()
    tables = tables_of(fleet, place)
    real = Store.remove

    def remove(self: Store, name: str) -> None:
        real(self, name)
        if name.startswith("marks"):
            monkeypatch.setattr(Store, "remove", real)
            fleet.write(place, tables)
            real(self, name)

    monkeypatch.setattr(Store, "remove", remove)
    fleet.drop(place)
    assert fleet.places() == []
    assert fleet.unfinished() == []


# The reader has the row, and another version comes before it reads the reports.
def test_a_reader_sees_one_version(fleet: Fleet, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (place,) = fleet.places()
    real = Fleet.read

    def read(self: Fleet, where: Place, table: str, columns=None) -> pa.Table:
        if table == "reports":
            monkeypatch.setattr(Fleet, "read", real)
            with engine(workers=1) as own:
                add(self, missions_at([tmp_path / "recorded"]), AddOptions(keep="full"), own)
        return real(self, where, table, columns)

    monkeypatch.setattr(Fleet, "read", read)
    with opened(fleet, place) as found:
        assert len(found.recording.events) == 3000
        assert len(found.recording.summaries) == 0


def test_a_folder_that_somebody_removes_while_it_is_empty(
    fleet: Fleet, monkeypatch: pytest.MonkeyPatch
):
    (place,) = fleet.places()
    tables = tables_of(fleet, place)
    fleet.drop(place)
    real, removed = Path.mkdir, []

    def mkdir(self: Path, *words: object, **named: object) -> None:
        real(self, *words, **named)
        if self.name.startswith("mission=") and self not in removed:
            removed.append(self)
            self.rmdir()

    monkeypatch.setattr(Path, "mkdir", mkdir)
    fleet.write(place, tables)
    assert removed
    assert fleet.places() == [place]


# Killed between a file and its name: nobody else would ever remove it.
@pytest.mark.parametrize("again", ["write", "drop"])
def test_what_one_who_was_killed_left_is_removed(fleet: Fleet, again: str):
    (place,) = fleet.places()
    tables = tables_of(fleet, place)
    root = Path(fleet.url)
    clean = {path for path in root.rglob("*") if path.is_file()}
    fleet.drop(place)
    for table in TABLES:
        folder = root / table / place.folder
        folder.mkdir(parents=True)
        (folder / ".part.parquet.tpc-0123abcd").write_bytes(b"PAR1")
    (build,) = (root / "builds").iterdir()
    build.with_name(f".{build.name}.tpc-0123abcd").write_bytes(b"{")
    fleet.put_build(build.stem, build.read_bytes())
    if again == "write":
        fleet.write(place, tables)
        assert {path for path in root.rglob("*") if path.is_file()} == clean
    else:
        fleet.drop(place)
        left = {path for path in root.rglob("*") if path.is_file()}
        assert left == {root / "fleet.json", build}
        assert not any(path.name.startswith("mission=") for path in root.rglob("*"))


# Who adds the same mission at once takes a file that is half written for one of the dead.
def test_a_file_that_is_taken_away_is_written_again(fleet: Fleet, monkeypatch: pytest.MonkeyPatch):
    (place,) = fleet.places()
    tables = tables_of(fleet, place)
    fleet.drop(place)
    real, taken = Path.replace, []

    def replace(self: Path, target: Path) -> Path:
        if target not in taken:
            taken.append(target)
            self.unlink()
        return real(self, target)

    monkeypatch.setattr(Path, "replace", replace)
    fleet.write(place, tables)
    assert taken
    assert tables_of(fleet, place) == tables


# The first missions of a build, on many workers: each time another one is a little earlier.
def test_many_who_write_the_same_file_at_once(fleet: Fleet, monkeypatch: pytest.MonkeyPatch):
    real = Path.replace

    def replace(self: Path, target: Path) -> Path:
        monkeypatch.setattr(Path, "replace", real)
        fleet.store.put("builds/0123.json", b"{}")
        monkeypatch.setattr(Path, "replace", replace)
        return real(self, target)

    monkeypatch.setattr(Path, "replace", replace)
    fleet.put_build("0123", b"{}")
    assert fleet.build("0123") == b"{}"
    assert len(list((Path(fleet.url) / "builds").glob("*0123*"))) == 1


def test_a_file_that_is_always_taken_away(fleet: Fleet, monkeypatch: pytest.MonkeyPatch):
    real = Path.replace

    def replace(self: Path, target: Path) -> Path:
        self.unlink()
        return real(self, target)

    monkeypatch.setattr(Path, "replace", replace)
    with pytest.raises(TpcError, match=r"builds/0123\.json: cannot be written: No such file"):
        fleet.put_build("0123", b"{}")


# A folder stands for what somebody else owns, which the system does not let us remove.
def test_a_leftover_that_cannot_be_removed_does_no_harm(fleet: Fleet):
    (place,) = fleet.places()
    tables = tables_of(fleet, place)
    fleet.drop(place)
    root = Path(fleet.url)
    (build,) = (root / "builds").iterdir()
    folder = root / "marks" / place.folder
    for owned in (build, folder / "part.parquet"):
        owned.with_name(f".{owned.name}.tpc-0123abcd").mkdir(parents=True)
    fleet.put_build(build.stem, build.read_bytes())
    fleet.write(place, tables)
    assert tables_of(fleet, place) == tables
    fleet.drop(place)
    assert fleet.places() == []
    assert fleet.unfinished() == []


def test_two_who_begin_at_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    fleet = Fleet(str(tmp_path / "fleet"))
    real, asked = Store.has, []

    def has(self: Store, name: str) -> bool:
        found = real(self, name)
        if not asked:
            asked.append(name)
            # The other one is about to put its file in place, and does so.
            fleet.begin()
        return found

    monkeypatch.setattr(Store, "has", has)
    fleet.begin()
    fleet.check()
    other = tmp_path / "other"
    other.mkdir()
    (other / ".fleet.json.1f").touch()
    Fleet(str(other)).begin()


# --- hostile data sets


@pytest.mark.parametrize("name", ["/", "../../", "."])
def test_a_mission_whose_name_is_a_path(fleet: Fleet, tmp_path: Path, name: str):
    (good,) = fleet.places()
    named = name if name == "." else f"{name if name != '/' else ''}{tmp_path}/planted"
    place = Place("a", "2026-11-30", named)
    fleet.write(place, tables_of(fleet, good))
    with opened(fleet, place) as found:
        assert len(found.recording.events)
    assert not (tmp_path / "planted").exists()


def test_a_build_whose_name_is_a_path(fleet: Fleet, tmp_path: Path):
    (tmp_path / "secret.json").write_text("{}")
    with pytest.raises(InputError, match=r"information of build \.\./\.\./secret is missing"):
        fleet.build("../../secret")


# --- stores


class _Cached(MemoryFileSystem):
    """A store that remembers what it listed, as those of clouds do."""

    protocol = "cached-listings"
    listed: ClassVar[dict[str, list[str]]] = {}
    seen: ClassVar[dict[str, bool]] = {}

    def find(self, path, *args, **kwargs):
        if path not in self.listed:
            self.listed[path] = super().find(path, *args, **kwargs)
        return self.listed[path]

    def exists(self, path, **kwargs):
        return self.seen.setdefault(path, super().exists(path, **kwargs))

    def invalidate_cache(self, path=None):
        self.listed.clear()
        self.seen.clear()


def test_what_others_wrote_meanwhile_counts(fleet: Fleet):
    fsspec.register_implementation("cached-listings", _Cached, clobber=True)
    other = Fleet("cached-listings://fleet")
    (place,) = fleet.places()
    try:
        assert other.places() == []
        assert not other.has(place)
        path = f"missions/{place.folder}/part.parquet"
        MemoryFileSystem().pipe_file(other.store._at(path), fleet.store.get(path))
        assert other.places() == [place]
        assert other.has(place)
    finally:
        MemoryFileSystem.store.clear()


# What keeps copies of files of a store is no folder of this machine.
def test_a_store_with_copies_is_no_folder(tmp_path: Path):
    try:
        store = Store("filecache::memory://fleet", options={"filecache": {"cache_storage": "TMP"}})
        assert not store._is_local
        assert Store(str(tmp_path))._is_local
        assert Store(f"file://{tmp_path}")._is_local
    finally:
        MemoryFileSystem.store.clear()


@pytest.fixture
def server(tmp_path: Path) -> Iterator[str]:
    pytest.importorskip("aiohttp")

    class Handler(http.server.SimpleHTTPRequestHandler):
        def __init__(self, *words, **named):
            super().__init__(*words, directory=str(tmp_path), **named)

        def log_message(self, *_: object) -> None:
            pass

    made = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = threading.Thread(target=made.serve_forever, daemon=True)
    thread.start()
    yield f"http://127.0.0.1:{made.server_port}"
    made.shutdown()
    made.server_close()


def test_a_data_set_on_a_web_server(fleet: Fleet, server: str, tmp_path: Path):
    store = Fleet(f"{server}/fleet")
    (place,) = fleet.places()
    assert place.robot == "uav 1"
    assert quote(place.robot, safe="") == "uav%201"
    assert store.places() == [place]
    assert store.has(place)
    assert tables_of(store, place) == tables_of(fleet, place)
    assert store.bytes_of() == fleet.bytes_of()
    write_folder(store, place, tmp_path / "again")
    with pytest.raises(TpcError, match="the store says"):
        store.drop(place)
    assert fleet.places() == [place]


def test_passwords_are_not_printed():
    assert shown_url("sftp://ana:a@b@host/x") == "sftp://host/x"
    assert shown_url("filecache::ftp://u:p@h/x") == "filecache::ftp://h/x"
    assert shown_url("/data/ana@home") == "/data/ana@home"
    for url in ("nosuch://ana:secret@host/fleet", "sftp://ana:secret@127.0.0.1:9/fleet"):
        done = CliRunner().invoke(main, ["fleet", "list", url])
        assert done.exit_code == 1
        assert "secret" not in done.output
        assert "127.0.0.1:9/fleet" in done.stderr or "nosuch://host/fleet: " in done.stderr


class _Alone(MemoryFileSystem):
    """A store that two threads must not ask at once, and that shows a file while it is written."""

    protocol = ("alone", "sftp")
    asked, together = 0, 0
    names: ClassVar[list[str]] = []
    both = threading.Event()

    def cat_file(self, path, *args, **kwargs):
        own = type(self)
        own.asked += 1
        if own.asked > 1:
            own.together += 1
            own.both.set()
        own.both.wait(0.2)
        own.asked -= 1
        return super().cat_file(path, *args, **kwargs)

    def pipe_file(self, path, *args, **kwargs):
        type(self).names.append(path)
        return super().pipe_file(path, *args, **kwargs)


@pytest.fixture
def alone() -> Iterator[type[_Alone]]:
    fsspec.register_implementation("alone", _Alone, clobber=True)
    _Alone.asked = _Alone.together = 0
    _Alone.names.clear()
    _Alone.both.clear()
    MemoryFileSystem.store.clear()
    yield _Alone
    MemoryFileSystem.store.clear()


def test_a_store_that_takes_one_request_at_a_time(alone: type[_Alone]) -> None:
    fleet = Fleet("alone://some/fleet")
    fleet.begin()
    threads = [threading.Thread(target=fleet.check) for _ in range(4)]
    for one in threads:
        one.start()
    for one in threads:
        one.join()
    assert alone.together == 0


def test_a_store_that_shows_what_is_half_written(alone: type[_Alone]) -> None:
    Fleet("alone://some/fleet").begin()
    assert [name.rpartition("/")[2][:12] for name in alone.names] == [".fleet.json."]
    assert [name.rpartition("/")[2] for name in alone.store] == ["fleet.json"]
