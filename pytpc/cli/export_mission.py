"""The part of ``export`` that is about recordings: its options, and what it writes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import wraps
from pathlib import Path
from typing import Any

import click

from pytpc.base.paths import MERGED_FILE, OWN_FOLDER
from pytpc.base.wording import many, plain
from pytpc.cli.arguments import PATH, REFERENCE
from pytpc.cli.console import print_json, progress, warn
from pytpc.cli.options import (
    MARKS,
    STATIC,
    Seconds,
    asked_mission,
    good_runs,
    recording_of,
)
from pytpc.cli.sources import static_for
from pytpc.diagnosis.question import PLAIN
from pytpc.recording.mission import RUN_FILE, is_converted, is_ros2_folder

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
_OF_RECORDINGS = (".bag", ".mcap", ".db3", ".tpc", ".log", ".txt")


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


def is_recording(source: Path) -> bool:
    """Whether a path is a recording, and no workspace."""
    if source.is_dir():
        recorded = is_converted(source) or is_ros2_folder(source) or (source / RUN_FILE).is_file()
        return recorded and not (source / OWN_FOLDER).is_dir()
    return source.suffix in _OF_RECORDINGS


def is_static(source: Path) -> bool:
    """Whether a path is static information alone."""
    if source.is_dir():
        return (source / OWN_FOLDER / MERGED_FILE).is_file()
    return source.suffix == ".json"


def export_mission(sources: Sequence[Path], viewers: Viewers) -> None:
    """Write a recording for other viewers.

    Raises:
        UsageError: it is not one recording.
        TpcError: it cannot be read or judged, or an output cannot be written.
    """
    # They take as long to import as the rest of the command.
    from pytpc.api.comparing import RecordedRun  # noqa: PLC0415
    from pytpc.api.exporting import export_of  # noqa: PLC0415

    first = next(iter(viewers.outputs))
    if len(sources) != 1:
        raise click.UsageError(f"give one recording as SOURCE for {first}")
    source = sources[0]
    if is_static(source):
        raise click.UsageError(
            f"{source} is static information, for --sarif and --html; give a recording for {first}"
        )
    run = RecordedRun(recording_of(source, viewers.marks_files), source)
    static = static_for(viewers.static_source, source, run.recording)
    good = good_runs(viewers.references, static)
    asked = asked_mission(run, static, PLAIN, good)
    with progress("judging the marks") as advance:
        found = export_of(asked, period_s=viewers.period_s, on_progress=advance)
    if found.unknown:
        warn(
            f"{many(found.unknown, 'report')} left out: the static information does not have their"
            " comparisons"
        )
    _write(found, viewers)
    if viewers.as_json:
        print_json(
            {
                "mission": found.name,
                "comparisons": len(found.series),
                "rows": found.count,
                "unknown": found.unknown,
                "marks": len(found.marks),
                "start_ns": found.start_ns,
                "end_ns": found.end_ns,
                "outputs": {
                    option.lstrip("-"): str(path) for option, path in viewers.outputs.items()
                },
            }
        )
        return
    what = (
        f"{many(found.count, 'row')} of {many(len(found.series), 'comparison')},"
        f" {many(len(found.marks), 'mark')}"
    )
    for path in viewers.outputs.values():
        click.echo(f"{what}: {plain(str(path))}")


def _write(found: Any, viewers: Viewers) -> None:  # noqa: ANN401
    """Write each output that is asked for."""
    from pytpc.present.viewers.flat_tables import write_tables  # noqa: PLC0415
    from pytpc.present.viewers.layouts import write_foxglove, write_plotjuggler  # noqa: PLC0415
    from pytpc.present.viewers.mcap_export import write_mcap  # noqa: PLC0415
    from pytpc.present.viewers.rerun_export import rerun_sdk, write_rerun  # noqa: PLC0415

    if viewers.rerun_file is not None:
        # Before anything is written, if it is missing.
        rerun_sdk()
    if viewers.mcap is not None:
        with progress(f"writing {viewers.mcap.name}") as advance:
            write_mcap(found, viewers.mcap, advance)
    if viewers.foxglove is not None:
        write_foxglove(found, viewers.foxglove)
    if viewers.plotjuggler is not None:
        write_plotjuggler(found, viewers.plotjuggler, viewers.mcap)
    if viewers.rerun_file is not None:
        with progress(f"writing {viewers.rerun_file.name}") as advance:
            write_rerun(found, viewers.rerun_file, advance)
    for folder, kind in ((viewers.csv_folder, "csv"), (viewers.parquet_folder, "parquet")):
        if folder is not None:
            with progress(f"writing {folder.name}") as advance:
                write_tables(found, folder, kind, advance)
