"""What a signal handler raises in the middle of a report, the program's own line raises."""

from __future__ import annotations

import signal
import textwrap
import traceback

import pytest
from hook_samples import PATH, instrumented, listed
from test_python_runtime_file import files, recording, rows, run

from pytpc.python_runtime import sites


class Late(Exception):
    """The error that a handler of SIGALRM raises."""


def raising(*_: object) -> None:
    """Like a handler that runs within the report."""
    raise Late


@pytest.mark.parametrize(
    ("source", "place"),
    [
        ("a = 1\nb = a < 2\n", (2, 5, "<")),
        ("a = 'x'\nb = a < 'y'\n", (2, 5, "<")),
        ("a = 1\nb = 0 < a < 2\n", (2, 5, ">")),
        ("a = 1\nif a: pass\n", (2, 4, "flag")),
        ("a = 1\nb = a or 2\n", (2, 5, "flag")),
        ("a = 1\nfor b in range(a): pass\n", (2, 10, "<")),
        ("a = 1\nmatch a:\n    case 1: pass\n", (2, 7, "flag")),
    ],
)
def test_what_a_handler_raises_comes_from_the_programs_line(source, place) -> None:
    before, handler = sites._take, signal.signal(signal.SIGUSR1, raising)
    sites.set_take(raising)
    try:
        with pytest.raises(Late) as caught:
            exec(instrumented(source, listed(*place)), {})
    finally:
        sites.set_take(before)
        signal.signal(signal.SIGUSR1, handler)
    frames = traceback.extract_tb(caught.value.__traceback__)
    # The test, the program, the handler.
    assert [frame.filename for frame in frames[1:]] == [PATH, __file__]


def test_every_time_out_reaches_the_program_and_no_report_is_hidden(tmp_path) -> None:
    done = run(
        tmp_path,
        """
        import signal
        class Late(Exception): pass
        made = caught = 0
        def late(*_):
            global made
            made += 1
            raise Late
        one, done = site("one"), [0]
        # The file is there before the first time-out comes.
        over(one, 0, 0)
        signal.signal(signal.SIGALRM, late)
        number = 0
        while made < 500:
            try:
                signal.setitimer(signal.ITIMER_REAL, 0.0002)
                while True:
                    number += 1
                    over(one, number, 0)
                    done.append(number)
            except Late:
                caught += 1
        signal.setitimer(signal.ITIMER_REAL, 0)
        assert caught == made, (caught, made)
        print(*done)
        """,
    )
    assert done.returncode == 0, done.stderr
    found = [int(cmp) for _, _, cmp, _ in rows(tmp_path)]
    # Of a comparison that was broken off there may be a report or none.
    assert found == sorted(set(found))
    assert set(map(int, done.stdout.split())) <= set(found)
    assert recording(tmp_path).malformed == 0


# Reports `two` after some steps of the runtime, as a handler of a signal may that comes there.
INTERRUPT = """
import pytpc.python_runtime
root = pytpc.python_runtime.__path__[0]
def interrupt(*gaps):
    left, steps, number = list(gaps), 0, 0
    def step(frame, event, arg):
        nonlocal steps, number
        if event == "opcode":
            steps += 1
            if steps == left[0]:
                del left[0]
                steps, number = 0, number + 1
                if not left:
                    sys.settrace(None)
                over(two, number, 0)
        return step
    def call(frame, event, arg):
        # What is skipped here is called for each report.
        if not frame.f_code.co_filename.startswith(root) or frame.f_code.co_name in skipped:
            return None
        frame.f_trace_opcodes, frame.f_trace_lines = True, False
        return step
    # Python 3.12 traces opcodes only where a frame has asked for them before.
    sys._getframe().f_trace_opcodes = True
    sys.settrace(call)
    return left
"""


