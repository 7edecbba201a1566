"""Hides the hook from tracers, and passes on what a signal handler raises within it.

A debugger, a profiler and coverage see every Python frame. The functions of the hook are Python,
but CPython runs one kind of function with tracing off: a hook of ``sys.audit``. `Quiet` is a class
whose instances are made in C alone: ``Quiet(function, a, b)`` lets the audit hook call
``function(a, b)`` and keeps the iterator that it returns.

With an audit hook in Python every audit event of a process costs about 0.2 us more. So there is no
hook until the program imports a tracer or has one, and the sites change to `Quiet` only when it
begins to trace.
"""

from __future__ import annotations

import os
import sys
from functools import lru_cache, partial
from itertools import chain
from operator import attrgetter
from typing import TYPE_CHECKING, Any
from weakref import WeakSet

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterator
    from types import TracebackType

    # Returns an iterator whose next element is the function's result, or which raises.
    Function = Callable[..., Iterator[Any]]

_REPORT = "tpc.report"
_TRACING = frozenset({"sys.settrace", "sys.setprofile", "sys.monitoring.register_callback"})
# Few programs trace without one of these modules.
TRACERS = frozenset(
    {
        "_pydevd_bundle", "bdb", "cProfile", "coverage", "debugpy", "hunter", "line_profiler",
        "profile", "pydevd", "pyinstrument", "pysnooper", "trace", "viztracer", "yappi",
    }
)  # fmt: skip
_FOLDER = os.path.dirname(os.path.abspath(__file__))


def _method(function: Callable[..., Any]) -> Any:  # noqa: ANN401
    """A method in C: the wrapper of ``lru_cache`` is a C function that binds its object."""
    return lru_cache(maxsize=0)(function)


class Quiet:
    """``Quiet(function, *arguments)`` calls the function unseen, and keeps what it returns."""

    __slots__ = ("given",)
    __init__ = _method(partial(sys.audit, _REPORT))
    __iter__ = _method(attrgetter("given"))
    # The rewritten program calls `quiet.__next__()`.
    __next__ = property(attrgetter("given.__next__"))


def _hook(event: str, arguments: tuple[Any, ...]) -> None:
    if event == _REPORT:
        quiet, function, *rest = arguments
        try:
            quiet.given = function(*rest)
        except BaseException as error:
            quiet.given = raising(error)
    elif event in _TRACING:
        begin()


class _State:
    """Whether there is an audit hook, and whether calls go through it."""

    is_watching = False
    is_quiet = False


class Site:
    """The functions that a place calls, as attributes; each returns an iterator.

    Once tracing begins, `be_quiet` hides them.
    """

    __slots__ = ("__weakref__", "_names")

    def offer(self, **functions: Function) -> None:
        """Make these functions the attributes."""
        self._names = tuple(functions)
        for name, function in functions.items():
            setattr(self, name, hidden(function))
        _SITES.add(self)

    def be_quiet(self) -> None:
        """Hide them from tracers from now on."""
        for name in self._names:
            setattr(self, name, partial(Quiet, getattr(self, name)))


_SITES: WeakSet[Site] = WeakSet()


def hidden(function: Function) -> Function:
    """The function to call instead of ``function`` now."""
    return partial(Quiet, function) if _State.is_quiet else function


# The elements of the iterators in an iterator.
flat = chain.from_iterable


def watch() -> None:
    """Call this when the program has a tracer, or imports one."""
    if not _State.is_watching:
        _State.is_watching = True
        sys.addaudithook(_hook)
    if sys.gettrace() is not None or sys.getprofile() is not None:
        begin()


def watch_if_traced() -> None:
    """Call `watch` if a tracer started the interpreter, or is imported."""
    if sys.gettrace() is not None or sys.getprofile() is not None or TRACERS & sys.modules.keys():
        watch()


def begin() -> None:
    """Hide the functions of the hook from tracers from now on."""
    if not _State.is_quiet:
        _State.is_quiet = True
        for site in list(_SITES):
            site.be_quiet()


def caller() -> int:
    """The frame of the program that called the function which asks."""
    frame = sys._getframe(2)
    if frame.f_code is _hook.__code__ and frame.f_back is not None:
        frame = frame.f_back
    return id(frame)


# --- exceptions of signal handlers


def _nothing() -> Generator[None, None, None]:
    return
    yield


def raising(error: BaseException) -> Iterator[Any]:
    """An iterator that raises an outside error as if it came from the program's line.

    `throw` of a generator that has ended raises without a frame of its own.
    """
    error.__traceback__ = foreign_frames(error.__traceback__)
    over = _nothing()
    next(over, None)
    return map(over.throw, (error,))


def foreign_frames(traceback: TracebackType | None) -> TracebackType | None:
    """A traceback without its leading frames in this folder."""
    while traceback is not None:
        file = traceback.tb_frame.f_code.co_filename
        if os.path.dirname(os.path.abspath(file)) != _FOLDER:
            break
        traceback = traceback.tb_next
    return traceback


def is_programs(error: Exception) -> bool:
    """Whether an error raised in the hook comes neither from it nor from a function that it calls.

    It may be raised anywhere: by a signal handler of the program, as for a time-out, or by another
    thread.
    """
    import signal  # noqa: PLC0415

    handlers = set()
    for number in signal.valid_signals():
        handler: Any = signal.getsignal(number)
        handler = getattr(handler, "func", handler)
        for function in (handler, vars(type(handler)).get("__call__")):
            code = getattr(function, "__code__", None)
            if code is not None:
                handlers.add(code)
    traceback = error.__traceback__
    while traceback is not None:
        if traceback.tb_frame.f_code in handlers:
            return True
        traceback = traceback.tb_next
    is_plain = type(error).__module__ in ("builtins", "struct")
    return not is_plain and foreign_frames(error.__traceback__) is None
