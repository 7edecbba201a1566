"""Patching what is not as it should be: files, folders, disks, and other patches."""

import os
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from packages import add_package, contents, install_prefix, make_workspace

from pytpc.base.errors import InputError, WorkspaceError
from pytpc.workspace import patch
from pytpc.workspace.patch import apply_changes, plan, plan_tree

ROOT = Path(__file__).resolve().parents[2]
HEAD = b"# >>> tpc >>>"
NOBODY = 65534


@pytest.fixture(autouse=True)
def prefix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An installed C++ half, as far as patching looks."""
    monkeypatch.setenv("TPC_PREFIX", str(tmp_path / "prefix"))
    return install_prefix(tmp_path / "prefix")


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    return make_workspace(tmp_path / "ws")


def run_script(*arguments: str | Path, user: int | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        ["/usr/bin/python3", ROOT / "modify_cmakelists.py", *arguments],
        env={"TPC_PREFIX": os.environ["TPC_PREFIX"], "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
        user=user,
        timeout=60,
        check=False,
    )


# --- files


@pytest.mark.parametrize(
    "text", [b"", b"include(common.cmake)\n", b"# project(arm)\n", b'set(X "\nproject(arm)\n")\n']
)
def test_a_package_without_project_is_refused(workspace: Path, text: bytes) -> None:
    path = workspace / "src/arm/CMakeLists.txt"
    path.write_bytes(text)
    before = contents(workspace)
    for any_tree in (False, True):
        with pytest.raises(InputError) as caught:
            patch.run(workspace, any_tree=any_tree)
        assert str(caught.value) == (
            f"{path}: does not call project() itself, as CMake wants it of a package's file; add"
            " project(NAME) behind cmake_minimum_required()"
        )
    assert contents(workspace) == before


@pytest.mark.parametrize("text", [b"PROJECT(arm)\n", b"if(TRUE)\n Project (\n arm\n )\nendif()\n"])
def test_project_may_be_written_in_any_way(workspace: Path, text: bytes) -> None:
    (workspace / "src/arm/CMakeLists.txt").write_bytes(text)
    assert len(plan(workspace)[0]) == 2


def test_a_file_that_lost_its_project_is_restored(workspace: Path) -> None:
    patch.run(workspace)
    path = workspace / "src/arm/CMakeLists.txt"
    path.write_bytes(path.read_bytes().replace(b"project(arm)", b""))
    patch.run(workspace, restore=True)
    assert path.read_bytes() == b"\r\n"


def test_a_read_only_file_is_patched_and_stays_read_only(workspace: Path) -> None:
    path = workspace / "src/arm/CMakeLists.txt"
    path.chmod(0o444)
    patch.run(workspace)
    assert path.read_bytes().startswith(HEAD)
    assert stat.S_IMODE(path.stat().st_mode) == 0o444
    patch.run(workspace, restore=True)
    assert path.read_bytes() == b"project(arm)\r\n"
    assert stat.S_IMODE(path.stat().st_mode) == 0o444


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can become somebody else")
def test_a_read_only_folder_is_one_line_and_nothing_lost(monkeypatch: pytest.MonkeyPatch) -> None:
    with tempfile.TemporaryDirectory() as name:
        workspace = make_workspace(Path(name) / "ws")
        Path(name).chmod(0o755)
        for path in workspace.rglob("*"):
            os.chown(path, NOBODY, NOBODY)
        (workspace / "src/face").chmod(0o555)
        before = contents(workspace)
        prefix = Path(name) / "prefix"
        install_prefix(prefix)
        monkeypatch.setenv("TPC_PREFIX", str(prefix))
        ran = run_script(workspace, user=NOBODY)
        assert (ran.returncode, ran.stdout) == (1, "")
        assert ran.stderr == (
            f"pytpc: error: {workspace}/src/face/CMakeLists.txt: cannot be written:"
            " Permission denied; no file was changed\n"
        )
        assert contents(workspace) == before


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system of 64 KiB of its own."""
    folder = tmp_path / "disk"
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=64k", "tpc-test", folder]
    if shutil.which("mount") is None or os.geteuid() != 0:
        pytest.skip("only root can mount a disk")
    mounted = subprocess.run(command, capture_output=True, text=True, check=False)
    if mounted.returncode != 0:
        pytest.skip(f"nothing can be mounted here: {mounted.stderr.strip()}")
    yield folder
    subprocess.run(["umount", folder], check=True)


