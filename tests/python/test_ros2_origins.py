"""Origins of values from command lines of ROS 2, and edits of its launch files, without ROS."""

from __future__ import annotations

from pathlib import Path

import pytest

from pytpc.base.errors import InputError
from pytpc.values.launch_kinds import is_of_ros2, is_ros2_launch, is_yaml
from pytpc.values.new_value import Refused
from pytpc.values.origins import Origin
from pytpc.values.recorded_files import check_keys
from pytpc.values.ros2_arguments import origins_in_params, origins_of_arguments
from pytpc.values.ros2_launch_edit import edit_ros2_launch
from pytpc.values.ros2_trace import OF_ROS2

FIRST = "/**:\n  ros__parameters:\n    a: 1\n    b: 2\nguard:\n  ros__parameters:\n    a: 3\n"
SECOND = "/**:\n  ros__parameters:\n    a: 4\n    b: 5\n"


def test_the_last_file_does_not_override_the_entry_of_the_node(tmp_path: Path) -> None:
    (tmp_path / "first.yaml").write_text(FIRST)
    (tmp_path / "second.yaml").write_text(SECOND)
    words = ["--params-file", "no.yaml", "--ros-args", "--params-file", "first.yaml"]
    words += ["--params-file", "second.yaml", "-p", "c:=1e3", "--", "-p", "d:=1"]
    found = origins_of_arguments("/guard", words, tmp_path)
    first, second = tmp_path / "first.yaml", tmp_path / "second.yaml"
    assert {name: (one.value, one.path, one.lineno) for name, one in found.items()} == {
        # `guard` is mentioned behind `/**`, whose second file changes the entry before it.
        "/guard/a": (3, first, 7),
        "/guard/b": (5, second, 4),
        "/guard/c": (1000.0, None, None),
    }
    assert found["/guard/a"].overridden == (f"{first}:3", f"{second}:3")
    assert found["/guard/b"].overridden == (f"{first}:4",)
    assert found["/guard/a"].keys == ("guard", "ros__parameters", "a")
    assert found["/guard/c"].note == "in the args of the node: c:=1e3"
    other = origins_of_arguments("/robot1/guard", words, tmp_path)
    assert [one.value for one in other.values()] == [4, 5, 1000.0]


def test_a_bad_rule(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="types int and string"):
        origins_of_arguments("/guard", ["--ros-args", "-p", "a:=[1, x]"], tmp_path)


def test_one_params_file(tmp_path: Path) -> None:
    path = tmp_path / "first.yaml"
    path.write_text(FIRST)
    assert {name: one.value for name, one in origins_in_params(path).items()} == {
        "/guard/a": 3,
        "/guard/b": 2,
    }
    assert origins_in_params(path, "/other/a")["/other/a"].lineno == 3


def test_kinds_of_files(tmp_path: Path) -> None:
    texts = {
        "a.launch.py": "",
        "b.launch": '<launch><node pkg="p" exec="e"/></launch>',
        "c.launch": '<launch><node pkg="p" type="e" name="n"/></launch>',
        "d.yaml": "launch:\n- arg: {name: x}\n",
        "e.yaml": FIRST,
        "f.yaml": "limit: 1\nlaunch:\n  height: 2\n",
        "g.launch": '<launch><rosparam file="$(dirname)/own.yaml"/></launch>',
        "h.yaml": "# robot\nlaunch:  # all\n\n# first\n  - arg: {name: x}\n",
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text)
    kinds = {
        name: [check(tmp_path / name) for check in (is_ros2_launch, is_of_ros2, is_yaml)]
        for name in texts
    }
    assert kinds == {
        "a.launch.py": [True, True, False],
        "b.launch": [True, True, False],
        "c.launch": [False, False, False],
        "d.yaml": [True, True, False],
        "e.yaml": [False, True, True],
        "f.yaml": [False, False, True],
        "g.launch": [False, False, False],
        "h.yaml": [True, True, False],
    }


def origin(name: str, value: object, file: str, lineno: int, argument: str = "") -> Origin:
    return Origin(
        name, "launch", value, Path(file), lineno, "", argument=argument, param_type=OF_ROS2
    )


