"""The block in a CMakeLists.txt, and patching a workspace with it."""

import os
import shutil
import stat
import subprocess
from pathlib import Path

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from packages import add_package, contents, install_prefix, make_workspace

from pytpc.base.errors import InputError, MissingToolError, WorkspaceError
from pytpc.workspace import patch
from pytpc.workspace.cmake_block import patch_text, restore_text
from pytpc.workspace.patch import ListFileChange, apply_changes, diff, plan

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / "modify_cmakelists.py"
BOM = b"\xef\xbb\xbf"
FILE = "/opt/tpc/share/tpc/cmake/tpc.cmake"
FIRST = (
    b"# >>> tpc >>> These three lines are TPC's; `pytpc patch --restore WORKSPACE` removes them."
)
LF_BLOCK = FIRST + b'\ninclude("' + FILE.encode() + b'" OPTIONAL)\n# <<< tpc <<<\n'
CRLF_BLOCK = FIRST + b'\r\ninclude("' + FILE.encode() + b'" OPTIONAL)\r\n# <<< tpc <<<\r\n'

CASES = [
    (b"", LF_BLOCK),
    (b"project(x)", LF_BLOCK + b"project(x)"),
    (b"project(x)\n", LF_BLOCK + b"project(x)\n"),
    (b"\n\nproject(x)\n", LF_BLOCK + b"\n\nproject(x)\n"),
    (b"project(x)\r\na()\r\n", CRLF_BLOCK + b"project(x)\r\na()\r\n"),
    (b"project(x)\r\na()\n", CRLF_BLOCK + b"project(x)\r\na()\n"),
    (b"project(x)\na()\r\n", LF_BLOCK + b"project(x)\na()\r\n"),
    (b"\r\nproject(x)\n", CRLF_BLOCK + b"\r\nproject(x)\n"),
    (BOM, BOM + LF_BLOCK),
    (BOM + b"project(x)\r\n", BOM + CRLF_BLOCK + b"project(x)\r\n"),
    (b"# caf\xe9\nproject(x)\n", LF_BLOCK + b"# caf\xe9\nproject(x)\n"),
    (b"\xff\xfe\x00\n\x00", LF_BLOCK + b"\xff\xfe\x00\n\x00"),
]


@pytest.mark.parametrize(("before", "after"), CASES)
def test_the_block_comes_first_in_the_files_own_line_ending(before: bytes, after: bytes) -> None:
    assert patch_text(before, FILE) == after
    assert patch_text(after, FILE) == after
    assert restore_text(after) == before
    assert restore_text(before) == before


ANY_TEXT = st.binary(max_size=80) | st.lists(
    st.sampled_from([BOM, b"\n", b"\r", b"\r\n", b"#", b"tpc", b">>>", b"project(x)", b'"'])
).map(b"".join)


@settings(database=None)
@given(data=ANY_TEXT, name=st.text(st.characters(exclude_characters="\0", exclude_categories="C")))
def test_restoring_gives_the_same_bytes_back(data: bytes, name: str) -> None:
    assume(b"tpc >>>" not in data and b"tpc <<<" not in data)
    patched = patch_text(data, "/" + name)
    assert patched != data
    assert patch_text(patched, "/" + name) == patched
    assert restore_text(patched) == data
    assert restore_text(patch_text(patched, FILE)) == data


def test_a_block_with_another_path_is_brought_up_to_date() -> None:
    old = patch_text(BOM + b"a()\r\n", "/old/place/tpc.cmake")
    assert patch_text(old, FILE) == BOM + CRLF_BLOCK + b"a()\r\n"


EDITED = [
    (LF_BLOCK.replace(b" OPTIONAL", b""), 1),
    (LF_BLOCK.replace(b"# <<< tpc <<<\n", b""), 1),
    (b"a()\nb()\n# <<< tpc <<<\n", 3),
    (b"\n# <<< tpc <<<\n", 2),
    (b"a()\n" + LF_BLOCK.replace(b"# <<<", b"set(X 1)\n# <<<"), 2),
    (LF_BLOCK + LF_BLOCK, 4),
    (LF_BLOCK + b"a()\n\n" + CRLF_BLOCK, 6),
    (CRLF_BLOCK.replace(b"OPTIONAL)\r\n", b"OPTIONAL)\n"), 1),
    (LF_BLOCK.replace(b"removes", b"takes out"), 1),
    (BOM + b"  # >>> tpc >>>\n" + LF_BLOCK, 1),
]


