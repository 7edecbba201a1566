"""Sights in files: from a bag to a table, from a table to causes and marks, and what goes wrong."""

from __future__ import annotations

import ast
import io
import itertools
import json
import subprocess
import sys
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import test_observer as field
import test_water_observer as tank
from mission_samples import STORE
from observer_scripts import shared_module
from rosbags.rosbag1 import Writer
from rosbags.typesys import get_types_from_msg

from pytpc_evaluation.demo.demo_examples import IMAGE_CAPTURE, SHARED_PACKAGE, WATER_SAMPLER

crowd = shared_module("crowd")
ObserverError = shared_module("errors").ObserverError
progress = shared_module("progress")
rules = shared_module("rules")
sights = shared_module("sights")
main = shared_module("command").main

needs_ros = pytest.mark.skipif(find_spec("rosbag") is None, reason="ROS is not installed")

EXAMPLES = SHARED_PACKAGE.parent
POSE = "geometry_msgs/msg/PoseStamped"
STANDING = [*tank.BEGIN, (60.0, tank.AT_TANK, 2.4, False, 0.0)]


@dataclass(frozen=True)
class Mixed(rules.Look):
    """One field of each type; as where annotations are not postponed, the last is a type."""

    count: int
    seen: bool


Mixed.__dataclass_fields__["seen"].type = bool


def run(observer, *arguments: object) -> int:
    return main(observer, [str(each) for each in arguments])


def names(folder: Path) -> list[str]:
    return [path.name for path in folder.iterdir()]


@pytest.fixture
def table(tmp_path) -> Path:
    path = tmp_path / "sights.parquet"
    sights.save_sights(list(tank.sights(*STANDING)), tank.observer.Sight, path)
    return path


