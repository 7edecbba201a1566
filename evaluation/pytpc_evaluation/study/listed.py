"""Lists of records in JSON that a study's folder may have."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from pytpc.base.checked_json import parse_json
from pytpc.base.errors import InputError

_Record = TypeVar("_Record")


def read_list(path: Path, record: Callable[[Any], _Record], wrong: str) -> list[_Record]:
    """The records of a file; none where there is no such file.

    Args:
        path: of a JSON list.
        record: makes a record from an entry; KeyError or TypeError where it is none.
        wrong: how the message begins if the file is something else.

    Raises:
        InputError: the file cannot be read, or is something else.
    """
    if not path.is_file():
        return []
    document = parse_json(path)
    try:
        if not isinstance(document, list):
            raise TypeError("a list is expected")
        return [record(one) for one in document]
    except (KeyError, TypeError) as error:
        raise InputError(f"{wrong}: {error}", path) from error
