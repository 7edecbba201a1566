"""Learns what is normal for a robot: good runs, made small, in a profile."""

from __future__ import annotations

import hashlib
import re
import shutil
import tempfile
from dataclasses import replace
from pathlib import Path

from pytpc.api.missions import check_has_reports
from pytpc.api.static_of_mission import recorded_static
from pytpc.base.errors import InputError, TpcError
from pytpc.base.paths import MERGED_FILE
from pytpc.diagnosis.thinned import thinned
from pytpc.recording.graph_file import GRAPH_FILE
from pytpc.recording.mission import Recording, save_recording
from pytpc.recording.profile import (
    LEARNED_FILE,
    LearnedRun,
    begin_profile,
    runs_in,
    write_learned,
)
from pytpc.values.origins import PARAMS_FILE, origins_file
from pytpc.values.recording import params_file

_NAME = 60
"""Characters of a recording's name in that of its folder."""


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
    begin_profile(profile)
    where = str(source.absolute())
    reports = len(recording.events) + len(recording.summaries)
    said = f"{recording.start_ns} {recording.end_ns} {reports}"
    name = re.sub(r"[^A-Za-z0-9_.-]+", "-", source.absolute().name).strip(".-")[:_NAME] or "run"
    folder = f"{name}-{hashlib.sha256(said.encode()).hexdigest()[:8]}"
    run = LearnedRun(folder, where, recording.start_ns, recording.end_ns, reports)
    try:
        scratch = Path(tempfile.mkdtemp(prefix=".learning-", dir=profile))
        try:
            _write(recording, source, run, scratch)
            _put(scratch, profile / folder)
        finally:
            shutil.rmtree(scratch, ignore_errors=True)
    except OSError as error:
        raise TpcError(f"cannot be written: {error.strerror or error}", profile) from error
    return run


def forget(profile: Path, name: str) -> LearnedRun:
    """Remove a run from a profile.

    Args:
        profile: the folder.
        name: of the run's folder, or of the recording if only one has it.

    Raises:
        InputError: no such run, or several.
    """
    runs = runs_in(profile)
    meant = [run for run in runs if name in (run.folder, run.name, run.source)]
    if len(meant) != 1:
        there = ", ".join(run.folder for run in meant or runs) or "none"
        what = "several runs" if meant else "no run"
        raise InputError(f"{what} called {name}; there are: {there}", profile)
    shutil.rmtree(profile / meant[0].folder, ignore_errors=True)
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
    """Put a finished folder in its place; one that was there is removed first."""
    made.chmod(0o755)
    if folder.exists():
        # Without this file it is no run of the profile.
        (folder / LEARNED_FILE).unlink(missing_ok=True)
        shutil.rmtree(folder)
    made.rename(folder)
