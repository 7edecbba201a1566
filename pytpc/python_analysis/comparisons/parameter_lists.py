"""Lists of parameter objects: results of ``get_parameters``, and arguments of callbacks.

An element is a read where the program takes its value. Its name is the one that it is compared with
(``if p.name == "limit": self.limit = p.value``), else the one at its place in the list of requested
names; where neither is known, it is ``<dynamic>``.
"""

from __future__ import annotations

from collections.abc import Iterator

from pytpc.python_analysis.flow.constants import DYNAMIC, Constants
from pytpc.python_analysis.ir.control import control_dependence, post_dominators
from pytpc.python_analysis.ir.instructions import Block, Function, Instr


class ParameterLists:
    """Finds the elements of lists whose value is taken, and their names."""

    def __init__(self, constants: Constants) -> None:
        self._constants = constants
        self._flow = constants.flow
        self._control: dict[Function, dict[Block, list[Block]]] = {}

    def taken(self, start: Instr, names: list[str]) -> Iterator[tuple[str, Instr]]:
        """The values that the program takes from elements of the list ``start``.

        Args:
            start: the instruction with the list.
            names: the names of its elements in order; empty where they are not known.

        Yields:
            The name of a parameter, and the instruction that has its value.
        """
        elements = self._elements(start)
        values = self._flow.points.rules.values
        for element, place in elements.items():
            for user in self._flow.users.get(element, ()):
                if user.op == "attr" and str(user.data) in values:
                    known = self._names(user, elements, place, names)
                    for value in self._values(user):
                        users = self._flow.users.get(value, ())
                        if users and all(self._is_entry(each, elements) for each in users):
                            continue
                        yield from ((name, value) for name in known)

    def tables(self, start: Instr) -> Iterator[Instr]:
        """The dicts from the names of elements to their values: ``{p.name: p.value for ...}``."""
        elements = self._elements(start)
        found: dict[Instr, None] = {}
        for element in elements:
            for user in self._flow.users.get(element, ()):
                if user.op == "attr" and user.data == "name":
                    for each in self._flow.users.get(user, ()):
                        if self._is_entry(each, elements):
                            found.update(dict.fromkeys(self._made(each.args[0])))
        yield from found

    def _made(self, table: Instr) -> list[Instr]:
        return [each.site for each in self._flow.points.of(table) if each.site is not None]

    def _is_entry(self, user: Instr, elements: dict[Instr, int | None]) -> bool:
        """True for ``table[p.name] = p.value``."""
        if user.op != "setitem":
            return False
        key, value = user.args[1:]
        named = key.op == "attr" and key.data == "name" and key.args[0] in elements
        return named and self._is_value(value, elements)

    def _is_value(self, value: Instr, elements: dict[Instr, int | None]) -> bool:
        attr = value.args[0] if value.op == "call" else value
        return (
            attr.op == "attr"
            and attr.args[0] in elements
            and str(attr.data) in self._flow.points.rules.values
        )

    def text(self, instr: Instr | None) -> str:
        """A constant text; empty where there is none, ``<dynamic>`` where it is not constant."""
        words = [""] if instr is None else self._constants.names(instr)
        return words[0] if len(words) == 1 else DYNAMIC

    def named(self, asked: Instr) -> list[str]:
        """The names in a list of names, or of tuples that begin with a name."""
        found: list[str] = []
        for each in self._flow.points.of(asked):
            if each.kind != "container" or each.site is None or each.site.op != "build":
                return []
            for part in each.site.args:
                first = part.args[0] if part.op == "build" and part.args else part
                words = self._constants.names(first)
                found.append(words[0] if len(words) == 1 else DYNAMIC)
        return found

    def _values(self, attr: Instr) -> list[Instr]:
        """The attribute itself, or the calls of it."""
        users = self._flow.users.get(attr, ())
        return [user for user in users if user.op == "call" and user.args[0] is attr] or [attr]

    def _elements(self, start: Instr) -> dict[Instr, int | None]:
        found: dict[Instr, int | None] = {}
        lists = {start}
        waiting: list[tuple[Instr, bool, int | None]] = [(start, True, None)]
        while waiting:
            value, is_list, place = waiting.pop()
            following = [(to, is_list, place) for to, _ in self._flow.copies(value)]
            for user in self._flow.users.get(value, ()) if is_list else ():
                if user.op == "iter":
                    uses = self._flow.users.get(user, ())
                    following += [(use, False, None) for use in uses if use.op == "next"]
                elif user.op == "item" and user.args[0] is value:
                    keys = list(self._constants.values(user.args[1]))
                    key = keys[0] if len(keys) == 1 else None
                    following.append((user, False, key if isinstance(key, int) else None))
            for to, is_more, at in following:
                if is_more and to not in lists:
                    lists.add(to)
                    waiting.append((to, True, None))
                elif not is_more and to not in found:
                    found[to] = at
                    waiting.append((to, False, at))
        return found

    def _names(
        self, attr: Instr, elements: dict[Instr, int | None], place: int | None, names: list[str]
    ) -> list[str]:
        compared = self._compared(attr, elements)
        if compared is not None:
            return [compared]
        if place is not None and -len(names) <= place < len(names):
            return [names[place]]
        return list(dict.fromkeys(names)) or [DYNAMIC]

    def _compared(self, attr: Instr, elements: dict[Instr, int | None]) -> str | None:
        """The constant that the element's name is equal to where ``attr`` runs."""
        function = attr.function
        if function not in self._control:
            self._control[function] = control_dependence(function)
        immediate = post_dominators(function)
        seen = {attr.block}
        waiting = [attr.block]
        while waiting:
            block = waiting.pop(0)
            for above in self._control[function].get(block, ()):
                is_yes = _leads(above.successors[0], block, immediate)
                name = self._equal(above.instrs[-1], elements, is_yes)
                if name is not None:
                    return name
                if above not in seen:
                    seen.add(above)
                    waiting.append(above)
        return None

    def _equal(self, branch: Instr, elements: dict[Instr, int | None], is_yes: bool) -> str | None:
        if branch.op != "branch" or branch.args[0].op != "compare":
            return None
        compare = branch.args[0]
        if compare.data != ("Eq" if is_yes else "NotEq"):
            return None
        for one, other in (compare.args, compare.args[::-1]):
            subject = one.args[0] if one.op == "match" else one
            if subject.op == "attr" and subject.data == "name" and subject.args[0] in elements:
                words = self._constants.names(other)
                return words[0] if len(words) == 1 else None
        return None


def _leads(first: Block, block: Block, immediate: list[int]) -> bool:
    """True where ``block`` runs whenever ``first`` does."""
    runner = first.number
    while runner >= 0 and runner != block.number and immediate[runner] != runner:
        runner = immediate[runner]
    return runner == block.number
