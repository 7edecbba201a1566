"""What is declared of parameters: in dynamic_reconfigure's files, never run, and in messages."""

from __future__ import annotations

import struct
from dataclasses import replace
from pathlib import Path

import pytest
from mission_samples import STORE, comparison, static_info
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from pytpc.diagnosis.results.suspects import Evaluation, Suspect
from pytpc.diagnosis.suggestion.advise import declared_for
from pytpc.ingest.declared_bag import decode_description
from pytpc.values.declared import declared_in, read_cfg, read_declared

EXAMPLES = Path(__file__).parents[2] / "examples" / "threshold_nodes"
HEAD = """#!/usr/bin/env python
from dynamic_reconfigure.parameter_generator_catkin import *
gen = ParameterGenerator()
"""


def cfg(text):
    """What ``text`` declares below the usual head of three lines, as rows, and what is skipped."""
    found, skipped = read_cfg((HEAD + text).encode(), Path("Node.cfg"))
    rows = [(one.parameter, one.type, one.low, one.high, one.default) for one in found]
    return rows, skipped


def test_a_file_as_they_are_written():
    found = read_declared([EXAMPLES / "cfg" / "Tracker.cfg"], pytest.fail)
    assert [(one.parameter, one.type, one.low, one.high, one.default) for one in found] == [
        ("gate", "double", -10.0, 10.0, 3.0),
        ("lost_distance", "double", -10.0, 10.0, 8.0),
        ("mode", "int", 0, 2, 1),
    ]
    assert found[0].choices == ()
    assert found[2].choices == (("Drop", 0), ("Hold", 1), ("Zero", 2))
    assert found[0].description == "Largest value that is followed"
    assert found[0].place == f"{EXAMPLES}/cfg/Tracker.cfg:16"
    assert found[0].step is None


def test_arguments_by_name_and_without_ranges():
    rows, skipped = cfg(
        "gen.add(name='a', paramtype=double_t, level=0, description='', default=.5, max=1, min=0)\n"
        "gen.add('b', bool_t, 0, 'Whether', True)\n"
        "gen.add('c', str_t, 0, 'Name', 'x')\n"
        "gen.add('d', 'int', 0, 'Plain', -3, -(2**31), 2**31 - 1)\n"
        "gen.add('e', double_t, 0, '', default=1, min=float('-inf'), max=1e3)\n"
    )
    assert skipped == []
    assert rows == [
        ("a", "double", 0, 1, 0.5),
        ("b", "bool", None, None, True),
        ("c", "str", None, None, "x"),
        # The ends of the type itself are no range.
        ("d", "int", None, None, -3),
        ("e", "double", None, 1000.0, 1),
    ]


def test_constants_arithmetic_groups_loops_and_branches():
    rows, skipped = cfg(
        "import math\n"
        "top: float = 2 * math.pi\n"
        "angles = gen.add_group('Angles')\n"
        "inner = angles.add_group('Inner')\n"
        "inner.add('yaw', double_t, 0, '', 0.0, -math.pi, top / 2)\n"
        "for axis in ['x', 'y']:\n"
        "    gen.add('max_' + axis, double_t, 0, '', 1, 0, 10)\n"
        "for i in range(2):\n"
        "    angles.add('joint_%d' % i, double_t, 0, '', 0, -math.radians(90), 90)\n"
        "if True:\n"
        "    gen.add('yes', int_t, 0, '', 1, 0, 2)\n"
        "else:\n"
        "    gen.add('no', int_t, 0, '', 1, 0, 2)\n"
        "exit(gen.generate('p', 'n', 'N'))\n"
    )
    assert skipped == []
    assert [row[0] for row in rows] == ["yaw", "max_x", "max_y", "joint_0", "joint_1", "yes"]
    assert rows[0][2:4] == (-3.141592653589793, 3.141592653589793)
    assert rows[3][2] == -1.5707963267948966


