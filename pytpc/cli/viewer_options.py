"""The options of ``export`` that are about recordings. It imports little, as the command does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import wraps
from pathlib import Path
from typing import Any

import click

from pytpc.cli.arguments import MARKS, PATH, REFERENCE, STATIC, Seconds

PERIOD = click.option(
    "--period",
    "period_s",
    type=Seconds(min=0.01, max=86400.0),
    default=1.0,
    show_default=True,
    metavar="SECONDS",
    help="How often the ranks that `watch` shows are written.",
)
_FILES = {
    "mcap": ("--mcap", "MCAP, for Foxglove, Lichtblick, PlotJuggler and Rerun."),
    "foxglove": ("--foxglove", "A layout for the MCAP file in Foxglove and Lichtblick."),
    "plotjuggler": ("--plotjuggler", "A layout for the MCAP file in PlotJuggler."),
    "rerun_file": ("--rerun", "A recording for Rerun's viewer (.rrd)."),
}
_FOLDERS = {
    "csv_folder": ("--csv", "Tables as CSV, for spreadsheets and pandas."),
    "parquet_folder": ("--parquet", "Tables as Parquet, for pandas and others."),
}


@dataclass(frozen=True)
class Viewers:
    """What is written of a recording, and how it is judged."""

    mcap: Path | None
    foxglove: Path | None
    plotjuggler: Path | None
    rerun_file: Path | None
    csv_folder: Path | None
    parquet_folder: Path | None
    static_source: Path | None
    marks_files: tuple[Path, ...]
    references: tuple[Path, ...]
    period_s: float
    as_json: bool

    @property
    def outputs(self) -> dict[str, Path]:
        """The files and folders to write, by their options."""
        named = {**_FILES, **_FOLDERS}
        return {
            option: path
            for name, (option, _) in named.items()
            if (path := getattr(self, name)) is not None
        }


def VIEWERS(command: Callable[..., None]) -> Callable[..., None]:
    """Add the options about recordings; the command gets ``viewers``."""
    names = [one.name for one in fields(Viewers)]

    @wraps(command)
    def with_viewers(**given: Any) -> None:  # noqa: ANN401
        made = Viewers(**{name: given.pop(name) for name in names})
        command(viewers=made, **given)

    options = [
        *(
            click.option(option, name, type=PATH, metavar=kind, help=f"Of a recording: {text}")
            for kind, named in (("FILE", _FILES), ("FOLDER", _FOLDERS))
            for name, (option, text) in named.items()
        ),
        STATIC,
        MARKS,
        REFERENCE,
        PERIOD,
        click.option(
            "--json", "as_json", is_flag=True, help="Of a recording: print JSON, for programs."
        ),
    ]
    for option in reversed(options):
        with_viewers = option(with_viewers)
    return with_viewers
