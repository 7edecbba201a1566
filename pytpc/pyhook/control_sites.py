"""What rewritten ``for`` and ``match`` statements call. See `pytpc.pyhook.sites`."""

from __future__ import annotations

import sys
from itertools import chain
from typing import TYPE_CHECKING

from pytpc.pyhook.sites import logger

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from pytpc.pyhook.sites import Held, Reported


class Loop:
    """``for i in range(limit)`` has become ``for i in LOOP.over(range(limit))``.

    Before each turn i is compared with the limit, and at the end what i would be, as a ``for`` of
    C does it. A loop that is left by ``break`` or ``return`` has no end.
    """

    __slots__ = ("_log",)

    def __init__(self, reported: tuple[Reported, ...]) -> None:
        """All keys of the place."""
        self._log = logger(reported)

    def over(self, iterable: Iterable[object]) -> Iterable[object]:
        """The same elements, with reports; what is no ``range`` is left as it is."""
        if type(iterable) is not range:
            return iterable
        counted: range = iterable
        stop, log = counted.stop, self._log
        behind = counted.start + len(counted) * counted.step

        def turn(element: int) -> int:
            log(element, stop, True)
            return element

        def end() -> None:
            log(behind, stop, False)

        turns: Iterator[object] = map(turn, counted)
        return chain(turns, iter(end, None))


class Subject:
    """``match subject`` has become ``match SUBJECT.hold(subject)``.

    The cases ask for the subject by `held`. Which of them is taken is said by `taken`, `default` or
    `none`, which stand in their guards.
    """

    __slots__ = ("_held", "_log")

    def __init__(self, reported: tuple[Reported, ...]) -> None:
        """All keys of a subject that is a parameter."""
        self._held: Held = {}
        self._log = logger(reported)

    def hold(self, subject: object) -> object:
        """Keep the subject of the calling frame's statement."""
        self._held[id(sys._getframe(1))] = subject, None
        return subject

    def held(self) -> object:
        """The subject."""
        return self._held[id(sys._getframe(1))][0]

    def taken(self) -> bool:
        """A case that compares is taken."""
        self._end(id(sys._getframe(1)), True)
        return True

    def default(self) -> bool:
        """The case that takes everything is taken."""
        self._end(id(sys._getframe(1)), False)
        return True

    def none(self) -> bool:
        """No case was taken, nor is this one."""
        self._end(id(sys._getframe(1)), False)
        return False

    def _end(self, frame: int, is_taken: bool) -> None:
        subject, _ = self._held.pop(frame)
        self._log(subject, subject, is_taken)