# Nothing that is not known is guessed at; what has nothing to do with the generator is no matter.
@pytest.mark.parametrize(
    ("text", "why"),
    [
        (
            "from local import add_common\nadd_common(gen)",
            "Node.cfg:5: add_common(gen): the functi",
        ),
        ("gen.add('a', double_t, 0, '', 0, LOW, 1)", "LOW is not known"),
        ("gen.add(NAME, double_t, 0, '', 0, 0, 1)", "NAME is not known"),
        ("gen.add('a', 'vector', 0, '', 0, 0, 1)", "name and type are not both known"),
        ("gen.add('a', **rest)", "arguments in a dictionary"),
        ("gen.add('a', double_t, 0, '', 0, 1 / 0, 1)", "1 / 0 has no value"),
        ("gen.add('a' * 10**9, double_t, 0, '', 0, 0, 1)", "a product of other things"),
        ("gen.add('%999999d' % 1, double_t, 0, '', 0, 0, 1)", "a long text"),
        ("gen.add('a', double_t, 0, '', 0, 0, 9**9**9)", "a large power"),
        ("for x in names():\n    gen.add(x, double_t, 0, '', 0, 0, 1)", "a loop over names()"),
        ("if x:\n    gen.add('a', double_t, 0, '', 0, 0, 1)", "it depends on x"),
        ("gen.add('a', double_t, 0, '', 0, 0, open('/etc/passwd').read())", "not followed"),
    ],
)
def test_what_is_not_followed_is_said(text, why):
    rows, skipped = cfg(f"{text}\ngen.add('last', double_t, 0, '', 0, 0, 1)\n")
    assert [row[0] for row in rows] == ["last"]
    assert len(skipped) == 1
    assert why in skipped[0]


def test_nothing_is_run(tmp_path):
    victim = tmp_path / "victim"
    text = f"import os\nos.mkdir({str(victim)!r})\nopen({str(victim)!r}, 'w')\nprint(1)\n"
    assert cfg(text) == ([], [])
    assert not victim.exists()


def test_steps_and_depth_have_an_end():
    loop = "for i in range(9999):\n    x = i\n    y = i\ngen.add('a', bool_t, 0, '', True)\n"
    rows, skipped = cfg(loop)
    assert rows == []
    assert "too many steps" in skipped[0]
    assert cfg("x = " + "-" * 5000 + "1\n")[0] == []


def test_files_that_are_no_such_thing(tmp_path):
    (tmp_path / "setup.cfg").write_text("[metadata]\nname = x\n")
    (tmp_path / "Old.cfg").write_text(HEAD + "print 'python 2'\n")
    (tmp_path / "build").mkdir()
    (tmp_path / "build" / "Copy.cfg").write_text(HEAD + "gen.add('a', bool_t, 0, '', True)\n")
    (tmp_path / "Huge.cfg").write_bytes(HEAD.encode() + b"#" * (1 << 20))
    (tmp_path / "Loop.cfg").symlink_to(tmp_path / "Loop.cfg")
    said = []
    assert read_declared([tmp_path, tmp_path / "gone"], said.append) == []
    assert [line.rpartition("/")[2].split(": ")[0] for line in said] == [
        "Huge.cfg",
        "Loop.cfg",
        "Old.cfg:4",
    ]
    assert said[0].endswith("too large")
    assert said[1].endswith("Too many levels of symbolic links")
    assert "not Python 3" in said[2]


def suspect(parameter, node="/node"):
    found = comparison(0, parameter)
    last = Evaluation(0, False, 0.0, 0.0, False, node)
    return Suspect(1, parameter, found.key, found, "I", 1.0, 1.0, (found.key,), last)


