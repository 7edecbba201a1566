"""What a signal does to processes that this one started."""

from __future__ import annotations

import signal
import subprocess

import pytest

from pytpc.base.signals import running


def program(*command):
    return lambda: subprocess.Popen(command, start_new_session=True)


# The signal comes when the process is there, and nobody knows it yet.
def test_a_signal_while_a_process_starts_ends_it():
    started = []

    def start():
        started.append(program("sleep", "600")())
        signal.raise_signal(signal.SIGINT)
        return started[0]

    with pytest.raises(KeyboardInterrupt), running(start, 60.0, 60.0):
        pytest.fail("the signal was lost")
    assert [one.poll() for one in started] == [-signal.SIGINT]
    assert signal.getsignal(signal.SIGINT) == signal.default_int_handler


def test_what_ended_by_itself_keeps_its_status():
    with running(program("sh", "-c", "exit 3"), 60.0, 60.0) as process:
        process.wait()
    assert process.returncode == 3


def test_a_program_that_does_not_exist_leaves_the_signals_as_they_were():
    before = signal.getsignal(signal.SIGTERM)
    with pytest.raises(FileNotFoundError), running(program("/no/such/program"), 1.0, 1.0):
        pass
    assert signal.getsignal(signal.SIGTERM) == before
