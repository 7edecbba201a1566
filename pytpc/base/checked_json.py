"""Static information as JSON: bytes to a checked object and back, with the place of each fault."""

from __future__ import annotations

import json
import math
import re
from functools import cache
from importlib.resources import files
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from pytpc.base.errors import InputError
from pytpc.base.regular_files import LARGEST_TEXT, read_file
from pytpc.base.wording import plain

if TYPE_CHECKING:
    from collections.abc import Sequence

    from jsonschema import Draft202012Validator
    from jsonschema_rs import Validator

SCHEMA_VERSION = 1
UNIT_SCHEMA = "static_info.schema.json"
MERGED_SCHEMA = "merged.schema.json"
RULES_SCHEMA = "rules.schema.json"
PYTHON_RULES_SCHEMA = "python_rules.schema.json"
_PACKAGE = "pytpc.base"
_LONGEST_MESSAGE = 160
_REBUILD = "; if another version of TPC wrote it, rebuild with `pytpc build`"
_BYTES_OF_VALUE = 16
# Of this many faults the one is shown that explains the others.
_FAULTS = 20
_SURROGATE = re.compile(rb"\\u[dD][89a-fA-F]")


def parse_json(path: Path, *, half_characters: bool = False, most: int = LARGEST_TEXT) -> object:
    """The JSON value in ``path``.

    ``half_characters`` allows escapes of half a surrogate pair, which no UTF-8 file can hold: names
    of files that are not UTF-8 are written so. The file has at most ``most`` bytes.

    Raises:
        InputError: the file cannot be read, is not UTF-8, not JSON (with the line of the fault), or
            too large.
    """
    raw = read_file(path, most)
    # Each needs a hundred times as much memory as it has bytes.
    if sum(raw.count(one) for one in (b",", b"[", b"{")) > most // _BYTES_OF_VALUE:
        raise InputError(f"has more than {most // _BYTES_OF_VALUE:,} values", path)
    try:
        data: object = json.loads(
            raw.decode("utf-8"), parse_constant=_refuse_constant, parse_float=_finite
        )
        if not half_characters and _SURROGATE.search(raw) is not None:
            # JSON can escape half of a surrogate pair, but no UTF-8 file can hold it.
            json.dumps(data, ensure_ascii=False).encode()
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        raise InputError(f"not JSON: byte {error.start} is not UTF-8", path, line) from error
    except UnicodeEncodeError as error:
        half = f"\\u{ord(error.object[error.start]):04x}"
        raise InputError(f"not JSON that can be read: {half} is half a character", path) from error
    except json.JSONDecodeError as error:
        what = "the file is empty" if not raw.strip() else f"{error.msg}, column {error.colno}"
        raise InputError(f"not JSON: {what}", path, error.lineno) from error
    except (RecursionError, ValueError) as error:
        raise InputError(f"not JSON that can be read: {error}", path) from error
    return data


def dump_json(data: object) -> bytes:
    """``data`` as indented UTF-8 JSON with a final newline; the same data gives the same bytes.

    Raises:
        InputError: it holds a file name that is not UTF-8, or a number that JSON cannot hold.
    """
    try:
        text = json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    except ValueError as error:
        raise InputError(f"cannot be written as JSON: {error}") from error
    try:
        return text.encode()
    except UnicodeEncodeError as error:
        line = text[text.rfind("\n", 0, error.start) : text.find("\n", error.start)]
        raise InputError(
            f"not UTF-8, so cannot be written as JSON: {plain(line.strip())}"
        ) from error


def check_unit(data: object, path: Path, pointer: str = "") -> dict[str, Any]:
    """``data`` itself, if it is a link unit by the schema.

    Args:
        data: a parsed JSON value.
        path: the file it came from, for the message.
        pointer: JSON pointer of ``data`` in that file.

    Raises:
        InputError: with the JSON pointer of what breaks the schema.
    """
    version = data.get("schema") if isinstance(data, dict) else SCHEMA_VERSION
    check_version(version, path, pointer)
    check_schema(data, path, UNIT_SCHEMA, pointer)
    if not isinstance(data, dict):
        raise TypeError("the schema let something else than an object pass")
    return data


def check_version(version: object, path: Path, pointer: str = "") -> None:
    """Check that a document is not of another version of static information.

    Raises:
        InputError: it is.
    """
    if isinstance(version, int) and version > SCHEMA_VERSION:
        raise InputError(
            f"{pointer}/schema: written by a newer TPC (format {version}; this one reads"
            f" {SCHEMA_VERSION}); rebuild the workspace, or upgrade TPC",
            path,
        )
    if isinstance(version, int) and version < SCHEMA_VERSION:
        raise InputError(
            f"{pointer}/schema: written by an older TPC (format {version}; this one"
            f" reads {SCHEMA_VERSION}); rebuild the workspace with `pytpc build`",
            path,
        )


def check_schema(
    data: object, path: Path, name: str, pointer: str = "", *, package: str = _PACKAGE
) -> None:
    """Check ``data``, at ``pointer`` in ``path``, against the schema ``name``.

    The schema is the file ``name`` in the folder ``schema`` of ``package``.

    Raises:
        InputError: with the JSON pointer of what breaks the schema.
    """
    try:
        if _quick_validator(name, package).is_valid(data):
            return
    except ValueError:
        # A value that it cannot hold, like an integer of 30 digits.
        pass
    found = _fault(data, name, package)
    if found is not None:
        place, message = found
        old = _REBUILD if name in (UNIT_SCHEMA, MERGED_SCHEMA) else ""
        raise InputError(f"{pointer + _pointer(place) or '/'}: {_shortened(message)}{old}", path)


