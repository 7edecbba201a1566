"""What is there of a mission when its recording, or what the user asks for, has changed."""

from __future__ import annotations

import inspect
import json
import os
import shutil
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner
from recorded_fleet import STATIC, mission

from pytpc.api.dask_engine import engine
from pytpc.api.fleet_adding import Added, AddOptions, add, stamp_of
from pytpc.api.fleet_given import missions_at
from pytpc.api.fleet_missions import FleetMission, missions
from pytpc.cli.main import main
from pytpc.fleet.data_set import Fleet

pytestmark = pytest.mark.filterwarnings("ignore")


def added(fleet: Fleet, *paths: Path, robot: str | None = None, **options: object) -> list[Added]:
    with engine(workers=2) as own:
        return add(fleet, missions_at(paths, robot), AddOptions(**options), own)


def rows(fleet: Fleet) -> list[FleetMission]:
    with engine() as own:
        return list(missions(fleet, own).found)


@pytest.fixture
def fleet(tmp_path: Path) -> Fleet:
    return Fleet(str(tmp_path / "fleet"))


# What was asked for once stays when the folder is added by routine.
@pytest.mark.parametrize(
    ("once", "kept"),
    [
        ({"verdict": "bad"}, ("bad", "edges", "2023-11-14")),
        ({"keep": "full"}, ("good", "full", "2023-11-14")),
        ({"day": "2024-02-29"}, ("good", "edges", "2024-02-29")),
        ({"static": STATIC}, ("good", "edges", "2023-11-14")),
    ],
)
def test_what_was_asked_for_stays(fleet: Fleet, tmp_path: Path, once, kept):
    path = mission(tmp_path / "r/m", 0)
    added(fleet, path, **once)
    assert [one.is_new for one in added(fleet, path)] == [False]
    assert [(one.verdict, one.keep, one.place.day) for one in rows(fleet)] == [kept]


@pytest.mark.parametrize("asked", [{"verdict": "bad"}, {"keep": "full"}, {"day": "2024-02-29"}])
def test_what_is_asked_for_later_replaces(fleet: Fleet, tmp_path: Path, asked):
    path = mission(tmp_path / "r/m", 0)
    added(fleet, path)
    added(fleet, path, **asked)
    (one,) = rows(fleet)
    told = {"verdict": one.verdict, "keep": one.keep, "day": one.place.day}
    assert told == {"verdict": "good", "keep": "edges", "day": "2023-11-14"} | asked
    assert fleet.unfinished() == []


# 2,000 of 3,000 evaluations were written when it was added first.
def test_a_recording_that_grew_is_one_mission(fleet: Fleet, tmp_path: Path):
    path = mission(tmp_path / "r/m", 0, rows=2000)
    added(fleet, path)
    shutil.rmtree(path)
    mission(path, 0, rows=3000)
    added(fleet, path)
    assert [one.reports for one in rows(fleet)] == [3000]
    # Another mission under the same path, such as that of a memory card.
    shutil.rmtree(path)
    mission(path, 1, rows=3000)
    added(fleet, path)
    assert [one.place.day for one in rows(fleet)] == ["2023-11-14", "2023-11-15"]


def test_the_same_mission_of_two_robots_is_told(fleet: Fleet, tmp_path: Path):
    path = mission(tmp_path / "r/m", 0)
    (first,) = added(fleet, path)
    assert first.place is not None
    (second,) = added(fleet, path, robot="other")
    what = f"is there as r/2023-11-14/{first.place.mission}, too: it counts twice until you drop"
    assert second.is_new
    assert second.notes == (f"{what} one",)
    assert [one.notes for one in added(fleet, path, robot="other")] == [()]


# Marks of a folder of bags are those of each bag within its time.
@pytest.mark.parametrize("name", ["a.bag.marks.csv", "marks.csv", "params.yaml", "origins.json"])
@pytest.mark.parametrize("bag", ["a.bag", "a[1].bag"])
def test_a_stamp_tells_each_file_that_is_read(tmp_path: Path, name: str, bag: str):
    path = tmp_path / bag
    path.touch()
    before = stamp_of(path)
    (tmp_path / name.replace("a.bag", bag)).write_text("time_ns,type,observer,note\n")
    assert stamp_of(path) != before


