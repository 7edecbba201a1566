"""Missions are added to a data set once, as a whole, and what is broken is named."""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
from dataclasses import replace
from pathlib import Path

import fsspec
import numpy as np
import pyarrow.dataset as ds
import pyarrow.parquet as pq
import pytest
from click.testing import CliRunner
from fsspec.implementations.memory import MemoryFileSystem
from recorded_fleet import EXAMPLE, mission

from patience import PATIENCE_S, wait_for
from pytpc.api.dask_engine import engine
from pytpc.api.fleet_adding import AddOptions, add
from pytpc.api.fleet_digests import comparisons_of
from pytpc.api.fleet_given import missions_at
from pytpc.api.fleet_missions import Selection, missions, write_folder
from pytpc.api.missions import with_names_of
from pytpc.base.errors import InputError, TpcError
from pytpc.cli.main import main
from pytpc.fleet.data_set import Fleet, Place
from pytpc.ingest.condense import condensed
from pytpc.ingest.reading import read
from pytpc.recording.events import Events
from pytpc.recording.mission import load_recording
from pytpc.static.static_info import StaticInfo

pytestmark = pytest.mark.filterwarnings("ignore")


def run(*words: object) -> str:
    """Standard output of a command that must do well."""
    done = CliRunner().invoke(main, ["fleet", *map(str, words)], catch_exceptions=False)
    assert done.exit_code == 0, done.output
    return done.stdout


def added(fleet: Fleet, *paths: Path, **options: object):
    with engine(workers=2) as own:
        return add(fleet, missions_at(paths), AddOptions(**options), own)


def files(folder: Path) -> dict[str, bytes]:
    found = sorted(path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in found}


# Folders of two robots; a good one and one with a mark of robot a, a good one of b.
@pytest.fixture
def recorded(tmp_path: Path) -> Path:
    folder = tmp_path / "recorded"
    mission(folder / "a/first", 0)
    mission(folder / "a/second", 1, marks=2)
    mission(folder / "b/first", 2)
    return folder


def test_missions_are_added_once(recorded: Path, tmp_path: Path):
    fleet = tmp_path / "fleet"
    assert run("add", fleet, recorded).startswith("3 missions added: 9,000 reports in ")
    before = files(fleet)
    assert run("add", fleet, recorded) == "0 missions added; 3 were there already\n"
    assert run("add", fleet, recorded, "--again") == "0 missions added; 3 were there already\n"
    assert files(fleet) == before
    rows = json.loads(run("list", fleet, "--json"))
    assert [(one["robot"], one["day"], one["name"], one["verdict"]) for one in rows] == [
        ("a", "2023-11-14", "first", "good"),
        ("a", "2023-11-15", "second", "bad"),
        ("b", "2023-11-16", "first", "good"),
    ]
    assert {(one["reports"], one["marks"]) for one in rows} == {(3000, 0), (3000, 2)}
    bad = json.loads(run("list", fleet, "--json", "--verdict", "bad", "--since", "2023-11-15"))
    assert [one["name"] for one in bad] == ["second"]


# A mark that is made later belongs to the same mission.
def test_marks_of_later(recorded: Path, tmp_path: Path):
    fleet = Fleet(str(tmp_path / "fleet"))
    places = [one.place for one in added(fleet, recorded)]
    at = load_recording(recorded / "a/first").start_ns + 5
    (recorded / "a/first/marks.csv").write_text(f"time_ns,type,observer,note\n{at},II,bo,late\n")
    again = added(fleet, recorded)
    assert [one.place for one in again] == places
    assert [one.reports for one in again] == [3000, 0, 0]
    with engine() as own:
        found = missions(fleet, own).found
    assert [one.verdict for one in found] == ["bad", "bad", "good"]
    assert fleet.read(places[0], "marks")["note"].to_pylist() == ["late"]


