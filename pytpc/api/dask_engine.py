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
_JOINED = 8
"""So many results are joined at once."""
_ANSWERS_S = 20
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
    ) -> list[Result]:
        """Do a task for each item; the results are in their order.

        Args:
            task: a function at the top of a module.
            items: what it is given.
            on_progress: called with (done, in all).

        Raises:
            TpcError: a task could not be done, or the cluster is gone.
        """
        found: list[Result] = self._made(task, items, None, on_progress)
        return found

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
        found: Result = self._made(task, items, join, on_progress)
        return found

    def _made(
        self,
        task: Callable[[Any], Any],
        items: Sequence[Any],
        join: Callable[[list[Any]], Any] | None,
        on_progress: Progress | None,
    ) -> Any:  # noqa: ANN401 - a list of results, or one
        if not items:
            return [] if join is None else join([])
        do = self._in_threads if self.client is None else self._on_cluster
        return do(task, items, join, on_progress or (lambda *_: None))

    def _in_threads(
        self,
        task: Callable[[Any], Any],
        items: Sequence[Any],
        join: Callable[[list[Any]], Any] | None,
        told: Progress,
    ) -> Any:  # noqa: ANN401
        from dask import delayed  # noqa: PLC0415 - it takes a second
        from dask.callbacks import Callback  # noqa: PLC0415 - it takes a second

        leaves = [delayed(task, pure=False)(item) for item in items]
        names = {leaf.key for leaf in leaves}
        done = 0

        def count(key: str, *_: object) -> None:
            nonlocal done
            if key in names:
                done += 1
                told(done, len(names))

        level = [] if join is None else _tree(leaves, delayed(join, pure=False))
        whole = level[0] if level else delayed(list, pure=False)(leaves)
        with Callback(posttask=count):
            return whole.compute(
                scheduler="threads", num_workers=self.workers, optimize_graph=False
            )

    def _on_cluster(
        self,
        task: Callable[[Any], Any],
        items: Sequence[Any],
        join: Callable[[list[Any]], Any] | None,
        told: Progress,
    ) -> Any:  # noqa: ANN401
        from concurrent.futures import CancelledError  # noqa: PLC0415

        from distributed import wait  # noqa: PLC0415 - it takes a second
        from distributed.scheduler import KilledWorker  # noqa: PLC0415 - it takes a second

        client, total, done = self.client, len(items), itertools.count(1)
        leaves = client.map(task, items, pure=False)
        for leaf in leaves:
            leaf.add_done_callback(lambda _: told(next(done), total))
        wanted = leaves
        if join is not None:
            wanted = _tree(leaves, lambda group: client.submit(join, group, pure=False))
        # What is joined need not be kept.
        del leaves
        try:
            while not all(one.done() for one in wanted):
                with suppress(TimeoutError, asyncio.TimeoutError):
                    wait(wanted, timeout=1)
            found = client.gather(wanted)
        except KilledWorker as error:
            raise TpcError(f"workers died again and again: {error}") from error
        except (CancelledError, OSError) as error:
            raise TpcError(f"the cluster is gone: {error}") from error
        return found if join is None else found[0]


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
