"""Which ROS 2 a machine has, which of its two ROS a package is for, and what a build is told."""

import os
from pathlib import Path

import pytest
from packages import add_package

from pytpc.base.errors import MissingToolError
from pytpc.build import ros_parts
from pytpc.build.missing import hint, missing_package
from pytpc.build.ros_parts import parts_of, require_ros2, run_under
from pytpc.workspace.colcon import Bases
from pytpc.workspace.packages import Package, find_packages, read_manifest
from pytpc.workspace.ros2 import (
    SYSTEM_PYTHON,
    Ros2,
    cmake_python,
    default_ros,
    find_ros2,
    for_ros1,
    for_ros2,
    has_cmake_package,
    how_to_source,
    likely_pythons,
    setups_with_rclpy,
    unsourced,
)

BOTH = """<buildtool_depend condition="$ROS_VERSION == 1">catkin</buildtool_depend>
<buildtool_depend condition="$ROS_VERSION == 2">ament_cmake</buildtool_depend>
<depend condition="$ROS_VERSION == 1">roscpp</depend>
<depend condition="$ROS_VERSION == 2">rclcpp</depend>
<export>
  <build_type condition="$ROS_VERSION == 1">catkin</build_type>
  <build_type condition="$ROS_VERSION == 2">ament_cmake</build_type>
</export>"""


def type_of(build_type: str) -> str:
    return f"<export><build_type>{build_type}</build_type></export>"


def with_rclpy(prefix: Path, place: str = "lib/python3.11/site-packages") -> Path:
    (prefix / place / "rclpy").mkdir(parents=True)
    (prefix / place / "rclpy/__init__.py").touch()
    return prefix


def with_python(prefix: Path) -> Path:
    (prefix / "bin").mkdir(parents=True, exist_ok=True)
    (prefix / "bin/python3").touch(mode=0o755)
    return prefix


