"""Files are written whole or not at all."""

import os
from pathlib import Path

import pytest

from pytpc.base.atomic import write_atomic
from pytpc.base.errors import TpcError


def test_a_file_is_made_with_its_folder_and_then_replaced(tmp_path: Path) -> None:
    target = tmp_path / "a/b/file"
    write_atomic(target, b"old")
    write_atomic(target, b"new")
    assert target.read_bytes() == b"new"
    assert list(target.parent.iterdir()) == [target]


def test_the_mode_is_that_of_a_new_file(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        write_atomic(tmp_path / "file", b"")
    finally:
        os.umask(before)
    assert (tmp_path / "file").stat().st_mode & 0o777 == 0o640


def test_a_folder_in_the_way_is_one_error_and_nothing_is_left(tmp_path: Path) -> None:
    (tmp_path / "file").mkdir()
    with pytest.raises(TpcError) as caught:
        write_atomic(tmp_path / "file", b"x")
    assert str(caught.value) == f"{tmp_path}/file: cannot be written: Is a directory"
    assert list(tmp_path.iterdir()) == [tmp_path / "file"]


def test_a_write_that_breaks_off_leaves_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    target = tmp_path / "file"
    target.write_bytes(b"old")

    def full(_descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(TpcError, match="No space left on device"):
        write_atomic(target, b"new")
    assert target.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [target]
