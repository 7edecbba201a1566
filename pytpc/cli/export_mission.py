"""The part of ``export`` that is about recordings: what it writes."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

import click

from pytpc.api.comparing import RecordedRun
from pytpc.api.exporting import export_of
from pytpc.base.errors import InputError
from pytpc.base.paths import MERGED_FILE, OWN_FOLDER
from pytpc.base.signals import signals_end
from pytpc.base.wording import many, plain
from pytpc.cli.console import print_json, progress, warn
from pytpc.cli.options import asked_mission, good_runs, recording_of
from pytpc.cli.sources import static_for
from pytpc.cli.viewer_options import Viewers
from pytpc.diagnosis.question import PLAIN
from pytpc.diagnosis.results.exported import MissionExport
from pytpc.present.viewers.flat_tables import TABLES, write_tables
from pytpc.present.viewers.layouts import write_foxglove, write_plotjuggler
from pytpc.present.viewers.mcap_export import write_mcap
from pytpc.present.viewers.rerun_export import rerun_sdk, write_rerun
from pytpc.recording.marks import is_marks_file
from pytpc.recording.marks_home import marks_home
from pytpc.recording.mission import RUN_FILE, is_converted, is_ros2_folder

_OF_RECORDINGS = (".bag", ".mcap", ".db3", ".tpc", ".log", ".txt")


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
    first = next(iter(viewers.outputs))
    if len(sources) != 1:
        raise click.UsageError(f"give one recording as SOURCE for {first}")
    source = sources[0]
    if is_static(source):
        raise click.UsageError(
            f"{source} is static information, for --sarif and --html; give a recording for {first}"
        )
    _refuse_outputs(source, viewers)
    if viewers.rerun_file is not None:
        # Before anything is read or written, if it is missing.
        rerun_sdk()
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
    # A signal leaves no part of a file.
    with signals_end():
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


def _refuse_outputs(source: Path, viewers: Viewers) -> None:
    """Refuse outputs that would replace what is read, a file of marks, or each other.

    Raises:
        UsageError: two options name the same file.
        InputError: an output lies where nothing may be replaced.
    """
    kept = {_real(path) for path in (source, *viewers.marks_files, *viewers.references)}
    if viewers.static_source is not None:
        kept.add(_real(viewers.static_source))
    home = marks_home(source)
    kept |= {_real(path) for path in (home.file, *home.files(), *home.files_nearby())}
    folder = _real(source)
    written: dict[Path, str] = {}
    for option, path in viewers.outputs.items():
        is_folder = path in (viewers.csv_folder, viewers.parquet_folder)
        if not is_folder and path.is_dir():
            raise InputError(f"it is a folder; give {option} the path of a file", path)
        kind = option.lstrip("-")
        files = [path / f"{name}.{kind}" for name in TABLES] if is_folder else [path]
        for file in files:
            real = _real(file)
            if real in kept or folder in real.parents or is_marks_file(file):
                raise InputError(
                    f"{option} would write into the recording, or over marks or another file that"
                    " is read; give another path",
                    file,
                )
            if (other := written.setdefault(real, option)) != option:
                raise click.UsageError(f"{other} and {option} name the same file: {file}")


def _real(path: Path) -> Path:
    return Path(os.path.realpath(path))


def _write(found: MissionExport, viewers: Viewers) -> None:
    """Write each output that is asked for."""
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
