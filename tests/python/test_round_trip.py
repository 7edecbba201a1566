"""tools/round-trip: on the project's own files and on a fixed set of awkward ones."""

from pathlib import Path

import pytest
from packages import install_prefix

import round_trip

ROOT = Path(__file__).resolve().parents[2]
AWKWARD = {
    "crlf/CMakeLists.txt": b"cmake_minimum_required(VERSION 3.16)\r\nproject(crlf)\r\n",
    "no_end/CMakeLists.txt": b"project(no_end)",
    "bom/CMakeLists.txt": b"\xef\xbb\xbfproject(bom)\n",
    "latin/CMakeLists.txt": b"# caf\xe9\nproject(latin)\n",
    "bracket/CMakeLists.txt": b"#[=[ project(no)\n]] ]=]\nproject(bracket)\n",
    "part/CMakeLists.txt": b"add_library(part part.cpp)\n",
    "template/CMakeLists.txt.in": b"@head@\nproject(@name@)\n",
    "module/Find.cmake": b"set(x [[\n]])\n",
    "a build/CMakeCache.txt": b"",
    "a build/CMakeLists.txt": b"project(generated)\n",
}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("TPC_PREFIX", str(tmp_path / "prefix"))
    install_prefix(tmp_path / "prefix")
    for name, text in AWKWARD.items():
        path = tmp_path / "files" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text)
    (tmp_path / "files/latin/CMakeLists.txt").chmod(0o444)
    return tmp_path / "files"


def test_awkward_files_survive(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert round_trip.main([str(folder)]) == 0
    lines = capsys.readouterr().out.splitlines()
    # Of ten files two are in a build folder; five of six CMakeLists.txt call project().
    assert sorted(lines[:-1]) == sorted(
        [
            "      8 files",
            "      6 CMakeLists.txt",
            "      1 *.in",
            "      1 *.cmake",
            "      1 with CRLF",
            "      1 without a final newline",
            "      1 not UTF-8",
            "      8 identical",
            "      5 projects as files",
        ]
    )
    assert lines[-1].startswith("CMake cannot parse it, patched or not: ")
    assert "/template/CMakeLists.txt.in:1: " in lines[-1]


def test_the_projects_own_files_survive(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert round_trip.main([str(ROOT / name) for name in ("examples", "cmake", "passes")]) == 0
    assert "      9 projects as files" in capsys.readouterr().out


def test_a_file_that_does_not_survive_is_told(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(round_trip, "restore_text", lambda data: data)
    assert round_trip.main([str(folder / "crlf")]) == 1
    said = capsys.readouterr().out.splitlines()[-1]
    assert said == (
        f"NOT IDENTICAL: {folder}/crlf/CMakeLists.txt: is another file when it is restored"
    )


def test_a_file_with_the_block_is_told(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = folder / "crlf/CMakeLists.txt"
    path.write_bytes(round_trip.patch_text(path.read_bytes(), round_trip.INCLUDED))
    assert round_trip.main([str(folder / "crlf")]) == 1
    assert "crlf/CMakeLists.txt: has the block already" in capsys.readouterr().out
