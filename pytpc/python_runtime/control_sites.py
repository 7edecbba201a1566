"""What rewritten ``for`` and ``match`` statements call. See `pytpc.python_runtime.sites`."""

from __future__ import annotations

import sys
from functools import partial
from itertools import chain, repeat
from operator import attrgetter
from typing import TYPE_CHECKING, Any

from pytpc.python_runtime.quiet import Site, caller, flat, keep, raising
from pytpc.python_runtime.sites import FALSE, TRUE, logger

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from pytpc.python_runtime.sites import Held, Reported


class Loop(Site):
    """``for i in range(limit)`` has become ``for i in LOOP.over(range(limit)).__next__()``.

    Before each turn i is compared with the limit, and at the end what i would be, as a ``for`` of
    C does it. A loop that is left by ``break`` or ``return`` has no end.
    """

    __slots__ = ("over", "turn")

    def __init__(self, reported: tuple[Reported, ...]) -> None:
        log = logger(reported)

        def turn(element: int, stop: int, is_turn: bool) -> Iterator[int]:
            try:
                log(element, stop, is_turn)
            except BaseException as error:
                return raising(error)
            return repeat(element, is_turn)

        def over(iterable: Any) -> Iterator[Any]:  # noqa: ANN401
            """The same elements, with reports; anything but a ``range`` is returned unchanged."""
            if type(iterable) is not range:
                return repeat(iterable)
            stop = iterable.stop
            elements: Iterable[int] = iterable
            is_turn: Iterable[bool] = repeat(True)
            if not iterable or iterable.index(iterable[-1]) < sys.maxsize:
                turns = len(iterable)
                elements = chain(iterable, (iterable.start + turns * iterable.step,))
                is_turn = chain(repeat(True, turns), (False,))
            # A longer one has no end that is ever seen, and no length that C can hold.
            # What `turn` is may change while the loop runs: a debugger may begin within it.
            current = map(attrgetter("turn"), repeat(self))
            return repeat(flat(map(partial.__call__, current, elements, repeat(stop), is_turn)))

        # Both are `partial`, whatever is behind them, so that C can call them.
        self.offer(over=over, turn=partial(turn))
        keep(self)


class Subject(Site):
    """``match subject`` has become ``match SUBJECT.hold(subject).__next__()``.

    The cases ask for the subject by `held`. Which of them is taken is said by `taken`, `default` or
    `none`, which stand in their guards.
    """

    __slots__ = ("default", "held", "hold", "none", "taken")

    def __init__(self, reported: tuple[Reported, ...]) -> None:
        kept: Held = {}
        log = logger(reported)

        def hold(subject: object) -> Iterator[object]:
            """Keep the subject of the calling frame's statement."""
            kept[caller()] = subject, None
            return repeat(subject)

        def held() -> Iterator[object]:
            """The subject."""
            return repeat(kept[caller()][0])

        def taken() -> Iterator[bool]:
            """A case that compares is taken."""
            return end(caller(), True, TRUE)

        def default() -> Iterator[bool]:
            """The case that takes everything is taken."""
            return end(caller(), False, TRUE)

        def none() -> Iterator[bool]:
            """No case was taken, nor is this one."""
            return end(caller(), False, FALSE)

        def end(frame: int, is_taken: bool, answer: Iterator[bool]) -> Iterator[bool]:
            subject, _ = kept.pop(frame)
            try:
                log(subject, subject, is_taken)
            except BaseException as error:
                return raising(error)
            return answer

        self.offer(hold=hold, held=held, taken=taken, default=default, none=none)
        keep(self)