@pytest.fixture(autouse=True)
def _no_ros(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in (
        "AMENT_PREFIX_PATH",
        "ROS_VERSION",
        "ROS_DISTRO",
        "VIRTUAL_ENV",
        "TPC_ROS2_PYTHON",
    ):
        monkeypatch.delenv(name, raising=False)


@pytest.mark.parametrize(
    "place", ["lib/python3.12/site-packages", "local/lib/python3.10/dist-packages"]
)
def test_a_sourced_ros_2_runs_under_the_systems_python(tmp_path: Path, place: str) -> None:
    distribution = with_rclpy(tmp_path / "kilted", place)
    overlay = tmp_path / "ws/install"
    env = {"AMENT_PREFIX_PATH": f"{overlay}{os.pathsep}{distribution}", "PATH": ""}
    assert find_ros2(env) == Ros2((overlay, distribution), SYSTEM_PYTHON)


def test_a_sourced_prefix_with_a_python_of_its_own_runs_under_it(tmp_path: Path) -> None:
    conda = with_python(with_rclpy(tmp_path / "conda"))
    found = find_ros2({"AMENT_PREFIX_PATH": str(conda), "PATH": ""})
    assert found == Ros2((conda,), conda / "bin/python3")


def test_the_active_environment_is_taken_if_it_has_rclpy(tmp_path: Path) -> None:
    active = with_python(with_rclpy(tmp_path / "venv"))
    expected = Ros2((active,), active / "bin/python3", is_sourced=False)
    assert find_ros2({"VIRTUAL_ENV": str(active), "PATH": ""}) == expected
    assert find_ros2({"PATH": f"{active}/bin"}) == expected
    plain = with_python(tmp_path / "plain")
    assert find_ros2({"VIRTUAL_ENV": str(plain), "PATH": f"{plain}/bin"}) is None


def test_the_python_that_the_user_names_goes_first(tmp_path: Path) -> None:
    named = with_python(with_rclpy(tmp_path / "mine")) / "bin/python3"
    distribution = with_rclpy(tmp_path / "kilted")
    env = {"TPC_ROS2_PYTHON": str(named), "PATH": ""}
    assert find_ros2(env) == Ros2((tmp_path / "mine",), named, is_sourced=False)
    assert find_ros2({**env, "AMENT_PREFIX_PATH": str(distribution)}) == Ros2(
        (distribution,), named
    )
    # One that is no program is as if it were not named.
    env["TPC_ROS2_PYTHON"] = str(tmp_path / "none")
    assert find_ros2(env) is None


def test_the_pythons_that_may_have_rclpy(tmp_path: Path) -> None:
    # Without rclpy in its own folders, it may have it in those of PYTHONPATH.
    plain = with_python(tmp_path / "plain") / "bin/python3"
    active = with_python(with_rclpy(tmp_path / "venv")) / "bin/python3"
    distribution = with_rclpy(tmp_path / "jazzy")
    env = {"VIRTUAL_ENV": str(tmp_path / "venv"), "PATH": str(plain.parent)}
    assert likely_pythons(env) == [active, plain]
    env["AMENT_PREFIX_PATH"] = str(distribution)
    assert likely_pythons(env) == [SYSTEM_PYTHON, active, plain]
    env["TPC_ROS2_PYTHON"] = str(plain)
    assert likely_pythons(env) == [plain, active]


def test_installed_distributions_of_every_layout_have_rclpy(tmp_path: Path) -> None:
    humble = with_rclpy(tmp_path / "humble", "local/lib/python3.10/dist-packages")
    kilted = with_rclpy(tmp_path / "kilted", "lib/python3.12/site-packages")
    noetic = tmp_path / "noetic"
    noetic.mkdir()
    for prefix in (humble, kilted, noetic):
        (prefix / "setup.sh").touch()
    found = setups_with_rclpy([humble, kilted, noetic, tmp_path / "none"])
    assert found == [kilted / "setup.sh", humble / "setup.sh"]


def test_a_distribution_that_was_not_sourced_is_only_named(tmp_path: Path) -> None:
    prefixes = [tmp_path / name for name in ("jazzy", "kilted", "noetic")]
    for prefix in prefixes:
        prefix.mkdir()
        (prefix / "setup.bash").touch()
    for prefix in prefixes[:2]:
        (prefix / "share/ament_index").mkdir(parents=True)
    jazzy, kilted, _ = (prefix / "setup.bash" for prefix in prefixes)
    assert unsourced({}, prefixes) == [kilted, jazzy]
    assert unsourced({"AMENT_PREFIX_PATH": str(prefixes[1])}, prefixes) == [jazzy]
    assert how_to_source({}, prefixes) == f"source {kilted}"
    assert how_to_source({}, []) == "source /opt/ros/DISTRO/setup.bash"


def test_the_ros_of_a_package_for_both(tmp_path: Path) -> None:
    assert default_ros({"ROS_VERSION": "1", "AMENT_PREFIX_PATH": "/x"}) == "1"
    assert default_ros({"ROS_VERSION": "2"}) == "2"
    assert default_ros({"AMENT_PREFIX_PATH": "/x"}) == "2"
    with_catkin = tmp_path / "one"
    (with_catkin / "share/catkin/cmake").mkdir(parents=True)
    (with_catkin / "share/catkin/cmake/catkinConfig.cmake").touch()
    assert default_ros({"CMAKE_PREFIX_PATH": str(with_catkin), "PATH": ""}) == "1"


@pytest.mark.parametrize("sourced", ["1", "2"])
def test_conditions_are_those_of_the_ros_that_a_package_is_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, sourced: str
) -> None:
    monkeypatch.setenv("ROS_VERSION", sourced)
    asks = """<depend condition="$ROS_VERSION == 1">roscpp</depend>
    <depend condition="$ROS_VERSION == 2">rclcpp</depend>"""
    for build_type, needs in (
        ("catkin", ("roscpp",)),
        ("ament_cmake", ("rclcpp",)),
        ("ament_python", ("rclcpp",)),
    ):
        folder = add_package(tmp_path / build_type, more=asks + type_of(build_type))
        assert read_manifest(folder).needs == needs
    both = read_manifest(add_package(tmp_path / "both", more=BOTH))
    expected = {"1": ("catkin", "roscpp"), "2": ("ament_cmake", "rclcpp")}[sourced]
    assert (both.build_type, both.run_depends[0], both.ros) == (*expected, sourced)


def test_the_prefixes_of_the_caller_come_first_for_ros_2() -> None:
    ros2 = Ros2((Path("/venv"),), Path("/venv/bin/python3"), is_sourced=False)
    changed = for_ros2({"CMAKE_PREFIX_PATH": "/opt/a:/venv", "HOME": "/h"}, ros2)
    assert changed == {
        "AMENT_PREFIX_PATH": "/venv",
        "CMAKE_PREFIX_PATH": "/opt/a:/venv",
        "HOME": "/h",
        "ROS_VERSION": "2",
    }
    assert for_ros2({}, None) == {"ROS_VERSION": "2"}


