"""Counts messages that were lost on the way, by the numbers that their senders give them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence, Set
from typing import Generic, TypeVar

import numpy as np

from pytpc.base.columns import Int64s
from pytpc.ingest.rosout_line import BatchHead, parse_batch

Name = TypeVar("Name", str, bytes)


class LossCounter(Generic[Name]):
    """Finds gaps in numbered messages; a sender that restarts begins anew.

    A ``latched`` sender, such as rospy, sends its last message to each new subscriber again, with a
    number of its own. rosout is such a subscriber, so one missing number of each is no loss.
    """

    def __init__(self) -> None:
        self.lost: Counter[Name] = Counter()
        self.missed_before: Counter[Name] = Counter()
        self._last: dict[Name, int] = {}
        self._spared: set[Name] = set()
        self._next_report: dict[tuple[Name, int], int] = {}

    def see(self, sender: Name, number: int, *, latched: bool = False) -> None:
        """Take in the number of one message."""
        last = self._last.get(sender)
        if last is not None:
            missing = max(0, number - last - 1)
            self._lose(sender, missing, one_is_spared=latched and missing == 1)
        elif number > 1:
            # roscpp counts from 0 and rospy from 1, so 1 may be the first one.
            self.missed_before[sender] = number - 1
        self._last[sender] = number

    def see_all(self, senders: Sequence[Name], numbers: Int64s, latched: Set[Name]) -> None:
        """The same for many messages in order."""
        codes = {sender: code for code, sender in enumerate(dict.fromkeys(senders))}
        code_of = np.array([codes[sender] for sender in senders], np.int32)
        for sender, code in codes.items():
            own = numbers[code_of == code]
            self.see(sender, int(own[0]), latched=sender in latched)
            missing = np.diff(own) - 1
            spared = sender in latched and bool((missing == 1).any())
            self._lose(sender, int(missing[missing > 0].sum()), one_is_spared=spared)
            self._last[sender] = int(own[-1])

    def see_text(self: LossCounter[str], sender: str, text: bytes) -> int:
        """Take in a text of /threshold_information; return how many reports it has."""
        if not text.startswith(b"#"):
            return 1
        batch = parse_batch(text.partition(b"\n")[0].decode("utf-8", "replace"))
        if not isinstance(batch, BatchHead):
            return 0
        self.see_batch(sender or batch.node, batch)
        return batch.count

    def see_batch(self, sender: Name, batch: BatchHead) -> None:
        """Take in the first line of a numbered text: its numbers count the process's reports."""
        process = (sender, batch.pid)
        expected = self._next_report.get(process)
        if expected is not None:
            self.lost[sender] += max(0, batch.seq - expected)
        elif batch.seq:
            self.missed_before[sender] += batch.seq
        self._next_report[process] = max(expected or 0, batch.seq + batch.count)

    def _lose(self, sender: Name, missing: int, *, one_is_spared: bool) -> None:
        if one_is_spared and sender not in self._spared:
            self._spared.add(sender)
            missing -= 1
        if missing:
            self.lost[sender] += missing
