"""A person need not give a parameter's name as the analysis knows it."""

import pytest

from pytpc.static.parameters import ByParameter, same_parameter

CASES = (
    ("limit", "limit", True),
    ("limit", "~limit", True),
    ("~limit", "limit", True),
    ("/mission/limit", "~limit", True),
    ("/mission/limit", "limit", True),
    ("/mission/limit", "/mission/limit", True),
    ("arm/limit", "~arm/limit", True),
    ("limit", "arm/limit", False),
    ("limits", "~limit", False),
    ("limit", "~limits", False),
    ("/arm/limit", "/leg/limit", False),
    ("wheel_left/limit", "wheel_<dynamic>/limit", True),
    ("wheel_<dynamic>/limit", "~wheel_<dynamic>/limit", True),
    ("wheel_/limit", "wheel_<dynamic>/limit", False),
    ("limit", "<dynamic>/limit", True),
    ("limit", "<dynamic>", False),
    ("<dynamic>", "<dynamic>", True),
    ("l.mit", "limit", False),
    ("limit", "l.mit", False),
)


@pytest.mark.parametrize(("given", "source", "same"), CASES)
def test_given_and_source(given: str, source: str, same: bool) -> None:
    assert same_parameter(given, source) == same


# The index finds what a look at each name would have found, in the order of the names.
@pytest.mark.parametrize("given", sorted({given for given, _, _ in CASES} | {"", "/", "~"}))
def test_an_index_finds_the_same(given: str) -> None:
    sources = [source for _, source, _ in CASES] + ["", "~", "~wheel_<dynamic>"]
    assert ByParameter(sources, str).meant(given) == [
        source for source in sources if same_parameter(given, source)
    ]
