"""Control dependence straight from the definition of Ferrante, Ottenstein and Warren (1987).

Y depends on X where an edge leaves X after which Y must be reached, while X need not lead to Y.
The graph has an entry with an edge to the exit, so that what always runs depends on the entry.
"""

from __future__ import annotations

import re

import networkx as nx

from tests.oracle.ir import Block, Function, Instruction, Value, number
from tests.oracle.memory import SILENT
from tests.oracle.throws import (
    Throws,
    Type,
    asks_for,
    begins_handler,
    ends_program,
    is_throw,
    only_asks,
    takes,
)

ENTRY, EXIT, AGAIN = "entry", "exit", "again"


Way = tuple[Block, ...]
Calls = dict[Instruction, set[Type]]
"""The calls that throw, and what."""


def parts(block: Block, thrown: Calls) -> list[Instruction]:
    """The calls inside a block by which it can be left."""
    return [i for i in block.instructions if i.opcode == "call" and i in thrown and not is_throw(i)]


def decided_way(before: Block, block: Block, thrown: Calls, flying: tuple[Type, ...] = ()) -> Way:
    """The blocks that surely follow when `block` is entered from `before`, as far as it is sure.

    It is so where the terminator decides by a merged value that is a constant on this way: in
    the source there is no decision at all, clang only joins ways and parts them again. Where an
    exception is `flying`, also where its type decides.
    """
    merged: dict[Value, int | None] = {}
    way: list[Block] = []
    sure = 0
    while block not in way[:-1] and not parts(block, thrown):
        if flying and begins_handler(block):
            break
        came = {p: p.operands[p.blocks.index(before)] for p in block.instructions if is_phi(p)}
        merged |= {p: folded(v, merged) for p, v in came.items()}
        end = block.terminator
        if flying and (end.opcode == "invoke" or len(end.blocks) == 1):
            way.append(end.blocks[0])
            before, block = block, end.blocks[0]
            continue
        if end.opcode not in ("br", "switch") or len(end.blocks) < 2:
            break
        condition = end.operands[0]
        value = None if condition.kind == "constant" else folded(condition, merged)
        if value is None and flying and (handler := asks_for(condition)):
            value = takes(handler, flying[0])
        if value is None:
            break
        sure = len(way) + 1
        if end.opcode == "br":
            after = end.blocks[value & 1]
        else:
            cases = [int(c) for c in re.findall(r"i\d+ (-?\d+), label", end.text)]
            after = end.blocks[1 + cases.index(value)] if value in cases else end.blocks[0]
        way.append(after)
        before, block = block, after
    return tuple(way[:sure])


def is_phi(i: Instruction) -> bool:
    return i.opcode == "phi"


def folded(value: Value, merged: dict[Value, int | None]) -> int | None:
    """The number that `value` is where merges are as `merged` says; None where that is open.

    A comparison is left open: that of a merged constant is one in the source too.
    """
    if value.kind == "constant":
        if found := re.fullmatch(r"i1 (true|false)", value.text):
            return int(found[1] == "true")
        return number(value)
    if not isinstance(value, Instruction):
        return None
    if value.opcode == "phi":
        return merged.get(value)
    known = [folded(o, merged) for o in value.operands]
    if None in known or value.opcode not in ("zext", "trunc", "xor"):
        return None
    return known[0] ^ known[1] if value.opcode == "xor" else known[0]


def followers(end: Instruction, thrown: Calls) -> list[Block]:
    """The blocks that follow a terminator, the landing pad too where something is thrown to it."""
    if end.opcode != "invoke":
        return end.blocks
    if end not in thrown or ends_program(end.blocks[1]):
        return end.blocks[:1]
    return end.blocks[1:] if is_throw(end) else end.blocks


def flow_graph(function: Function, thrown: Calls, plain: bool = False) -> nx.DiGraph:
    """Nodes are (block, way that surely follows), or (block, the call that a part is behind).

    Calls have an edge for what they throw where a `throw` in the user's code is behind it.
    In a `plain` graph only what an exception's type decides is sure.
    """
    graph = nx.DiGraph([(ENTRY, EXIT)])

    def follow(start: Block) -> None:
        todo = [(ENTRY, (start, ()))]
        while todo:
            before, node = todo.pop()
            known = node in graph
            graph.add_edge(before, node)
            if known:
                continue
            block, way = node
            if isinstance(way, tuple):
                for call in parts(block, thrown):
                    graph.add_edge(node, EXIT)
                    graph.add_edge(node, (block, call))
                    node, way = (block, call), ()
            end = block.terminator
            following = way[:1] if way else followers(end, thrown)
            for after in following:
                if not way and end.opcode == "invoke" and after is end.blocks[1]:
                    for t in sorted(thrown[end], key=str):
                        todo.append((node, (after, decided_way(block, after, thrown, (t,)))))
                    continue
                sure = () if plain else decided_way(block, after, thrown)
                todo.append((node, (after, way[1:] or sure)))
            if not following:
                graph.add_edge(node, EXIT)

    # What only an exception leads to, and (allowed difference DEAD CODE) what nothing leads to,
    # is entered as the function is.
    follow(function.blocks[0])
    entered = {s for b in function.blocks for s in followers(b.terminator, thrown)}
    for block in function.blocks:
        if block not in entered:
            follow(block)
    # So is the landing pad of a call that is not known to throw, besides one that is.
    ends = [b.terminator for b in function.blocks if b.terminator.opcode == "invoke"]
    silent = [e.blocks[1] for e in ends if e.blocks[1] not in followers(e, thrown)]
    for pad in dict.fromkeys(silent):
        if (pad, ()) not in graph:
            follow(pad)
    end_endless_loops(graph, function)
    return graph


