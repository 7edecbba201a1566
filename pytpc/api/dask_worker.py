"""What a worker process of ``--cluster local`` does at its start."""

from __future__ import annotations

import signal


def dask_setup(_worker: object) -> None:
    """Leave Ctrl-C, which a terminal sends to all processes, to the command: it ends its workers.

    Dask calls this.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
