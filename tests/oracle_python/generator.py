"""Random small nodes of two modules, each from its seed."""

from __future__ import annotations

from oracle_python.scope import Lines, Scope
from oracle_python.statements import Statements

_HELPERS = '''\
import contextlib
import functools
import rospy
class Other(Exception):
    pass
class Manager:
    def __init__(self, level):
        self.level = level
    def __enter__(self):
        return self.level
    def __exit__(self, *what):
        return False
@contextlib.contextmanager
def managed(level):
    yield level
def logged(function):
    @functools.wraps(function)
    def wrapper(*args, **kwargs):
        rospy.loginfo("called")
        return function(*args, **kwargs)
    return wrapper
def scaled(by):
    def decorate(function):
        def wrapper(*args, **kwargs):
            return function(*args, **kwargs)
        return wrapper
    return decorate
'''
_FAULTS = '''\
class Fault(Exception):
    pass
class Worse(Fault):
    pass
'''


class Generator(Statements):
    """Makes one program."""

    def program(self) -> dict[str, str]:
        """Sources by the names of modules; ``node`` is the script."""
        self.lines = Lines()
        for line in (_HELPERS + _FAULTS).splitlines():
            self.lines.add(line)
        self.lines.add(f"LEVEL = {self.read()}")
        outer = Scope(["LEVEL"])
        outer.publishers = ['rospy.Publisher("helped", float)']
        self._function("helped", outer)
        outer.calls.append("helped({0}, {1})")
        self._class("Base", "object", outer, ["base", "common"])
        helpers = self.lines.text().replace("helpers.", "")
        self.lines = Lines()
        for line in ("import functools", "import rospy", "import helpers",
                     "from helpers import Base, Fault, Worse, helped"):  # fmt: skip
            self.lines.add(line)
        return {"helpers": helpers, "node": self._node()}

    def _node(self) -> str:
        add = self.lines.add
        outer = Scope(["G", "H", "helpers.LEVEL"], calls=["helped({0}, b={1})", "helpers.helped({0}, {1})"])
        outer.publishers = ["pub", 'rospy.Publisher("other", float)']
        outer.tables = ["TABLE"]
        outer.texts = ["MODE"]
        add('pub = rospy.Publisher("out", float)')
        add(f"G = {self.read()}")
        add("H = 0.5")
        add('MODE = rospy.get_param("~mode", "slow")')
        add(f'TABLE = {{"a": {self.read()}, "b": {self.literal()}}}')
        for name in ("one", "two"):
            self._function(name, outer)
            outer.calls += self._ways_to_call(name)
        self._generator("many", outer)
        self._class("Node", "Base", outer, ["common", "own", "last"])
        add(f"node = Node({self.number(outer, 1)}, {self.read()})")
        add(f"other = Node(b={self.literal()})" if self.chance(0.5) else "other = node")
        add(self.one_of(['rospy.Subscriber("in", float, node.callback)',
                         'rospy.Subscriber("in", float, lambda message: node.callback(message))']))  # fmt: skip
        if self.chance(0.5):
            add('rospy.Timer(1.0, functools.partial(node.timer, extra=G))')
        return self.lines.text()

    def _ways_to_call(self, name: str) -> list[str]:
        return [
            f"{name}({{0}}, {{1}})", f"{name}(b={{1}}, a={{0}})", f"{name}(*({{0}}, {{1}}))",
            f'{name}(**{{{{"a": {{0}}, "b": {{1}}}}}})', f"functools.partial({name}, {{0}})({{1}})",
            f"{name}({{0}})",
        ]  # fmt: skip

    def _inside(self, outer: Scope, *numbers: str) -> Scope:
        inner = outer.inner()
        inner.numbers += [*numbers, *numbers]
        inner.can_return = True
        return inner

    def _function(self, name: str, outer: Scope) -> None:
        inner = self._inside(outer, "a", "b")
        inner.targets.append("a")
        default = self.one_of([self.literal(), *outer.numbers])
        with self.lines.block(f"def {name}(a, b={default}):"):
            if "G" in outer.numbers and self.chance(0.3):
                self.lines.add("global H")
                inner.targets.append("H")
            self._do_local(inner, 0)
            self.body(inner)
            self.lines.add(f"return {self.number(inner)}")
        self.lines.add("")

    def _generator(self, name: str, outer: Scope) -> None:
        inner = self._inside(outer, "a")
        inner.can_return = False
        with self.lines.block(f"def {name}(a):"):
            self.body(inner, 2, 2)
            self.lines.add(f"yield {self.number(inner)}")
            with self.lines.block(f"if {self.condition(inner)}:"):
                self.lines.add(f"yield {self.number(inner)}")
        outer.lists.append(f"list({name}({self.one_of(outer.numbers)}))")

    def _class(self, name: str, base: str, outer: Scope, methods: list[str]) -> None:
        fields = ["self.low", "self.high", "self.state"]
        inner = self._inside(outer, *fields, *fields, "self.KEPT")
        inner.targets += fields
        inner.lists.append("self.items")
        inner.publishers += ["self.pub", "self.pub"]
        is_node = name == "Node"
        with self.lines.block(f"class {name}({base}):"):
            self.lines.add(f"KEPT = {self.read() if self.chance(0.5) else self.literal()}")
            with self.lines.block(f"def __init__(self, a=1.0, b={self.literal()}):"):
                self._maker(outer, is_node)
            with self.lines.block("@property\n" + "    " * self.lines.depth + "def gap(self):"):
                self.lines.add(f"return {self.number(inner)}")
            inner.numbers.append("self.gap")
            for method in methods:
                within = inner.inner()
                within.numbers += ["a", "b"]
                with self.lines.block(f"def {method}(self, a, b={self.literal()}):"):
                    if is_node and method == "common" and self.chance(0.6):
                        self.lines.add("super().common(a, b)")
                    self.body(within, 3)
                    self.lines.add(f"return {self.number(within)}")
                inner.calls += [f"self.{method}({{0}}, {{1}})", f"self.{method}({{0}}, b={{1}})"]
            if is_node:
                self._callbacks(inner)

    def _maker(self, outer: Scope, is_node: bool) -> None:
        inner = self._inside(outer, "a", "b")
        if is_node:
            self.lines.add(self.one_of(["super().__init__(a, b)", "Base.__init__(self, a, b)"]))
        else:
            self.lines.add('self.pub = rospy.Publisher("own", float)')
            for field in ("self.low", "self.high", "self.state"):
                self.lines.add(f"{field} = {self.one_of(['a', 'b', self.literal(), self.read()])}")
            self.lines.add("self.items = [0.5]")
        field = self.one_of(["low", "high", "state"])
        self.lines.add(
            self.one_of(
                [
                    f"self.{field} = {self.read()}",
                    f"self.low, self.high = {self.read()}, {self.number(inner, 1)}",
                    f'for key in ("low", "{field}"):\n            setattr(self, key, rospy.get_param("~" + key, 1.0))',
                    f'setattr(self, "{field}", {self.read()})',
                    f"self.__dict__.update({field}={self.read()})",
                ]
            )
        )

    def _callbacks(self, inner: Scope) -> None:
        inner.numbers += ["message.data"] * 6
        inner.texts += ["message.text"]
        with self.lines.block("def callback(self, message):"):
            self.body(inner.inner(), 6)
        del inner.numbers[-6:]
        inner.texts.pop()
        inner.numbers.append("extra")
        with self.lines.block("def timer(self, event, extra=2.0):"):
            self.body(inner.inner(), 3)


def program(seed: int) -> dict[str, str]:
    """The program of a seed."""
    return Generator(seed).program()
