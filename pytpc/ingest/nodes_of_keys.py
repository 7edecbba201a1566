"""Which node the reports of a process with several nodes are of.

A message or a file names one node for all of its reports: the one that the process is named after.
A process with several nodes also says once for each key whose it is, if it is another node's.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pytpc.base.columns import Int32s, Int64s


class NodesOfKeys:
    """Replaces nodes in columns of codes.

    Args:
        moves: the node of each key and process, by the codes of key and of the process's node.
        nodes: how many codes of nodes there are.
    """

    def __init__(self, moves: Mapping[tuple[int, int], int], nodes: int) -> None:
        """Each code is from 0 and below ``nodes``, or below 2^31 for keys."""
        self._moves = dict(moves)
        self._width = max(1, nodes)
        pairs = sorted(moves)
        self._known: Int64s = np.array([key * self._width + node for key, node in pairs], np.int64)
        self._to = np.array([moves[pair] for pair in pairs], np.int32)

    def of(self, key: Int32s, node: Int32s) -> Int32s:
        """int32[n]: the node of each row, from its ``key`` int32[n] and its process's ``node``."""
        if not self._known.size:
            return node
        asked = key.astype(np.int64) * self._width + node
        place = np.minimum(np.searchsorted(self._known, asked), self._known.size - 1)
        return np.where(self._known[place] == asked, self._to[place], node).astype(np.int32)

    def of_pair(self, pair: tuple[int, int]) -> tuple[int, int]:
        """A pair of codes, key and node, with the key's own node."""
        return pair[0], self._moves.get(pair, pair[1])