def test_any_arrow_tool_reads_it(recorded: Path, tmp_path: Path):
    fleet = tmp_path / "fleet"
    run("add", fleet, recorded)
    table = ds.dataset(fleet / "comparisons", partitioning="hive").to_table()
    assert {"robot", "day", "mission", "key", "parameter", "median"} <= set(table.column_names)
    assert set(table["robot"].to_pylist()) == {"a", "b"}
    assert sum(table["evaluations"].to_pylist()) == 9000
    values = pq.read_table(fleet / "values").to_pandas()
    assert set(values.mission) == {
        one["mission"] for one in json.loads(run("list", fleet, "--json"))
    }


# 3,000 evaluations of which most are in summaries; all of them where the user wants that.
def test_a_mission_is_a_folder_again(recorded: Path, tmp_path: Path):
    whole = load_recording(recorded / "a/second")
    fleet = Fleet(str(tmp_path / "full"))
    for one in added(fleet, recorded / "a/second", keep="full"):
        assert one.place is not None
        write_folder(fleet, one.place, tmp_path / "again")
    again = load_recording(tmp_path / "again")
    for name, column in whole.events.columns().items():
        if name not in {"key", "node"}:
            assert np.array_equal(column, again.events.columns()[name])
    assert again.marks == whole.marks
    small = Fleet(str(tmp_path / "small"))
    (one,) = added(small, recorded / "a/second")
    assert one.place is not None
    # The same mission, whatever is kept of it.
    assert one.place == fleet.places()[0]
    write_folder(small, one.place, tmp_path / "edges")
    edges = load_recording(tmp_path / "edges")
    assert int(edges.summaries.count.sum()) == 3000
    assert int(edges.summaries.flops.sum()) == int(whole.events.flop.sum())
    assert len(edges.events) < 1000
    said = CliRunner().invoke(main, ["rank", str(tmp_path / "edges"), "--json"])
    assert said.exit_code == 0, said.output


def test_a_broken_mission_among_others(recorded: Path, tmp_path: Path):
    for name in ("events.parquet", "marks.json"):
        path = recorded / "a/second" / name
        path.write_bytes(path.read_bytes()[:200])
    done = CliRunner().invoke(main, ["fleet", "add", str(tmp_path / "fleet"), str(recorded)])
    assert done.exit_code == 1
    assert done.stdout == "2 missions added: 6,000 reports in " + done.stdout[35:]
    assert done.stdout.endswith("; 1 could not be added\n")
    (line,) = [one for one in done.stderr.splitlines() if "error" in one]
    assert line.startswith(f"pytpc: error: {recorded}/a/second: ")


def test_a_broken_file_in_the_data_set(recorded: Path, tmp_path: Path):
    fleet = tmp_path / "fleet"
    run("add", fleet, recorded)
    first = sorted((fleet / "missions").rglob("*.parquet"))[0]
    first.write_bytes(b"PAR1 and nothing else")
    done = CliRunner().invoke(main, ["fleet", "list", str(fleet), "--json"])
    assert done.exit_code == 1
    assert len(json.loads(done.stdout)) == 2
    assert "warning: a/2023-11-14/first-" in done.stderr


def test_a_data_set_of_tomorrow(tmp_path: Path):
    (tmp_path / "fleet.json").write_text('{"schema": 2}')
    done = CliRunner().invoke(main, ["fleet", "list", str(tmp_path)])
    assert done.exit_code == 1
    what = "is a fleet's data set of format 2; this TPC reads 1: install a newer pytpc"
    assert done.stderr == f"pytpc: error: {tmp_path}: {what}\n"


def test_something_else_is_there(tmp_path: Path, recorded: Path):
    with pytest.raises(InputError, match="is no fleet's data set"):
        added(Fleet(str(tmp_path)), recorded)
    with pytest.raises(InputError, match="make one with `pytpc fleet add`"):
        Fleet(str(tmp_path)).check()