@pytest.mark.parametrize(("data", "line"), EDITED)
def test_an_edited_block_is_refused_with_its_line(data: bytes, line: int) -> None:
    for attempt in (lambda: patch_text(data, FILE), lambda: restore_text(data)):
        with pytest.raises(WorkspaceError, match="edited by hand") as caught:
            attempt()
        assert caught.value.line == line


def test_a_block_that_was_moved_is_restored_but_not_patched() -> None:
    moved = b"# Copyright\n\n" + LF_BLOCK + b"a()\n"
    assert restore_text(moved) == b"# Copyright\n\na()\n"
    with pytest.raises(WorkspaceError, match="must come first") as caught:
        patch_text(moved, FILE)
    assert caught.value.line == 3


@pytest.mark.skipif(shutil.which("cmake") is None, reason="cmake is not installed")
@pytest.mark.parametrize("folder", ["plain", 'a "b" c', "$ENV{HOME} ${x}", "@PROJECT_NAME@ (;#"])
def test_cmake_includes_what_the_block_names(tmp_path: Path, folder: str) -> None:
    included = tmp_path / folder / "tpc.cmake"
    included.parent.mkdir()
    included.write_text('message(NOTICE "included")\n', encoding="utf-8")
    package = tmp_path / "package"
    package.mkdir()
    text = b"cmake_minimum_required(VERSION 3.0)\nproject(x NONE)\n"
    (package / "CMakeLists.txt").write_bytes(patch_text(text, str(included)))
    command = ["cmake", "-S", package, "-B", tmp_path / "build"]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
    assert ran.stderr.splitlines()[0] == "included"