@pytest.mark.usefixtures("python")
def test_reports_between_the_steps_of_the_first_one(tmp_path) -> None:
    program = INTERRUPT + textwrap.dedent("""
        import random
        skipped, random = (), random.Random(1)
        at, is_inside = 0, True
        while is_inside:
            at += 7
            one, two = site("one"), site("two")
            child = os.fork()
            if not child:
                left = interrupt(at, random.randrange(1, 400), random.randrange(1, 400))
                for number in range(3):
                    over(one, number, 0)
                sys.settrace(None)
                RUNTIME.end()
                os._exit(len(left) < 3)
            is_inside = os.waitpid(child, 0)[1] != 0
        """)
    done = run(tmp_path, program)
    assert (done.returncode, done.stderr) == (0, "")
    assert len(files(tmp_path)) > 100
    found = recording(tmp_path)
    assert (found.malformed, found.lost) == (0, {})


@pytest.mark.usefixtures("python")
def test_reports_between_the_steps_in_which_a_chunk_begins(tmp_path) -> None:
    program = INTERRUPT + textwrap.dedent("""
        skipped = ("take", "compare", "over")
        number = reports = 0
        for at in range(1, 600):
            one, two = site("one"), site(f"two{at}")
            over(one, number, 0)
            # The second in which the clocks are compared again.
            RUNTIME.file._sync_at = RUNTIME.file._look_at = 0
            left = interrupt(at)
            for number in range(number + 1, number + 2048):
                over(one, number, 0)
            sys.settrace(None)
            number, reports = number + 1, reports + (not left)
        print(reports, number)
        """)
    done = run(tmp_path, program)
    assert (done.returncode, done.stderr) == (0, "")
    interrupted, made = map(int, done.stdout.split())
    assert interrupted > 100
    found = recording(tmp_path)
    assert (found.malformed, found.lost) == (0, {})
    assert [cmp for key, _, cmp, _ in rows(tmp_path) if key == "one"] == list(range(made))
    nested = sum(dropped.count for dropped in found.dropped if dropped.why == "nested")
    assert len(found.events) + nested == made + interrupted


def test_a_report_while_the_first_one_opens_the_file(tmp_path) -> None:
    done = run(
        tmp_path,
        """
        one, real, start, starts = site("one"), os.posix_fallocate, RUNTIME.start, []
        def fallocate(*words):
            # As a signal's handler that comes in the middle.
            over(one, 1, 0)
            return real(*words)
        def counted():
            starts.append(1)
            start()
        RUNTIME.start = counted
        os.posix_fallocate = fallocate
        over(one, 2, 0)
        over(one, 3, 0)
        # It is tried again by each report until there is a file, and no more often.
        assert len(starts) < 10, len(starts)
        """,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert [cmp for _, _, cmp, _ in rows(tmp_path)] == [2.0, 3.0]


def test_ctrl_c_while_the_first_report_opens_the_file(tmp_path) -> None:
    done = run(
        tmp_path,
        """
        one, real = site("one"), os.posix_fallocate
        def fallocate(*words):
            os.posix_fallocate = real
            raise KeyboardInterrupt
        os.posix_fallocate = fallocate
        try:
            over(one, 1, 0)
        except KeyboardInterrupt:
            print("stopped")
        over(one, 2, 0)
        """,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "stopped\n", "")
    assert [cmp for _, _, cmp, _ in rows(tmp_path)] == [2.0]
    assert len(files(tmp_path)) == 1


def test_ctrl_c_while_a_key_is_written(tmp_path) -> None:
    done = run(
        tmp_path,
        """
        one, two = site("one"), site("two")
        over(one, 1, 0)
        file = RUNTIME.file
        class Words:
            def __setitem__(self, at, what): raise KeyboardInterrupt
        words, file._system.extent.words = file._system.extent.words, Words()
        try:
            over(two, 2, 0)
        except KeyboardInterrupt:
            file._system.extent.words = words
        over(two, 3, 0)
        """,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert [(key, cmp) for key, _, cmp, _ in rows(tmp_path)] == [("one", 1.0), ("two", 3.0)]
    assert recording(tmp_path).malformed == 0
