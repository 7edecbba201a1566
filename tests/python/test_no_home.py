"""A user without a home folder: no HOME, and no account, as in a container with a number alone."""

from __future__ import annotations

import os
import time
from pathlib import Path
from typing import NoReturn

import pytest

from pytpc.api.record import node_files
from pytpc.base.errors import TpcError
from pytpc.values.journal import folder_of
from pytpc.values.recorded_files import workspaces_of


@pytest.fixture(autouse=True)
def homeless(monkeypatch: pytest.MonkeyPatch) -> None:
    def home() -> NoReturn:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", home)
    for name in ("HOME", "ROS_HOME", "TPC_FOLDER"):
        monkeypatch.delenv(name, raising=False)


# docs/reference/runtime.md says where nodes write.
@pytest.mark.parametrize(
    ("env", "folder"),
    [
        ({}, f"/tmp/tpc-{os.geteuid()}"),
        ({"HOME": "/h"}, "/h/.ros/tpc"),
        ({"HOME": "/h", "ROS_HOME": "/r"}, "/r/tpc"),
        ({"HOME": "/h", "ROS_HOME": "/r", "TPC_FOLDER": "/t"}, "/t"),
    ],
)
def test_the_nodes_files_are_looked_for_where_nodes_write_them(env, folder, monkeypatch):
    for name, value in env.items():
        monkeypatch.setenv(name, value)
    # Nothing was written after tomorrow.
    assert node_files(time.time_ns() + 86_400 * 10**9) == (Path(folder), 0)


def test_what_needs_a_home_says_so_in_a_line():
    for needs_one in (folder_of, workspaces_of):
        with pytest.raises(TpcError, match="no home folder; set HOME"):
            needs_one({})
    assert folder_of({"XDG_STATE_HOME": "/s"}) == Path("/s/tpc/applied")