@pytest.fixture
def packages(tmp_path):
    """Packages a and b, which declare rate differently, and gain alike."""
    for name, high in (("a", 10), ("b", 20)):
        folder = tmp_path / name
        (folder / "cfg").mkdir(parents=True)
        (folder / "src").mkdir()
        (folder / "package.xml").write_text("<package/>")
        text = (
            f"gen.add('rate', int_t, 0, '', 1, 0, {high})\ngen.add('gain', int_t, 0, '', 1, 0, 3)\n"
        )
        (folder / "cfg" / "N.cfg").write_text(HEAD + text)
    return tmp_path


def test_declarations_go_with_the_package(packages):
    static = static_info(comparison(0, "~rate"), source_root=str(packages))
    declared = declared_in(static)
    assert [one.parameter for one in declared] == ["rate", "gain", "rate", "gain"]
    source = packages / "b" / "src" / "node.cpp"
    assert declared_for(declared, suspect("~rate"), source).high == 20
    assert declared_for(declared, suspect("~rate"), packages / "a/src/x.cpp").high == 10
    # Without a place it may be either; gain is the same in both.
    assert declared_for(declared, suspect("~rate")) is None
    assert declared_for(declared, suspect("gain")).high == 3
    assert declared_for(declared, suspect("~speed")) is None
    # The handle of a server puts its namespace before the name that the file has.
    assert declared_for(declared, suspect("~planner/rate"), source).high == 20
    assert declared_for(declared, suspect("~planner_rate"), source) is None
    # Another package's file says nothing of this one's parameter.
    (packages / "c" / "src").mkdir(parents=True)
    (packages / "c" / "package.xml").write_text("<package/>")
    assert declared_for(declared, suspect("~rate"), packages / "c" / "src" / "x.cpp") is None
    # What the node itself published counts first.
    said = replace(declared[0], parameter="/ns/node/rate", high=7, place="topic /ns/node/x")
    assert declared_for([*declared, said], suspect("~rate", "/ns/node"), source).high == 7
    assert declared_for([*declared, said], suspect("~rate", "/node"), source).high == 20


MESSAGES = {
    "BoolParameter": "string name\nbool value",
    "IntParameter": "string name\nint32 value",
    "StrParameter": "string name\nstring value",
    "DoubleParameter": "string name\nfloat64 value",
    "GroupState": "string name\nbool state\nint32 id\nint32 parent",
    "ParamDescription": "string name\nstring type\nuint32 level\nstring description\n"
    "string edit_method",
    "Group": "string name\nstring type\nParamDescription[] parameters\nint32 parent\nint32 id",
    "Config": "BoolParameter[] bools\nIntParameter[] ints\nStrParameter[] strs\n"
    "DoubleParameter[] doubles\nGroupState[] groups",
    "ConfigDescription": "Group[] groups\nConfig max\nConfig min\nConfig dflt",
}
NAME = "dynamic_reconfigure/msg/"


def dynamic_store():
    """The message types of dynamic_reconfigure, from their definitions."""
    store = get_typestore(Stores.ROS1_NOETIC)
    for name, text in MESSAGES.items():
        store.register(get_types_from_msg(text, f"{NAME}{name}"))
    return store


def description(store):
    """Parameters gate (1..9, default 3), mode (an enumeration, 0..2) and on, in two groups."""
    types = {name: store.types[f"{NAME}{name}"] for name in MESSAGES}

    def config(gate, mode, on):
        return types["Config"](
            bools=[types["BoolParameter"](name="on", value=on)],
            ints=[types["IntParameter"](name="mode", value=mode)],
            strs=[types["StrParameter"](name="frame", value="map")],
            doubles=[types["DoubleParameter"](name="gate", value=gate)],
            groups=[types["GroupState"](name="Default", state=True, id=0, parent=0)],
        )

    def parameter(name, kind, method=""):
        return types["ParamDescription"](
            name=name, type=kind, level=0, description=f"the {name}", edit_method=method
        )

    enum = "{'enum': [{'name': 'Drop', 'value': 0}, {'name': 'Hold', 'value': 1}]}"
    first = [parameter("gate", "double"), parameter("mode", "int", enum)]
    second = [parameter("on", "bool"), parameter("frame", "str", "{'enum': os.system('x')}")]
    groups = [
        types["Group"](name="Default", type="", parameters=first, parent=0, id=0),
        types["Group"](name="More", type="tab", parameters=second, parent=0, id=1),
    ]
    return types["ConfigDescription"](
        groups=groups,
        max=config(9.0, 2, True),
        min=config(1.0, 0, False),
        dflt=config(3.0, 1, True),
    )