@pytest.mark.parametrize(
    ("text", "one", "given", "after"),
    [
        ('d = {"x": 4.0}  # m\n', origin("/n/x", 4.0, "l.py", 1), "5", 'd = {"x": 5.0}  # m\n'),
        ("d = {'x': 'é', 'y': 1}\n", origin("/n/y", 1, "l.py", 1), "2", "d = {'x': 'é', 'y': 2}\n"),
        ("d = {'x': 'a'}\n", origin("/n/x", "a", "l.py", 1), "it's", "d = {'x': 'it\\'s'}\n"),
        ("d = {'x': -1}\n", origin("/n/x", -1, "l.py", 1), "3", "d = {'x': 3}\n"),
        ("d = {'x': True}\n", origin("/n/x", True, "l.py", 1), "off", "d = {'x': False}\n"),
        (
            "d = {'x': ParameterValue(1.5, value_type=float)}\n",
            origin("/n/x", 1.5, "l.py", 1),
            "2",
            "d = {'x': ParameterValue(2.0, value_type=float)}\n",
        ),
        (
            "A('lim', default_value='1.5')\n",
            origin("/n/x", 1.5, "l.py", 1, "lim"),
            "2",
            "A('lim', default_value='2.0')\n",
        ),
        (
            '<launch>\n<node><param name="x" value="1.5"/></node></launch>\n',
            origin("/n/x", 1.5, "l.xml", 2),
            "2",
            '<launch>\n<node><param name="x" value="2.0"/></node></launch>\n',
        ),
        (
            "launch:\n- node:\n    param:\n    - name: x\n      value: 1.5 # m\n",
            origin("/n/x", 1.5, "l.yaml", 5),
            "2",
            "launch:\n- node:\n    param:\n    - name: x\n      value: 2.0 # m\n",
        ),
    ],
)
def test_a_literal_in_a_launch_file_changes(text: str, one: Origin, given: str, after: str) -> None:
    edit = edit_ros2_launch(text.encode(), one, one.lineno or 0, given)
    assert edit.data.decode() == after


@pytest.mark.parametrize(
    ("text", "one", "given", "why"),
    [
        ("d = {'x': 2 * y}\n", origin("/n/x", 4.0, "l.py", 1), "5", r"computes it: 2 \* y"),
        ("d = {'x': 1}; e = {'x': 1}\n", origin("/n/x", 1, "l.py", 1), "5", "several values"),
        ("d = {'x': 1}\n", origin("/n/x", 1, "l.py", 1), "1.5", "is a whole number"),
        ("d = {'y': 1}\n", origin("/n/x", 1, "l.py", 1), "5", "no literal"),
        (
            '<l><param name="x" value="$(eval 1 + 2)"/></l>',
            origin("/n/x", 3, "l.xml", 1),
            "5",
            "computes it",
        ),
        (
            '<l><arg name="a" default="1"/><p v="$(var a)" w="$(var a)"/></l>',
            origin("/n/x", 1, "l.xml", 1, "a"),
            "5",
            "used 2 times here; --force changes all",
        ),
    ],
)
def test_what_is_no_plain_literal_is_refused(text: str, one: Origin, given: str, why: str) -> None:
    with pytest.raises(Refused, match=why) as refused:
        edit_ros2_launch(text.encode(), one, one.lineno or 0, given)
    assert refused.value.lineno == 1


def test_the_keys_of_a_recording_are_those_of_the_parameter() -> None:
    keys = ("/robot1", "*", "ros__parameters", "limits", "min")
    good = Origin("/robot1/guard/limits.min", "yaml", 1, Path("p.yaml"), 1, "", keys=keys)
    check_keys(good)
    for name in ("/robot1/guard/limits.max", "/robot2/guard/limits.min", "/robot1/a/b/limits.min"):
        with pytest.raises(InputError, match="is not that of"):
            check_keys(Origin(name, "yaml", 1, Path("p.yaml"), 1, "", keys=keys))