def check_rules(path: Path) -> None:
    """Check a user's file of rules, which names more functions that read or expose.

    The plugin checks it again when it links, but there a fault is only a warning: the link unit
    stays as it was, and the build goes on.

    Raises:
        InputError: the file cannot be read, is no JSON or breaks the schema, with the place.
    """
    check_schema(parse_json(path), path, RULES_SCHEMA)


class _WholeNumber:
    """The keyword ``whole``: no float. The standard takes 5.0 for an integer."""

    def __init__(self, parent: object, value: object, path: object) -> None:
        """The schema around the keyword does not matter."""

    def validate(self, instance: object) -> None:
        """Refuse a float.

        Raises:
            ValueError: it is one.
        """
        if isinstance(instance, float):
            raise ValueError("a float")


@cache
def _quick_validator(name: str, package: str) -> Validator:
    """Says whether a document is valid, a hundred times as fast as ``_validator``.

    It does not say which of several faults explains the others, which ``best_match`` finds out.
    """
    import jsonschema_rs  # noqa: PLC0415

    units: Any = (UNIT_SCHEMA, _whole(_schema(UNIT_SCHEMA, _PACKAGE)))
    return jsonschema_rs.validator_for(
        _whole(_schema(name, package)),
        registry=jsonschema_rs.Registry([units]),
        keywords={"whole": _WholeNumber},
    )


def _whole(schema: Any) -> Any:  # noqa: ANN401
    """A part of a schema, with the keyword ``whole`` at each integer."""
    if isinstance(schema, list):
        return [_whole(one) for one in schema]
    if not isinstance(schema, dict):
        return schema
    found = {name: _whole(one) for name, one in schema.items()}
    return {**found, "whole": True} if found.get("type") == "integer" else found


def _fault(data: object, name: str, package: str) -> tuple[list[str | int], str] | None:
    """Place and message of the fault that explains ``data`` best; None if it is valid."""
    from jsonschema.exceptions import best_match  # noqa: PLC0415

    validator = _validator(name, package)
    shorter, numbers = _faulty_items(data, name, package)
    fault = best_match(validator.iter_errors(shorter))
    if fault is None:
        # The two validators do not agree; the slow one decides.
        numbers, fault = {}, best_match(validator.iter_errors(data))
    if fault is None:
        return None
    place = list(fault.absolute_path)
    if len(place) > 1 and place[0] in numbers and isinstance(place[1], int):
        place[1] = numbers[place[0]][place[1]]
    return place, fault.message


def _faulty_items(
    data: object, name: str, package: str
) -> tuple[object, dict[str | int, list[int]]]:
    """A document whose lists have only the items with the first faults, and their old numbers.

    To explain a fault among 10,000 comparisons takes a quarter of a minute otherwise.
    """
    if not isinstance(data, dict):
        return data, {}
    try:
        faults = list(islice(_quick_validator(name, package).iter_errors(data), _FAULTS))
    except ValueError:
        return data, {}
    whole = {fault.instance_path[0] for fault in faults if len(fault.instance_path) == 1}
    places: dict[str | int, set[int]] = {}
    for fault in faults:
        match fault.instance_path:
            case [str(key), int(place), *_]:
                places.setdefault(key, set()).add(place)
    numbers: dict[str | int, list[int]] = {
        key: sorted(places.get(key, ()))
        for key, value in data.items()
        if isinstance(value, list) and key not in whole
    }
    shorter = {key: [data[key][place] for place in kept] for key, kept in numbers.items()}
    return {**data, **shorter}, numbers


@cache
def _validator(name: str, package: str) -> Draft202012Validator:
    # jsonschema takes a tenth of a second to import, and many commands check nothing.
    from jsonschema import Draft202012Validator, validators  # noqa: PLC0415
    from referencing import Registry  # noqa: PLC0415
    from referencing.jsonschema import DRAFT202012  # noqa: PLC0415

    schema = _schema(name, package)
    Draft202012Validator.check_schema(schema)
    # The standard takes 5.0 for an integer; a line or a column must be one to count with.
    checker = Draft202012Validator.TYPE_CHECKER.redefine(
        "integer", lambda _, value: isinstance(value, int) and not isinstance(value, bool)
    )
    strict = validators.extend(  # type: ignore[no-untyped-call]
        Draft202012Validator, type_checker=checker
    )
    # The one schema that another one names.
    units = DRAFT202012.create_resource(_schema(UNIT_SCHEMA, _PACKAGE))
    registry: Any = Registry().with_resource(UNIT_SCHEMA, units)
    validator: Draft202012Validator = strict(schema, registry=registry)
    return validator


def _schema(name: str, package: str) -> dict[str, Any]:
    text = files(package).joinpath("schema").joinpath(name).read_text("utf-8")
    schema: dict[str, Any] = json.loads(text)
    return schema


def _pointer(place: Sequence[str | int]) -> str:
    """JSON pointer (RFC 6901) of the value that is wrong; empty for the whole document."""
    steps = [str(step).replace("~", "~0").replace("/", "~1") for step in place]
    return "".join(f"/{step}" for step in steps)


def _shortened(message: str) -> str:
    """The end of a message says what is wrong; its beginning may be the whole document."""
    if len(message) <= _LONGEST_MESSAGE:
        return message
    return message[:40] + " ... " + message[-(_LONGEST_MESSAGE - 45) :]


def _finite(text: str) -> float:
    number = float(text)
    if math.isinf(number):
        raise ValueError(f"{text} is too large for a number")
    return number


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is not a JSON number")