def test_reading_asks_no_thread_of_arrow(table):
    # A program that ends while one of them holds the file is aborted (apache/arrow#34314). Here
    # some test has started them already, so that a program of its own is asked.
    program = (
        "import os, sys\n"
        "sys.path[:0] = sys.argv[2:]\n"
        "import observer\n"
        "from pathlib import Path\n"
        "from simulated_world import sights\n"
        "threads = lambda: len(os.listdir('/proc/self/task'))\n"
        "before = threads()\n"
        "assert sights.load_sights(Path(sys.argv[1]), observer.Sight)\n"
        "print(threads() - before)\n"
    )
    modules = (SHARED_PACKAGE / "src", WATER_SAMPLER.folder / "scripts")
    words = [sys.executable, "-c", program, *map(str, (table, *modules))]
    done = subprocess.run(words, check=False, capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("0\n", "")


# 0.1 has no exact double, 2^62 + 1 no exact float.
ROWS = [Mixed(0.1, 1e-300, -2.5, float("inf"), 2**62 + 1, True), Mixed(0.1, 0, 0, 0, -1, False)]


@pytest.mark.parametrize("rows", [[], ROWS[:1], ROWS], ids=len)
def test_a_table_gives_back_the_sights_it_was_made_of(tmp_path, rows):
    path = tmp_path / "sights.parquet"
    sights.save_sights(rows, Mixed, path)
    assert sights.load_sights(path, Mixed) == rows
    assert names(tmp_path) == ["sights.parquet"]
    schema = pq.read_schema(path)
    assert [str(kind) for kind in schema.types] == ["double"] * 4 + ["int64", "bool"]


def test_a_sight_has_floats_ints_and_bools_alone():
    @dataclass(frozen=True)
    class Named(rules.Look):
        name: str

    with pytest.raises(TypeError, match=r"Named\.name is no float, int or bool: str"):
        sights.schema_of(Named)


def test_a_failed_write_leaves_the_old_table(tmp_path):
    path = tmp_path / "sights.parquet"
    sights.save_sights(ROWS, Mixed, path)
    with pytest.raises(pa.ArrowException):
        sights.save_sights([Mixed(0.0, 0.0, 0.0, 0.0, "many", True)], Mixed, path)
    assert sights.load_sights(path, Mixed) == ROWS
    assert names(tmp_path) == ["sights.parquet"]


def column(values: list, kind: pa.DataType) -> pa.Array:
    return pa.array(values, kind)


@pytest.mark.parametrize(
    ("change", "error"),
    [
        ({"count": None}, "column count is missing, not int64"),
        ({"count": column([1.0, 2.0], pa.float64())}, "column count is double, not int64"),
        ({"seen": column([True, None], pa.bool_())}, "column seen has gaps"),
        ({"time": column([2.0, 1.0], pa.float64())}, "back from 2.000 s to 1.000 s at sight 1"),
        ({"time": column([2.0, float("nan")], pa.float64())}, "back from 2.000 s to nan s"),
    ],
)
def test_a_table_of_other_things_is_refused(tmp_path, change, error):
    path = tmp_path / "other.parquet"
    columns = {name: column([0.0, 1.0], pa.float64()) for name in ("time", "x", "y", "z")}
    columns |= {"count": column([1, 2], pa.int64()), "seen": column([True, False], pa.bool_())}
    columns |= change
    pq.write_table(pa.table({k: v for k, v in columns.items() if v is not None}), path)
    with pytest.raises(ObserverError, match=f"^{path}: .*{error}"):
        sights.load_sights(path, Mixed)


class Bag:
    """Writes bags with the messages of a robot."""

    def __init__(self, path: Path, *own: tuple[Path, str]) -> None:
        self.writer = Writer(path)
        self.writer.open()
        self.connections: dict[str, object] = {}
        self.late_s: dict[str, float] = {}
        for folder, name in own:
            text = (folder / f"msg/{name}.msg").read_text()
            kinds = get_types_from_msg(text, f"{folder.name}/msg/{name}")
            STORE.register({kind: what for kind, what in kinds.items() if kind not in STORE.types})

    def type(self, name: str) -> type:
        return STORE.types[name]

    def header(self, time: float) -> object:
        stamp = self.type("builtin_interfaces/msg/Time")(int(time), round(time % 1.0 * 1e9))
        return self.type("std_msgs/msg/Header")(seq=0, stamp=stamp, frame_id="map")

    def point(self, *place: float) -> object:
        return self.type("geometry_msgs/msg/Point")(*place)

    def add(self, topic: str, time: float, kind: str, *fields: object) -> None:
        if topic not in self.connections:
            self.connections[topic] = self.writer.add_connection(topic, kind, typestore=STORE)
        message = self.type(kind)(self.header(time), *fields)
        raw = STORE.serialize_ros1(message, kind)
        recorded = time + self.late_s.get(topic, 0.0)
        self.writer.write(self.connections[topic], round(recorded * 1e9), raw)

    def late(self, topic: str) -> None:
        """What is added on this topic is recorded 5 s after its stamp."""
        self.late_s[topic] = 5.0

    def pose(self, topic: str, time: float, *place: float, turn: tuple = (0.0, 1.0)) -> None:
        facing = self.type("geometry_msgs/msg/Quaternion")(0.0, 0.0, *turn)
        pose = self.type("geometry_msgs/msg/Pose")(self.point(*place), facing)
        self.add(topic, time, POSE, pose)


# A quarter turn is a half angle of 45 degrees.
@needs_ros
def test_what_was_seen_of_the_image_capture_is_read_from_its_bag(tmp_path):
    path, out = tmp_path / "mission.bag", tmp_path / "sights.parquet"
    bag = Bag(path, (IMAGE_CAPTURE.folder, "Picture"))
    bag.pose("/truth/uav", 0.5, 9.0, 9.0, 9.0)  # the person was not seen yet
    bag.pose("/truth/person", 1.0, 0.0, 3.0, 1.7)
    bag.pose("/truth/uav", 1.25, 0.5, 0.25, 1.5, turn=(0.5**0.5, 0.5**0.5))
    bag.add("/camera/picture", 2.0, "image_capture/msg/Picture", 7, np.zeros(3, np.uint8))
    bag.add("/camera/picture", 2.1, "image_capture/msg/Picture", 8, np.zeros(3, np.uint8))
    bag.pose("/truth/uav", 2.25, 0.5, 0.25, 1.5)
    bag.writer.close()
    assert run(field.observer.OBSERVER, "--bag", path, "--sights", out) == 0
    first, second = sights.load_sights(out, field.observer.Sight)
    assert first.yaw == pytest.approx(1.570796)
    assert (first.time, first.x, first.y, first.z) == (1.25, 0.5, 0.25, 1.5)
    assert (first.person_x, first.person_y, first.pictures) == (0.0, 3.0, 0)
    assert (second.time, second.yaw, second.pictures) == (2.25, 0.0, 2)


# The tip is 3-4-5 away from the tank's middle, 0.5 m, and 0.25 m under the water.
@needs_ros
def test_what_was_seen_of_the_water_sampler_is_read_from_its_bag(tmp_path):
    path, out = tmp_path / "mission.bag", tmp_path / "sights.parquet"
    bag = Bag(path, (WATER_SAMPLER.folder, "SamplerTruth"))
    bag.pose("/truth/uav", 1.0, 9.0, 9.0, 9.0)  # and nothing below it
    for time, radius in ((1.5, 0.49), (2.0, 0.51)):
        bag.pose("/truth/uav", time, 2.5, 0.5, 2.0)
        seen = (bag.point(3.3, 0.4, 0.4), bag.point(3.0, 0.0, 0.65), radius, True, 0.125)
        bag.add("/truth/sampler", time, "water_sampler/msg/SamplerTruth", *seen)
    bag.writer.close()
    assert run(tank.observer.OBSERVER, "--bag", path, "--sights", out) == 0
    first, second = sights.load_sights(out, tank.observer.Sight)
    assert (first.time, first.x, first.y, first.z) == (1.5, 2.5, 0.5, 2.0)
    assert first.tip_depth == pytest.approx(0.25)
    assert (first.pump_running, first.vial_level) == (True, 0.125)
    assert (first.above_tank, second.above_tank) == (False, True)


@needs_ros
def test_a_bag_of_a_robot_that_never_began_has_no_sight_and_no_mark(tmp_path):
    path = tmp_path / "mission.bag"
    with_one_pose(path)
    out = [tmp_path / name for name in ("sights.parquet", "causes.json", "marks.parquet")]
    flags = zip(("--sights", "--causes", "--marks"), out, strict=True)
    assert run(tank.observer.OBSERVER, "--bag", path, *[x for pair in flags for x in pair]) == 0
    assert pq.read_table(out[0]).num_rows == 0
    assert json.loads(out[1].read_text()) == []
    assert pq.read_table(out[2]).num_rows == 0


def test_from_a_table_to_causes_and_marks(table, tmp_path):
    causes, marks = tmp_path / "causes.json", tmp_path / "marks.parquet"
    arguments = ("--sights", table, "--seed", 3, "--users", 2, "--causes", causes, "--marks", marks)
    assert run(tank.observer.OBSERVER, *arguments, "__name:=observer") == 0
    (cause,) = json.loads(causes.read_text())
    wanted = rules.causes_of(tank.observer.OBSERVER.rules(), tank.sights(*STANDING))
    assert rules.Cause(**cause) == wanted[0]
    found = pq.read_table(marks)
    kinds = [("time_ns", "int64"), ("observer", "string"), ("cause", "int32")]
    kinds += [("right", "string"), ("said", "string")]
    assert [(each.name, str(each.type)) for each in found.schema] == kinds
    rows = [crowd.CrowdMark(**row) for row in found.to_pylist()]
    # The first sight is that of 0.1 s, the last that of 60 s.
    assert rows == crowd.marks_of(wanted, 0.1, 60.0, 3, crowd.USERS[:2])
    assert rows


def not_a_bag(path: Path) -> None:
    path.write_text("no bag")


# A busy machine records the clicks of 1.5 and 3 s after all else. At 3 s it is the click first.
@needs_ros
def test_what_was_recorded_late_was_seen_when_it_happened(tmp_path):
    path = tmp_path / "mission.bag"
    bag = Bag(path, (IMAGE_CAPTURE.folder, "Picture"))
    bag.late("/camera/picture")
    bag.pose("/truth/person", 0.0, 0.0, 3.0, 1.7)
    for time in (1.0, 2.0, 3.0):
        bag.pose("/truth/uav", time, 0.0, 0.0, 1.5)
    for time in (1.5, 3.0):
        bag.add("/camera/picture", time, "image_capture/msg/Picture", 1, np.zeros(3, np.uint8))
    bag.writer.close()
    seen = shared_module("bag").read_bag(path, field.observer.OBSERVER)
    assert [(each.time, each.pictures) for each in seen] == [(1.0, 0), (2.0, 1), (3.0, 2)]


def with_one_pose(path: Path) -> bytes:
    bag = Bag(path)
    bag.pose("/truth/uav", 1.0, 0.0, 0.0, 0.0)
    bag.writer.close()
    return path.read_bytes()


def cut_off(path: Path) -> None:
    path.write_bytes(with_one_pose(path)[:-40])


def without_text_in_its_first_message(path: Path) -> None:
    path.write_bytes(with_one_pose(path).replace(b"time=", b"\xffime=", 1))


def of_another_robot(path: Path) -> None:
    bag = Bag(path)
    bag.pose("/odom", 1.0, 0.0, 0.0, 0.0)
    bag.writer.close()


def with_other_messages(path: Path) -> None:
    bag = Bag(path)
    bag.pose("/truth/sampler", 1.0, 0.0, 0.0, 0.0)
    bag.writer.close()


@needs_ros
@pytest.mark.parametrize(
    ("make", "error"),
    [
        (lambda _: None, "mission.bag: No such file or directory"),
        (not_a_bag, "mission.bag: no readable bag"),
        (cut_off, "mission.bag: no readable bag"),
        # What rosbag does not look for itself.
        (without_text_in_its_first_message, "mission.bag: no readable bag: UnicodeDecodeError"),
        (of_another_robot, "mission.bag: nothing was recorded on /truth/uav, /truth/sampler"),
        (with_other_messages, "/truth/sampler has geometry_msgs/PoseStamped, not water_sampler/"),
    ],
)
def test_a_bad_bag_is_one_line_and_status_1(tmp_path, capsys, make, error):
    path, out = tmp_path / "mission.bag", tmp_path / "sights.parquet"
    make(path)
    assert run(tank.observer.OBSERVER, "--bag", path, "--sights", out) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert error in line
    assert not out.exists()


@pytest.mark.parametrize(
    ("arguments", "error"),
    [
        (["--causes", "{}/causes.json"], "--sights is missing"),
        (["--sights", "{}/none.parquet"], "/none.parquet: No such file or directory"),
        (["--sights", __file__], "test_sights.py: no readable Parquet file"),
        (
            ["--sights", "{}/sights.parquet", "--causes", "{}/none/causes.json"],
            "/none/causes.json: cannot be written: No such file or directory",
        ),
        (
            ["--sights", "{}/sights.parquet", "--marks", "{}/none/marks.parquet"],
            "/none/marks.parquet: cannot be written: No such file or directory",
        ),
    ],
)
def test_a_bad_file_is_one_line_and_status_1(table, tmp_path, capsys, arguments, error):
    assert run(tank.observer.OBSERVER, *[each.format(tmp_path) for each in arguments]) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.endswith(error)
    assert names(tmp_path) == ["sights.parquet"]


def test_a_python_without_what_a_bag_needs_is_one_line(tmp_path, monkeypatch, capsys):
    monkeypatch.delitem(sys.modules, "simulated_world.bag", raising=False)
    monkeypatch.setitem(sys.modules, "genpy", None)
    arguments = ("--bag", tmp_path / "mission.bag", "--sights", tmp_path / "sights.parquet")
    assert run(tank.observer.OBSERVER, *arguments) == 1
    (line,) = capsys.readouterr().err.splitlines()
    assert line.endswith(f"this Python ({sys.executable}) has no genpy")


def test_sights_of_another_robot_are_refused(table, capsys):
    assert run(field.observer.OBSERVER, "--sights", table) == 1
    assert capsys.readouterr().err.endswith("column yaw is missing, not double\n")


def test_there_are_no_more_users_than_in_the_thesis(table, capsys):
    with pytest.raises(SystemExit):
        run(tank.observer.OBSERVER, "--sights", table, "--users", 5)
    assert "invalid choice: 5" in capsys.readouterr().err


@needs_ros
def test_without_a_file_it_watches_the_running_robot(monkeypatch):
    watched = []
    node = shared_module("observer_node")
    monkeypatch.setattr(node, "watch", lambda *what: watched.append(what))
    # What roslaunch adds is not for us.
    assert run(tank.observer.OBSERVER, "--seed", 7, "__name:=observer", "__log:=/tmp/x.log") == 0
    assert watched == [(tank.observer.OBSERVER, 7)]


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_progress_is_shown_from_the_third_second_on_and_wiped_at_the_end(monkeypatch):
    # The clock is asked at the begin, at 100 s, and for each item, a second later each time.
    clock = itertools.count(100.0)
    monkeypatch.setattr(progress.time, "monotonic", lambda: next(clock))
    terminal = Terminal()
    monkeypatch.setattr("sys.stderr", terminal)
    assert list(progress.Progress("reading x.bag", 4).over("abcd")) == list("abcd")
    # The first comes after a second. One, two and three of four are done when the others come.
    shown = "".join(f"\rreading x.bag: {percent} %" for percent in (25, 50, 75))
    assert terminal.getvalue() == f"{shown}\r\x1b[K"


def test_progress_is_for_terminals(monkeypatch):
    monkeypatch.setattr("sys.stderr", io.StringIO())
    assert list(progress.Progress("reading x.bag", 0).over([])) == []
    assert sys.stderr.getvalue() == ""


def imported(path: Path) -> set[str]:
    """The packages that a module imports, at its top or later."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.Import):
            found |= {each.name.partition(".")[0] for each in node.names}
        elif isinstance(node, ast.ImportFrom):
            found.add((node.module or "").partition(".")[0])
    return found


def imported_by(paths: list[Path], names: set[str]) -> set[str]:
    """Which of the packages the modules import; one that does not name any is not parsed."""
    naming = [path for path in paths if any(name in path.read_text() for name in names)]
    return names & set[str]().union(*map(imported, naming))


def test_observers_and_tpc_know_nothing_of_each_other():
    observers = [*EXAMPLES.glob("*/scripts/observer.py"), *SHARED_PACKAGE.rglob("*.py")]
    observers += (EXAMPLES / "other_people").glob("*.py")
    tpc = list((EXAMPLES.parent / "pytpc").rglob("*.py"))
    robots = {path.parts[-3] for path in EXAMPLES.glob("*/scripts/observer.py")}
    assert robots >= {"image_capture", "water_sampler"}
    assert imported_by(observers, {"pytpc", "pyarrow", "simulated_world"}) == {
        "pyarrow",
        "simulated_world",
    }
    assert imported_by(tpc, {"simulated_world", "rosbag", "rospy", *robots}) == {"rospy"}
