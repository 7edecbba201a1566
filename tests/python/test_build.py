"""Building: the command for colcon, what is made of its logs, and the environment of the nodes.

Here colcon is a script of ours; tests/ros builds with the real one.
"""

import fcntl
import json
import os
import shutil
import signal
import sys
import time
from collections.abc import Collection, Sequence
from pathlib import Path
from types import SimpleNamespace

import pytest
from file_api import reply, target
from packages import add_package, install_prefix
from static_units import comparison, failed_unit, unit

from mixed_workspace import make_mixed
from pytpc.base.errors import InputError, MissingToolError, RunError, TpcError, WorkspaceError
from pytpc.build import build
from pytpc.build.build import build_workspace, workspace_env
from pytpc.build.fallback import LeftAlone
from pytpc.static.link_unit import LeftOut
from pytpc.static.static_info import StaticInfo
from pytpc.workspace.colcon import (
    Bases,
    BuildError,
    BuildOptions,
    build_environment,
    colcon_command,
    ended_jobs,
)
from pytpc.workspace.packages import Package

TOOLCHAIN = Path("/opt/tpc/share/tpc/cmake/tpc.cmake")
BASES = Bases(Path("/ws/.tpc"))
PACKAGES = [
    Package("arm", Path("/ws/src/[arm]"), "catkin"),
    Package("f", Path("/ws/f*"), "cmake"),
]


def values(command: list[str], option: str) -> list[str]:
    """What follows the last ``option``, up to the next word with two dashes."""
    start = len(command) - command[::-1].index(option)
    end = start
    while end < len(command) and not command[end].startswith("--"):
        end += 1
    return command[start:end]


def test_packages_alone_without_what_they_need() -> None:
    options = BuildOptions(packages=["arm"])
    command = colcon_command(BASES, PACKAGES, TOOLCHAIN, options, exactly=True)
    assert command[-2:] == ["--packages-select", "arm"]


def test_the_whole_command() -> None:
    assert colcon_command(BASES, PACKAGES, TOOLCHAIN) == [
        "colcon",
        "--log-base",
        "/ws/.tpc/log",
        "build",
        "--cmake-args",
        "-DCMAKE_TOOLCHAIN_FILE=/opt/tpc/share/tpc/cmake/tpc.cmake",
        "-DCMAKE_BUILD_TYPE=RelWithDebInfo",
        "-DTPC_RULES=",
        "-DTPC_BASE=/ws/.tpc",
        "-DPYTHON_EXECUTABLE=/usr/bin/python3",
        "--build-base",
        "/ws/.tpc/build",
        "--install-base",
        "/ws/.tpc/install",
        "--event-handlers",
        "console_direct+",
        "console_cohesion-",
        "console_stderr-",
        "summary-",
        "--paths",
        "/ws/src/[arm]",
        "/ws/f[*]",
    ]


def test_chosen_packages_are_built_with_what_they_need() -> None:
    command = colcon_command(
        BASES, PACKAGES, TOOLCHAIN, BuildOptions(packages=["arm"], build_type="Debug")
    )
    assert values(command, "--packages-up-to") == ["arm"]
    assert "-DCMAKE_BUILD_TYPE=Debug" in values(command, "--cmake-args")


def test_the_users_rules_go_to_cmake_by_their_absolute_path() -> None:
    command = colcon_command(BASES, PACKAGES, TOOLCHAIN, BuildOptions(rules=Path("own.json")))
    assert f"-DTPC_RULES={Path.cwd()}/own.json" in values(command, "--cmake-args")


def test_broken_rules_end_a_build_before_it_begins(tmp_path: Path) -> None:
    add_package(tmp_path / "src", "arm")
    rules = tmp_path / "own.json"
    rules.write_text('{"reeds": []}')
    with pytest.raises(InputError, match=r"own\.json: /: .*'reeds'"):
        build_workspace(tmp_path, BuildOptions(rules=rules))
    assert not (tmp_path / ".tpc").exists()


