"""From the analysis to reports: the hook finds again what `pytpc analyse` writes."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from pytpc.cli.main import main
from pytpc.ingest.reading import read
from pytpc.static.static_info import StaticInfo

ROOT = Path(__file__).parents[2]
MANIFEST = """<package format="2"><name>{}</name><version>0.0.1</version>
<description>d</description><license>BSD</license>
<maintainer email="someone@example.org">x</maintainer></package>"""
# As much of ROS as the nodes below need; nothing of it is instrumented.
ROSPY = """import types
def get_param(name): return 3
class Publisher:
    def __init__(self, *_): pass
    def publish(self, what): print("published", what)
def Subscriber(_topic, _kind, callback):
    for value in (2, 4):
        callback(types.SimpleNamespace(data=value))
def init_node(_): pass
"""
PARAMS = """import rospy
def above(value):
    return value > rospy.get_param('~top')
"""
NODE = """import rospy
from my_utils.params import above
def main():
    pub = rospy.Publisher('out', object)
    rospy.init_node('user')
    rospy.Subscriber('in', object, lambda m: pub.publish(m.data) if above(m.data) else None)
    rospy.Subscriber('in', object, lambda m: pub.publish(min(m.data, rospy.get_param('~most'))))
"""


@pytest.fixture
def source(tmp_path: Path) -> Path:
    """A workspace with the package of a node, one of modules, and a fake of ROS."""
    source = tmp_path / "ws/src"
    files = {
        "my_utils/setup.py": "setup(packages=['my_utils'], package_dir={'': 'src'})",
        "my_utils/src/my_utils/__init__.py": "",
        "my_utils/src/my_utils/params.py": PARAMS,
        "user/setup.py": "setup(entry_points={'console_scripts': ['go=user.go:main']})",
        "user/user/__init__.py": "",
        "user/user/go.py": NODE,
        "../../ros/rospy.py": ROSPY,
        "../../bin/go": "#!/usr/bin/env python3\nfrom user.go import main\nmain()\n",
    }
    for name, text in files.items():
        path = source / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    for name in ("my_utils", "user"):
        (source / name / "package.xml").write_text(MANIFEST.format(name))
    done = CliRunner().invoke(main, ["analyse", str(source), "-o", str(tmp_path / "static.json")])
    assert (done.exit_code, done.stderr) == (0, "")
    return source


def reports(
    folder: Path, script: Path, *modules: Path
) -> tuple[str, list[tuple[int, float, float, bool]]]:
    """The output of a program, and its reports as line, value, threshold and outcome."""
    environment = {
        **os.environ,
        "TPC_SINK": "file",
        "TPC_FOLDER": str(folder / "tpc"),
        "TPC_FILE_RESERVE": "0",
        "TPC_STATIC": str(folder / "static.json"),
        "PYTHONPATH": os.pathsep.join(map(str, modules)),
    }
    done = subprocess.run(
        [sys.executable, str(ROOT / "pytpc/python_runtime/run.py"), str(script)],
        env=environment, capture_output=True, text=True, check=False, timeout=60,
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (0, "")
    lines = {
        one.key: one.lineno
        for unit in StaticInfo.load(folder / "static.json").units
        for one in unit.comparisons
    }
    (file,) = (folder / "tpc").glob("*.tpc")
    events = read(file).events
    at = [lines[events.keys[code]] for code in events.key]
    values = (events.cmp.tolist(), events.thresh.tolist(), events.res.tolist())
    return done.stdout, list(zip(at, *values, strict=True))


# 2 > 3 is false, 4 > 3 is true and published; then min(2, 3) and min(4, 3), where 4 is above 3.
SAID = "published 4\npublished 2\npublished 3\n"
REPORTED = [(3, 2.0, 3.0, False), (3, 4.0, 3.0, True), (7, 2.0, 3.0, False), (7, 4.0, 3.0, True)]


def test_an_entry_point_and_another_packages_module_report(source: Path, tmp_path: Path) -> None:
    paths = (tmp_path / "ros", source / "user", source / "my_utils/src")
    assert reports(tmp_path, tmp_path / "bin/go", *paths) == (SAID, REPORTED)


def test_installed_copies_report(source: Path, tmp_path: Path) -> None:
    installed = tmp_path / "install"
    shutil.copytree(source / "user/user", installed / "user")
    shutil.copytree(source / "my_utils/src/my_utils", installed / "my_utils")
    assert reports(tmp_path, tmp_path / "bin/go", tmp_path / "ros", installed) == (SAID, REPORTED)


ODD = """# coding: latin-1
import rospy
pub = rospy.Publisher('out', 1)
limit = rospy.get_param('~p')
"""


@pytest.mark.parametrize(
    ("start", "ends"),
    [
        ("", "\n"),
        ("\f", "\n"),
        ("x = '\x0c\xe4'\n", "\n"),
        ("", "\r\n"),
        ("x = '\x1c\x85'\n", "\r\n"),
    ],
)
def test_odd_files_report(start: str, ends: str, tmp_path: Path) -> None:
    (tmp_path / "ros").mkdir()
    (tmp_path / "ros/rospy.py").write_text(ROSPY)
    script = tmp_path / "node.py"
    text = f"{ODD}{start}if '\xe4' and 5 > limit:\n    pub.publish(1)\nrospy.init_node('n')\n"
    script.write_bytes(text.replace("\n", ends).encode("latin-1"))
    output = tmp_path / "static.json"
    CliRunner().invoke(main, ["analyse", str(script), "-o", str(output)])
    # An installed copy is told by its lines.
    copy = tmp_path / "copy/node.py"
    copy.parent.mkdir()
    script.rename(copy)
    line = 6 if start.endswith("\n") else 5
    said = "published 1\n"
    assert reports(tmp_path, copy, tmp_path / "ros") == (said, [(line, 5.0, 3.0, True)])


FORMULAS = """import rospy
pub = rospy.Publisher('out', 1)
limit = rospy.get_param('~p')
def say(value):
    print('asked', value)
    return value
def heard(m):
    if say(m.data) > limit * say(m.data - 1):
        pub.publish('above')
    pub.publish(say(m.data) < say(1) + limit)
rospy.init_node('n')
rospy.Subscriber('in', 1, heard)
"""


def test_formulas_report_and_evaluate_each_operand_once_in_order(tmp_path: Path) -> None:
    (tmp_path / "ros").mkdir()
    (tmp_path / "ros/rospy.py").write_text(ROSPY)
    script = tmp_path / "node.py"
    script.write_text(FORMULAS)
    done = CliRunner().invoke(main, ["analyse", str(script), "-o", str(tmp_path / "static.json")])
    assert done.exit_code == 0, done.stderr
    # limit is 3. For 2: 2 > 3 * 1, 2 < 1 + 3; for 4: 4 > 3 * 3, 4 < 1 + 3.
    said = "asked 2\nasked 1\nasked 2\nasked 1\npublished True\n"
    said += "asked 4\nasked 3\nasked 4\nasked 1\npublished False\n"
    reported = [(8, 2, 3, False), (10, 2, 4, True), (8, 4, 9, False), (10, 4, 4, False)]
    assert reports(tmp_path, script, tmp_path / "ros") == (said, reported)
