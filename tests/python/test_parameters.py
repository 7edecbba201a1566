"""A person need not give a parameter's name as the analysis knows it."""

import pytest

from pytpc.static.parameters import same_parameter


@pytest.mark.parametrize(
    ("given", "source", "same"),
    [
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
    ],
)
def test_given_and_source(given: str, source: str, same: bool) -> None:
    assert same_parameter(given, source) == same