# Whose clock was never set begins in 1970; one that is years ahead is named.
def test_clocks_that_disagree(tmp_path: Path):
    mission(tmp_path / "r/late", 3000)
    made = added(Fleet(str(tmp_path / "fleet")), tmp_path / "r")
    # Files of today, reports of 2032.
    assert made[0].notes[-1].startswith("its clock says 2032-01-31, but its files are of 20")


def test_half_written_missions_do_not_exist(recorded: Path, tmp_path: Path):
    fleet = Fleet(str(tmp_path / "fleet"))
    added(fleet, recorded)
    place = fleet.places()[0]
    (tmp_path / "fleet/missions" / place.folder / "part.parquet").unlink()
    assert len(fleet.places()) == 2
    assert fleet.unfinished() == [place]
    assert "missions" in run("show", fleet.url)
    assert run("drop", fleet.url, "--half", "--yes") == "1 mission removed\n"
    assert fleet.unfinished() == []
    added(fleet, recorded)
    assert len(fleet.places()) == 3


def test_missions_are_removed(recorded: Path, tmp_path: Path):
    fleet = tmp_path / "fleet"
    run("add", fleet, recorded)
    run("drop", fleet, "--robot", "a", "--yes")
    assert [one["robot"] for one in json.loads(run("list", fleet, "--json"))] == ["b"]
    assert not list(fleet.rglob("robot=a"))
    run("drop", fleet, "first", "--yes")
    assert json.loads(run("list", fleet, "--json")) == []


def _add_in_process(fleet: str, recorded: str) -> None:
    added(Fleet(fleet), Path(recorded))


def test_two_who_add_the_same_at_once(recorded: Path, tmp_path: Path):
    once = tmp_path / "once"
    run("add", once, recorded)
    both = tmp_path / "both"
    spawn = multiprocessing.get_context("spawn")
    processes = [
        spawn.Process(target=_add_in_process, args=(str(both), str(recorded))) for _ in range(2)
    ]
    for process in processes:
        process.start()
    for process in processes:
        process.join(PATIENCE_S)
        assert process.exitcode == 0
    assert files(both) == files(once)


