"""Where the work on many missions is done: on Dask, in this process or in others.

Without a cluster the tasks run in threads of this process, and no service is started. With
``local`` they run in worker processes on this machine, and with the address of a scheduler of Dask
on its workers, which need this pytpc. The tasks, and the tree in which results are joined, are the
same everywhere, so that the results are the same bit for bit. A worker that dies is replaced by
Dask, and its tasks are done again: all tasks may be done twice.
"""

from __future__ import annotations

import asyncio
import itertools
import logging
import os
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from typing import Any, TypeVar

from pytpc.base.errors import InputError, TpcError

Item = TypeVar("Item")
Result = TypeVar("Result")
Progress = Callable[[int, int], None]

LOCAL = "local"
MEMORY = "2GB"
"""What a worker may have: near it, its tasks wait; beyond it, it is started again."""
DIED = (
    "worker processes died while they read it; it may not fit into their memory"
    f" (of each {MEMORY} with --cluster local)"
)
"""What to say of something at which they died."""
_JOINED = 8
"""So many results are joined at once."""
_ANSWERS_S = 20
_STARTS_S = 300.0
"""After so long without any worker there will be none: on this machine, one starts in seconds."""
_AT_START = "pytpc.api.dask_worker"


@dataclass(frozen=True)
class Engine:
    """Does tasks; made by ``engine``. ``client`` is that of a cluster, None for threads."""

    workers: int
    client: Any = None

    def map(
        self,
        task: Callable[[Item], Result],
        items: Sequence[Item],
        on_progress: Progress | None = None,
        lost: Callable[[Item], Result] | None = None,
    ) -> list[Result]:
        """Do a task for each item; the results are in their order.

        Args:
            task: a function at the top of a module.
            items: what it is given.
            on_progress: called with (done, in all).
            lost: makes the result of an item at which worker processes die again and again, as one
                that does not fit into their memory; None: that is an error.

        Raises:
            TpcError: a task could not be done, or the cluster is gone.
        """
        if not items:
            return []
        if self.client is None:
            found: list[Result] = self._in_threads(task, items, None, on_progress)
            return found
        with _explained():
            return self._mapped(task, items, on_progress, lost)

    def joined(
        self,
        task: Callable[[Item], Result],
        items: Sequence[Item],
        join: Callable[[list[Result]], Result],
        on_progress: Progress | None = None,
    ) -> Result:
        """Do a task for each item, and join the results in a tree.

        Args:
            task: as for ``map``.
            items: as for ``map``.
            join: makes one result of a few, or of none; it keeps their order.
            on_progress: as for ``map``.

        Raises:
            TpcError: as ``map``.
        """
        if not items:
            return join([])
        if self.client is None:
            found: Result = self._in_threads(task, items, join, on_progress)
            return found
        client = self.client
        with _explained():
            leaves = self._submitted(task, items, on_progress)
            whole = _tree(leaves, lambda group: client.submit(join, group, pure=False))
            # What is joined need not be kept.
            del leaves
            self._wait_for(whole)
            made: list[Result] = client.gather(whole)
            return made[0]

    def _in_threads(
        self,
        task: Callable[[Any], Any],
        items: Sequence[Any],
        join: Callable[[list[Any]], Any] | None,
        on_progress: Progress | None,
    ) -> Any:  # noqa: ANN401 - a list of results, or one
        from dask import delayed  # noqa: PLC0415 - it takes a second
        from dask.callbacks import Callback  # noqa: PLC0415 - it takes a second

        leaves = [delayed(task, pure=False)(item) for item in items]
        names = {leaf.key for leaf in leaves}
        done = 0

        def count(key: str, *_: object) -> None:
            nonlocal done
            if key in names:
                done += 1
                if on_progress is not None:
                    on_progress(done, len(names))

        level = [] if join is None else _tree(leaves, delayed(join, pure=False))
        whole = level[0] if level else delayed(list, pure=False)(leaves)
        with Callback(posttask=count):
            return whole.compute(
                scheduler="threads", num_workers=self.workers, optimize_graph=False
            )

    def _mapped(
        self,
        task: Callable[[Item], Result],
        items: Sequence[Item],
        on_progress: Progress | None,
        lost: Callable[[Item], Result] | None,
    ) -> list[Result]:
        """``map`` on a cluster."""
        leaves = self._submitted(task, items, on_progress)
        self._wait_for(leaves)
        if lost is None:
            made: list[Result] = self.client.gather(leaves)
            return made
        killed = [number for number, leaf in enumerate(leaves) if _is_killed(leaf)]
        # The results are fetched before another worker dies with them.
        made = self.client.gather([one for n, one in enumerate(leaves) if n not in killed])
        del leaves
        for number in killed:
            item = items[number]
            # Alone: it may have waited on workers that died at another one.
            again = self._submitted(task, [item], None)
            self._wait_for(again)
            found = lost(item) if _is_killed(again[0]) else self.client.gather(again)[0]
            made.insert(number, found)
        return made

    def _submitted(
        self, task: Callable[[Any], Any], items: Sequence[Any], on_progress: Progress | None
    ) -> list[Any]:
        total, done = len(items), itertools.count(1)
        leaves: list[Any] = self.client.map(task, items, pure=False)
        if on_progress is not None:
            for leaf in leaves:
                leaf.add_done_callback(lambda _: on_progress(next(done), total))
        return leaves

    def _wait_for(self, wanted: Sequence[Any]) -> None:
        """Wait in turns, between which a signal is heard.

        Raises:
            TpcError: there has been no worker for long.
        """
        from distributed import wait  # noqa: PLC0415 - it takes a second

        cluster, seen_s = self.client.cluster, time.monotonic()
        while not all(one.done() for one in wanted):
            with suppress(TimeoutError, asyncio.TimeoutError):
                wait(wanted, timeout=1)
            # Dask gives up a worker process that dies while it starts.
            if cluster is not None and len(cluster.workers) < self.workers:
                cluster.scale(self.workers)
            if self.client.ncores():
                seen_s = time.monotonic()
            elif time.monotonic() - seen_s > _STARTS_S:
                what = "no worker process starts any more; give fewer --workers, or no --cluster"
                if cluster is None:
                    address = self.client.scheduler.address
                    what = f"{address} has no workers; start some with `dask worker {address}`"
                raise TpcError(what)


