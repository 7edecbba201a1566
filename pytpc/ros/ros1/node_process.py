"""What the processes of a graph's nodes say of themselves, where they run on this machine.

A node that has compared nothing yet tells its graph nothing of TPC. Its process does: it has loaded
the log library, or was started so that Python nodes report.
"""

from __future__ import annotations

import os
import socket
from pathlib import Path
from urllib.parse import urlsplit

from pytpc.base.errors import RunError
from pytpc.ros.node_start import RUN, SWITCH
from pytpc.ros.ros1.master import CALL_ERRORS, Master, call, own_host

_PROC = Path("/proc")
_LIBRARY = b"libtpc_log.so"
_MOST_BYTES = 1 << 20
# Columns of /proc/net/tcp (proc(5)), and the state of a socket that takes connections.
_LOCAL, _STATE, _INODE = 1, 3, 9
_LISTEN = "0A"
_LOOPBACK = ("localhost", "127.0.0.1", "127.0.1.1")
_CONNECT_S = 1.0


def is_built_with_tpc(master: Master, node: str) -> bool | None:
    """Whether a node was built or started with TPC; None where that is not to be seen from here."""
    process = _process_of(master, node)
    if process is None:
        return None
    try:
        with (process / "maps").open("rb") as stream:
            maps = stream.read(_MOST_BYTES)
        words = (process / "cmdline").read_bytes().split(b"\0")
        variables = (process / "environ").read_bytes().split(b"\0")
    except OSError:
        return None
    if _LIBRARY in maps or os.fsencode(RUN) in words:
        return True
    if len(maps) == _MOST_BYTES:
        return None
    is_python = bool(words) and Path(os.fsdecode(words[0])).name.startswith("python")
    return is_python and f"{SWITCH}=1".encode() in variables


def is_gone(master: Master, node: str) -> bool:
    """Whether a node that the master knows has died without telling it.

    That is seen from here if it ran on this machine: nothing listens at its address any more. Of a
    node of another machine that calls itself localhost, it cannot be known.
    """
    names = _own_names(master)
    here = urlsplit(master.uri).hostname in names
    try:
        place = urlsplit(master.node_uri(node) or "")
        host, port = place.hostname, place.port
        if host is None or port is None or host not in names or (host in _LOOPBACK and not here):
            return False
        with socket.create_connection((host, port), _CONNECT_S):
            return False
    except ConnectionRefusedError:
        return True
    except (RunError, OSError, ValueError):
        return False


def _process_of(master: Master, node: str) -> Path | None:
    """The folder of a node's process below /proc; None if it is not to be seen from here.

    In a container that shares the network, a node runs on this machine, and its number is that of
    another process here.
    """
    try:
        place = urlsplit(master.node_uri(node) or "")
        if place.hostname not in _own_names(master) or place.port is None:
            return None
        pid = call(place.geturl(), "getPid", master.caller)
    except (RunError, ValueError, *CALL_ERRORS):
        return None
    process = _PROC / str(pid)
    return process if isinstance(pid, int) and _listens(process, place.port) else None


def _listens(process: Path, port: int) -> bool:
    """Whether a process takes connections at a port."""
    try:
        # A kernel without IPv6 has no tcp6.
        tables = [one for one in (process / "net/tcp", process / "net/tcp6") if one.is_file()]
        rows = [line.split() for one in tables for line in one.read_text().splitlines()[1:]]
        found = {
            f"socket:[{row[_INODE]}]"
            for row in rows
            if row[_STATE] == _LISTEN and int(row[_LOCAL].rpartition(":")[2], 16) == port
        }
        return any(str(one.readlink()) in found for one in (process / "fd").iterdir())
    except OSError:
        return False


def _own_names(master: Master) -> set[str]:
    name = socket.gethostname()
    return {*_LOOPBACK, name.lower(), own_host(os.environ, master.uri)}
