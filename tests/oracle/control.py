"""Control dependence straight from the definition of Ferrante, Ottenstein and Warren (1987).

Y depends on X where an edge leaves X after which Y must be reached, while X need not lead to Y.
The graph has an entry with an edge to the exit, so that what always runs depends on the entry.
"""

from __future__ import annotations

import re

import networkx as nx

from tests.oracle.ir import Block, Function, Instruction, Value, number

ENTRY, EXIT, AGAIN = "entry", "exit", "again"


Way = tuple[Block, ...]


def decided_way(before: Block, block: Block) -> Way:
    """The blocks that surely follow when `block` is entered from `before`, as far as it is sure.

    It is so where the terminator decides by a merged value that is a constant on this way: in
    the source there is no decision at all, clang only joins ways and parts them again.
    """
    merged: dict[Value, int | None] = {}
    way: list[Block] = []
    while block not in way[:-1]:
        came = {p: p.operands[p.blocks.index(before)] for p in block.instructions if is_phi(p)}
        merged |= {p: folded(v, merged) for p, v in came.items()}
        end = block.terminator
        if end.opcode not in ("br", "switch") or len(end.blocks) < 2:
            break
        condition = end.operands[0]
        value = None if condition.kind == "constant" else folded(condition, merged)
        if value is None:
            break
        if end.opcode == "br":
            after = end.blocks[value & 1]
        else:
            cases = [int(c) for c in re.findall(r"i\d+ (-?\d+), label", end.text)]
            after = end.blocks[1 + cases.index(value)] if value in cases else end.blocks[0]
        way.append(after)
        before, block = block, after
    return tuple(way)


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


def flow_graph(function: Function) -> nx.DiGraph:
    """Nodes are (block, way that surely follows); calls that throw have no edge for it."""
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
            following = way[:1] if way else block.terminator.blocks
            if block.terminator.opcode == "invoke":
                following = following[:1]
            for after in following:
                todo.append((node, (after, way[1:] or decided_way(block, after))))
            if not following:
                graph.add_edge(node, EXIT)

    # What only an exception leads to, and (allowed difference DEAD CODE) what nothing leads to,
    # is entered as the function is.
    follow(function.blocks[0])
    entered = {
        s
        for b in function.blocks
        for s in (
            b.terminator.blocks[:1] if b.terminator.opcode == "invoke" else b.terminator.blocks
        )
    }
    for block in function.blocks:
        if block not in entered:
            follow(block)
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


class ControlDependence:
    """Of one function: the predicates that control a block, and an edge between two blocks."""

    def __init__(self, function: Function) -> None:
        self.graph = flow_graph(function)
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
        found = {n[0].terminator for n in nodes if n != ENTRY and n[0] != AGAIN}
        return {i for i in found if i.opcode in ("br", "switch") and len(set(i.blocks)) > 1}

    def controllers(self, block: Block, item: Instruction) -> tuple[set[Instruction], bool]:
        """The predicates that control `item` in `block`, and whether the function's calls do.

        A branch is one only where the way is still open when it is come to.
        """
        ways = {n for n in self.of_node if n[0] is block}
        if item is block.terminator and (block, ()) in ways:
            ways = {(block, ())}
        nodes = set().union(*(self.of_node[n] for n in ways))
        return self.predicates(nodes), ENTRY in nodes

    def choosers(self, before: Block, block: Block) -> set[Instruction]:
        """The predicates that choose the way from `before` to `block`."""
        nodes = [n for n in self.of_node if n[0] is before]
        open_, decided = (before, ()), [n for n in nodes if n[1] and n[1][0] is block]
        found = self.predicates(set().union(*(self.of_node[n] for n in decided)))
        if open_ not in nodes:
            return found
        end = before.terminator
        is_choice = end.opcode in ("br", "switch") and len(set(end.blocks)) > 1
        return found | self.predicates(self.of_node[open_]) | ({end} if is_choice else set())