def test_a_build_for_ros_1_finds_nothing_of_ros_2() -> None:
    env = {
        "AMENT_PREFIX_PATH": "/opt/ros/kilted:/ws/arm",
        "CMAKE_PREFIX_PATH": "/ws/arm:/opt/ros/noetic",
        "PYTHONPATH": "/opt/ros/kilted/lib/python3.12/site-packages:/own",
        "PATH": "/opt/ros/kilted/bin:/usr/bin",
        "COLCON_PREFIX_PATH": "/ws:/other/install",
        "ROS_VERSION": "2",
    }
    assert for_ros1(env) == {
        "CMAKE_PREFIX_PATH": "/opt/ros/noetic",
        "PYTHONPATH": "/own",
        "PATH": "/usr/bin",
        "COLCON_PREFIX_PATH": "/other/install",
        "ROS_VERSION": "1",
    }
    assert for_ros1({"PATH": "/usr/bin"}) == {"PATH": "/usr/bin", "ROS_VERSION": "1"}


def test_ament_runs_under_a_python_that_has_it(tmp_path: Path) -> None:
    wheels = with_python(with_rclpy(tmp_path / "venv"))
    ros2 = Ros2((wheels,), wheels / "bin/python3", is_sourced=False)
    assert cmake_python(None) == cmake_python(ros2) == SYSTEM_PYTHON
    (wheels / "lib/python3.11/site-packages/ament_package").mkdir()
    (wheels / "lib/python3.11/site-packages/ament_package/__init__.py").touch()
    assert cmake_python(ros2) == wheels / "bin/python3"
    assert has_cmake_package("ament_cmake", [wheels]) is False


def mixed(folder: Path) -> list[Package]:
    add_package(folder / "arm", more=type_of("catkin"), cmakelists=b"project(arm)\n")
    add_package(
        folder / "camera", more=f"<depend>arm</depend>{type_of('ament_cmake')}", cmakelists=b"\n"
    )
    add_package(folder / "maths", more=type_of("cmake"), cmakelists=b"project(maths)\n")
    return find_packages(folder)


def names(packages: object) -> list[str]:
    assert isinstance(packages, tuple)
    return [each.name for each in packages]


def test_each_ros_is_built_in_a_run_of_its_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("AMENT_PREFIX_PATH", "/opt/ros/kilted")
    monkeypatch.setenv("CMAKE_PREFIX_PATH", "/opt/ros/kilted")
    bases = Bases(tmp_path / ".tpc")
    ros2 = Ros2((Path("/opt/ros/kilted"),), SYSTEM_PYTHON)
    one, two = parts_of(mixed(tmp_path / "src"), [], bases, ros2)
    # Plain CMake packages go with the first part, where both find them.
    assert (names(one.packages), one.names) == (["arm", "maths"], ())
    assert (names(two.packages), two.names) == (["camera"], ())
    assert one.environment["ROS_VERSION"] == "1"
    assert one.environment["CMAKE_PREFIX_PATH"] == ""
    assert "AMENT_PREFIX_PATH" not in one.environment
    assert two.environment["ROS_VERSION"] == "2"
    places = [*(f"{bases.install}/{name}" for name in ("arm", "maths")), str(bases.install)]
    assert two.environment["CMAKE_PREFIX_PATH"].split(":") == [*places, "/opt/ros/kilted"]
    assert two.cmake_args == ("-DPython3_EXECUTABLE=/usr/bin/python3",)
    assert one.cmake_args == ()


def test_only_the_parts_with_chosen_packages_are_built(tmp_path: Path) -> None:
    packages, bases = mixed(tmp_path / "src"), Bases(tmp_path / ".tpc")
    (only,) = parts_of(packages, ["arm"], bases, None)
    assert (names(only.packages), only.names) == (["arm", "maths"], ("arm",))
    one, two = parts_of(packages, ["camera"], bases, None)
    assert (one.names, two.names) == (("arm",), ("camera",))


