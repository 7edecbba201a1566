"""What holds for all tests."""

from __future__ import annotations

import signal
from collections.abc import Iterator

import pytest
from hypothesis import HealthCheck, settings

from interpreters import tested_and_absent

# Started in the background (`make test &`) everything ignores Ctrl-C, and so does what is started
# here: the tests that interrupt a program would wait for ever.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# A machine that is busy makes examples slowly; that says nothing about what is tested.
settings.register_profile("busy", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("busy")


@pytest.fixture(autouse=True, scope="session")
def _own_runtime_folder(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Recordings that run in another test, or in a terminal of the user, are not found here."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_RUNTIME_DIR", str(tmp_path_factory.mktemp("runtime")))
        yield


@pytest.fixture(autouse=True)
def _signals_stay() -> Iterator[None]:
    """A handler that a test left would take the signals of the tests after it."""
    numbers = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    before = [signal.getsignal(number) for number in numbers]
    yield
    assert [signal.getsignal(number) for number in numbers] == before


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Say under which interpreters python_runtime was tested, if it was."""
    passed = [report.nodeid for report in terminalreporter.getreports("passed")]
    tested, absent = tested_and_absent(passed)
    if tested:
        lacking = f"; not on this machine: {', '.join(absent)}" if absent else ""
        terminalreporter.line(f"python_runtime ran under Python {', '.join(tested)}{lacking}")