def test_the_users_cmake_arguments_add_to_ours() -> None:
    command = colcon_command(
        BASES,
        PACKAGES,
        TOOLCHAIN,
        BuildOptions(
            cmake_args=["-DFAULT=ON"],
            colcon_args=[
                "--merge-install",
                "--cmake-args",
                "-DX=1",
                "-Wno-dev",
                "--parallel-workers",
                "1",
            ],
        ),
    )
    assert values(command, "--cmake-args") == [
        f"-DCMAKE_TOOLCHAIN_FILE={TOOLCHAIN}",
        "-DCMAKE_BUILD_TYPE=RelWithDebInfo",
        "-DTPC_RULES=",
        "-DTPC_BASE=/ws/.tpc",
        "-DPYTHON_EXECUTABLE=/usr/bin/python3",
        "-DFAULT=ON",
        "-DX=1",
        "-Wno-dev",
    ]
    assert command.count("--cmake-args") == 1
    assert values(command, "--parallel-workers") == ["1"]
    assert command.index("--merge-install") > command.index("build")


@pytest.mark.parametrize("option", ["--build-base", "--install-base=x", "--log-base", "--paths"])
def test_the_bases_are_not_the_users_to_choose(option: str) -> None:
    with pytest.raises(WorkspaceError, match="cannot be given: TPC sets it"):
        colcon_command(BASES, PACKAGES, TOOLCHAIN, BuildOptions(colcon_args=[option, "y"]))


