"""Runs commands on a scheduler of Dask with some workers, and counts what that takes.

`benchmarks/fleet.py` starts it in a network of its own, so that all bytes are those of the cluster.
It reads one JSON object from standard input, ``{"workers": 2, "commands": {"add": [...], ...}}``;
in a command the word ``ADDRESS`` stands for that of the scheduler. It prints one: ``commands`` has
for each of them its ``output``, ``seconds`` on the wall, ``bytes`` on the network, and the
processor seconds of the scheduler (``scheduler_s``), of all workers (``workers_s``), and of the one
that had most to do (``busiest_s``); ``peak_mb`` is the largest memory of a worker.
"""

from __future__ import annotations

import fcntl
import json
import os
import socket
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

_SIOCSIFFLAGS, _IFF_UP, _SIOCGIFFLAGS = 0x8914, 0x1, 0x8913
_PATIENCE_S = 120.0


def raise_loopback() -> None:
    """Switch on the loopback of a network that was just made; elsewhere it is on."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        asked = fcntl.ioctl(any_socket, _SIOCGIFFLAGS, struct.pack("16sH14x", b"lo", 0))
        (flags,) = struct.unpack_from("H", asked, 16)
        if not flags & _IFF_UP:
            wanted = struct.pack("16sH14x", b"lo", flags | _IFF_UP)
            fcntl.ioctl(any_socket, _SIOCSIFFLAGS, wanted)


def loopback_bytes() -> int:
    """Bytes that went over the loopback so far, each counted once."""
    for line in Path("/proc/net/dev").read_text().splitlines():
        name, _, counts = line.partition(":")
        if name.strip() == "lo":
            return int(counts.split()[0])
    raise SystemExit("no loopback in /proc/net/dev")


def processor_s(process: subprocess.Popen[bytes]) -> float:
    """Processor seconds of a process that runs."""
    after_name = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return sum(map(int, after_name[11:13])) / os.sysconf("SC_CLK_TCK")


@contextmanager
def started(*words: str) -> Iterator[subprocess.Popen[bytes]]:
    """A process of Dask until the end of the block."""
    process = subprocess.Popen(
        [sys.executable, "-m", "dask", *words],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        yield process
    finally:
        process.terminate()
        process.wait()


def address_in(path: Path) -> str:
    """The address in the file that a scheduler writes."""
    until = time.monotonic() + _PATIENCE_S
    while time.monotonic() < until:
        try:
            return str(json.loads(path.read_text())["address"])
        except (OSError, ValueError):
            time.sleep(0.1)
    raise SystemExit(f"no scheduler after {_PATIENCE_S:.0f} s: is dask[distributed] installed?")


def run(workers: int, commands: dict[str, list[str]], folder: Path) -> dict[str, object]:
    """See the module."""
    from distributed import Client  # noqa: PLC0415 - the network is not up before

    file = folder / "scheduler.json"
    here = ["--host", "127.0.0.1", "--no-dashboard"]
    with ExitStack() as stack:
        scheduler = stack.enter_context(
            started("scheduler", *here, "--port", "0", "--scheduler-file", str(file))
        )
        address = address_in(file)
        each = ["worker", address, *here, "--no-nanny", "--nthreads", "1"]
        each += ["--memory-limit", "2GB", "--local-directory", str(folder)]
        crew = [stack.enter_context(started(*each)) for _ in range(workers)]
        with Client(address, timeout=_PATIENCE_S) as client:
            client.wait_for_workers(workers, timeout=_PATIENCE_S)
        found = {}
        for name, command in commands.items():
            words = [address if word == "ADDRESS" else word for word in command]
            before = loopback_bytes(), *map(processor_s, (scheduler, *crew))
            began = time.monotonic()
            done = subprocess.run(
                words, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, check=True
            )
            seconds = time.monotonic() - began
            after = loopback_bytes(), *map(processor_s, (scheduler, *crew))
            sent, scheduled, *worked = (y - x for x, y in zip(before, after, strict=True))
            found[name] = {
                "output": done.stdout,
                "seconds": seconds,
                "bytes": sent,
                "scheduler_s": scheduled,
                "workers_s": sum(worked),
                "busiest_s": max(worked),
            }
        peaks = [_peak_mb(one) for one in crew]
    return {"commands": found, "peak_mb": max(peaks)}


def _peak_mb(process: subprocess.Popen[bytes]) -> float:
    text = Path(f"/proc/{process.pid}/status").read_text()
    return int(text.partition("VmHWM:")[2].split()[0]) / 1024


def main() -> None:
    """Reads the commands, and prints what they took."""
    job = json.load(sys.stdin)
    raise_loopback()
    with tempfile.TemporaryDirectory() as folder:
        json.dump(run(job["workers"], job["commands"], Path(folder)), sys.stdout)


if __name__ == "__main__":
    main()
