"""Runs a program on a graph of its own, inside this process and without ROS.

All comparisons say what they compare; one of them may be turned.
"""

from __future__ import annotations

import builtins
import operator
import random
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import CodeType, ModuleType, SimpleNamespace
from typing import Any

from oracle_python.instrument import Instrument, Place
from oracle_python.values import BUILTINS, MEASURED, Number, Text, origin_of, plain

STEPS = 1000
_SAMPLES = 8
_SIGNS: dict[str, Callable[[Any, Any], Any]] = {
    "<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge,
    "==": operator.eq, "!=": operator.ne, "is": operator.is_, "is not": operator.is_not,
    "in": lambda a, b: a in b, "not in": lambda a, b: a not in b,
}  # fmt: skip


class _Endless(BaseException):
    """More steps than a program may take."""


@dataclass
class Seen:
    """What one operand of a comparison was: ``origins`` of all evaluations, empty for constants."""

    origins: set[frozenset[str]] = field(default_factory=set)

    @property
    def parameters(self) -> set[str]:
        """The parameters among them."""
        return {name for origin in self.origins if origin != MEASURED for name in origin}

    @property
    def is_sure(self) -> bool:
        """True where it was never anything measured."""
        return MEASURED not in self.origins


@dataclass
class Outcome:
    """``published``: (topic, value) in order. ``is_whole``: it ended, without an error of its own.

    ``seen``: number of a place and side (0, 1) -> what was there.
    """

    published: list[tuple[str, object]] = field(default_factory=list)
    is_whole: bool = True
    error: BaseException | None = None
    seen: dict[tuple[int, int], Seen] = field(default_factory=dict)


class Compiled:
    """A program, its comparisons replaced; ``places`` numbers them."""

    def __init__(self, modules: Mapping[str, str]) -> None:
        """``modules`` are sources by name, the node's ``node``."""
        self.places: list[Place] = []
        self.code: dict[str, CodeType] = {}
        for name, source in modules.items():
            tree = Instrument(f"{name}.py", self.places).run(source)
            self.code[name] = compile(tree, f"<{name}>", "exec")


class Run:
    """One run; ``turned`` is the number of a place, ``how`` says which evaluations are turned."""

    def __init__(self, program: Compiled, seed: int, turned: int = -1, how: str = "all") -> None:
        """The input follows from ``seed``."""
        self.program = program
        self.random = random.Random(seed)
        self.values = random.Random(f"parameters {seed}")
        self.parameters: dict[str, Any] = {}
        self.turned, self.how = turned, how
        self.count = self.steps = 0
        self.result = Outcome()
        self.callbacks: list[Callable[..., Any]] = []
        self.modules: dict[str, ModuleType] = {"rospy": self._rospy()}

    def run(self) -> Outcome:
        """Import the node, then hand samples to whoever subscribed."""
        try:
            self._guarded(lambda: self._load("node"))
            for _ in range(_SAMPLES):
                value = Number(round(self.random.uniform(-10, 10), 1), MEASURED)
                text = Text(self.random.choice(["slow", "fast", "off"]), MEASURED)
                message = SimpleNamespace(data=value, text=text)
                for callback in list(self.callbacks):
                    self._guarded(lambda callback=callback, m=message: callback(m))  # type: ignore[misc]
        except _Endless:
            self.result.is_whole = False
        return self.result

    def _guarded(self, action: Callable[[], Any]) -> None:
        try:
            action()
        except Exception as error:
            self._look_at(error)

    def _look_at(self, error: BaseException | None) -> None:
        # What Python itself raises is no business of the analysis: only what is raised explicitly.
        own = type(error).__module__ in self.program.code or isinstance(error, AssertionError)
        if not own and getattr(error, "args", None) != ("own",):
            self.result.is_whole = False
            self.result.error = error

    # What programs see

    def _rospy(self) -> ModuleType:
        module = ModuleType("rospy")
        module.__dict__.update(
            get_param=self._get_param,
            Publisher=lambda topic, *_, **__: SimpleNamespace(
                publish=lambda value: self._publish(topic, value)
            ),
            Subscriber=lambda topic, kind, callback, *_: self.callbacks.append(callback),
            Timer=lambda period, callback: self.callbacks.append(callback),
            loginfo=lambda *_: None,
            init_node=lambda *_: None,
        )
        return module

    def _publish(self, topic: str, value: object) -> None:
        self.step()
        self.result.published.append((topic, repr(plain(value))))

    def _get_param(self, name: str, default: Any = None) -> Any:
        if name not in self.parameters:
            if isinstance(default, str):
                value: Any = Text(self.values.choice(["slow", "fast", "off"]), frozenset({name}))
            elif name.startswith("~table"):
                value = {
                    key: Number(round(self.values.uniform(-6, 6), 1), frozenset({f"{name}/{key}"}))
                    for key in ("low", "high")
                }
            else:
                number = self.values.choice([0.0, round(self.values.uniform(-6, 6), 1)])
                value = Number(number, frozenset({name}))
            self.parameters[name] = value
        return self.parameters[name]

    def _load(self, name: str) -> ModuleType:
        if name not in self.modules:
            if name not in self.program.code:
                return builtins.__import__(name)
            module = self.modules[name] = ModuleType(name)
            given = {**builtins.__dict__, **BUILTINS, "__import__": self._import}
            given.update(
                __compare__=self.compare, __chain__=self.chain, __flag__=self.flag,
                __seen__=self.look, __step__=self.step, __caught__=self.caught,
            )  # fmt: skip
            module.__dict__["__builtins__"] = given
            exec(self.program.code[name], module.__dict__)
        return self.modules[name]

    def _import(self, name: str, *rest: Any) -> ModuleType:
        if name in self.program.code or name in self.modules:
            return self._load(name)
        return builtins.__import__(name, *rest)

    # What instrumented code calls

    def step(self) -> None:
        """Count a round of a loop, or a comparison."""
        self.steps += 1
        if self.steps > STEPS:
            raise _Endless

    def caught(self) -> None:
        """An exception is handled."""
        self._look_at(sys.exc_info()[1])

    def compare(self, number: int, left: Any, right: Any) -> Any:
        """Compare two values."""
        self.step()
        self._note(number, 0, left)
        self._note(number, 1, right)
        sign = _SIGNS[self.program.places[number].sign]
        return self._turned(number, sign(left, right))

    def chain(self, first: int, left: Any, *later: Callable[[], Any]) -> Any:
        """Compare as long as it is true."""
        outcome: Any = True
        for at, operand in enumerate(later):
            right = operand()
            outcome = self.compare(first + at, left, right)
            if not outcome:
                return outcome
            left = right
        return outcome

    def flag(self, number: int, value: Any) -> Any:
        """The truth of a value."""
        self.look(number, value)
        return self._turned(number, bool(value))

    def look(self, number: int, value: Any) -> Any:
        """A value whose truth decides."""
        self.step()
        self._note(number, 0, value)
        return value

    def _note(self, number: int, side: int, value: object) -> None:
        self.result.seen.setdefault((number, side), Seen()).origins.add(origin_of(value))

    def _turned(self, number: int, outcome: Any) -> Any:
        if number != self.turned:
            return outcome
        self.count += 1
        if self.how == "all" or (self.how == "odd" and self.count % 2) or self.count == 1:
            return not outcome
        return outcome
