"""Where nodes of this machine got their values: the command lines of their processes.

A graph of ROS 2 does not say which process a node is in. A process is that of a node if its command
line names the node, or if all that it sets is what the node began with.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from pytpc.base.errors import InputError
from pytpc.ros.ros2.address import DOMAIN
from pytpc.ros.ros2.flight import StartedProcess
from pytpc.values.origins import Origin, split_name
from pytpc.values.ros2_arguments import NodeArguments
from pytpc.values.scalars import same_value
from pytpc.values.trace import Trace

_PROC = Path("/proc")
_ROS_ARGS = b"--ros-args"
_SEVERAL = "several processes may be that of its node, and set it in other places"


class CommandLines:
    """The command lines of nodes, read while their processes live.

    Args:
        domain: of the graph; processes of others are left out.
    """

    def __init__(self, domain: str) -> None:
        """Nothing is read yet."""
        self._domain = domain.encode()
        self._known: dict[tuple[int, tuple[str, ...]], NodeArguments] = {}
        self.faults: dict[str, None] = {}

    def look(self, started: Iterable[StartedProcess] = ()) -> None:
        """Read those that are new: of the processes that run, and of those that TPC has started."""
        for process in [*started, *self._running()]:
            key = (process.pid, process.words)
            if key in self._known:
                continue
            try:
                self._known[key] = NodeArguments.of(process.words, process.folder)
            except InputError as error:
                self._known[key] = NodeArguments(())
                self.faults[str(error)] = None

    def _running(self) -> Iterator[StartedProcess]:
        for folder in _PROC.iterdir():
            if not folder.name.isdigit():
                continue
            # It may end meanwhile, or be another user's.
            with contextlib.suppress(OSError):
                words = (folder / "cmdline").read_bytes().rstrip(b"\0").split(b"\0")
                if _ROS_ARGS in words and self._is_here((folder / "environ").read_bytes()):
                    place = (folder / "cwd").readlink()
                    yield StartedProcess(int(folder.name), tuple(map(os.fsdecode, words)), place)

    def _is_here(self, environ: bytes) -> bool:
        given = dict(one.partition(b"=")[::2] for one in environ.split(b"\0"))
        return (given.get(DOMAIN.encode()) or b"0") == self._domain

    def trace(
        self, values: Mapping[str, object], launched: Trace | None, *, is_own: bool
    ) -> Trace | None:
        """Where the values came from: what a launch file sets, and what command lines do.

        Args:
            values: with which the nodes began, by full names.
            launched: what the launch file sets; None: it is not known, or there is none.
            is_own: whether TPC has started the nodes, so that all command lines are known.

        Returns:
            None where nothing is known.
        """
        nodes = {split_name(name)[0] for name in values}
        placed = dict({} if launched is None else launched.placed or {})
        files = dict({} if launched is None else launched.files)
        declaring = {node.name for node in launched.nodes} if launched is not None else set()
        declaring |= nodes if is_own else set()
        for node in sorted(nodes):
            found = self._of(node, {name: values[name] for name in values if _is_of(name, node)})
            if found is None:
                continue
            declaring.add(node)
            origins, read = found
            files.update({path: sha for path, sha in read.items() if path not in files})
            for name, origin in origins.items():
                placed.setdefault(name, origin)
        if launched is None and not declaring:
            return None
        base = launched or Trace(None, {}, {}, (), {})
        return replace(base, placed=placed, files=files, declaring=frozenset(declaring))

    def _of(
        self, node: str, values: Mapping[str, object]
    ) -> tuple[dict[str, Origin], Mapping[str, str]] | None:
        """The origins of a node's values, and the files they are in; None: it is not found."""
        named, fitting = [], []
        for arguments in self._known.values():
            if not arguments.may_be(node):
                continue
            try:
                origins = arguments.origins(node)
            except InputError as error:
                self.faults[str(error)] = None
                continue
            origins = {name: origin for name, origin in origins.items() if name in values}
            if arguments.name:
                named.append((origins, arguments.files))
            elif origins and all(same_value(o.value, values[name]) for name, o in origins.items()):
                fitting.append((origins, arguments.files))
        chosen = named or fitting
        if not chosen:
            return None
        files = {path: sha for _, read in chosen for path, sha in read.items()}
        return _agreed([origins for origins, _ in chosen]), files


def _agreed(found: list[dict[str, Origin]]) -> dict[str, Origin]:
    """The origins, not known where the processes that may be the node's do not agree."""
    agreed = {}
    for name, origin in {name: one for each in found for name, one in each.items()}.items():
        is_same = all(_place(each.get(name)) == _place(origin) for each in found)
        unknown = Origin(name, "unknown", origin.value, None, None, "", note=_SEVERAL)
        agreed[name] = origin if is_same else unknown
    return agreed


def _place(origin: Origin | None) -> object:
    return None if origin is None else (origin.path, origin.lineno, origin.keys, origin.note)


def _is_of(name: str, node: str) -> bool:
    return split_name(name)[0] == node
