"""The text of a report: what is read, and what is said of everything else."""

from __future__ import annotations

import math
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mission_samples import line

from pytpc.ingest.rosout_line import PREFIX, Malformed, parse_report, parse_stamped
from pytpc.recording.events import Report

K = "0a1b2c3d-0000-5000-8000-00000000000F"
LOW = K.lower()


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (f"{K},1,cmp:0.25,thresh:3,res:0", Report(LOW, True, 0.25, 3.0, False)),
        (
            f"{K},False,cmp:1e-05,thresh:-1.5e+300,res:True",
            Report(LOW, False, 1e-5, -1.5e300, True),
        ),
        (f"{K},0,cmp:inf,thresh:-inf,res:0", Report(LOW, False, math.inf, -math.inf, False)),
        (f"{K},0,cmp:1.0000001,thresh:1,res:0\n", Report(LOW, False, 1.0000001, 1.0, False)),
        (f"{K},1,cmp:5e-324,thresh:.5,res:1", Report(LOW, True, 5e-324, 0.5, True)),
    ],
)
def test_reports(text, expected):
    assert parse_report(PREFIX + text) == expected


def test_nan():
    for text in ("nan", "-nan"):
        report = parse_report(f"{PREFIX}{K},1,cmp:{text},thresh:nan,res:1")
        assert isinstance(report, Report)
        assert math.isnan(report.cmp)
        assert math.isnan(report.thresh)


@pytest.mark.parametrize(
    "text",
    ["", "took a picture", f" {PREFIX}{K},1", "threshold_information", "Threshold_information:"],
)
def test_other_log_messages_are_no_reports(text):
    assert parse_report(text) is None


# The prefix has 22 characters, so the key begins in column 23 and ends in column 58.
@pytest.mark.parametrize(
    ("rest", "what", "column"),
    [
        ("", "a key (a UUID) is expected", 23),
        ("not-a-key,1,cmp:1,thresh:1,res:1", "a key (a UUID) is expected", 23),
        (f"{K}", '"," is expected after a key (a UUID)', 59),
        (f"{K},2,cmp:1,thresh:1,res:1", "a result (0, 1, True or False) is expected", 60),
        (f"{K},true,cmp:1,thresh:1,res:1", "a result (0, 1, True or False) is expected", 60),
        (f"{K},1,cmp:,thresh:1,res:1", "cmp as a number is expected", 66),
        (f"{K},1,cmp:1_0,thresh:1,res:1", '",thresh:" is expected after cmp as a number', 67),
        (f"{K},1,cmp:0x10,thresh:1,res:1", '",thresh:" is expected after cmp as a number', 67),
        (f"{K},1,cmp:infinity,thresh:1,res:1", '",thresh:" is expected after cmp as a number', 69),
        (f"{K},1,cmp:\u0661,thresh:1,res:1", "cmp as a number is expected", 66),
        (f"{K},1,cmp:1e999,thresh:1,res:1", "a number is beyond the range of a double", 66),
        (f"{K},1,cmp:1,thresh:-1e999,res:1", "a number is beyond the range of a double", 75),
        (f"{K},1,cmp:1,thresh:1,res:", "res (0, 1, True or False) is expected", 81),
        (f"{K},1,cmp:1,thresh:1,res:1,more", "the line goes on after res", 82),
        (f"{K},1,cmp:1,thresh:1,res:1\nres:1", "the line goes on after res", 82),
    ],
)
def test_malformed_reports_say_what_and_where(rest, what, column):
    assert parse_report(PREFIX + rest) == Malformed(what, column)


def test_stamped_reports():
    text = f"1700000000.1234567,{K},True,cmp:1,thresh:2,res:False"
    expected = Report(LOW, True, 1.0, 2.0, False)
    # A float of seconds would lose the last digits; the text does not.
    assert parse_stamped(text) == (1700000000123456700, expected)
    assert parse_stamped(text.replace("1700000000", "0")) == (123456700, expected)
    assert parse_stamped("took a picture") == Malformed("a time in seconds is expected", 1)
    assert parse_stamped(f"12,{K},1") == Malformed("a time in seconds is expected", 1)
    assert parse_stamped(f"1.0,{K},1") == Malformed(
        '",cmp:" is expected after a result (0, 1, True or False)', 43
    )


@given(st.booleans(), st.floats(), st.floats(), st.booleans())
def test_what_is_written_reads_back(result, cmp, thresh, res):
    text = f"{PREFIX}{LOW},{int(result)},cmp:{cmp!r},thresh:{thresh!r},res:{int(res)}"
    found = parse_report(text)
    assert isinstance(found, Report)
    # repr, so that NaN equals NaN and -0.0 differs from 0.0.
    assert repr(found) == repr(Report(LOW, result, cmp, thresh, res))


@given(st.text())
def test_no_text_makes_the_parser_fail(text):
    assert parse_report(text) is None or text.startswith(PREFIX)
    assert isinstance(parse_report(PREFIX + text), Malformed)
    assert isinstance(parse_stamped(text), Malformed)


# 200,000 lines in a second of processor time: a million in 5 s would still be fast enough.
def test_parsing_is_fast():
    lines = [line(n % 50, n % 2, n / 7, 0.5) for n in range(200_000)]
    started = time.process_time()
    assert all(type(parse_report(text)) is Report for text in lines)
    assert time.process_time() - started < 5
