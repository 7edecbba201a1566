"""Arguments and options that several commands share, and a command's arguments as one object."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import TypeVar

import click

Arguments = TypeVar("Arguments")
Command = TypeVar("Command", bound=Callable[..., object])

PATH = click.Path(path_type=Path)
JSON = click.option("--json", "as_json", is_flag=True, help="Print JSON, for programs.")
STATIC_OUTPUT = click.option(
    "-o",
    "--output",
    type=PATH,
    default=Path("static.json"),
    show_default=True,
    help="Write the static information to this file.",
)
RULES = click.option(
    "--rules",
    type=PATH,
    metavar="FILE",
    help="JSON file with your own rules: more functions that read a parameter or expose.",
)
PYTHON_RULES = click.option(
    "--python-rules",
    type=PATH,
    metavar="FILE",
    help="JSON file with your own rules for Python nodes.",
)
NO_PYTHON = click.option("--no-python", is_flag=True, help="Do not analyse Python nodes.")
CONSTANTS = click.option(
    "--constants", is_flag=True, help="Report comparisons with constants, too."
)

REFERENCE = click.option(
    "--reference",
    "references",
    type=PATH,
    multiple=True,
    metavar="RECORDING",
    help="A good run of the same robot, or a PROFILE of them by `learn`; may be repeated, the last"
    " one last. What differs is shown first, and a parameter that kept its value is unlikely to be"
    " the cause.",
)

STATIC = click.option(
    "--static",
    "static_source",
    type=PATH,
    metavar="FILE_OR_FOLDER",
    help="Static information: a static.json, a build base or a built workspace. [default: that of"
    " the recording, else the one found in this folder or a sourced workspace]",
)
MARKS = click.option(
    "--marks",
    "marks_files",
    type=PATH,
    multiple=True,
    metavar="FILE",
    help="CSV file with more marks of the recording, as `mark -o` writes it; may be repeated.",
)


class Seconds(click.FloatRange):
    """A number of seconds; unlike click's float range it rejects "nan"."""

    name = "seconds"

    def convert(
        self, value: float, param: click.Parameter | None, ctx: click.Context | None
    ) -> float:
        """Convert the text, or fail with a usage error."""
        seconds = float(super().convert(value, param, ctx))
        if math.isnan(seconds):
            self.fail(f"{value!r} is not a number.", param, ctx)
        return seconds


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
