"""A bounded share of the fuzzing of the readers; and the fuzzer sees what it is there to see."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fuzz import readers
from fuzz.reader_samples import EXTENSIONS, samples
from pytpc.ingest.bulk_lines import read_lines
from pytpc.ingest.rosout_line import Malformed, parse_stamped

INPUTS = range(60)
SHARE_S = 3.0


@pytest.mark.parametrize("reader", sorted(EXTENSIONS))
def test_changed_recordings(reader: str, tmp_path: Path) -> None:
    until = time.monotonic() + SHARE_S
    # However busy the machine is; more where there is time.
    tally = readers.run(reader, INPUTS, tmp_path)
    more = readers.run(reader, range(INPUTS.stop, 10**6), tmp_path, until=until)
    assert tally.findings + more.findings == []
    assert tally.inputs == len(INPUTS)
    assert min(tally.read, tally.refused + tally.events) > 0


@pytest.mark.parametrize("reader", sorted(EXTENSIONS))
def test_the_samples_themselves_are_read(reader: str, tmp_path: Path) -> None:
    every = list(samples(reader))
    assert every
    for number, data in enumerate(every):
        path = tmp_path / f"{number}{EXTENSIONS[reader]}"
        path.write_bytes(data)
        assert readers.read_input(path) > 0


def test_same_number_same_input() -> None:
    assert readers.make("tpc", 7) == readers.make("tpc", 7)
    assert readers.make("tpc", 7) != readers.make("tpc", 8)


def _fails(_: Path) -> int:
    raise IndexError("x")


def _hangs(_: Path) -> int:
    while True:
        time.sleep(0.01)


@pytest.mark.parametrize(("one", "finding"), [(_fails, "IndexError: x"), (_hangs, "than 1 s")])
def test_what_is_wrong_is_a_finding(one, finding, tmp_path, monkeypatch) -> None:
    monkeypatch.setattr(readers, "SECONDS", 1)
    tally = readers.run("csv", range(3, 4), tmp_path, one=one)
    assert len(tally.findings) == 1
    assert finding in tally.findings[0]
    assert (tmp_path / "csv-3.csv").read_bytes() == readers.make("csv", 3)


def test_memory_that_grows_is_a_finding(tmp_path, monkeypatch) -> None:
    peaks = iter([100.0, 101.0 + readers.GROWTH_MB])
    monkeypatch.setattr(readers, "_peak_mb", lambda: next(peaks))
    tally = readers.run("csv", range(3, 4), tmp_path, one=lambda _: 0)
    assert tally.findings == [f"csv 3: {readers.GROWTH_MB + 1} MB of memory"]


PIECES = (
    *("1.5", "1700000000.1234567", ",", "0a1b2c3d-0000-5000-8000-00000000000F", "0", "True"),
    *(",cmp:", ",thresh:", ",res:", "1e5", "-inf", "nan", "+.5e-3", "1.", "1e999", " ", "\r"),
    *("9999999999.9", '"', "\t", "infinity", "0x1p3", "\N{ARABIC-INDIC DIGIT THREE}"),
)
LINE = st.lists(st.sampled_from(PIECES), max_size=12).map("".join)
REPORT = st.tuples(
    st.sampled_from(["1.5", "1700000000.1234567", "9999999999.9", "1", ""]),
    st.sampled_from(
        ["0a1b2c3d-0000-5000-8000-00000000000F", "0A1b2c3d-0000-5000-8000-00000000000f"]
    ),
    st.sampled_from(["0", "1", "True", "False", "2", "true"]),
    *[st.floats().map(repr) | st.sampled_from(["1e999", "+1", ".5", "1.", "-nan", "", "1_0"])] * 2,
    st.sampled_from(["0", "1", "True", "1 ", ""]),
).map(lambda part: "{},{},{},cmp:{},thresh:{},res:{}".format(*part))


# The quick way and the strict way must agree about every line.
@given(st.lists(REPORT | LINE, min_size=1, max_size=40))
@settings(deadline=None, max_examples=200)
def test_many_at_once_as_one_by_one(lines: list[str]) -> None:
    lines = [line.replace("\n", "") for line in lines]
    seen = []
    for part in read_lines([line.encode() for line in lines], stamped=True):
        if isinstance(part, int):
            seen.append(part)
            continue
        for row, number in enumerate(range(part.begin, part.end)):
            seen.append(number)
            found = parse_stamped(lines[number])
            assert not isinstance(found, Malformed), lines[number]
            assert part.time_ns is not None
            time_ns, report = found
            assert time_ns == part.time_ns[row]
            assert report.key == part.keys[part.key[row]]
            assert (report.result, report.res) == (part.result[row], part.res[row])
            assert repr(report.cmp) == repr(float(part.cmp[row]))
            assert repr(report.thresh) == repr(float(part.thresh[row]))
    assert seen == list(range(len(lines)))