@pytest.fixture
def prefix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An installed C++ half, as far as patching looks."""
    monkeypatch.setenv("TPC_PREFIX", str(tmp_path / "prefix"))
    return install_prefix(tmp_path / "prefix")


@pytest.fixture
def workspace(tmp_path: Path) -> Path:
    return make_workspace(tmp_path / "ws")


def test_a_workspace_is_patched_and_restored(workspace: Path, prefix: Path) -> None:
    before = contents(workspace)
    changes, unchanged = plan(workspace)
    assert [change.path.parent.name for change in changes] == ["arm", "face"]
    assert unchanged == 0
    apply_changes(changes)
    patched = contents(workspace)
    assert patched.keys() == before.keys()
    include = b'include("' + os.fsencode(prefix) + b'" OPTIONAL)'
    assert patched["src/arm/CMakeLists.txt"].split(b"\r\n")[1] == include
    assert patched["src/face/CMakeLists.txt"].split(b"\n")[1] == include
    assert plan(workspace) == ([], 2)
    changes, _ = plan(workspace, restore=True)
    apply_changes(changes)
    assert contents(workspace) == before


def test_only_the_named_package_is_changed(workspace: Path, prefix: Path) -> None:
    changes, _ = plan(workspace, packages=["face"])
    assert [change.path for change in changes] == [workspace / "src/face/CMakeLists.txt"]
    with pytest.raises(WorkspaceError, match="no package fac in this workspace; did you mean face"):
        plan(workspace, packages=["fac"])


def test_one_broken_file_stops_all(workspace: Path, prefix: Path) -> None:
    text = b"project(zoo)\nadd_library(zoo\n"
    broken = add_package(workspace / "src/zoo", cmakelists=text) / "CMakeLists.txt"
    before = contents(workspace)
    with pytest.raises(InputError) as caught:
        patch.run(workspace)
    assert str(caught.value) == (
        f'{broken}:2: CMake cannot parse this file: the "(" of add_library is never closed'
    )
    assert contents(workspace) == before


def test_one_edited_block_stops_all(workspace: Path, prefix: Path) -> None:
    text = b"project(zoo)\n# <<< tpc <<<\n"
    edited = add_package(workspace / "src/zoo", cmakelists=text) / "CMakeLists.txt"
    before = contents(workspace)
    for restore in (False, True):
        with pytest.raises(WorkspaceError) as caught:
            patch.run(workspace, restore=restore)
        assert str(caught.value).startswith(f"{edited}:2: TPC's block was edited by hand")
    assert contents(workspace) == before


def test_a_file_that_broke_after_patching_is_restored(workspace: Path, prefix: Path) -> None:
    patch.run(workspace)
    path = workspace / "src/face/CMakeLists.txt"
    path.write_bytes(path.read_bytes() + b"\nif(")
    patch.run(workspace, restore=True)
    assert path.read_bytes() == b"project(face)\nif("


def test_mode_and_symbolic_links_stay(workspace: Path, prefix: Path, tmp_path: Path) -> None:
    real = tmp_path / "elsewhere.txt"
    real.write_bytes(b"project(shared)\n")
    real.chmod(0o640)
    for name in ("arm", "face"):
        link = workspace / "src" / name / "CMakeLists.txt"
        link.unlink()
        link.symlink_to(real)
    changes, _ = plan(workspace)
    assert len(changes) == 1
    apply_changes(changes)
    assert (workspace / "src/arm/CMakeLists.txt").is_symlink()
    assert real.read_bytes().endswith(b"\n# <<< tpc <<<\nproject(shared)\n")
    assert stat.S_IMODE(real.stat().st_mode) == 0o640
    assert plan(workspace) == ([], 1)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a file away")
def test_the_owner_stays_when_root_patches(workspace: Path, prefix: Path) -> None:
    path = workspace / "src/arm/CMakeLists.txt"
    os.chown(path, 12345, 54321)
    patch.run(workspace)
    assert (path.stat().st_uid, path.stat().st_gid) == (12345, 54321)


def test_a_mode_that_cannot_be_set_leaves_every_file_as_it_was(
    workspace: Path, prefix: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = contents(workspace)

    def failing(_path: Path, _mode: int) -> None:
        raise PermissionError(1, "Operation not permitted")

    monkeypatch.setattr(Path, "chmod", failing)
    with pytest.raises(WorkspaceError, match="Operation not permitted; no file was changed"):
        patch.run(workspace)
    assert contents(workspace) == before


@pytest.mark.parametrize("fails_at", [1, 2])
def test_a_failing_rename_leaves_every_file_as_it_was(
    workspace: Path, prefix: Path, monkeypatch: pytest.MonkeyPatch, fails_at: int
) -> None:
    before = contents(workspace)
    changes, _ = plan(workspace)
    replace = Path.replace
    calls = 0

    def failing(self: Path, target: Path) -> Path:
        nonlocal calls
        calls += 1
        if calls == fails_at:
            raise OSError(5, "Input/output error")
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", failing)
    with pytest.raises(WorkspaceError, match="Input/output error; no file was changed") as caught:
        apply_changes(changes)
    assert caught.value.path == str(changes[fails_at - 1].path)
    assert contents(workspace) == before


def test_a_full_disk_leaves_every_file_as_it_was(
    workspace: Path, prefix: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = contents(workspace)
    changes, _ = plan(workspace)
    calls = 0

    def failing(descriptor: int) -> None:
        nonlocal calls
        calls += 1
        if calls == 2:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", failing)
    with pytest.raises(WorkspaceError, match="No space left on device") as caught:
        apply_changes(changes)
    assert caught.value.path == str(changes[1].path)
    assert contents(workspace) == before


def test_an_interrupt_leaves_every_file_as_it_was(
    workspace: Path, prefix: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = contents(workspace)
    changes, _ = plan(workspace)
    replace = Path.replace
    calls = 0

    def interrupted(self: Path, target: Path) -> Path:
        nonlocal calls
        calls += 1
        if calls == 2:
            raise KeyboardInterrupt
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", interrupted)
    with pytest.raises(KeyboardInterrupt):
        apply_changes(changes)
    assert contents(workspace) == before


def test_packages_without_cmake_are_left_alone(workspace: Path, prefix: Path) -> None:
    (workspace / "src/face/CMakeLists.txt").unlink()
    changes, _ = plan(workspace)
    assert [change.path.parent.name for change in changes] == ["arm"]


def test_patching_needs_the_installed_file_and_restoring_does_not(
    workspace: Path, prefix: Path
) -> None:
    patch.run(workspace)
    prefix.unlink()
    with pytest.raises(MissingToolError, match="make setup"):
        plan(workspace)
    changes, _ = plan(workspace, restore=True)
    assert len(changes) == 2


@pytest.mark.skipif(shutil.which("patch") is None, reason="patch is not installed")
@pytest.mark.parametrize(
    "text", [b"a()\nb()\nc()\nd()\n", b"a()\r\nb()\r\n", b"a()", b"", BOM + b"a()\n", b"#x\ry\n"]
)
def test_the_diff_is_one_that_patch_applies(workspace: Path, prefix: Path, text: bytes) -> None:
    path = workspace / "src/arm/CMakeLists.txt"
    path.write_bytes(text)
    change = ListFileChange(path, path, text, patch_text(text, FILE))
    shown = diff(change, workspace)
    assert shown.startswith(b"--- a/src/arm/CMakeLists.txt\n+++ b/src/arm/CMakeLists.txt\n@@ ")
    command = ["patch", "--binary", "-p1"]
    subprocess.run(command, cwd=workspace, input=shown, check=True, capture_output=True)
    assert path.read_bytes() == change.after


def test_a_dry_run_shows_and_writes_nothing(
    workspace: Path, prefix: Path, capfdbinary: pytest.CaptureFixture[bytes]
) -> None:
    before = contents(workspace)
    patch.run(workspace, dry_run=True)
    shown = capfdbinary.readouterr().out
    assert shown.count(b"\n+# >>> tpc >>>") == 2
    assert b"+# <<< tpc <<<\n project(face)\n\\ No newline at end of file\n" in shown
    assert b"+# <<< tpc <<<\r\n project(arm)\r\n" in shown
    assert contents(workspace) == before


def test_the_command_says_what_it_did(
    workspace: Path, prefix: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    patch.run(workspace, packages=["arm"])
    patch.run(workspace)
    patch.run(workspace, restore=True)
    arm, face = (workspace / "src" / name / "CMakeLists.txt" for name in ("arm", "face"))
    assert capsys.readouterr().out.splitlines() == [
        f"patched {arm}",
        "1 patched",
        f"patched {face}",
        "1 patched, 1 already with the block",
        f"restored {arm}",
        f"restored {face}",
        "2 restored",
    ]


def run_script(
    *arguments: str | Path, folder: Path, before: str = ""
) -> subprocess.CompletedProcess[str]:
    """modify_cmakelists.py with Debian's Python; ``before`` is code that runs first."""
    code = f"import runpy; {before}; runpy.run_path({str(SCRIPT)!r}, run_name='__main__')"
    command = ["-c", code] if before else [str(SCRIPT)]
    return subprocess.run(
        ["/usr/bin/python3", *command, *arguments],
        cwd=folder,
        env={
            "TPC_PREFIX": str(folder / "prefix"),
            "PYTHONDONTWRITEBYTECODE": "1",
            **({"PYTHONPATH": str(ROOT)} if before else {}),
        },
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_script_ends_with_one_line_and_status_1(tmp_path: Path) -> None:
    ran = run_script(tmp_path / "none", folder=tmp_path)
    assert (ran.returncode, ran.stdout) == (1, "")
    assert ran.stderr == f"pytpc: error: {tmp_path}/none: no such folder\n"


def test_an_interrupted_script_ends_with_130(tmp_path: Path) -> None:
    interrupted = (
        "import pytpc.workspace.patch as patch;"
        " patch.plan_tree = lambda *_, **__: exec('raise KeyboardInterrupt')"
    )
    ran = run_script(tmp_path, folder=tmp_path, before=interrupted)
    assert (ran.returncode, ran.stdout, ran.stderr) == (130, "", "")


def test_the_script_runs_on_debians_python(workspace: Path, prefix: Path, tmp_path: Path) -> None:
    before = contents(workspace)
    for option, done in ((), "2 patched"), (("--restore",), "2 restored"):
        ran = run_script(workspace, *option, folder=tmp_path)
        assert (ran.returncode, ran.stderr) == (0, "")
        assert ran.stdout.splitlines()[-1] == done
    assert contents(workspace) == before
