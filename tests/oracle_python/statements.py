"""Random statements."""

from __future__ import annotations

from oracle_python.expressions import Expressions
from oracle_python.scope import Lines, Scope

_FAULTS = ("Fault", "Worse", "helpers.Other", "ValueError")


class Statements(Expressions):
    """Writes statements into ``lines``."""

    def __init__(self, seed: int) -> None:
        """An empty module."""
        super().__init__(seed)
        self.lines = Lines()

    def body(self, scope: Scope, most: int = 4, depth: int = 0) -> None:
        """Some statements."""
        for _ in range(self.random.randint(1, max(1, most - depth))):
            self.statement(scope, depth)

    def _block(self, head: str, scope: Scope, depth: int) -> None:
        with self.lines.block(head):
            self.body(scope.inner(), 3, depth + 1)

    def statement(self, scope: Scope, depth: int) -> None:
        """One statement; ``depth`` is that of blocks around it."""
        simple = ("assign", "assign", "local", "local", "publish", "publish", "truth", "store", "call")
        compound = ("if", "if", "if", "if", "while", "for", "try", "with", "unpack", "comprehension",
                    "closure", "match", "leave", "leave", "list")  # fmt: skip
        pool = simple if depth >= 3 else simple + compound
        getattr(self, f"_do_{self.random.choice(pool)}")(scope, depth)

    # Simple ones

    def _do_assign(self, scope: Scope, depth: int) -> None:
        if not scope.targets:
            return
        target = self.one_of(scope.targets)
        if self.chance(0.2):
            self.lines.add(f"{target} {self.one_of(['+=', '-='])} {self.literal()}")
        else:
            self.lines.add(f"{target} = {self.number(scope)}")

    def _do_local(self, scope: Scope, depth: int) -> None:
        name = self.fresh("v")
        self.lines.add(f"{name} = {self.number(scope)}")
        scope.numbers.append(name)
        scope.targets.append(name)

    def _do_publish(self, scope: Scope, depth: int) -> None:
        self.lines.add(f"{self.one_of(scope.publishers)}.publish({self.number(scope, 1)})")

    def _do_truth(self, scope: Scope, depth: int) -> None:
        name = self.fresh("ok")
        self.lines.add(f"{name} = {self.condition(scope)}")
        scope.truths.append(name)

    def _do_store(self, scope: Scope, depth: int) -> None:
        if scope.tables and self.chance(0.5):
            self.lines.add(f'{self.one_of(scope.tables)}["b"] = {self.number(scope)}')
        elif scope.lists:
            self.lines.add(f"{self.one_of(scope.lists)}.append({self.number(scope)})")

    def _do_call(self, scope: Scope, depth: int) -> None:
        if scope.calls:
            self.lines.add(self.call(scope, 1))

    def _do_list(self, scope: Scope, depth: int) -> None:
        name = self.fresh("c")
        if self.chance(0.5):
            self.lines.add(f"{name} = [{self.number(scope)}, {self.number(scope)}]")
            scope.lists.append(name)
        else:
            first, second = self.number(scope), self.number(scope)
            form = self.one_of(['{{"a": {}, "b": {}}}', "dict(a={}, b={})"])
            self.lines.add(f"{name} = {form.format(first, second)}")
            scope.tables.append(name)

    def _do_unpack(self, scope: Scope, depth: int) -> None:
        one, other = self.fresh("v"), self.fresh("v")
        star = "*" if self.chance(0.2) else ""
        self.lines.add(f"{one}, {star}{other} = {self.number(scope)}, {self.number(scope)}")
        scope.numbers.append(one)
        (scope.lists if star else scope.numbers).append(other)

    def _do_comprehension(self, scope: Scope, depth: int) -> None:
        name, element = self.fresh("c"), self.fresh("e")
        inner = scope.inner()
        inner.numbers.append(element)
        source = self.one_of(scope.lists or [f"({self.number(scope)}, {self.number(scope)})"])
        test = f" if {self.condition(inner, 1)}" if self.chance(0.6) else ""
        self.lines.add(f"{name} = [{self.number(inner, 1)} for {element} in {source}{test}] + [0.5]")
        scope.lists.append(name)

    # Compound ones

    def _do_if(self, scope: Scope, depth: int) -> None:
        self._block(f"if {self.condition(scope)}:", scope, depth)
        if self.chance(0.2):
            self._block(f"elif {self.condition(scope)}:", scope, depth)
        if self.chance(0.4):
            self._block("else:", scope, depth)

    def _loop(self, head: str, scope: Scope, depth: int, first: str = "") -> None:
        inner = scope.inner()
        inner.loops += 1
        with self.lines.block(head):
            if first:
                self.lines.add(first)
            self.body(inner, 3, depth + 1)
            if self.chance(0.4):
                word = self.one_of(["break", "continue"])
                with self.lines.block(f"if {self.condition(inner)}:"):
                    self.lines.add(word)
                self.body(inner, 1, depth + 1)
        if self.chance(0.3):
            self._block("else:", scope, depth)

    def _do_while(self, scope: Scope, depth: int) -> None:
        counter = self.fresh("n")
        self.lines.add(f"{counter} = 0")
        test = f" and {self.condition(scope, 1)}" if self.chance(0.6) else ""
        self._loop(f"while {counter} < 3{test}:", scope, depth, f"{counter} += 1")

    def _do_for(self, scope: Scope, depth: int) -> None:
        name = self.fresh("e")
        inner = scope.inner()
        inner.numbers.append(name)
        sources = [f"({self.number(scope)}, {self.number(scope)})", "range(2)", "(1.0, 2.0)"]
        sources += [f"list({each})" for each in scope.lists]
        self._loop(f"for {name} in {self.one_of(sources)}:", inner, depth)

    def _do_try(self, scope: Scope, depth: int) -> None:
        inner = scope.inner()
        with self.lines.block("try:"):
            self.body(inner, 3, depth + 1)
            if self.chance(0.5):
                with self.lines.block(f"if {self.condition(inner)}:"):
                    self._raise()
            elif self.chance(0.3):
                self.lines.add(f"assert {self.condition(inner)}")
            self.body(inner, 1, depth + 1)
        has_handler = self.chance(0.8)
        if has_handler:
            taken = self.one_of(["Fault", "Worse", "(Fault, ValueError)", "Exception", "Fault as fault"])
            self._block(f"except {taken}:", scope, depth)
            if self.chance(0.2):
                self._block("else:", scope, depth)
        if not has_handler or self.chance(0.3):
            self._block("finally:", scope, depth)

    def _raise(self) -> None:
        self.lines.add(f'raise {self.random.choice(_FAULTS)}("own")')

    def _do_with(self, scope: Scope, depth: int) -> None:
        name = self.fresh("v")
        inner = scope.inner()
        inner.numbers.append(name)
        manager = self.one_of(["helpers.Manager", "helpers.managed"])
        self._block(f"with {manager}({self.number(scope)}) as {name}:", inner, depth)

    def _do_match(self, scope: Scope, depth: int) -> None:
        if not scope.texts:
            return
        with self.lines.block(f"match {self.one_of(scope.texts)}:"):
            self._block('case "slow":', scope, depth)
            if self.chance(0.5):
                self._block(f'case "fast" if {self.condition(scope)}:', scope, depth)
            if self.chance(0.5):
                self._block("case _:", scope, depth)

    def _do_closure(self, scope: Scope, depth: int) -> None:
        name, argument = self.fresh("inner"), self.fresh("a")
        inner = Scope(
            [argument, *scope.numbers], [], list(scope.calls), list(scope.truths), [], list(scope.tables),
            list(scope.publishers), list(scope.texts), can_return=True,
        )  # fmt: skip
        changed = self.one_of([each for each in scope.targets if each.isidentifier()] or [""])
        is_local = changed.startswith("v")
        decorated = self.chance(0.3)
        if decorated:
            self.lines.add(self.one_of(["@helpers.logged", "@helpers.scaled(2.0)"]))
        with self.lines.block(f"def {name}({argument}, *rest, **more):"):
            if is_local and scope.can_return:
                self.lines.add(f"nonlocal {changed}")
                inner.targets.append(changed)
            self.body(inner, 3, depth + 1)
            self.lines.add(f"return {self.number(inner)}")
        scope.calls.append(f"{name}({{0}}, {{1}})")

    def _do_leave(self, scope: Scope, depth: int) -> None:
        words = []
        if scope.can_return:
            words += ["return", "return", "raise"]
        if scope.loops:
            words += ["break", "continue"]
        if not words:
            return
        with self.lines.block(f"if {self.condition(scope)}:"):
            word = self.one_of(words)
            if word == "raise":
                self._raise()
            elif word == "return":
                self.lines.add(f"return {self.number(scope)}")
            else:
                self.lines.add(word)
