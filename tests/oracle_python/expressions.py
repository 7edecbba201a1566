"""Random numbers and conditions as Python writes them."""

from __future__ import annotations

import random

from oracle_python.scope import Scope

_SIGNS = ("<", "<=", ">", ">=", "==", "!=")
_TEXTS = ("slow", "fast", "off")


class Expressions:
    """Makes expressions over what a scope has."""

    def __init__(self, seed: int) -> None:
        """The same program for the same seed."""
        self.random = random.Random(seed)
        self.names = 0
        self.parameters = 0

    def fresh(self, prefix: str) -> str:
        """A name that nothing else has."""
        self.names += 1
        return f"{prefix}{self.names}"

    def chance(self, probability: float) -> bool:
        """True as often as that."""
        return self.random.random() < probability

    def one_of(self, choices: list[str]) -> str:
        """Any of them."""
        return self.random.choice(choices)

    # Numbers

    def read(self) -> str:
        """A parameter read."""
        self.parameters += 1
        name = f"~p{self.parameters}"
        return self.one_of(
            [
                f'rospy.get_param("{name}", 1.0)',
                f'rospy.get_param("{name}")',
                f'rospy.get_param("~" + "p{self.parameters}", 2.0)',
                f'rospy.get_param("~table{self.parameters}")["low"]',
            ]
        )

    def literal(self) -> str:
        """A constant."""
        return str(round(self.random.uniform(-5, 5), 1))

    def number(self, scope: Scope, depth: int = 0) -> str:
        """A number."""
        if depth >= 2 or self.chance(0.5):
            return self.one_of(scope.numbers) if self.chance(0.85) else self.literal()
        kind = self.random.randrange(20)
        make = getattr(self, f"_number_{kind}", None)
        return make(scope, depth + 1) if make else self.one_of(scope.numbers)

    def _number_0(self, scope: Scope, depth: int) -> str:
        sign = self.one_of(["+", "-", "*"])
        return f"({self.number(scope, depth)} {sign} {self.literal()})"

    def _number_1(self, scope: Scope, depth: int) -> str:
        yes, no = self.number(scope, depth), self.number(scope, depth)
        return f"({yes} if {self.condition(scope, depth)} else {no})"

    def _number_2(self, scope: Scope, depth: int) -> str:
        word = self.one_of(["or", "and"])
        return f"({self.one_of(scope.numbers)} {word} {self.number(scope, depth)})"

    def _number_3(self, scope: Scope, depth: int) -> str:
        return self.call(scope, depth)

    _number_4 = _number_5 = _number_6 = _number_3

    def _number_7(self, scope: Scope, depth: int) -> str:
        return f"(lambda q, r={self.number(scope, depth)}: r)({self.number(scope, depth)})"

    def _number_8(self, scope: Scope, depth: int) -> str:
        name = self.fresh("q")
        inner = scope.inner()
        inner.numbers = [name, *inner.numbers[-3:]]
        inner.calls = []
        return f"(lambda {name}: {self.number(inner, depth)})({self.number(scope, depth)})"

    def _number_9(self, scope: Scope, depth: int) -> str:
        return f"{self.one_of(scope.lists)}[-1]" if scope.lists else self.literal()

    def _number_10(self, scope: Scope, depth: int) -> str:
        if not scope.tables:
            return self.literal()
        table = self.one_of(scope.tables)
        return self.one_of([f'{table}["a"]', f'{table}["b"]', f'{table}.get("a", 1.0)'])

    def _number_11(self, scope: Scope, depth: int) -> str:
        word = self.one_of(["min", "max"])
        return f"{word}({self.number(scope, depth)}, {self.literal()})"

    def _number_12(self, scope: Scope, depth: int) -> str:
        return f"float({self.number(scope, depth)})"

    def _number_13(self, scope: Scope, depth: int) -> str:
        at = self.random.randrange(2)
        return f"({self.number(scope, depth)}, {self.number(scope, depth)})[{at}]"

    def _number_14(self, scope: Scope, depth: int) -> str:
        first, second = self.number(scope, depth), self.number(scope, depth)
        key = self.one_of(["low", "high"])
        return f'{{"low": {first}, "high": {second}}}["{key}"]'

    def _number_15(self, scope: Scope, depth: int) -> str:
        name = self.fresh("e")
        return f"[{name} for {name} in ({self.number(scope, depth)},)][0]"

    def _number_16(self, scope: Scope, depth: int) -> str:
        return f"abs({self.number(scope, depth)})"

    def _number_17(self, scope: Scope, depth: int) -> str:
        return f"-{self.one_of(scope.numbers)}"

    def call(self, scope: Scope, depth: int) -> str:
        """A call of the program's own."""
        if not scope.calls:
            return self.one_of(scope.numbers)
        pattern = self.one_of(scope.calls)
        return pattern.format(self.number(scope, depth), self.number(scope, depth))

    # Conditions

    def condition(self, scope: Scope, depth: int = 0) -> str:
        """What decides."""
        kind = self.random.randrange(16)
        if depth >= 2 or kind < 7:
            return self.comparison(scope, depth)
        match kind:
            case 7 | 8:
                word = self.one_of(["and", "or"])
                return f"({self.condition(scope, depth + 1)} {word} {self.condition(scope, depth + 1)})"
            case 9:
                return f"not {self.condition(scope, depth + 1)}"
            case 10:
                return self.one_of(scope.truths or scope.numbers)
            case 11:
                return self.one_of(scope.numbers)
            case 12 if scope.lists:
                name = self.fresh("e")
                inner = scope.inner()
                inner.numbers = [name, *inner.numbers]
                word = self.one_of(["any", "all"])
                of = self.one_of(scope.lists)
                return f"{word}({self.comparison(inner, 2)} for {name} in {of})"
            case 13:
                return f"({self.number(scope, 2)} < {self.number(scope, 2)} <= {self.number(scope, 2)})"
            case 14 if scope.texts:
                return f'{self.one_of(scope.texts)} {self.one_of(["==", "!="])} {self.text(scope)}'
            case 15:
                name = self.fresh("w")
                sign = self.one_of(list(_SIGNS))
                return f"({name} := {self.number(scope, depth + 1)}) {sign} {self.number(scope, 2)}"
            case _:
                return self.comparison(scope, depth)

    def text(self, scope: Scope) -> str:
        """A text."""
        if self.chance(0.4):
            return self.one_of(scope.texts)
        return f'"{self.random.choice(_TEXTS)}"'

    def comparison(self, scope: Scope, depth: int) -> str:
        """Two numbers compared."""
        left, right = self.number(scope, depth), self.number(scope, depth)
        return f"{left} {self.one_of(list(_SIGNS))} {right}"
