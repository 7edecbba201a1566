"""Control dependence: which branches decide whether a block runs.

J. Ferrante, K. Ottenstein, J. Warren, "The Program Dependence Graph and Its Use in Optimization",
TOPLAS 9(3), 1987: a block depends on a branch if one side of it always leads to the block, and the
other does not. The dominators are those of K. Cooper, T. Harvey, K. Kennedy, "A Simple, Fast
Dominance Algorithm", 2001.
"""

from __future__ import annotations

from pytpc.python_analysis.ir.instructions import Block, Function, reachable


def control_dependence(function: Function) -> dict[Block, list[Block]]:
    """For each block, in order, the blocks whose last instruction decides whether it runs.

    A handler depends on what its ``try`` depends on, unless a ``raise`` leads to it.
    """
    blocks = function.blocks
    immediate = post_dominators(function)
    found: dict[Block, list[Block]] = {block: [] for block in blocks}
    for block in blocks:
        if len(block.successors) < 2:
            continue
        stop = immediate[block.number]
        for successor in block.successors:
            runner = successor.number
            while runner != stop and runner >= 0:
                if block not in found[blocks[runner]]:
                    found[blocks[runner]].append(block)
                runner = immediate[runner]
    _inherit(function, found)
    return found


def _inherit(function: Function, found: dict[Block, list[Block]]) -> None:
    """Blocks that no edge leads to run where their ``try`` does."""
    for block in function.blocks:
        if block.opened is None:
            continue
        above = found.get(block.opened, [])
        for other in _only_behind(function, block):
            found[other] += [way for way in above if way not in found[other]]


def _only_behind(function: Function, handler: Block) -> list[Block]:
    """The blocks that are reached through ``handler`` alone."""
    without = reachable([function.blocks[0]], handler)
    within = reachable([handler], by_raise=False)
    return [block for block in function.blocks if block in within and block not in without]


def post_dominators(function: Function) -> list[int]:
    """The number of each block's immediate post-dominator, by the block's number; -1 for the last.

    A loop without an exit counts as left at its end.
    """
    blocks = function.blocks
    size = len(blocks)
    last = size - 1
    follows = [[after.number for after in block.successors] for block in blocks]
    before: list[list[int]] = [[] for _ in blocks]
    for number, after in enumerate(follows):
        for successor in after:
            before[successor].append(number)
    order = _backward_order(last, before)
    while len(order) < size:
        # The innermost block of a loop without an exit, as far as that is known.
        left = set(order)
        stuck = max(number for number in range(size) if number not in left)
        follows[stuck].append(last)
        before[last].append(stuck)
        order = _backward_order(last, before)
    rank = {number: place for place, number in enumerate(order)}
    immediate = [-2] * size
    immediate[last] = last
    changed = True
    while changed:
        changed = False
        for number in order[1:]:
            known = [after for after in follows[number] if immediate[after] != -2]
            nearest = known[0]
            for other in known[1:]:
                nearest = _meet(nearest, other, immediate, rank)
            if immediate[number] != nearest:
                immediate[number], changed = nearest, True
    immediate[last] = -1
    return immediate


def _meet(one: int, other: int, immediate: list[int], rank: dict[int, int]) -> int:
    while one != other:
        while rank[one] > rank[other]:
            one = immediate[one]
        while rank[other] > rank[one]:
            other = immediate[other]
    return one


def _backward_order(last: int, before: list[list[int]]) -> list[int]:
    """Reverse post-order of the reversed graph, from the exit."""
    seen = {last}
    order: list[int] = []
    stack = [(last, iter(before[last]))]
    while stack:
        number, further = stack[-1]
        for following in further:
            if following not in seen:
                seen.add(following)
                stack.append((following, iter(before[following])))
                break
        else:
            order.append(number)
            stack.pop()
    order.reverse()
    return order