# A folder of the system on a disk, such as lost+found, or one of somebody else.
def test_a_folder_that_cannot_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    mission(tmp_path / "disk/r/m", 0)
    closed = tmp_path / "disk/lost+found"
    closed.mkdir()
    real = Path.iterdir

    def iterdir(self: Path):
        if self == closed:
            raise PermissionError(13, "Permission denied")
        return real(self)

    monkeypatch.setattr(Path, "iterdir", iterdir)
    words = ["fleet", "add", str(tmp_path / "fleet"), str(tmp_path / "disk")]
    done = CliRunner().invoke(main, words)
    assert done.exit_code == 1
    assert done.stderr.startswith(f"pytpc: error: {closed}: cannot be read: Permission denied\n")
    assert done.stdout.startswith("1 mission added: ")
    assert done.stdout.endswith("; 1 could not be added\n")
    done = CliRunner().invoke(main, [*words[:-1], str(closed)])
    assert done.stderr == f"pytpc: error: {closed}: cannot be read: Permission denied\n"


def test_folders_deeper_than_the_stack_of_python(tmp_path: Path):
    deep = tmp_path.joinpath(*"d" * 200)
    deep.mkdir(parents=True)
    (deep / "m.bag").touch()
    limit = sys.getrecursionlimit()
    try:
        sys.setrecursionlimit(len(inspect.stack()) + 100)
        found = missions_at([tmp_path])
    finally:
        sys.setrecursionlimit(limit)
    assert [one.path for one in found] == [deep / "m.bag"]


# A robot's name of another encoding: 0xe9 is é in Latin 1.
def test_a_robot_whose_name_is_no_text(fleet: Fleet, tmp_path: Path):
    folder = Path(os.fsdecode(os.fsencode(tmp_path) + b"/caf\xe9"))
    mission(tmp_path / "r/m", 0)
    (tmp_path / "r").rename(folder)
    (one,) = missions_at([folder])
    assert one.robot == "caf\N{REPLACEMENT CHARACTER}"
    # Arrow opens no file below it: that is said, and the others are added.
    mission(tmp_path / "r/m", 0)
    made = added(fleet, folder, tmp_path / "r/m")
    assert [one.place is not None for one in made] == [False, True]
    assert made[0].why


def test_a_data_set_among_its_missions_is_no_mission(tmp_path: Path):
    mission(tmp_path / "r/m", 0)
    fleet = Fleet(str(tmp_path / "fleet"))
    added(fleet, tmp_path)
    (tmp_path / "fleet/kept.bag").touch()
    assert [one.path.name for one in missions_at([tmp_path])] == ["m"]


# The static information was copied there with the time of its build, years ago.
def test_the_day_does_not_come_from_other_files(fleet: Fleet, tmp_path: Path):
    path = mission(tmp_path / "r/m", 0)
    os.utime(path / "static.json", (10**9, 10**9))
    (one,) = added(fleet, path)
    assert one.place is not None
    assert one.place.day == "2023-11-14"
    assert one.notes == ()


def test_days_that_are_none(tmp_path: Path):
    words = ["fleet", "add", str(tmp_path / "fleet"), str(tmp_path), "--day", "2023-02-30"]
    done = CliRunner().invoke(main, words)
    assert done.exit_code == 2
    assert "'2023-02-30' is no day" in done.stderr


def test_a_table_that_is_lost_is_told(fleet: Fleet, tmp_path: Path):
    for number in range(2):
        mission(tmp_path / f"r/m{number}", number, marks=number)
    places = [one.place for one in added(fleet, tmp_path / "r")]
    assert places[0] is not None
    for table in ("comparisons", "reports"):
        (Path(fleet.url) / table / places[0].folder / "part.parquet").unlink()
    done = CliRunner().invoke(main, ["fleet", "outliers", fleet.url, "--json"])
    assert done.exit_code == 1
    assert json.loads(done.stdout) is not None
    assert "its comparisons are missing: add it again" in done.stderr
    words = ["fleet", "show", fleet.url, places[0].mission, "-o", str(tmp_path / "out")]
    done = CliRunner().invoke(main, words)
    assert "has not all reports of r/2023-11-14/m0-" in done.stderr
