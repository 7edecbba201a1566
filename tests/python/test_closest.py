"""Names that a user most likely meant."""

import pytest

from pytpc.base.closest import closest, did_you_mean

# SequenceMatcher's ratio is 2 M / T: M characters in common, T characters in both names.


@pytest.mark.parametrize(
    ("name", "known", "meant"),
    [
        ("rnk", ["rank", "mark"], ["rank"]),  # 6/7; mark has "rk": 4/7 < 0.6
        ("LIMIT", ["limit"], ["limit"]),
        ("~limi", ["/arm/limit", "/arm/speed"], ["/arm/limit"]),  # by the last part: 8/9
        ("/arm/limi", ["/leg/limit", "/arm/limit"], ["/arm/limit"]),
        ("/left/arm/nothing", ["/left/arm/limit"], []),  # only the node is the same
        ("limit", ["limit_a", "limit_b", "speed"], ["limit_a", "limit_b"]),  # 10/12 each
        ("zzz", ["rank"], []),
        ("", ["rank"], []),
        ("x" * 10_000, ["x" * 10_000], []),
    ],
)
def test_closest(name: str, known: list[str], meant: list[str]):
    assert closest(name, known) == meant


def test_three_at_most_and_in_words():
    assert closest("limit", ["limit1", "limit2", "limit3", "limit4"]) == [
        "limit1",
        "limit2",
        "limit3",
    ]
    assert did_you_mean("limit", ["limit1", "limit2"]) == "; did you mean limit1 or limit2?"
    assert (
        did_you_mean("limit", ["limit\x1b1"]) == "; did you mean limit\N{REPLACEMENT CHARACTER}1?"
    )