def end_endless_loops(graph: nx.DiGraph, function: Function) -> None:
    """Lets each region that never ends do so after any round, before it begins again.

    The node for that is no predicate; in the source nothing is decided there.
    """
    order = {block: n for n, block in enumerate(function.blocks)}
    while True:
        stuck = set(graph) - nx.ancestors(graph, EXIT) - {EXIT}
        if not stuck:
            return
        regions = list(nx.strongly_connected_components(graph.subgraph(stuck)))
        region = next(r for r in regions if all(s in r for n in r for s in graph.successors(n)))
        entered = [n for n in region if any(p not in region for p in graph.predecessors(n))]
        first = min(entered, key=lambda n: order[n[0]])
        again = (AGAIN, first)
        for before in [p for p in graph.predecessors(first) if p in region]:
            graph.remove_edge(before, first)
            graph.add_edge(before, again)
        graph.add_edge(again, first)
        graph.add_edge(again, EXIT)


def does_something(block: Block) -> bool:
    """True for more than an end of a condition, where the ways join and part again."""
    calls = [i for i in block.instructions if i.opcode == "call"]
    stores = any(i.opcode == "store" for i in block.instructions)
    return stores or any(not SILENT.match(c.callee.name) for c in calls)


class ControlDependence:
    """Of one function: the predicates that control a block, and an edge between two blocks."""

    def __init__(
        self, function: Function, throws: Throws | None = None, plain: bool = False
    ) -> None:
        self.thrown: Calls = throws.thrown if throws else {}
        self.graph = flow_graph(function, self.thrown, plain)
        self.plain = self if plain else ControlDependence(function, throws, plain=True)
        self.above = self.post_dominators()
        nodes = [n for n in self.graph if n not in (ENTRY, EXIT) and n[0] != AGAIN]
        self.of_node = {n: self.controllers_of(n) for n in nodes}

    def post_dominators(self) -> dict[object, set[object]]:
        """For each node all nodes that every way from it to the exit passes, itself included."""
        parents = nx.immediate_dominators(self.graph.reverse(), EXIT)
        out: dict[object, set[object]] = {}
        for node in self.graph:
            out[node], at = {node}, node
            while at != EXIT:
                at = parents[at]
                out[node].add(at)
        return out

    def controllers_of(self, node: object) -> set[object]:
        """The definition, tried with each edge."""
        return {
            x
            for x, after in self.graph.edges
            if node in self.above[after] and not (node != x and node in self.above[x])
        }

    def predicates(self, nodes: set[object]) -> set[Instruction]:
        """What decides at the ends of `nodes`: predicates, and calls that may throw."""
        found = {self.end(*n) for n in nodes if n != ENTRY and n[0] != AGAIN}
        return {i for i in found if i.opcode == "call" or self.is_choice(i)}

    def is_choice(self, end: Instruction) -> bool:
        return len(set(followers(end, self.thrown))) > 1

    def end(self, block: Block, way: Way | Instruction) -> Instruction:
        """The instruction at which the ways from a node part."""
        calls = parts(block, self.thrown)
        behind = calls.index(way) + 1 if isinstance(way, Instruction) else 0
        return [*calls, block.terminator][behind]

    def part(self, item: Instruction) -> object:
        """The node that `item` is in, where no way is decided."""
        calls = [c for c in parts(item.block, self.thrown) if c.number < item.number]
        return (item.block, calls[-1] if calls else ())

    def controllers(self, block: Block, item: Instruction) -> tuple[set[Instruction], bool]:
        """The predicates that control `item` in `block`, and whether the function's calls do.

        A branch is one only where the way is still open when it is come to.
        """
        ways = {n for n in self.of_node if n[0] is block}
        is_open = (block, ()) in ways and (item is block.terminator or only_asks(block))
        if parts(block, self.thrown) or is_open:
            ways = {self.part(item)}
        elif len(ways) > 1 and does_something(block) and self.plain is not self:
            # What is done on all ways through a block depends on none of them.
            return self.plain.controllers(block, item)
        nodes = set().union(*(self.of_node[n] for n in ways))
        return self.predicates(nodes), ENTRY in nodes

    def choosers(self, before: Block, block: Block) -> set[Instruction]:
        """The predicates that choose the way from `before` to `block`."""
        nodes = [n for n in self.of_node if n[0] is before]
        ways = [n for n in nodes if isinstance(n[1], tuple)]
        open_, decided = self.part(before.terminator), [n for n in ways if n[1][:1] == (block,)]
        found = self.predicates(set().union(*(self.of_node[n] for n in decided)))
        if open_ not in nodes:
            return found
        end = before.terminator
        choice = {end} if self.is_choice(end) else set()
        return found | self.predicates(self.of_node[open_]) | choice