def test_a_full_disk_loses_nothing(small_disk: Path) -> None:
    workspace = make_workspace(small_disk / "ws")
    with (small_disk / "filler").open("wb", buffering=0) as stream:
        try:
            while True:
                stream.write(bytes(512))
        except OSError:
            pass
    before = contents(workspace)
    with pytest.raises(WorkspaceError, match="No space left on device; no file was changed"):
        patch.run(workspace)
    assert contents(workspace) == before
    # Room for one of the two files that have to be written beside the old ones.
    os.truncate(small_disk / "filler", (small_disk / "filler").stat().st_size - 4096)
    with pytest.raises(WorkspaceError, match="No space left on device; no file was changed"):
        patch.run(workspace)
    assert contents(workspace) == before
    (small_disk / "filler").unlink()
    patch.run(workspace)
    patch.run(workspace, restore=True)
    assert contents(workspace) == before


# --- other hands


def test_a_file_that_changed_since_it_was_read_is_not_overwritten(workspace: Path) -> None:
    changes, _ = plan(workspace)
    face = workspace / "src/face/CMakeLists.txt"
    face.write_bytes(b"project(face)\nadd_library(new)\n")
    before = contents(workspace)
    with pytest.raises(WorkspaceError, match="changed meanwhile; no file was written") as caught:
        apply_changes(changes)
    assert caught.value.path == str(face)
    assert contents(workspace) == before


