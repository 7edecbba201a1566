"""Learns what is normal for a robot: good runs, made small, in a profile."""

from __future__ import annotations

import hashlib
import json
import shutil
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from pytpc.api.comparing import RecordedRun
from pytpc.api.missions import check_has_reports
from pytpc.api.static_of_mission import recorded_static
from pytpc.base.errors import InputError, TpcError
from pytpc.base.legal_names import file_part
from pytpc.base.paths import MERGED_FILE
from pytpc.diagnosis.thinned import thinned
from pytpc.recording.graph_file import GRAPH_FILE
from pytpc.recording.mission import Recording, save_recording
from pytpc.recording.profile import (
    LEARNED_FILE,
    LearnedRun,
    begin_profile,
    is_profile,
    runs_in,
    write_learned,
)
from pytpc.values.origins import PARAMS_FILE, origins_file
from pytpc.values.recording import params_file


def learn(recording: Recording, source: Path, profile: Path) -> LearnedRun:
    """Put a good run into a profile; the same run again replaces the earlier one.

    What is kept: a few rows of each comparison, the values of parameters, the graph, and the static
    information of the build. Marks are not kept.

    Args:
        recording: the run.
        source: its path, beside which its other files are.
        profile: the folder; it is made.

    Raises:
        InputError: the run has no reports, or ``profile`` is something else.
        TpcError: the profile cannot be written.
    """
    check_has_reports(recording, source)
    if (source / LEARNED_FILE).is_file():
        raise InputError("is a part of a profile already; give the recording itself", source)
    if is_profile(source):
        raise InputError("is a profile; give the recordings themselves", source)
    where = str(source.absolute())
    reports = len(recording.events) + len(recording.summaries)
    digest = reports_digest(recording)
    name = file_part(source.absolute().name, "run")
    run = LearnedRun(
        f"{name}-{digest[:8]}", where, recording.start_ns, recording.end_ns, reports, digest
    )
    # Who reads the profile reads these values; what is broken is said now.
    _ = RecordedRun(recording, source).values
    begin_profile(profile)
    try:
        scratch = Path(tempfile.mkdtemp(prefix=".learning-", dir=profile))
        try:
            _write(recording, source, run, scratch)
            _put(scratch, profile / run.folder)
        finally:
            shutil.rmtree(scratch, ignore_errors=True)
    except OSError as error:
        raise TpcError(f"cannot be written: {error.strerror or error}", profile) from error
    return run


def reports_digest(recording: Recording) -> str:
    """The SHA-256 of all reports of a recording, as hexadecimal digits."""
    found = hashlib.sha256()
    for table in (recording.events, recording.summaries):
        found.update(json.dumps([table.keys, table.nodes]).encode())
        for name, column in sorted(table.columns().items()):
            found.update(name.encode() + np.ascontiguousarray(column).tobytes())
    return found.hexdigest()


def forget(profile: Path, name: str) -> LearnedRun:
    """Remove a run from a profile.

    Args:
        profile: the folder.
        name: of the run's folder, or of the recording if only one has it.

    Raises:
        InputError: no such run, or several.
    """
    runs = runs_in(profile)
    meant = [run for run in runs if name == run.folder]
    meant = meant or [run for run in runs if name in (run.name, run.source)]
    if len(meant) != 1:
        there = ", ".join(run.folder for run in meant or runs) or "none"
        what = "several runs" if meant else "no run"
        raise InputError(f"{what} called {name}; there are: {there}", profile)
    folder = profile / meant[0].folder
    try:
        # Without this file it is no run of the profile, whatever is left of it.
        (folder / LEARNED_FILE).unlink()
        shutil.rmtree(folder)
    except OSError as error:
        raise TpcError(f"cannot be removed: {error.strerror or error}", folder) from error
    return meant[0]


def _write(recording: Recording, source: Path, run: LearnedRun, folder: Path) -> None:
    small = replace(thinned(recording), name=run.name, marks=())
    save_recording(small, folder)
    files = {
        PARAMS_FILE: params_file(source),
        origins_file(source).name: origins_file(source),
        GRAPH_FILE: (source if source.is_dir() else source.parent) / GRAPH_FILE,
        MERGED_FILE: recorded_static(source, recording),
    }
    for name, file in files.items():
        if file is not None and file.is_file():
            shutil.copyfile(file, folder / name)
    write_learned(run, folder)


def _put(made: Path, folder: Path) -> None:
    """Put a finished folder in its place; one that was there goes out of the way first."""
    made.chmod(0o755)
    gone = made.with_name(f"{made.name}-gone")
    if folder.exists():
        folder.rename(gone)
    made.rename(folder)
    shutil.rmtree(gone, ignore_errors=True)
