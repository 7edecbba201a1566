"""The time that an analysis may take, and the description of an internal error."""

from __future__ import annotations

import ast
import ctypes
import threading
import time
import traceback
from pathlib import Path

from pytpc.python_analysis.ir.instructions import Instr

_ARRIVAL_S = 1.0
SECONDS = 120.0
"""The budget of a link unit, as in C++ (``TPC_MAX_SECONDS``)."""


class BudgetSpentError(BaseException):
    """The time is over. It is not an ``Exception``, so that no analysis catches it."""


class Budget:
    """Ends its ``with`` block by a `BudgetSpentError` once the time is over.

    A timer raises it in the working thread, so that every loop of every analysis ends without
    checking the time.
    """

    def __init__(self, seconds: float) -> None:
        """``seconds`` of wall-clock time; 0 is no limit."""
        self._seconds = seconds
        self._lock = threading.Lock()
        self._is_working = False
        self._is_over = False
        self._thread = 0
        self._timer: threading.Timer | None = None

    def __enter__(self) -> Budget:
        self._thread = threading.get_ident()
        self._is_working = True
        if self._seconds > 0:
            self._timer = threading.Timer(self._seconds, self._end)
            self._timer.daemon = True
            self._timer.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        """Stop counting. Wait for an error that was raised and has not arrived yet, and drop it.

        Cancelling it by ``PyThreadState_SetAsyncExc(thread, NULL)`` makes CPython 3.11 check for
        errors forever, and then a traced program stands still.
        """
        try:
            with self._lock:
                self._is_working = False
                if self._timer is not None:
                    self._timer.cancel()
            limit = time.monotonic() + _ARRIVAL_S
            while self._is_over and kind is not BudgetSpentError and time.monotonic() < limit:
                time.sleep(0)
        except BudgetSpentError:
            pass

    def _end(self) -> None:
        with self._lock:
            if self._is_working:
                self._is_over = True
                ctypes.pythonapi.PyThreadState_SetAsyncExc(
                    ctypes.c_ulong(self._thread), ctypes.py_object(BudgetSpentError)
                )


def what_failed(error: BaseException) -> str:
    """An internal error in one line: what it is, where it was raised, and for which source line."""
    if isinstance(error, RecursionError):
        what = "expressions or statements are nested too deeply"
    elif isinstance(error, MemoryError):
        what = "not enough memory"
    else:
        frame = traceback.extract_tb(error.__traceback__)[-1]
        inside = f" in {Path(frame.filename).name}:{frame.lineno}"
        said = " ".join(str(error).split())
        what = f"an error of the analysis: {type(error).__name__}{inside}"
        what += f": {said[:120]}" if said else ""
    place = place_of(error)
    return f"{place}: {what}" if place else what


def place_of(error: BaseException) -> str | None:
    """``file:line`` of the user's source that was analysed when an error was raised, if known.

    It is the place of an instruction among the variables of the innermost frame that has one.
    """
    tracebacks = []
    trace = error.__traceback__
    while trace is not None:
        tracebacks.append(trace)
        trace = trace.tb_next
    for trace in reversed(tracebacks):
        values = list(trace.tb_frame.f_locals.values())
        path = next((each for each in map(_module_path, values) if each), None)
        if path is None:
            continue
        line = next((each for each in map(_line, values) if each), None)
        return path if line is None else f"{path}:{line}"
    return None


def _module_path(value: object) -> str | None:
    if isinstance(value, Instr):
        return value.function.module.path
    module = getattr(value, "module", None)
    path = getattr(module, "path", None)
    return path if isinstance(path, str) else None


def _line(value: object) -> int | None:
    node = value.node if isinstance(value, Instr) else value
    return getattr(node, "lineno", None) if isinstance(node, ast.AST) else None
