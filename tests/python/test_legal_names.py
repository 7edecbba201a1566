"""Names for viewers: legal whatever they were made of, and never the same twice."""

from __future__ import annotations

import re

from hypothesis import given
from hypothesis import strategies as st

from pytpc.base.legal_names import LegalNames

LEGAL = re.compile(r"(/[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*)+")


@given(st.lists(st.lists(st.text(max_size=300), min_size=1, max_size=4), max_size=20))
def test_any_names_are_legal_and_differ(found: list[list[str]]) -> None:
    names = LegalNames()
    made = [names.take("tpc", *parts) for parts in found]
    assert len(set(made)) == len(made)
    assert all(LEGAL.fullmatch(one) and len(one) < 220 for one in made)


def test_a_number_does_not_meet_a_name_that_has_one() -> None:
    names = LegalNames()
    made = [names.take(one) for one in ("a_2", "a", "a", "a.", "a_2")]
    assert made == ["/a_2", "/a", "/a_3", "/a_4", "/a_2_2"]
