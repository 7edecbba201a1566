"""A program does the same with and without the hook: see `hook_programs`."""

from __future__ import annotations

from hook_programs import difference
from hook_samples import PATH, everywhere, outcome, taking
from hypothesis import given, settings
from hypothesis import strategies as st


@settings(max_examples=300, deadline=None)
@given(st.integers(min_value=0, max_value=2**40))
def test_a_program_does_the_same(seed: int) -> None:
    assert not difference(seed)


def test_a_program_with_its_own_exception_has_the_same_traceback() -> None:
    source = "def f(a, b):\n    return 1 < (a\n        < b)\nf(1, None)\n"
    expected = outcome(compile(source, PATH, "exec"), {})
    with taking():
        assert outcome(everywhere(source), {}) == expected
    # In line 2, from the `a` of `a < b` to line 3.
    assert expected[0][2][-1][:3] == ("f", 2, 3)