def test_what_ros_1_needs_of_ros_2_is_built_first(tmp_path: Path) -> None:
    add_package(tmp_path / "arm", more=f"<depend>camera</depend>{type_of('catkin')}")
    add_package(tmp_path / "camera", more=type_of("ament_python"))
    one, two = parts_of(find_packages(tmp_path), [], Bases(tmp_path / ".tpc"), None)
    assert (names(one.packages), names(two.packages)) == (["camera"], ["arm"])


def test_a_workspace_for_one_ros_is_one_part(tmp_path: Path) -> None:
    add_package(tmp_path / "arm", more=type_of("catkin"))
    add_package(tmp_path / "maths", more=type_of("cmake"))
    (only,) = parts_of(find_packages(tmp_path), ["arm"], Bases(tmp_path / ".tpc"), None)
    assert (names(only.packages), only.names) == (["arm", "maths"], ("arm",))
    assert (only.environment["ROS_VERSION"], only.cmake_args) == ("1", ())


def test_a_package_of_ament_cmake_needs_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    add_package(tmp_path / "arm", more=type_of("ament_cmake"), cmakelists=b"project(arm)\n")
    monkeypatch.setattr(ros_parts, "has_cmake_package", lambda *_: False)
    with pytest.raises(MissingToolError, match="arm is for ROS 2, and ament_cmake was not found"):
        require_ros2(find_packages(tmp_path))


def test_copied_scripts_run_under_the_python_of_ros_2(tmp_path: Path) -> None:
    bases = Bases(tmp_path)
    package = Package("guard", tmp_path / "src/guard", "ament_python")
    places = [bases.install / "guard/lib/guard", bases.install / "lib/guard"]
    own = tmp_path / "own"
    own.write_text("#!/usr/bin/python3\nimport rclpy\n")
    for place in places:
        place.mkdir(parents=True)
        (place / "copied").write_text("#!/usr/bin/python3\nimport rclpy\n")
        (place / "other").write_text("#!/usr/bin/env python3\n")
        (place / "linked").symlink_to(own)
    run_under(bases, [package], Ros2((), SYSTEM_PYTHON))
    assert (places[0] / "copied").read_text().startswith("#!/usr/bin/python3\n")
    run_under(bases, [package], Ros2((), Path("/venv/bin/python3"), is_sourced=False))
    for place in places:
        assert (place / "copied").read_text() == "#!/venv/bin/python3\nimport rclpy\n"
        assert (place / "other").read_text() == "#!/usr/bin/env python3\n"
    assert own.read_text() == "#!/usr/bin/python3\nimport rclpy\n"


@pytest.mark.parametrize(
    ("line", "name"),
    [
        ('  Could not find a package configuration file provided by "nav2_util" with', "nav2_util"),
        ('  By not providing "Findrclcpp.cmake" in CMAKE_MODULE_PATH this project', "rclcpp"),
        ("/w/a.cpp:1:10: fatal error: rclcpp/rclcpp.hpp: No such file or directory", "rclcpp"),
        ("/w/a.cpp:1:10: fatal error: 'rclcpp/rclcpp.hpp' file not found", "rclcpp"),
        ("ModuleNotFoundError: No module named 'ament_package'", "ament_package"),
        # A folder of headers that the manifest does not name is no package.
        ("/w/a.cpp:1:10: fatal error: 'sys/none.h' file not found", ""),
        ("make: *** [all] Error 2", ""),
    ],
)
def test_the_package_that_a_build_lacks(line: str, name: str) -> None:
    assert missing_package(["one line", line], ["rclcpp", "nav2_util"]) == name


def test_the_hint_names_the_package_the_key_and_the_command() -> None:
    package = Package("guard", Path("/w/guard"), "ament_cmake", ("no_such_one",))
    tail = ["fatal error: 'no_such_one/a.hpp' file not found"]
    said = hint(package, tail, None, "source /opt/ros/kilted/setup.bash")
    assert said == (
        "no_such_one of ROS 2 is not installed; a ROS 2 was not sourced: source"
        " /opt/ros/kilted/setup.bash; or: rosdep install --ignore-src --from-paths /w/guard"
        " (rosdep's key no_such_one)"
    )
    sourced = Ros2((Path("/opt/ros/kilted"),), SYSTEM_PYTHON)
    assert "was not sourced" not in hint(package, tail, sourced, "source x")
    of_ros1 = Package("arm", Path("/w/arm"), "catkin", ("no_such_one",))
    assert hint(of_ros1, tail, None, "source x") == ""