def test_the_environment_is_free_of_the_callers_python_and_make(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("VIRTUAL_ENV", "/venv")
    monkeypatch.setenv("PYTHONHOME", "/venv")
    monkeypatch.setenv("MAKEFLAGS", " -j2 --jobserver-auth=3,4")
    monkeypatch.setenv("PATH", "/venv/bin:/usr/bin")
    monkeypatch.setenv("CMAKE_PREFIX_PATH", "/opt/ros/noetic")
    environment = build_environment()
    assert environment["PATH"] == "/usr/bin:/bin:/venv/bin"
    assert environment["CMAKE_PREFIX_PATH"] == "/opt/ros/noetic"
    assert environment.keys().isdisjoint({"VIRTUAL_ENV", "PYTHONHOME", "MAKEFLAGS"})
    monkeypatch.setenv("MAKEFLAGS", "-j1")
    assert build_environment()["MAKEFLAGS"] == "-j1"


def test_how_packages_ended() -> None:
    events = (
        "[0.1] (a) JobStarted: {'identifier': 'a'}",
        "[1.5] (a) JobEnded: {'identifier': 'a', 'rc': 0}",
        "[2.0] (b) JobEnded: {'identifier': 'b', 'rc': 2}",
        "[2.1] (c) JobSkipped: {'identifier': 'c'}",
        "[2.2] (d) JobEnded: {'identifier': 'd', 'rc': 'SIGINT'}",
        "[2.3] (-) EventReactorShutdown: {}",
        r"""[9.0] (e) StdoutLine: {'line': b"[9] (x) JobEnded: {'identifier': 'x', 'rc': 1}\n"}""",
    )
    assert ended_jobs("\n".join(events)) == {"a": "0", "b": "2", "c": "skipped", "d": "'SIGINT'"}
    assert ended_jobs("") == {}


@pytest.fixture
def workspace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A workspace with the packages arm and face, and an installed C++ half to look at."""
    install_prefix(tmp_path / "prefix")
    monkeypatch.setenv("TPC_PREFIX", str(tmp_path / "prefix"))
    monkeypatch.setattr(build, "require_tools", dict)
    monkeypatch.setattr(build, "require_ros", lambda: None)
    for name in ("arm", "face"):
        add_package(tmp_path / "ws/src" / name, cmakelists=f"project({name})\n".encode())
    return tmp_path / "ws"


class FakeColcon:
    """Stands in for colcon: runs Python lines in a process of its own, in the workspace."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.lines: list[str] = []
        self.asked: list[tuple[tuple[str, ...], bool]] = []
        monkeypatch.setattr(build, "colcon_command", self._command)

    def _command(
        self,
        bases: Bases,
        packages: object,
        toolchain: object,
        options: BuildOptions,
        *,
        exactly: bool,
    ) -> list[str]:
        self.asked.append((tuple(options.packages), exactly))
        head = [
            "import os, sys, time",
            "from pathlib import Path",
            f"cmake_args = {options.cmake_args!r}",
            f"base = Path({str(bases.root)!r})",
        ]
        return [sys.executable, "-c", "\n".join([*head, *self.lines])]

    def writes(self, place: str, text: str) -> None:
        self.lines += [
            f"path = base / {place!r}",
            "path.parent.mkdir(parents=True, exist_ok=True)",
            f"path.write_text({text!r})",
        ]

    def logs(self, events: str) -> None:
        self.writes("log/build_1/events.log", events)
        self.link_log("'build_1'")

    def link_log(self, name: str) -> None:
        self.lines += [
            "link = base / 'log/latest_build'",
            "link.unlink(missing_ok=True)",
            f"link.symlink_to({name})",
        ]


@pytest.fixture
def colcon(monkeypatch: pytest.MonkeyPatch) -> FakeColcon:
    return FakeColcon(monkeypatch)


OK_EVENTS = "[1.0] (face) JobEnded: {'identifier': 'face', 'rc': 0}\n"


def test_a_build_gives_units_and_what_was_missed(workspace: Path, colcon: FakeColcon) -> None:
    face = workspace / ".tpc/build/face"
    reply(
        face,
        [target("detector", "EXECUTABLE"), target("thin", "EXECUTABLE"), target("t", "EXECUTABLE")],
    )
    (face / "devel").mkdir()
    (face / "devel/detector").touch()
    (face / "devel/thin").touch()
    stale = face / "tpc/renamed.json"
    stale.parent.mkdir()
    stale.write_text("this target is no more, so its file is not read", encoding="utf-8")
    removed = workspace / ".tpc/build/gone/tpc/gone.json"
    removed.parent.mkdir(parents=True)
    removed.write_text("nor is that of a package that is no more", encoding="utf-8")
    colcon.lines.append("print('Starting >>> face'); print('Finished <<< face [1s]')")
    colcon.writes("build/face/tpc/detector.json", json.dumps(unit()))
    colcon.writes("build/arm/tpc/broken.json", json.dumps(failed_unit(package="arm")))
    colcon.logs(OK_EVENTS)
    said: list[str] = []
    result = build_workspace(workspace, on_output=said.append)
    assert said == ["Starting >>> face", "Finished <<< face [1s]"]
    assert [found.link_unit for found in result.units] == ["broken", "detector"]
    missing = LeftOut("face", "thin", "its package was configured without TPC")
    assert result.static.left_out == (missing,)
    assert [package.name for package in result.packages] == ["arm", "face"]
    assert not stale.exists()
    assert result.bases.install == workspace / ".tpc/install"
    saved = json.loads(result.bases.static_info.read_text(encoding="utf-8"))
    assert [found["link_unit"] for found in saved["units"]] == ["broken", "detector"]
    assert (workspace / ".tpc/.gitignore").read_text(encoding="utf-8") == "*\n"
    assert (workspace / ".tpc/build/arm/.cmake/api/v1/query/codemodel-v2").is_file()


class Changed:
    """Says that the units of ``arm`` have to be linked again."""

    def __init__(self, *, waits: bool = False) -> None:
        self.folders: list[str] = []
        self.waits = waits

    def at_once(self, folder: Path) -> bool:
        assert folder.name == "face"
        waited, self.waits = self.waits, False
        return waited

    def begin(self, folders: Sequence[Path]) -> None:
        self.folders = [folder.name for folder in folders]

    def link_again(self) -> Collection[str]:
        return ["arm"]


def test_what_uses_a_unit_that_changed_is_linked_again(workspace: Path, colcon: FakeColcon) -> None:
    """hand needs arm; face does not, and tail does and is not asked for."""
    for name in ("hand", "tail"):
        add_package(
            workspace / "src" / name,
            more="<depend>arm</depend>",
            cmakelists=f"project({name})".encode(),
        )
    between = Changed()
    build_workspace(workspace, between=between)
    assert sorted(between.folders) == ["arm", "face", "hand", "tail"]
    assert colcon.asked == [((), False), (("arm", "hand", "tail"), True)]
    colcon.asked.clear()
    build_workspace(workspace, BuildOptions(packages=["hand", "face"]), between=between)
    assert sorted(between.folders) == ["arm", "face", "hand"]
    assert colcon.asked == [(("hand", "face"), False), (("arm", "hand"), True)]
    colcon.asked.clear()
    own = BuildOptions(cmake_args=["-DCMAKE_TOOLCHAIN_FILE=own.cmake"])
    build_workspace(workspace, own, between=between)
    assert colcon.asked == [((), False)]


FIXED_PY = """import rospy
if __name__ == "__main__":
    rospy.init_node("fixed")
    if rospy.get_time() > 7:
        rospy.Publisher("late", object).publish()
"""


def test_python_nodes_are_analysed_behind_the_build(workspace: Path, colcon: FakeColcon) -> None:
    """A target and a script of one name; and a package that C++ left alone."""
    make_mixed(workspace)
    fixed = workspace / "src/face/fixed.py"
    fixed.write_text(FIXED_PY, encoding="utf-8")
    colcon.writes(
        "build/mission/tpc/mission.json", json.dumps(unit(package="mission", link_unit="mission"))
    )
    fails_with_tpc(colcon)
    told: list[tuple[int, int]] = []
    result = build_workspace(workspace, on_scripts=lambda done, total: told.append((done, total)))
    assert list(result.left_alone) == ["face"]
    assert [(found.package, found.link_unit) for found in result.units] == [
        ("camera", "node"),
        ("face", "fixed"),
        ("mission", "mission"),
        ("mission", "pump"),
        ("mission", "scripts/mission.py"),
    ]
    assert told == [(1, 4), (2, 4), (3, 4), (4, 4)]
    assert [found.link_unit for found in result.static.left_out] == ["scripts/broken.py"]
    assert StaticInfo.load(result.bases.static_info) == result.static
    constants = build_workspace(workspace, BuildOptions(packages=["face"], constants=True)).static
    assert len(constants.comparisons) == len(result.static.comparisons) + 1
    without = build_workspace(workspace, BuildOptions(python=False))
    assert [found.link_unit for found in without.units] == ["mission"]


def test_python_alone_needs_neither_a_compiler_nor_our_half_in_c(
    tmp_path: Path, colcon: FakeColcon, monkeypatch: pytest.MonkeyPatch
) -> None:
    workspace = make_mixed(tmp_path / "ws")
    shutil.rmtree(workspace / "src/mission")
    monkeypatch.setenv("TPC_PREFIX", str(tmp_path / "none"))
    asked: list[str] = []
    monkeypatch.setattr(build, "require_tools", asked.extend)
    colcon.logs(OK_EVENTS)
    assert [found.link_unit for found in build_workspace(workspace).units] == ["node"]
    assert asked == ["colcon"]


def test_broken_rules_for_python_end_a_build_before_it_begins(workspace: Path) -> None:
    rules = workspace / "python.json"
    rules.write_text('{"reeds": []}', encoding="utf-8")
    with pytest.raises(InputError, match=r"python\.json: /.*reeds"):
        build_workspace(workspace, BuildOptions(python_rules=rules))
    assert not (workspace / ".tpc").exists()


def test_the_profile_of_cmake_is_that_of_python(workspace: Path, colcon: FakeColcon) -> None:
    make_mixed(workspace)
    colcon.logs(OK_EVENTS)
    result = build_workspace(
        workspace, BuildOptions(colcon_args=["--cmake-args", "-DTPC_PROFILE=thesis"])
    )
    assert {found.tool.profile for found in result.units} == {"thesis"}


def test_the_sources_are_not_touched(workspace: Path, colcon: FakeColcon, tmp_path: Path) -> None:
    def sources() -> dict[Path, tuple[bytes, int]]:
        files = (path for path in (workspace / "src").rglob("*") if path.is_file())
        return {path: (path.read_bytes(), path.stat().st_mtime_ns) for path in files}

    before = sources()
    colcon.logs(OK_EVENTS)
    result = build_workspace(workspace, BuildOptions(bases=Bases(tmp_path / "own")))
    assert sources() == before
    assert sorted(path.name for path in workspace.iterdir()) == ["src"]
    assert result.bases.static_info == tmp_path / "own/static.json"


def test_a_package_that_fails_is_named_with_the_end_of_its_errors(
    workspace: Path, colcon: FakeColcon
) -> None:
    colcon.logs("[1.0] (face) JobEnded: {'identifier': 'face', 'rc': 2}\n")
    colcon.writes("log/build_1/face/stderr.log", "".join(f"error {n}\n" for n in range(100)))
    colcon.lines.append("sys.exit(1)")
    with pytest.raises(BuildError) as caught:
        build_workspace(workspace, BuildOptions(fallback=False))
    assert caught.value.package == "face"
    assert caught.value.tail == tuple(f"error {n}" for n in range(75, 100))
    log = workspace / ".tpc/log/build_1/face/stdout_stderr.log"
    assert str(caught.value).startswith(f"{log}: package face does not build (status 2)")
    assert not (workspace / ".tpc/static.json").exists()


def test_a_fault_of_colcon_is_not_blamed_on_a_package(workspace: Path, colcon: FakeColcon) -> None:
    colcon.logs("[0.1] (face) JobEnded: {'identifier': 'face', 'rc': 1}\n")
    log = (
        "[0.9s] ERROR:colcon.colcon_core.entry_point:cannot import name 'X' from 'em'\nTraceback\n"
    )
    colcon.writes("log/build_1/logger_all.log", f"[0.1s] INFO:colcon:begins\n{log}")
    colcon.lines.append("sys.exit(1)")
    with pytest.raises(RunError) as caught:
        build_workspace(workspace)
    path = workspace / ".tpc/log/build_1/logger_all.log"
    assert str(caught.value) == f"{path}: colcon itself fails: cannot import name 'X' from 'em'"


def test_a_failure_of_colcon_itself_is_not_blamed_on_an_old_log(
    workspace: Path, colcon: FakeColcon
) -> None:
    old = workspace / ".tpc/log/build_0"
    old.mkdir(parents=True)
    (old / "events.log").write_text("[1.0] (a) JobEnded: {'identifier': 'a', 'rc': 2}\n")
    (workspace / ".tpc/log/latest_build").symlink_to("build_0")
    colcon.lines.append("sys.exit('colcon: error: unrecognized arguments: --bogus\\n')")
    with pytest.raises(RunError) as caught:
        build_workspace(workspace)
    assert str(caught.value) == (
        "colcon ends with status 1: colcon: error: unrecognized arguments: --bogus"
    )


def test_broken_static_information_is_named(workspace: Path, colcon: FakeColcon) -> None:
    bad = json.dumps(unit(comparisons=[comparison(distance=0)]))
    colcon.writes("build/face/tpc/detector.json", bad)
    colcon.logs(OK_EVENTS)
    with pytest.raises(InputError) as caught:
        build_workspace(workspace)
    path = workspace / ".tpc/build/face/tpc/detector.json"
    assert str(caught.value).startswith(f"{path}: /comparisons/0/distance: ")


def test_an_interrupt_ends_everything_below(workspace: Path, colcon: FakeColcon) -> None:
    colcon.lines += [
        "import subprocess",
        "child = subprocess.Popen(['/bin/sleep', '60'])",
        "print(child.pid, flush=True)",
        "child.wait()",
    ]
    started: list[int] = []

    def interrupt(line: str) -> None:
        started.append(int(line))
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        build_workspace(workspace, on_output=interrupt)
    deadline = time.monotonic() + 5
    while Path(f"/proc/{started[0]}").exists() and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not Path(f"/proc/{started[0]}").exists()


def refuse(message: str) -> None:
    raise MissingToolError(message)


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        ("src/face/CMakeLists.txt", "CMake cannot parse this file"),
        ("src/face/package.xml", "not XML"),
        ("../prefix/lib/libtpc_log.so", "make setup"),
        ("../prefix/lib/tpc/TpcPasses.so", "make setup"),
        ("require_tools", "no clang"),
        ("require_ros", "no ROS"),
    ],
)
def test_what_cannot_work_is_said_before_anything_is_written(
    workspace: Path, monkeypatch: pytest.MonkeyPatch, damage: str, message: str
) -> None:
    if damage.startswith("require"):
        monkeypatch.setattr(build, damage, lambda: refuse(message))
    elif damage.startswith("src"):
        (workspace / damage).write_text("<package(", encoding="utf-8")
    else:
        (workspace / damage).unlink()
    with pytest.raises(TpcError, match=message):
        build_workspace(workspace)
    assert sorted(path.name for path in workspace.iterdir()) == ["src"]


