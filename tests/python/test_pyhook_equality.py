"""A program does the same with and without the hook.

Programs are made at random: every operand has a side effect, operands are numbers, texts, None,
NaN and objects whose comparison and truth are the program's own, and may raise.
"""

from __future__ import annotations

import numpy as np
from hook_samples import PATH, everywhere, outcome, taking, without_addresses
from hypothesis import HealthCheck, given, reject, settings
from hypothesis import strategies as st

OPERATORS = ["<", "<=", ">", ">=", "==", "!=", "is", "is not", "in", "not in"]

PRELUDE = '''\
log = []
class Odd:
    """Compares by its own code, gives objects without a truth, or raises."""
    def __init__(self, name, mode):
        self.name, self.mode = name, mode
    def _compare(self, how, other):
        log.append((how, self.name))
        if self.mode == "raise":
            raise ValueError(how + self.name)
        if self.mode == "odd":
            return Odd(self.name + "'", "plain")
        return self.mode == "plain"
    def __lt__(self, other): return self._compare("lt", other)
    def __le__(self, other): return self._compare("le", other)
    def __gt__(self, other): return self._compare("gt", other)
    def __ge__(self, other): return self._compare("ge", other)
    def __eq__(self, other): return self._compare("eq", other)
    def __ne__(self, other): return self._compare("ne", other)
    def __contains__(self, other): return self._compare("in", other)
    def __bool__(self):
        log.append(("bool", self.name))
        if self.mode == "raise":
            raise ValueError("bool" + self.name)
        return self.mode == "plain"
    def __repr__(self): return "Odd " + self.name
    __hash__ = None
def t(number, value):
    log.append(number)
    return value
nan = float("nan")
'''

VALUES = [
    "0", "1", "2.5", "-3", "nan", "True", "None", "'a'", "'b'", "(1, 2)", "[1]", "10**400",
    "Odd('p', 'plain')", "Odd('f', 'false')", "Odd('o', 'odd')", "Odd('r', 'raise')",
    "array([1, 2])", "float64(1.5)", "bool_(True)",
]  # fmt: skip

counter = st.integers(min_value=0, max_value=999)
value = st.builds(lambda number, text: f"t({number}, {text})", counter, st.sampled_from(VALUES))


def _comparison(operands: list[str], operators: list[str]) -> str:
    words = [operands[0]]
    for operator, operand in zip(operators, operands[1:], strict=False):
        words += [operator, operand]
    return f"({' '.join(words)})"


def _extended(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    operators = st.lists(st.sampled_from(OPERATORS), min_size=1, max_size=3)
    chain = st.builds(_comparison, st.lists(inner, min_size=4, max_size=4), operators)
    return st.one_of(
        chain,
        chain,
        chain,
        st.builds("({} and {})".format, inner, inner),
        st.builds("({} or {})".format, inner, inner),
        st.builds("(not {})".format, inner),
        st.builds("({} if {} else {})".format, inner, inner, inner),
        st.builds("t({}, (lambda: {})())".format, counter, inner),
        st.builds("[{} for x in (1, 2) if {}]".format, inner, inner),
        st.builds("next((y for y in [{}] if {}), 7)".format, inner, inner),
        st.builds("(w := {})".format, inner),
        st.builds("(yield {})".format, inner),
        st.builds("f'{{{}}}'".format, value),
    )


expression = st.recursive(value, _extended, max_leaves=8)


def _indented(text: str) -> str:
    return "\n".join("    " + line for line in text.splitlines())


statement = st.one_of(
    st.builds("log.append(repr({}))".format, expression),
    st.builds("if {}:\n    log.append('yes')\nelse:\n    log.append('no')".format, expression),
    st.builds(
        "n = 0\nwhile {} and n < 2:\n    n += 1\nelse:\n    log.append('end')".format,
        expression,
    ),
    st.builds("assert {}, {}".format, expression, expression),
    st.builds(
        "try:\n    x = ({}\n         < {})\nexcept ValueError as e:\n    log.append(str(e))".format,
        expression,
        expression,
    ),
    st.builds("match {}:\n    case 1 if {}:\n        log.append('one')".format, value, expression),
    st.builds("return {}".format, expression),
)
program = st.lists(statement, min_size=1, max_size=3).map(
    lambda parts: (
        f"{PRELUDE}def f():\n" + "\n".join(map(_indented, parts)) + "\n    yield\n"
        "for sent in f():\n    log.append(repr(sent))\n"
    )
)


def _names() -> dict[str, object]:
    return {
        "__name__": "program",
        "array": np.array,
        "float64": np.float64,
        "bool_": np.bool_,
    }


@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(program)
def test_a_program_does_the_same(source: str) -> None:
    plain, changed = _names(), _names()
    try:
        code = compile(source, PATH, "exec")
    except SyntaxError:
        # `yield` within a comprehension.
        reject()
    expected = outcome(code, plain)
    with taking():
        found = outcome(everywhere(source), changed)
    assert without_addresses(str(changed["log"])) == without_addresses(str(plain["log"]))
    assert found == expected
    # Nothing is added to the program's names.
    assert changed.keys() == plain.keys()


def test_a_program_with_its_own_exception_has_the_same_traceback() -> None:
    source = "def f(a, b):\n    return 1 < (a\n        < b)\nf(1, None)\n"
    expected = outcome(compile(source, PATH, "exec"), {})
    with taking():
        assert outcome(everywhere(source), {}) == expected
    # In line 2, from the `a` of `a < b` to line 3.
    assert expected[0][2][-1][:3] == ("f", 2, 3)
