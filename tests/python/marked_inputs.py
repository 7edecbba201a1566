"""One mission of a minute (100 to 160 s) as every kind of input, and the ways to mark it."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest
import tpc_file
from click.testing import CliRunner, Result
from mission_samples import BagFile, comparison, key, line, ns, shortest, static_info
from ros2_bags import Ros2Bag
from tpc_file import TpcFile, report, site, sync

from pytpc.cli.main import main
from pytpc.recording.marks import Mark, write_marks

START, END = 100, 160
SECONDS = range(START, END + 1, 2)
EXPECTED = (Mark(ns(110), "I", "marks0"), Mark(ns(120), "II", "marks1", "too slow"))
"""What two observers marked. marks0 also marked type II at 115 s and took it back."""
LIVE = [
    (111, "/marks0/mark_action", 110),
    (116, "/marks0/mark_no_action", 115),
    (117, "/marks0/mark_undo", 115),
    (121, "/marks1/mark_no_action", 120),
]
NOTE = (122, "/marks1/mark_note", "120.000000000,too slow")


def values(second: int) -> tuple[int, float, float]:
    """The result, the compared value and the threshold at a second."""
    return int(second >= 110), float(second), 109.0


def run(*arguments: object) -> Result:
    """The command line in this process; it must end well."""
    done = CliRunner().invoke(main, [str(argument) for argument in arguments])
    assert done.exit_code == 0, done.output
    return done


def bag(path: Path, *, live: bool = False) -> Path:
    with BagFile(path) as writer:
        for second in SECONDS:
            writer.log(second, "/uav", line(0, *values(second)))
        if live:
            for second, topic, marked in LIVE:
                writer.mark(second, topic, marked)
            writer.text(NOTE[0], NOTE[1], "/observer", NOTE[2])
    return path


def ros2_folder(folder: Path, kind: str, *, live: bool = False) -> Ros2Bag:
    with Ros2Bag(folder, kind) as writer:
        for second in SECONDS:
            writer.log(second, "uav", line(0, *values(second)))
        if live:
            for second, topic, marked in LIVE:
                writer.mark(second, topic, marked)
            writer.text(*NOTE)
    return writer


def ros2_file(folder: Path, kind: str, *, live: bool = False) -> Path:
    """The storage file alone, without the folder of rosbag2."""
    made = ros2_folder(folder / "whole", kind, live=live)
    return made.file.rename(folder / f"mission.{kind}")


def tpc(path: Path, *, node: str = "/uav", pid: int = 77) -> Path:
    made = TpcFile(tpc_file.header(node=node, real=ns(START), pid=pid))
    made.system(site(1, key(0)), sync(0, ns(START)))
    rows = [(second, *values(second)) for second in SECONDS]
    made.thread(
        1,
        *(report(1, ns(at - START), cmp, limit, result=result) for at, result, cmp, limit in rows),
    )
    return made.write(path)


def nodes_files(folder: Path) -> Path:
    folder.mkdir(parents=True)
    tpc(folder / "uav-77-1.tpc")
    tpc(folder / "arm-78-1.tpc", node="/arm", pid=78)
    return folder


def recorded(folder: Path, *, live: bool = False) -> Path:
    """What `record` leaves of a mission whose nodes also wrote files."""
    folder.mkdir()
    bag(folder / "mission.bag", live=live)
    nodes_files(folder / "tpc")
    (folder / "run.json").write_text(json.dumps({"schema": 1}), encoding="utf-8")
    return folder


def parquet(folder: Path, *, live: bool = False) -> Path:
    """`record --parquet`: the bag and what was converted from it in one folder."""
    run("convert", recorded(folder, live=live), "-o", folder)
    return folder


def converted(path: Path, *, live: bool = False) -> Path:
    """`convert`, of a bag elsewhere."""
    elsewhere = path.parent / "elsewhere"
    elsewhere.mkdir()
    run("convert", bag(elsewhere / "first.bag", live=live), "-o", path)
    return path


def text(path: Path, form: str) -> Path:
    rows = [form.format(at=second, line=line(0, *values(second))) for second in SECONDS]
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path


def reports_csv(path: Path) -> Path:
    rows = []
    for second in SECONDS:
        result, cmp, limit = values(second)
        numbers = f"cmp:{shortest(cmp)},thresh:{shortest(limit)},res:{result}"
        rows.append(f"{second}.0,{key(0)},{result},{numbers}")
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    return path


def plain_folder(folder: Path, *, live: bool = False) -> Path:
    """A bag and a log of one mission, put into a folder by hand."""
    folder.mkdir()
    bag(folder / "monday.bag", live=live)
    text(folder / "rosout.log", "{at}.5 INFO /other {line}")
    return folder


@dataclass(frozen=True)
class Input:
    """A kind of input, by its name in the table.

    ``make`` writes it into a folder, for kinds with topics also with marks in them (``live``).
    ``before`` are the files in which earlier versions kept its marks, beside what they are named
    after; ``same`` are other paths of the same recording.
    """

    make: Callable[..., Path]
    has_topics: bool = False
    before: tuple[str, ...] = ()
    same: tuple[str, ...] = ()


INPUTS = {
    "ROS 1 bag": Input(lambda at, **live: bag(at / "m.bag", **live), True, ("m.bag",)),
    "mcap": Input(lambda at, **live: ros2_file(at, "mcap", **live), True, ("mission.mcap",)),
    "db3": Input(lambda at, **live: ros2_file(at, "db3", **live), True, ("mission.db3",)),
    "rosbag2 folder": Input(
        lambda at, **live: ros2_folder(at / "m", "db3", **live).file.parent,
        True,
        ("m", "m/m.db3"),
        ("m/m.db3",),
    ),
    "folder of record": Input(
        lambda at, **live: recorded(at / "m", **live),
        True,
        ("m", "m/mission.bag", "m/tpc/uav-77-1.tpc"),
        ("m/mission.bag", "m/tpc", "m/tpc/uav-77-1.tpc"),
    ),
    "record --parquet": Input(
        lambda at, **live: parquet(at / "m", **live),
        True,
        ("m", "m/mission.bag"),
        ("m/mission.bag", "m/events.parquet", "m/tpc"),
    ),
    "folder of convert": Input(
        lambda at, **live: converted(at / "m", **live), True, ("m",), ("m/events.parquet",)
    ),
    "Parquet file": Input(lambda at, **live: converted(at / "m.parquet", **live), True),
    "CSV of convert": Input(lambda at, **live: converted(at / "m.csv", **live), True, ("m.csv",)),
    "folder of .tpc": Input(
        lambda at: nodes_files(at / "m"), before=("m", "m/uav-77-1.tpc"), same=("m/uav-77-1.tpc",)
    ),
    "plain folder": Input(
        lambda at, **live: plain_folder(at / "m", **live),
        True,
        ("m", "m/monday.bag", "m/rosout.log"),
        ("m/monday.bag",),
    ),
    ".tpc file": Input(lambda at: tpc(at / "uav-77-1.tpc"), before=("uav-77-1.tpc",)),
    "log": Input(lambda at: text(at / "m.log", "{at}.0 INFO /uav {line}"), before=("m.log",)),
    "console text": Input(
        lambda at: text(at / "m.txt", "[ INFO] [{at}.000000000]: {line}"), before=("m.txt",)
    ),
    "CSV": Input(lambda at: reports_csv(at / "m.csv"), before=("m.csv",)),
}


@contextmanager
def keys(pressed: str) -> Iterator[None]:
    """A terminal on which these keys were pressed, one a turn; ``>`` is the right arrow."""
    names = {">": "right", "\r": "enter"}
    waiting = [names.get(one, one) for one in pressed]

    @contextmanager
    def read() -> Iterator[Callable[[], list[str]]]:
        yield lambda: [waiting.pop(0)]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("pytpc.present.marking_terminal._keys", read)
        patch.setattr(sys.stdin, "isatty", lambda: True, raising=False)
        yield


def session(*arguments: object, pressed: str) -> None:
    """A session of `mark` or `watch` with these keys, in this process."""
    with keys(pressed):
        main([str(argument) for argument in arguments], standalone_mode=False)


def static_file(at: Path) -> Path:
    path = at / "static.json"
    static_info(comparison(0, "limit")).save(path)
    return path


# Right is 5 s. marks0: type I at 110 s, type II at 115 s, undone. marks1: type II at 120 s.
KEYS = {"marks0": ">>1>2uq", "marks1": ">>>>2ntoo slow\rq"}


def by_marks_add(at: Path, source: Path) -> list[Path]:
    run("marks", source, "--observer", "marks0", "--add", 10, "I")
    run("marks", source, "--observer", "marks0", "--add", 15, "II")
    run("marks", source, "--observer", "marks1", "--add", 20, "II", "--note", "too slow")
    run("marks", source, "--remove", 2)
    return []


def by_mark(at: Path, source: Path) -> list[Path]:
    for observer, pressed in KEYS.items():
        session("mark", source, "--observer", observer, pressed=pressed)
    return []


def by_watch(at: Path, source: Path) -> list[Path]:
    static = static_file(at)
    for observer, pressed in KEYS.items():
        session("watch", source, "--static", static, "--observer", observer, pressed=pressed)
    return []


def by_mark_o(at: Path, source: Path) -> list[Path]:
    files = [at / f"{observer}.marks" for observer in KEYS]
    for file, (observer, pressed) in zip(files, KEYS.items(), strict=True):
        session("mark", source, "--observer", observer, "-o", file, pressed=pressed)
    return files


def by_earlier_versions(at: Path, source: Path) -> list[Path]:
    """Each earlier file has a mark of its own, or all marks are in the only one."""
    names = INPUTS_BY_PATH[source].before
    for number, name in enumerate(names):
        mine = EXPECTED[number % 2 :: 2] if len(names) > 1 else EXPECTED
        write_marks(mine, at / f"{name}.marks.csv")
    return []


INPUTS_BY_PATH: dict[Path, Input] = {}

WAYS: dict[str, Callable[[Path, Path], list[Path]]] = {
    "marks --add": by_marks_add,
    "mark": by_mark,
    "watch": by_watch,
    "topics": lambda _at, _source: [],
    "mark -o": by_mark_o,
    "earlier versions": by_earlier_versions,
}
"""Each marks a recording, and returns the files that have to be given with ``--marks``."""


def make(name: str, at: Path, *, live: bool = False) -> Path:
    """A recording of this kind."""
    kind = INPUTS[name]
    path = kind.make(at, live=True) if live else kind.make(at)
    INPUTS_BY_PATH[path] = kind
    return path


def has_way(name: str, way: str) -> bool:
    """Whether a kind of input can be marked in this way."""
    kind = INPUTS[name]
    if way == "topics":
        return kind.has_topics
    return way != "earlier versions" or bool(kind.before)
