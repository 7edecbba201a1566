"""Who calls whom, and with what."""

from __future__ import annotations

from collections.abc import Callable

from pytpc.python_analysis.ir.instructions import Function, Instr, Shape
from pytpc.python_analysis.points_to.objects import Obj
from pytpc.python_analysis.rules_file import Argument

Given = tuple[str | None, Instr]
"""An argument: its keyword (``*``, ``**``: unpacked; None: positional) and its value."""


def argument(given: list[Given], where: Argument) -> Instr | None:
    """The argument of a call that a rule names; None where the call does not give it."""
    for keyword, value in given:
        if keyword is not None and keyword == where.keyword:
            return value
    positional = []
    for keyword, value in given:
        if keyword == "*":
            break
        if keyword is None:
            positional.append(value)
    place = where.place
    return positional[place] if place is not None and place < len(positional) else None


class CallTable:
    """Who calls whom.

    ``callees``: an instruction -> the functions that it runs. ``callers``: the reverse.
    ``outside``: an instruction -> the dotted names that it calls, each with the object if it is a
    method. ``given``: a call and a parameter -> the values that the parameter gets, or its default.
    ``registered``: a function -> the calls that pass it to code outside the sources, which may run
    it later.
    """

    def __init__(self) -> None:
        self.callees: dict[Instr, dict[Function, None]] = {}
        self.callers: dict[Function, dict[Instr, None]] = {}
        self.outside: dict[Instr, dict[tuple[str, Obj | None], None]] = {}
        self.registered: dict[Function, dict[Instr, None]] = {}
        self.callbacks: dict[Instr, dict[Function, None]] = {}
        self.given: dict[tuple[Instr, Instr], list[Instr]] = {}
        self._awaiting: dict[tuple[Instr, Instr], list[Callable[[Instr], None]]] = {}
        self._sites: dict[Instr, list[Instr]] = {}
        self._awaiting_site: dict[Instr, list[Callable[[Instr], None]]] = {}

    @staticmethod
    def arguments(instr: Instr) -> list[Given]:
        """The arguments of a call as they are written."""
        shape = instr.data
        names = shape.names if isinstance(shape, Shape) else ()
        return list(zip(names, instr.args[1:], strict=True))

    def when_given(self, site: Instr, param: Instr, action: Callable[[Instr], None]) -> None:
        """Call ``action`` for each value that the call ``site`` gives to ``param``."""
        self._awaiting.setdefault((site, param), []).append(action)
        for value in list(self.given.get((site, param), ())):
            action(value)

    def may_unpack(self, site: Instr, param: Instr) -> bool:
        """True where an unpacked argument of ``site`` may be the value of ``param``."""
        return param in self.given.get((site, param), ())

    def when_site(self, param: Instr, action: Callable[[Instr], None]) -> None:
        """Call ``action`` for each call that gives something to ``param``."""
        self._awaiting_site.setdefault(param, []).append(action)
        for site in list(self._sites.get(param, ())):
            action(site)

    def give(self, site: Instr, param: Instr, value: Instr) -> None:
        """``site`` gives ``value`` to ``param``."""
        known = self.given.setdefault((site, param), [])
        if not known:
            self._sites.setdefault(param, []).append(site)
            for act in list(self._awaiting_site.get(param, ())):
                act(site)
        if value not in known:
            known.append(value)
            for action in list(self._awaiting.get((site, param), ())):
                action(value)


def kept_as_given(instr: Instr) -> Instr | None:
    """The parameter of ``__init__`` whose value ``self.name = parameter`` keeps.

    Objects of one class are distinguished by such values.
    """
    if instr.op != "setattr":
        return None
    owner, value = instr.args
    first = unchanged_parameter(owner)
    found = unchanged_parameter(value)
    if first is None or first.data != 0:
        return None
    return found


def unchanged_parameter(value: Instr) -> Instr | None:
    """The parameter of ``__init__`` that a value is, if nothing else is stored in it."""
    function = value.function
    if value.op != "load" or value.data not in function.parameters:
        return None
    if function.owner is None or not function.qualname.endswith(".__init__"):
        return None
    place = function.parameters.index(value.data)
    if place in (function.vararg, function.kwarg):
        return None
    stores = [
        each for each in function.instructions() if each.op == "store" and each.data is value.data
    ]
    return function.param_instrs[place] if len(stores) == 1 else None
