"""What `make setup` installs: lists of packages, and no more for a user than a user needs."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import time
from pathlib import Path

import pytest
import tomllib
from packaging.requirements import Requirement

from pytpc.base.paths import COLCON_EXTENSIONS, build_tools

ROOT = Path(__file__).parents[2]
KINDS = ("", "-demo", "-test", "-llvm22")
LISTS = {name: ROOT / f"tools/debian-packages{name}.txt" for name in KINDS}
# Each package that the product's messages do not name, and why a user needs it all the same.
BUILDS_TPC = {
    "catkin": "the user's packages are catkin packages",
    "g++": "what clang rejects is built with it; colcon asks gcc for the architecture",
    "libroscpp-dev": "headers of the log library",
    "libstd-srvs-dev": "headers of the log library",
    "llvm-19-dev": "headers of the passes",
    "ninja-build": "builds the passes",
    "pkg-config": "finds ROS for the log library",
    "python3-roslaunch": "pytpc record --launch; brings rosmaster, rosparam and rosout",
    "python3-rospy": "pytpc relay, and Python nodes that report",
    "python3-venv": "the Python side lives in one",
}


def packages(name: str) -> list[str]:
    lines = [line.split("#")[0].strip() for line in LISTS[name].read_text().splitlines()]
    return [line for line in lines if line]


def test_no_package_stands_twice():
    everything = [package for name in LISTS for package in packages(name)]
    assert len(everything) == len(set(everything))


def test_a_user_gets_what_the_product_asks_for_and_nothing_else():
    named = {package for words in build_tools().values() for package in words.split()}
    named |= {"python3-" + name for name in COLCON_EXTENSIONS}
    assert set(packages("")) == named | set(BUILDS_TPC)


def test_the_demo_gets_what_its_robots_declare():
    declared = {
        depend.replace("_", "-")
        for robot in ("image_capture", "water_sampler", "navigation", "simulated_world")
        for depend in re.findall(
            r"<\w*depend>(\w+)</\w*depend>", (ROOT / f"examples/{robot}/package.xml").read_text()
        )
    }
    # A ROS package is a Debian package of a longer name, or one that a user has anyway.
    named = [
        re.sub(r"^(lib|python3-|ros-)|-dev$", "", package)
        for package in packages("-demo") + packages("")
    ]
    brought = {"message-runtime", "rosgraph-msgs", "roscpp", "simulated-world"}
    assert declared - set(named) <= brought
    assert {re.sub(r"^(lib|python3-|ros-)|-dev$", "", p) for p in packages("-demo")} <= declared


def project() -> dict:
    return tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def test_a_user_gets_no_python_package_of_the_tests():
    users = {Requirement(text).name for text in project()["dependencies"]}
    tests = {Requirement(text).name for text in project()["optional-dependencies"]["dev"]}
    assert not users & tests
    assert {"pytest", "hypothesis", "ruff", "mypy", "selenium", "import-linter"} <= tests


@pytest.fixture
def debian(tmp_path: Path) -> Path:
    """A folder of programs in which dpkg-query knows two packages, one of them removed."""
    programs = tmp_path / "bin"
    programs.mkdir()
    query = programs / "dpkg-query"
    query.write_text(
        "#!/bin/sh\necho 'here install ok installed'\necho 'gone deinstall ok config-files'\n"
        "exit 1\n"
    )
    query.chmod(0o755)
    return programs


def missing(programs: Path, *lists: Path) -> str:
    ran = subprocess.run(
        [ROOT / "tools/install-packages", "--missing", *lists],
        env={**os.environ, "PATH": f"{programs}:/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=True,
    )
    return ran.stdout.strip()


def test_missing_packages_of_several_lists_are_named(debian, tmp_path):
    first, second = tmp_path / "first", tmp_path / "second"
    first.write_text("# a comment\nhere\ngone # another\n\n")
    second.write_text("her\nnew\n")
    assert missing(debian, first, second) == "gone her new"
    first.write_text("here\n")
    assert missing(debian, first) == ""


def test_setup_refuses_a_level_that_it_does_not_know():
    ran = subprocess.run(
        [ROOT / "tools/setup", "everything"], capture_output=True, text=True, check=False
    )
    assert ran.returncode == 1
    assert ran.stderr == "setup: error: no level 'everything': user, demo, test, docs or ros2\n"


# Without a node in C++, the demonstration on ROS 2 needs neither a compiler nor ROS 1.
@pytest.mark.parametrize("has_rclcpp", [False, True])
def test_ros2_without_rclcpp_needs_no_compiler(tmp_path, has_rclcpp):
    tools = tmp_path / "tools"
    tools.mkdir()
    setup = Path(shutil.copy(ROOT / "tools/setup", tools))
    install = tools / "install-packages"
    install.write_text('#!/bin/sh\nshift\necho "$@" >asked\nexit 1\n')
    install.chmod(0o755)
    prefix = tmp_path / "ros"
    if has_rclcpp:
        (prefix / "share/rclcpp").mkdir(parents=True)
        (prefix / "share/rclcpp/package.xml").touch()
    env = {"AMENT_PREFIX_PATH": f"/none:{prefix}"}
    assert subprocess.run([setup, "ros2"], env=env, cwd=tmp_path, check=False).returncode == 1
    name = "debian-packages.txt" if has_rclcpp else "debian-packages-ros2.txt"
    assert (tmp_path / "asked").read_text() == f"tools/{name}\n"


def test_one_version_everywhere():
    version = (ROOT / "VERSION").read_text().strip()
    assert re.fullmatch(r"\d+\.\d+\.\d+", version)
    assert project()["dynamic"] == ["version"]
    # setuptools reads no file from above the package's own folder.
    evaluation = tomllib.loads((ROOT / "evaluation/pyproject.toml").read_text())
    assert evaluation["project"]["version"] == version
    written = re.compile(rf"(?<![\d.]){re.escape(version)}(?![\d.])")
    for path in (ROOT / "pyproject.toml", ROOT / "CMakeLists.txt"):
        assert not written.search(path.read_text()), f"{path.name} repeats the version"
    assert f"## [{version}]" in (ROOT / "CHANGELOG.md").read_text()


@pytest.mark.parametrize("ending", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_ends_what_setup_has_started(tmp_path, ending):
    tools = tmp_path / "tools"
    tools.mkdir()
    setup = Path(shutil.copy(ROOT / "tools/setup", tools))
    (tools / "debian-packages.txt").write_text("new\n")
    started = tmp_path / "started"
    install = tools / "install-packages"
    # A whole line is in the file, or none: the move is one step.
    install.write_text(
        '#!/bin/sh\n[ "$1" = --missing ] && echo new && exit\n'
        f"echo $$ >{started}.new\nmv {started}.new {started}\nexec sleep 600\n"
    )
    install.chmod(0o755)
    # A test that runs in the background hands an ignored interrupt on.
    ran = subprocess.Popen(["/usr/bin/env", "--default-signal=INT", setup], cwd=tmp_path)
    try:
        while not started.exists():
            assert ran.poll() is None
            time.sleep(0.05)
        ran.send_signal(ending)
        assert ran.wait(timeout=60) == 130
        sleeper = Path("/proc", started.read_text().strip())
        while sleeper.exists():
            time.sleep(0.05)
    finally:
        ran.kill()
        ran.wait()
