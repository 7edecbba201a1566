"""Numbers as a person writes them; each expectation is what somebody would have typed."""

from __future__ import annotations

import math
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from pytpc.base.wording import exact, show, tidy


# 0.65 less 74 steps of 1e-16; a tenth summed up ten times; 0.2, 1/8 and 1e-5 as floats of 32 bits.
@pytest.mark.parametrize(
    ("value", "written"),
    [
        (-0.6499999999999926, "-0.65"),
        (0.1 + 0.2, "0.3"),
        (sum([0.1] * 10), "1"),
        (struct.unpack("f", struct.pack("f", 0.2))[0], "0.2"),
        (struct.unpack("f", struct.pack("f", -1.57))[0], "-1.57"),
        (struct.unpack("f", struct.pack("f", 1e-5))[0], "1e-05"),
        (0.125, "0.125"),
        (1234567.0, "1234567"),
        (1234567, "1234567"),
        (12345678.25, "12345678"),
        (-0.0, "0"),
        (1e16, "1e+16"),
        (math.nan, "nan"),
        (-math.inf, "-inf"),
        (True, "true"),
        (None, "?"),
    ],
)
def test_numbers_are_shown_as_they_were_written(value, written):
    assert show(value) == written


# 1/3 has no short form: it stays what it is. A step of 1e-9 is more than noise.
@pytest.mark.parametrize("value", [1 / 3, 0.65 + 1e-9, 16777217.5, 3, True])
def test_what_is_no_noise_stays(value):
    assert tidy(value) == value
    assert type(tidy(value)) is type(value)


@given(st.decimals(min_value=-1000, max_value=1000, places=4), st.integers(-20, 20))
def test_noise_of_a_few_last_digits_goes(written, steps):
    value = float(written)
    noisy = value
    for _ in range(abs(steps)):
        noisy = math.nextafter(noisy, math.copysign(math.inf, steps))
    if value:
        assert tidy(noisy) == value
        single = struct.unpack("f", struct.pack("f", value))[0]
        assert float(show(single)) == float(f"{value:.6g}")


@given(st.floats(allow_nan=False))
def test_what_is_exact_reads_as_the_same_number(value):
    assert float(exact(value)) == value


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_tidy_number_means_the_same(value):
    found = tidy(value)
    assert math.isclose(found, value, rel_tol=1e-7)
    assert tidy(found) == found