def test_what_cannot_be_put_back_is_said(workspace: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    changes, _ = plan(workspace)
    replace = Path.replace
    calls = 0

    def failing(self: Path, target: Path) -> Path:
        nonlocal calls
        calls += 1
        if calls > 1:
            raise OSError(5, "Input/output error")
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", failing)
    with pytest.raises(WorkspaceError) as caught:
        apply_changes(changes)
    arm = workspace / "src/arm/CMakeLists.txt"
    assert caught.value.message == f"cannot be written: Input/output error; still changed: {arm}"


def test_two_patches_and_a_restore_at_once(workspace: Path) -> None:
    for number in range(20):
        add_package(workspace / f"src/more{number:02}", cmakelists=b"project(more)\n")
    before = contents(workspace)
    command = ["/usr/bin/python3", str(ROOT / "modify_cmakelists.py"), str(workspace)]
    for last in ([], ["--restore"]):
        together = [
            subprocess.Popen([*command, *options], stdout=subprocess.DEVNULL)
            for options in ([], ["--restore"], [], ["--restore"])
        ]
        assert [process.wait(60) for process in together] == [0, 0, 0, 0]
        subprocess.run([*command, *last], stdout=subprocess.DEVNULL, check=True)
        lists = list(workspace.rglob("CMakeLists.txt"))
        patched = [path.read_bytes().startswith(HEAD) for path in lists]
        assert patched == [not last] * 22
    assert contents(workspace) == before


KILLED = """
import os, sys, time
from pathlib import Path
from pytpc.workspace import patch
replace = Path.replace
def slow(self, target):
    done = replace(self, target)
    print("replaced", flush=True)
    time.sleep(60)
    return done
Path.replace = slow
patch.run(Path(sys.argv[1]))
"""


def test_after_a_kill_between_two_files_the_next_run_does_the_rest(workspace: Path) -> None:
    before = contents(workspace)
    with subprocess.Popen(
        [sys.executable, "-c", KILLED, str(workspace)],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdout is not None
        assert process.stdout.readline() == "replaced\n"
        process.send_signal(signal.SIGKILL)
    left = [name for name in contents(workspace) if name not in before]
    assert len(left) == 1
    assert left[0].startswith("src/face/.CMakeLists.txt.tpc-")
    changes, unchanged = plan(workspace)
    assert ([change.path.parent.name for change in changes], unchanged) == (["face"], 1)
    patch.run(workspace)
    assert contents(workspace).keys() == before.keys()
    patch.run(workspace, restore=True)
    assert contents(workspace) == before


def test_a_restore_after_a_kill_removes_what_was_left(workspace: Path) -> None:
    before = contents(workspace)
    # What a process that was killed before its first rename leaves.
    (workspace / "src/arm/.CMakeLists.txt.tpc-0123abcd").write_bytes(b"half")
    (workspace / "src/arm/.CMakeLists.txt.tpc-mine").write_bytes(b"somebody's")
    patch.run(workspace, restore=True)
    assert contents(workspace) == {**before, "src/arm/.CMakeLists.txt.tpc-mine": b"somebody's"}


# --- any tree, for the script of the thesis


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """Projects without package.xml, subdirectories, a build folder, and catkin_make's toplevel."""
    folder = tmp_path / "tree"
    toplevel = tmp_path / "opt/toplevel.cmake"
    toplevel.parent.mkdir()
    toplevel.write_bytes(b"project(Project)\n")
    files = {
        "one/CMakeLists.txt": b"project(one)\nadd_subdirectory(sub)\n",
        "one/sub/CMakeLists.txt": b"add_library(sub x.cpp)\n",
        "two/deep/CMakeLists.txt": b"\xef\xbb\xbfPROJECT(two)\r\n",
        "build/CMakeCache.txt": b"",
        "build/generated/CMakeLists.txt": b"project(generated)\n",
        ".hidden/CMakeLists.txt": b"project(hidden)\n",
        "build_tpc/.built_by": b"catkin build",
        "build_tpc/prebuild/CMakeLists.txt": b"project(prebuild)\n",
        "ignored/COLCON_IGNORE": b"",
        "ignored/CMakeLists.txt": b"project(ignored)\n",
    }
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(text)
    (folder / "CMakeLists.txt").symlink_to(toplevel)
    add_package(folder / "three", cmakelists=b"project(three)\n")
    return folder


def test_each_file_with_project_is_patched_and_restored(tree: Path) -> None:
    before = contents(tree)
    ran = run_script(tree)
    assert (ran.returncode, ran.stderr) == (0, "")
    assert ran.stdout.splitlines() == [
        f"patched {tree}/one/CMakeLists.txt",
        f"patched {tree}/three/CMakeLists.txt",
        f"patched {tree}/two/deep/CMakeLists.txt",
        f"left alone {tree}/CMakeLists.txt, a link to {tree.parent}/opt/toplevel.cmake",
        "3 patched",
    ]
    after = contents(tree)
    changed = [name for name in after if after[name] != before[name]]
    assert changed == ["one/CMakeLists.txt", "three/CMakeLists.txt", "two/deep/CMakeLists.txt"]
    assert run_script(tree).stdout.splitlines()[-1] == "0 patched, 3 already with the block"
    assert run_script(tree, "--restore").stdout.splitlines()[-1] == "3 restored"
    assert contents(tree) == before


def test_a_broken_project_stops_all(tree: Path) -> None:
    path = tree / "two/deep/CMakeLists.txt"
    path.write_bytes(b"project(two)\nif(X\n")
    before = contents(tree)
    ran = run_script(tree)
    assert (ran.returncode, ran.stdout) == (1, "")
    assert ran.stderr.startswith(f"pytpc: error: {path}:2: CMake cannot parse this file: ")
    assert contents(tree) == before


def test_a_tree_without_projects_is_an_error_for_patching_alone(tmp_path: Path) -> None:
    folder = tmp_path / "none"
    folder.mkdir()
    with pytest.raises(WorkspaceError, match=r"no CMakeLists.txt with project\(\) in this folder"):
        plan_tree(folder)
    assert plan_tree(folder, restore=True) == ([], 0, [])
    with pytest.raises(WorkspaceError, match="no such folder"):
        plan_tree(tmp_path / "nowhere")


def test_the_toplevel_file_of_catkin_make_is_no_packages(workspace: Path, tmp_path: Path) -> None:
    toplevel = tmp_path / "toplevel.cmake"
    toplevel.write_bytes(b"project(Project)\n")
    (workspace / "src/CMakeLists.txt").symlink_to(toplevel)
    patch.run(workspace)
    assert toplevel.read_bytes() == b"project(Project)\n"
    assert (workspace / "src/CMakeLists.txt").is_symlink()
