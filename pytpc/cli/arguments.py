"""The arguments and options of a command as one object."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import TypeVar

Arguments = TypeVar("Arguments")


def as_object(
    kind: Callable[..., Arguments],
) -> Callable[[Callable[[Arguments], None]], Callable[..., None]]:
    """Hand a command its arguments and options as one object of the dataclass ``kind``."""

    def decorated(command: Callable[[Arguments], None]) -> Callable[..., None]:
        @wraps(command)
        def with_object(**given: object) -> None:
            command(kind(**given))

        return with_object

    return decorated
