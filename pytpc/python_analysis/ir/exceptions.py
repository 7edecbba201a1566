"""Which handlers may catch an exception, by the names of classes."""

from __future__ import annotations

import ast
import builtins
from collections.abc import Sequence

from pytpc.python_analysis.ir.instructions import Handler

ALL: None = None


def names_taken(handler: ast.ExceptHandler) -> tuple[str, ...] | None:
    """The last parts of the classes' names; None where the handler catches everything."""
    match handler.type:
        case None:
            return ALL
        case ast.Tuple(elts=parts):
            names = tuple(ast.unparse(part).rsplit(".", 1)[-1] for part in parts)
        case other:
            names = (ast.unparse(other).rsplit(".", 1)[-1],)
    return ALL if "BaseException" in names else names


def taken_by(handlers: Sequence[Handler], name: str | None) -> tuple[list[Handler], bool]:
    """Where an exception of the class ``name`` (None: unknown) may go.

    Returns:
        The handlers, the innermost first, and whether it may leave the function.
    """
    taken: list[Handler] = []
    for handler in handlers:
        sure = _takes(handler.names, name)
        if sure is not False:
            taken.append(handler)
        if sure:
            return taken, False
    return taken, True


def _takes(names: tuple[str, ...] | None, raised: str | None) -> bool | None:
    """True, False, or None where it is unknown."""
    if names is None:
        return True
    if raised is None:
        return True if "Exception" in names else None
    if raised in names:
        return True
    kind = getattr(builtins, raised, None)
    if not (isinstance(kind, type) and issubclass(kind, BaseException)):
        return True if "Exception" in names else None
    known = [getattr(builtins, name, None) for name in names]
    return any(isinstance(each, type) and issubclass(kind, each) for each in known)