def test_descriptions_in_a_bag(tmp_path):
    store = dynamic_store()
    bag = tmp_path / "m.bag"
    topic = "/ns/node/parameter_descriptions"
    kind = f"{NAME}ConfigDescription"
    with Writer(bag) as writer:
        connection = writer.add_connection(topic, kind, typestore=store, callerid="/ns/node")
        for time in (1, 2):
            raw = store.serialize_ros1(description(store), kind)
            writer.write(connection, time, raw)
        # A topic of that name of another type, and one of that type with another name.
        wrong = writer.add_connection(
            "/n/parameter_descriptions", "std_msgs/msg/String", typestore=STORE, callerid="/n"
        )
        text = STORE.types["std_msgs/msg/String"](data="x")
        writer.write(wrong, 3, STORE.serialize_ros1(text, "std_msgs/msg/String"))
        relayed = writer.add_connection("/relayed", kind, typestore=store, callerid="/relay")
        writer.write(relayed, 3, store.serialize_ros1(description(store), kind))
        other = writer.add_connection("/x", "std_msgs/msg/String", typestore=STORE, callerid="/x")
        text = STORE.types["std_msgs/msg/String"](data="x")
        writer.write(other, 3, STORE.serialize_ros1(text, "std_msgs/msg/String"))
    found = read_declared([tmp_path], pytest.fail)
    rows = [(one.parameter, one.type, one.low, one.high, one.default) for one in found]
    assert rows == [
        ("/ns/node/gate", "double", 1.0, 9.0, 3.0),
        ("/ns/node/mode", "int", 0, 2, 1),
        ("/ns/node/on", "bool", None, None, True),
        ("/ns/node/frame", "str", None, None, "map"),
    ]
    assert found[1].choices == (("Drop", 0), ("Hold", 1))
    # It is read, and not run.
    assert found[3].choices == ()
    assert found[0].description == "the gate"
    assert found[0].place == f"topic {topic}"
    # A bag of another name is known by its first bytes, as when its reports are read.
    other = bag.rename(tmp_path / "mission.bag.1")
    assert read_declared([other]) == found


def test_broken_messages_and_bags(tmp_path):
    store = dynamic_store()
    raw = bytes(store.serialize_ros1(description(store), f"{NAME}ConfigDescription"))
    assert len(decode_description(raw, "/n/parameter_descriptions")) == 4
    for length in range(0, len(raw), 7):
        with pytest.raises((ValueError, IndexError, struct.error)):
            decode_description(raw[:length], "/n/parameter_descriptions")
    latin = raw.replace(b"the gate", b"the g\xe4te")
    assert decode_description(latin, "/n/parameter_descriptions")[0].description == "the g\ufffdte"
    bag = tmp_path / "m.bag"
    bag.write_bytes(b"#ROSBAG V2.0\n broken")
    (tmp_path / "other.bag").write_bytes(b"something else")
    said = []
    assert read_declared([tmp_path], said.append) == []
    assert len(said) == 1
    assert said[0].startswith(f"{bag}: descriptions of parameters: ")


def test_a_recording_that_is_no_bag_declares_nothing(tmp_path: Path) -> None:
    recording = tmp_path / "mission.tpc"
    recording.write_bytes(b"TPCLOG1\n".ljust((1 << 20) + 1, b"\0"))
    said: list[str] = []
    assert read_declared([recording], said.append) == []
    assert said == []