def test_threads_processes_and_a_killed_worker_make_the_same(tmp_path: Path):
    for number in range(8):
        mission(tmp_path / f"recorded/r{number % 3}/m{number}", number, marks=number % 2)
    run("add", tmp_path / "threads", tmp_path / "recorded")
    command = [sys.executable, "-m", "pytpc", "fleet", "add", "killed", "recorded"]
    env = {**os.environ, "PYTHONPATH": str(EXAMPLE.parents[1])}
    adding = subprocess.Popen(
        [*command, "--cluster", "local", "--workers", "2"], cwd=tmp_path, env=env,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    done = tmp_path / "killed/missions"
    wait_for(lambda: adding.poll() is not None or any(done.rglob("part.parquet")))
    workers = _workers_of(adding.pid)
    if adding.poll() is None:
        # It may have ended just now; then nobody was killed, and the rest still holds.
        for worker in workers[:1]:
            os.kill(worker, signal.SIGKILL)
    said, errors = adding.communicate(timeout=PATIENCE_S)
    assert adding.returncode == 0, errors
    assert said.startswith("8 missions added")
    assert files(tmp_path / "killed") == files(tmp_path / "threads")


def _workers_of(parent: int) -> list[int]:
    """The processes of workers: the children of the nannies' process that run tasks."""
    found = []
    for folder in Path("/proc").iterdir():
        try:
            status = (folder / "stat").read_text().rpartition(") ")[2].split()
            command = (folder / "cmdline").read_bytes()
        except (OSError, IndexError):
            continue
        if folder.name.isdigit() and int(status[1]) == parent and b"spawn_main" in command:
            found.append(int(folder.name))
    return found


def test_ctrl_c_leaves_a_whole_data_set(tmp_path: Path):
    for number in range(30):
        mission(tmp_path / f"recorded/r/m{number}", number)
    command = [sys.executable, "-m", "pytpc", "fleet", "add", "fleet", "recorded"]
    env = {**os.environ, "PYTHONPATH": str(EXAMPLE.parents[1])}
    adding = subprocess.Popen(command, cwd=tmp_path, env=env, stderr=subprocess.PIPE)
    wait_for(lambda: adding.poll() is not None or any((tmp_path / "fleet").rglob("part.parquet")))
    adding.send_signal(signal.SIGINT)
    adding.communicate(timeout=PATIENCE_S)
    assert adding.returncode in (0, 130)
    rows = json.loads(run("list", tmp_path / "fleet", "--json"))
    assert rows or adding.returncode == 130
    run("add", tmp_path / "fleet", tmp_path / "recorded")
    assert len(json.loads(run("list", tmp_path / "fleet", "--json"))) == 30


class _Slow(MemoryFileSystem):
    """A store that answers only when it is told to."""

    protocol = "slow"
    answers = threading.Event()

    def cat_file(self, path, *args, **kwargs):
        type(self).answers.wait(PATIENCE_S)
        return super().cat_file(path, *args, **kwargs)


@pytest.fixture
def _stores():
    fsspec.register_implementation("slow", _Slow, clobber=True)
    _Slow.answers.clear()
    MemoryFileSystem.store.clear()
    yield
    _Slow.answers.set()
    MemoryFileSystem.store.clear()


@pytest.mark.usefixtures("_stores")
def test_a_store_that_does_not_answer():
    with pytest.raises(TpcError, match="the store does not answer within 0 s"):
        Fleet("slow://fleet", 0.2).check()


@pytest.mark.usefixtures("_stores")
def test_a_store_at_a_url(recorded: Path):
    fleet = Fleet("memory://some/fleet")
    added(fleet, recorded)
    assert [place.robot for place in fleet.places()] == ["a", "a", "b"]
    with engine() as own:
        found = missions(fleet, own, Selection(robots=("b",))).found
    assert [one.name for one in found] == ["first"]
    fleet.drop(found[0].place)
    assert [place.robot for place in fleet.places()] == ["a", "a"]


def test_a_store_of_no_known_kind(recorded: Path):
    with pytest.raises(InputError, match="no such store"):
        added(Fleet("nosuch://fleet"), recorded)


# A file system with room for a few kilobytes.
def test_a_full_disk(recorded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    fleet = Fleet(str(tmp_path / "fleet"))
    real = os.fsync
    left = [9]

    def fsync(descriptor: int) -> None:
        left[0] -= 1
        if left[0] < 0:
            raise OSError(28, "No space left on device")
        real(descriptor)

    monkeypatch.setattr(os, "fsync", fsync)
    made = added(fleet, recorded)
    assert {one.why for one in made if one.place is None} == {
        f"{fleet.url}: No space left on device"
    }
    monkeypatch.undo()
    assert not [path for path in (tmp_path / "fleet").rglob(".*") if path.is_file()]
    assert len(fleet.places()) == sum(one.place is not None for one in made) < 3
    assert all(one.place is not None for one in added(fleet, recorded))
    assert len(fleet.places()) == 3


def test_names_that_paths_take_otherwise(recorded: Path, tmp_path: Path):
    place = Place("../a=b c/..", "2026-11-30", "x%2F?")
    fleet = Fleet(str(tmp_path / "fleet"))
    (one,) = added(fleet, recorded / "b/first")
    assert one.place is not None
    fleet.write(place, {name: fleet.read(one.place, name) for name in ("missions", "reports")})
    assert place in fleet.places()
    assert not (tmp_path / "a=b c").exists()
    fleet.drop(place)
    assert fleet.places() == [one.place]


# Bags in a folder are missions of their own; a folder of pytpc record is one.
def test_what_is_one_mission(tmp_path: Path):
    for name in ("bags/monday.bag", "bags/tuesday.bag", "one/run.json", "one/mission.bag"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.touch()
    found = [(str(one.path.relative_to(tmp_path)), one.robot) for one in missions_at([tmp_path])]
    assert found == [
        ("bags/monday.bag", "bags"), ("bags/tuesday.bag", "bags"), ("one", tmp_path.name),
    ]  # fmt: skip
    assert {one.robot for one in missions_at([tmp_path], "uav")} == {"uav"}
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="no recordings in this folder"):
        missions_at([tmp_path / "empty"])


# A terminal sends Ctrl-C to the workers, too: only the command answers it.
def test_ctrl_c_with_workers_is_one_line(tmp_path: Path):
    for number in range(12):
        mission(tmp_path / f"recorded/r/m{number}", number)
    command = [sys.executable, "-m", "pytpc", "fleet", "add", "fleet", "recorded"]
    env = {**os.environ, "PYTHONPATH": str(EXAMPLE.parents[1])}
    adding = subprocess.Popen(
        [*command, "--cluster", "local", "--workers", "2"], cwd=tmp_path, env=env,
        stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    done = tmp_path / "fleet/missions"
    wait_for(lambda: adding.poll() is not None or any(done.rglob("part.parquet")))
    os.killpg(adding.pid, signal.SIGINT)
    _, errors = adding.communicate(timeout=PATIENCE_S)
    # It may have ended just before.
    assert adding.returncode in (0, 130)
    assert ("pytpc: interrupted" in errors.splitlines()) == (adding.returncode == 130)
    assert "Traceback" not in errors


def test_condensed_reading_counts_all(tmp_path: Path):
    path = mission(tmp_path / "m", 0, marks=1)
    small = read(path, period_ns=10**10)
    whole = read(path)
    assert int(small.summaries.count.sum()) == len(whole.events)
    assert int(small.events.flop.sum()) == int(whole.events.flop.sum())


# Three nodes, a comparison and its second instance, whose threshold is now 0 and now 8; NaN and
# infinities; a clock that is set back by 30 s. Counts are exact, and no value is made up.
def test_condensed_counts_of_nodes_and_instances():
    whole = load_recording(EXAMPLE)
    random = np.random.default_rng(1)
    keys = sorted({*whole.events.keys[:2], f"{whole.events.keys[0]}#2"})
    rows = 3000
    times = np.sort(random.integers(10**18, 10**18 + 60 * 10**9, rows))
    times[rows // 2 :] -= 30 * 10**9
    cmp, thresh = random.normal(size=rows), random.choice([0.0, 8.0], rows)
    cmp[::50], cmp[1::50], thresh[2::50] = np.nan, np.inf, -np.inf
    columns = {
        "time_ns": times, "cmp": cmp, "thresh": thresh, "result": cmp > thresh,
        "res": cmp > thresh, "key": random.integers(0, 3, rows), "node": np.arange(rows) % 3,
    }  # fmt: skip
    events = Events.of(**columns, keys=keys, nodes=["/a", "/b", "/c/d"])
    span = {"start_ns": int(events.time_ns.min()), "end_ns": int(events.time_ns.max())}
    recording = replace(whole, events=events, marks=(), **span)
    static = StaticInfo.load(EXAMPLE / "static.json")
    named = with_names_of(recording, static, None)
    exact = comparisons_of(recording, named).to_pylist()
    small = comparisons_of(condensed(recording, 10**10), named).to_pylist()
    names = ("key", "node", "evaluations", "turns", "first_ns", "last_ns", "first_turn_ns")
    assert [[one[name] for name in names] for one in small] == [
        [one[name] for name in names] for one in exact
    ]
    assert len(small) == 9
    finite = np.concatenate([cmp[np.isfinite(cmp)], thresh[np.isfinite(thresh)]])
    for one in small:
        assert finite.min() <= one["value_low"] <= one["value_high"] <= finite.max()