def _is_killed(leaf: Any) -> bool:  # noqa: ANN401 - a Future of Dask
    """Whether workers died at it again and again."""
    from distributed.scheduler import KilledWorker  # noqa: PLC0415 - it takes a second

    return leaf.status == "error" and isinstance(leaf.exception(), KilledWorker)


@contextmanager
def _explained() -> Iterator[None]:
    """What may happen to a cluster as an error of ours.

    Raises:
        TpcError: as `Engine.map`.
    """
    from concurrent.futures import CancelledError  # noqa: PLC0415

    from distributed.scheduler import KilledWorker  # noqa: PLC0415 - it takes a second

    try:
        yield
    except KilledWorker as error:
        raise TpcError(f"workers died again and again: {error}") from error
    except (CancelledError, OSError) as error:
        raise TpcError(f"the cluster is gone: {error}") from error


def _tree(leaves: list[Any], join: Callable[[list[Any]], Any]) -> list[Any]:
    """The one result in which all are joined, a few at a time."""
    level = [join(leaves[at : at + _JOINED]) for at in range(0, len(leaves), _JOINED)]
    return level if len(level) == 1 else _tree(level, join)


@contextmanager
def engine(cluster: str | None = None, workers: int | None = None) -> Iterator[Engine]:
    """Where tasks are done until the end of the block.

    Args:
        cluster: None, ``local`` or the address of a scheduler, such as ``tcp://10.0.0.5:8786``.
        workers: how many threads or processes; None: as many as this process may use cores.

    Raises:
        InputError: the address is none, or nothing answers there.
    """
    count = workers or len(os.sched_getaffinity(0))
    if cluster is None:
        yield Engine(count)
        return
    import dask  # noqa: PLC0415 - both take a second
    import distributed  # noqa: PLC0415

    # What a worker that ends says of its own connections is nothing for the user.
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    with ExitStack() as stack:
        if cluster == LOCAL:
            quiet = {"distributed.worker.daemon": True, "logging.distributed": "critical"}
            stack.enter_context(dask.config.set(quiet))
            made = distributed.LocalCluster(
                n_workers=count,
                threads_per_worker=1,
                memory_limit=MEMORY,
                host="127.0.0.1",
                dashboard_address=None,
                silence_logs=logging.CRITICAL,
                preload=[*dask.config.get("distributed.worker.preload"), _AT_START],
            )
            address = stack.enter_context(made)
        else:
            address = cluster
        try:
            client = stack.enter_context(distributed.Client(address, timeout=_ANSWERS_S))
        # With Python 3.10 that of asyncio is no OSError.
        except (OSError, ValueError, asyncio.TimeoutError) as error:
            why = str(error).partition("\n")[0]
            raise InputError(f"no scheduler of Dask answers at {cluster}: {why}") from error
        yield Engine(count, client)
