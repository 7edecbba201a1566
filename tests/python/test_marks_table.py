"""No mark is lost: every input, marked in every way, read by every reader and under every name."""

from __future__ import annotations

import json
import multiprocessing
import os
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
from marked_inputs import EXPECTED, INPUTS, WAYS, bag, has_way, make, run, session, static_file
from mission_samples import ns

from pytpc import api
from pytpc.ingest.reading import read as read_files
from pytpc.recording.marking_session import MarkChange
from pytpc.recording.marks import Mark, marks_beside, read_marks, write_marks
from pytpc.recording.marks_file import END_PATIENCE_S, MarksFile
from pytpc.recording.marks_home import marks_home

Found = list[tuple[int, str | None]]


def _options(files: Sequence[Path]) -> list[object]:
    return [word for file in files for word in ("--marks", file)]


def by_marks(at: Path, source: Path, files: Sequence[Path]) -> Found:
    done = run("marks", source, "--json", *_options(files))
    return [(mark["time_ns"], mark["type"]) for mark in json.loads(done.stdout)]


def by_rank(at: Path, source: Path, files: Sequence[Path]) -> Found:
    done = run("rank", source, "--static", static_file(at), "--json", *_options(files))
    return [(mark["time_ns"], mark["type"]) for mark in json.loads(done.stdout)]


def by_report(at: Path, source: Path, files: Sequence[Path]) -> Found:
    output = at / "page.html"
    options = ["--static", static_file(at), "--top", 1, "-o", output]
    done = run("report", source, *options, "--json", *_options(files))
    (mission,) = json.loads(done.stdout)["missions"]
    return [(ns(100 + mark["seconds"]), mark["type"]) for mark in mission["marks"]]


def by_library(at: Path, source: Path, files: Sequence[Path]) -> Found:
    found = read_files([source, *files]).marks if files else api.read(source).marks
    assert found == EXPECTED
    return [(mark.time_ns, mark.type) for mark in found]


READERS: dict[str, Callable[[Path, Path, Sequence[Path]], Found]] = {
    "marks": by_marks,
    "rank": by_rank,
    "report": by_report,
    "api.read": by_library,
}


@pytest.fixture(
    scope="module",
    params=[
        pytest.param((name, way), id=f"{name} | {way}")
        for name in INPUTS
        for way in WAYS
        if has_way(name, way)
    ],
)
def marked(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory):
    """A folder with a recording that was marked, and the files to give with it."""
    name, way = request.param
    at = tmp_path_factory.mktemp("marked")
    source = make(name, at, live=way == "topics")
    return at, source, WAYS[way](at, source)


@pytest.mark.parametrize("reader", READERS)
def test_marks(marked: tuple[Path, Path, list[Path]], reader: str):
    assert READERS[reader](*marked) == [(ns(110), "I"), (ns(120), "II")]


