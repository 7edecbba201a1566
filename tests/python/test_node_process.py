"""What the process of a node says of itself, where it can be seen."""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator

import pytest

from pytpc.ros.ros1 import node_process
from pytpc.ros.ros1.master import Master
from pytpc.ros.ros1.node_process import is_built_with_tpc

MASTER = Master("http://127.0.0.1:11311", "/me")


@pytest.fixture
def pid(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[int]]:
    """What a node of this process says is its number."""
    said = [os.getpid()]
    with socket.create_server(("127.0.0.1", 0)) as server:
        uri = f"http://127.0.0.1:{server.getsockname()[1]}/"
        monkeypatch.setattr(Master, "node_uri", lambda *_: uri)
        monkeypatch.setattr(node_process, "call", lambda *_: said[0])
        yield said


def test_a_process_without_the_library_was_not_built_with_tpc(pid: list[int]) -> None:
    assert is_built_with_tpc(MASTER, "/node") is False


# The node is in a container with the network of this machine, and counts processes by itself.
def test_another_process_of_that_number_is_not_asked(pid: list[int]) -> None:
    pid[0] = os.getppid()
    assert is_built_with_tpc(MASTER, "/node") is None


def test_of_a_process_with_more_libraries_than_are_read_nothing_is_said(
    pid: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(node_process, "_MOST_BYTES", 100)
    assert is_built_with_tpc(MASTER, "/node") is None
