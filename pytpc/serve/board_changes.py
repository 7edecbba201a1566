"""What is new in a board, so that a page is told only that."""

from __future__ import annotations

from typing import Any

Board = dict[str, Any]


def changes(before: Board | None, after: Board) -> Board:
    """What turns one board into another.

    Returns:
        For each part that differs: a list of rows as ``{"order": ids, "rows": new and changed
        ones}`` (``order`` only if that changed), any other part as ``{"is": value}``.
        Everything, if there was none before.

    >>> one = {"near": [{"id": "a", "v": 1}, {"id": "b", "v": 1}], "window_s": 12}
    >>> two = {"near": [{"id": "a", "v": 1}, {"id": "b", "v": 2}], "window_s": 12}
    >>> changes(one, two)
    {'near': {'rows': [{'id': 'b', 'v': 2}]}}
    """
    found = {}
    for name, value in after.items():
        known = before.get(name) if before is not None else None
        if before is not None and known == value:
            continue
        if not isinstance(value, list):
            found[name] = {"is": value}
            continue
        old = {row["id"]: row for row in known or ()}
        part: Board = {"rows": [row for row in value if old.get(row["id"]) != row]}
        order = [row["id"] for row in value]
        if known is None or order != list(old):
            part["order"] = order
        found[name] = part
    return found


def is_news(found: Board) -> bool:
    """Whether it is more than that time passed."""
    return bool(found.keys() - {"clock"})