# One name marks, each other name finds it, and undoes nothing of it.
@pytest.mark.parametrize("name", INPUTS)
def test_a_recording_has_the_same_marks_under_each_of_its_names(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    at, links = tmp_path / "at", tmp_path / "links"
    at.mkdir()
    links.mkdir()
    source = make(name, at)
    monkeypatch.chdir(at)
    (links / "link").symlink_to(source)
    (links / "folder").symlink_to(at)
    others = [at / one for one in INPUTS[name].same]
    names: list[object] = [
        source,
        f"{source}/" if source.is_dir() else source,
        source.relative_to(at),
        f"../at/{source.name}",
        links / "link",
        links / "folder" / source.name,
        *others,
        *(links / "folder" / one.relative_to(at) for one in others),
    ]
    if source.is_dir():
        (links / "bag").symlink_to(others[0] if others else source)
        names.append(links / "bag")
    for second, path in enumerate(names):
        run("marks", path, "--add", second, "I")
    expected = [Mark(ns(100 + second), "I") for second in range(len(names))]
    for path in names:
        assert list(api.read(os.fspath(path)).marks) == expected, path
    if source.is_dir():
        monkeypatch.chdir(source)
        assert list(api.read(".").marks) == expected
        run("marks", ".", "--add", 50, "II")
        assert len(api.read(source).marks) == len(expected) + 1
    for _ in names:
        run("marks", names[-1], "--remove", 1)
    assert expected[0] not in api.read(source).marks


# Marks at 110 and 130 s in the folder of two missions; those of monday's time are monday's.
def test_a_recording_among_others_has_the_marks_of_its_time(tmp_path: Path):
    bag(tmp_path / "monday.bag")
    later = Mark(ns(100_000), "II")
    write_marks([Mark(ns(110), "I")], marks_beside(tmp_path / "tuesday.bag"))
    write_marks([Mark(ns(130), "I"), later], tmp_path / "marks.csv")
    assert api.read(tmp_path / "monday.bag").marks == (Mark(ns(130), "I"),)
    assert api.read(tmp_path / "monday.bag").end_ns == ns(160)
    assert api.read(tmp_path).marks == (Mark(ns(110), "I"), Mark(ns(130), "I"), later)


# Somebody else's file of this name is no error and no mark.
def test_marks_of_a_school_class_are_left_alone(tmp_path: Path):
    path = bag(tmp_path / "monday.bag")
    (tmp_path / "marks.csv").write_text("pupil,mark\nana,1\n")
    assert api.read(path).marks == ()


@pytest.mark.parametrize("form", ["", ".parquet", ".csv"], ids=["folder", "parquet", "csv"])
def test_convert_takes_the_marks_along_and_both_are_marked_afterwards(form: str, tmp_path: Path):
    path, out = bag(tmp_path / "a.bag"), tmp_path / f"out/b{form}"
    run("marks", path, "--add", 10, "I")
    run("convert", path, "-o", out)
    run("marks", path, "--add", 20, "I")
    run("marks", out, "--add", 30, "II")
    assert [mark.time_ns for mark in api.read(path).marks] == [ns(110), ns(120)]
    assert [mark.time_ns for mark in api.read(out).marks] == [ns(110), ns(130)]
    run("convert", path, "-o", out)
    assert [mark.time_ns for mark in api.read(out).marks] == [ns(110), ns(120), ns(130)]


# A copy in marks.json could not be removed.
def test_marks_of_a_folder_that_is_converted_in_place_can_be_removed(tmp_path: Path):
    folder = make("folder of record", tmp_path)
    run("marks", folder / "mission.bag", "--add", 10, "I")
    run("convert", folder, "-o", folder)
    run("marks", folder, "--remove", 1)
    assert api.read(folder).marks == ()
    assert api.read(folder / "mission.bag").marks == ()


def test_the_folder_takes_its_marks_along(tmp_path: Path):
    folder = make("folder of .tpc", tmp_path)
    run("marks", folder, "--add", 10, "I")
    assert api.read(folder.rename(tmp_path / "other")).marks == (Mark(ns(110), "I"),)


# The same mark, with a note in one of two files: undo takes both.
def test_a_mark_in_two_files_is_removed_from_both(tmp_path: Path):
    folder = make("folder of record", tmp_path)
    write_marks([Mark(ns(110), "I", "ana")], marks_beside(folder))
    write_marks([Mark(ns(110), "I", "ana", "late")], folder / "mission.bag.marks.csv")
    assert api.read(folder).marks == (Mark(ns(110), "I", "ana", "late"),)
    run("marks", folder, "--remove", 1)
    assert api.read(folder).marks == ()


# What earlier versions wrote beside the folder is what a later session takes back.
def test_a_mark_of_an_earlier_version_is_undone(tmp_path: Path):
    folder = make("folder of record", tmp_path)
    theirs = Mark(ns(105), "I", "ben")
    write_marks([theirs, Mark(ns(110), "I", "ana")], marks_beside(folder))
    session("mark", folder / "mission.bag", "--observer", "ana", pressed="uq")
    assert api.read(folder).marks == (theirs,)
    assert not (folder / "marks.csv").exists()


# A bag that a folder only links to has its marks at home.
def test_a_folder_of_links_has_the_marks_of_what_they_lead_to(tmp_path: Path):
    folder = make("folder of record", tmp_path)
    run("marks", folder, "--add", 10, "I")
    (tmp_path / "links").mkdir()
    (tmp_path / "links/first.bag").symlink_to(folder / "mission.bag")
    assert api.read(tmp_path / "links").marks == (Mark(ns(110), "I"),)


def _mark_many(home_of: Path, observer: str, began: object) -> None:
    file = MarksFile(marks_home(home_of))
    began.wait()  # type: ignore[attr-defined]
    for number in range(50):
        file.take(MarkChange(None, Mark(ns(100 + number), "I", observer)))
        file.take(MarkChange(None, Mark(ns(100 + number), "II", observer)))
        # The second one was a mistake.
        file.take(MarkChange(Mark(ns(100 + number), "II", observer), None))
        file.flush()
    assert file.flush(END_PATIENCE_S) == ""


# 50 marks of each of two observers, one of whom marks the bag and the other one the folder.
def test_two_observers_at_once_lose_no_mark(tmp_path: Path):
    folder = make("folder of record", tmp_path)
    context = multiprocessing.get_context("spawn")
    began = context.Barrier(2)
    observers = [
        context.Process(target=_mark_many, args=(path, name, began))
        for path, name in [(folder, "marks0"), (folder / "mission.bag", "marks1")]
    ]
    for one in observers:
        one.start()
    for one in observers:
        one.join(60)
    assert [one.exitcode for one in observers] == [0, 0]
    found = api.read(folder).marks
    assert len(found) == 100
    assert {mark.type for mark in found} == {"I"}


# Who ends while another one writes waits, instead of leaving without the marks.
def test_the_end_waits_for_another_observer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = bag(tmp_path / "a.bag")
    file = MarksFile(marks_home(path))
    file.take(MarkChange(None, Mark(ns(110), "I")))
    busy = iter([True, True, False])

    def flock(_descriptor: int, _how: int) -> None:
        if next(busy):
            raise BlockingIOError

    monkeypatch.setattr("pytpc.recording.marks_file.fcntl.flock", flock)
    assert file.flush() == "not saved yet: another observer is writing a.bag.marks.csv"
    assert file.flush(END_PATIENCE_S) == ""
    assert read_marks(marks_beside(path)) == (Mark(ns(110), "I"),)


# Network file systems refuse to lock a folder that is open for reading.
def test_a_file_system_without_locks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    def flock(_descriptor: int, _how: int) -> None:
        raise OSError(9, "Bad file descriptor")

    monkeypatch.setattr("pytpc.recording.marks_file.fcntl.flock", flock)
    path = bag(tmp_path / "a.bag")
    run("marks", path, "--add", 10, "I")
    assert api.read(path).marks == (Mark(ns(110), "I"),)


def test_a_folder_that_cannot_be_written_is_said_at_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    path = bag(tmp_path / "a.bag")
    monkeypatch.setattr("pytpc.recording.marks_file.os.access", lambda *_: False)
    with pytest.raises(Exception, match=r"cannot be written: mark into another file with `pytpc"):
        MarksFile(marks_home(path))