def test_ros_is_not_needed_for_plain_cmake(
    workspace: Path, colcon: FakeColcon, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("arm", "face"):
        cmake = "<export><build_type>cmake</build_type></export>"
        add_package(workspace / "src" / name, more=cmake)
    monkeypatch.setattr(build, "require_ros", lambda: pytest.fail("looked for ROS"))
    colcon.logs(OK_EVENTS)
    assert build_workspace(workspace).units == ()


def test_a_file_where_the_base_should_be_is_one_line(workspace: Path, colcon: FakeColcon) -> None:
    (workspace / ".tpc").write_text("", encoding="utf-8")
    with pytest.raises(WorkspaceError) as caught:
        build_workspace(workspace)
    assert str(caught.value) == f"{workspace}/.tpc: cannot be written: Not a directory"


def test_the_nodes_environment_is_that_of_a_fresh_login(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_PACKAGE_PATH", "/the/callers/own")
    monkeypatch.setenv("PYTHONPATH", "/the/callers/own")
    monkeypatch.setenv("HOME", "/home/me")
    (tmp_path / "setup.bash").write_text(
        "echo chatter\nexport ROS_PACKAGE_PATH=/here/share:$ROS_PACKAGE_PATH\n"
        "export TWO_LINES=$'a=b\\nc'\nnot_exported=1\n",
        encoding="utf-8",
    )
    assert workspace_env(tmp_path) == {
        "HOME": "/home/me",
        "PATH": "/usr/bin:/bin",
        "ROS_PACKAGE_PATH": "/here/share:",
        "TWO_LINES": "a=b\nc",
        **{name: os.environ[name] for name in KEPT if name in os.environ},
    }


KEPT = ("USER", "LOGNAME", "LANG", "LC_ALL", "TERM", "TZ", "TMPDIR")


def test_an_install_base_that_is_none_or_fails_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(WorkspaceError, match=r"no setup.bash here; build the workspace first"):
        workspace_env(tmp_path)
    (tmp_path / "setup.bash").write_text("echo broken >&2\nreturn 3\n", encoding="utf-8")
    with pytest.raises(RunError) as caught:
        workspace_env(tmp_path)
    assert str(caught.value) == f"{tmp_path}/setup.bash: fails with status 3: broken"


# A Ctrl-C reaches all processes of the terminal's session. The 6th field of stat is the session.
def test_a_set_up_script_is_out_of_reach_of_ctrl_c(tmp_path: Path) -> None:
    text = "export OWN=$$ SESSION=$(cut -d ' ' -f 6 /proc/$$/stat)\n"
    (tmp_path / "setup.bash").write_text(text, encoding="utf-8")
    env = workspace_env(tmp_path)
    assert env["SESSION"] == env["OWN"]


def test_a_set_up_script_that_does_not_end(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.setattr(build, "_SET_UP_S", 0.5)
    (tmp_path / "setup.bash").write_text("exec sleep 600\n", encoding="utf-8")
    with pytest.raises(RunError, match=r"setup\.bash: does not end within"):
        workspace_env(tmp_path)


def fails_with_tpc(colcon: FakeColcon, *, without: str = "0") -> None:
    """Package face fails unless it is left alone; then it ends with the status ``without``."""
    colcon.lines += [
        "alone = next(one for one in cmake_args if one.startswith('-DTPC_LEFT_ALONE='))",
        f"status = {without!r} if alone.endswith('/src/face') else '2'",
        "name = f'build_{status}'",
        "(base / 'log' / name / 'face').mkdir(parents=True, exist_ok=True)",
        "ended = f\"[1.0] (face) JobEnded: {{'identifier': 'face', 'rc': {status}}}\\n\"",
        "(base / 'log' / name / 'events.log').write_text(ended)",
        "(base / 'log' / name / 'face/stderr.log').write_text(f'error: {status}\\nstop\\n')",
        "(base / 'build/face').mkdir(parents=True, exist_ok=True)",
        "(base / 'build/face/made').write_text(status)",
    ]
    colcon.link_log("name")
    colcon.lines.append("sys.exit(status != '0')")


def test_code_that_must_be_optimised_to_link_waits_for_no_process(
    workspace: Path, colcon: FakeColcon
) -> None:
    """The first link, which does not optimise, fails; so it is tried with the analysis."""
    tries = workspace / "tries"
    colcon.lines += [
        f"tries = Path({str(tries)!r})",
        "status = 0 if tries.exists() else 2",
        "tries.touch()",
        "(base / f'log/build_{status}/face').mkdir(parents=True, exist_ok=True)",
        "ended = f\"[1.0] (face) JobEnded: {{'identifier': 'face', 'rc': {status}}}\\n\"",
        "(base / f'log/build_{status}/events.log').write_text(ended)",
        "said = 'ld.lld: error: undefined symbol: once' if status else ''",
        "(base / f'log/build_{status}/face/stderr.log').write_text(said)",
    ]
    colcon.link_log("f'build_{status}'")
    colcon.lines.append("sys.exit(status)")
    between = Changed(waits=True)
    between.link_again = lambda: []  # type: ignore[method-assign]
    assert build_workspace(workspace, between=between).left_alone == {}
    assert colcon.asked == [((), False), ((), False)]


def test_a_package_that_builds_only_without_tpc_is_left_alone(
    workspace: Path, colcon: FakeColcon
) -> None:
    fails_with_tpc(colcon)
    result = build_workspace(workspace)
    assert result.left_alone == {"face": "error: 2"}
    # The folder with the other compiler is gone, and stays away.
    assert (workspace / ".tpc/build/face/made").read_text() == "0"
    assert not [*(workspace / ".tpc/set-aside").glob("*")]
    assert build_workspace(workspace).left_alone == {"face": "error: 2"}


def test_a_package_that_does_not_build_at_all_keeps_its_folder(
    workspace: Path, colcon: FakeColcon
) -> None:
    fails_with_tpc(colcon, without="3")
    with pytest.raises(BuildError) as caught:
        build_workspace(workspace)
    assert (caught.value.package, caught.value.tail[0]) == ("face", "error: 3")
    assert (workspace / ".tpc/build/face/made").read_text() == "2"
    assert not (workspace / ".tpc/left-alone.json").exists()


def test_another_try_begins_without_the_old_folder(workspace: Path, colcon: FakeColcon) -> None:
    fails_with_tpc(colcon)
    build_workspace(workspace)
    colcon.lines = ["assert not (base / 'build/face/made').exists()"]
    assert build_workspace(workspace, BuildOptions(retry=True)).left_alone == {}
    assert not (workspace / ".tpc/left-alone.json").exists()


def test_a_try_that_was_interrupted_is_undone(workspace: Path, colcon: FakeColcon) -> None:
    aside = workspace / ".tpc/set-aside/face"
    aside.mkdir(parents=True)
    (aside / "made").write_text("with TPC")
    (workspace / ".tpc/build/face").mkdir(parents=True)
    colcon.lines.append("assert (base / 'build/face/made').read_text() == 'with TPC'")
    assert build_workspace(workspace).left_alone == {}


@pytest.mark.parametrize("text", ["[]", '{"face": 1}'])
def test_a_broken_list_of_packages_left_alone_is_named(
    workspace: Path, colcon: FakeColcon, text: str
) -> None:
    (workspace / ".tpc").mkdir()
    (workspace / ".tpc/left-alone.json").write_text(text)
    with pytest.raises(InputError, match=r"left-alone\.json: not a list of packages"):
        build_workspace(workspace)


def test_a_path_with_dots_is_left_alone_by_the_name_that_cmake_gives_it(
    workspace: Path, colcon: FakeColcon
) -> None:
    fails_with_tpc(colcon)
    (workspace / "src/deep").mkdir()
    colcon.lines[0:0] = ["assert not [one for one in cmake_args if '..' in one], cmake_args"]
    result = build_workspace(workspace / "src/deep/../..")
    assert result.left_alone == {"face": "error: 2"}
    assert result.bases.root == workspace / ".tpc"


def test_the_reason_says_what_clang_lacks(tmp_path: Path) -> None:
    tail = (
        "CMake Error at /usr/share/Modules/FindPackageHandleStandardArgs.cmake:230 (message):",
        "  Could NOT find OpenMP_CXX (missing: OpenMP_CXX_FLAGS OpenMP_CXX_LIB_NAMES)",
        "Call Stack (most recent call first):",
    )
    alone = LeftAlone(Bases(tmp_path), [Package("face", tmp_path / "face", "cmake")])
    (tmp_path / "build/face").mkdir(parents=True)
    alone.begin(BuildError("does not build", tmp_path / "log", "face", tail))
    why = alone.reasons["face"]
    assert "Could NOT find OpenMP_CXX" in why
    assert why.endswith("apt-get install libomp-19-dev")


def test_two_builds_at_once_are_one_line(workspace: Path, colcon: FakeColcon) -> None:
    own = workspace / ".tpc"
    own.mkdir()
    descriptor = os.open(own, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        with pytest.raises(WorkspaceError, match="another pytpc build is running"):
            build_workspace(workspace)
    finally:
        os.close(descriptor)
    build_workspace(workspace)


def test_a_signal_to_end_ends_everything_below(workspace: Path, colcon: FakeColcon) -> None:
    colcon.writes("pid", "")
    colcon.lines += [
        "(base / 'pid').write_text(str(os.getpid()))",
        "print('begun', flush=True)",
        "time.sleep(60)",
    ]

    def end(line: str) -> None:
        if line == "begun":
            os.kill(os.getpid(), signal.SIGTERM)

    before = signal.getsignal(signal.SIGTERM)
    signal.signal(signal.SIGTERM, lambda *_: None)
    try:
        with pytest.raises(SystemExit) as caught:
            build_workspace(workspace, on_output=end)
    finally:
        signal.signal(signal.SIGTERM, before)
    assert caught.value.code == 128 + signal.SIGTERM
    pid = int((workspace / ".tpc/pid").read_text())
    with pytest.raises(ProcessLookupError):
        os.kill(pid, 0)


def test_what_colcon_says_before_the_first_package_is_shown(
    workspace: Path, colcon: FakeColcon
) -> None:
    colcon.writes("log/build_1/logger_all.log", "")
    colcon.link_log("'build_1'")
    colcon.lines.append("sys.exit('the install layout is merged')")
    with pytest.raises(RunError, match="colcon ends with status 1: the install layout is merged"):
        build_workspace(workspace)


def test_a_full_disk_is_no_fault_of_the_package(
    workspace: Path, colcon: FakeColcon, monkeypatch: pytest.MonkeyPatch
) -> None:
    fails_with_tpc(colcon)
    full = SimpleNamespace(total=1, used=1, free=0)
    monkeypatch.setattr(shutil, "disk_usage", lambda _path: full)
    with pytest.raises(RunError, match="the disk is full"):
        build_workspace(workspace)
    assert not (workspace / ".tpc/left-alone.json").exists()


def test_packages_that_need_one_another_are_named_before_anything_is_written(
    workspace: Path,
) -> None:
    for name, other in (("arm", "face"), ("face", "arm")):
        kind = "build_depend" if name == "arm" else "exec_depend"
        add_package(workspace / "src" / name, more=f"<{kind}>{other}</{kind}>")
    with pytest.raises(WorkspaceError) as caught:
        build_workspace(workspace)
    assert str(caught.value) == f"{workspace}: circular dependency: arm -> face -> arm"
    assert sorted(path.name for path in workspace.iterdir()) == ["src"]
