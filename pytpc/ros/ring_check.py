"""What there is of rings on this machine, for ``doctor``."""

from __future__ import annotations

import shlex
from pathlib import Path

from pytpc.base.errors import InputError
from pytpc.base.wording import many
from pytpc.ingest.ring_files import rings_in
from pytpc.workspace.doctor.finding import Finding, Severity


def check_rings(folder: Path) -> list[Finding]:
    """Notes on the rings in the folder where nodes write their files."""
    try:
        found = rings_in(folder)
    except InputError:
        return []
    findings = []
    running = found.writing
    if running.segments:
        oldest = max(one.began_ago_ns for one in running.segments) / 60e9
        what = (
            f"{_processes(running.processes)} with a ring: the last {oldest:.1f} min in"
            f" {many(len(running.segments), 'file')}, {_mib(running.size)}"
        )
        findings.append(Finding(Severity.NOTE, what, str(folder), "to keep it: pytpc keep"))
    ended = len(found.segments) - len(running.segments)
    if ended:
        what = (
            f"{many(ended, 'file')} of rings of {_processes(found.processes - running.processes)}"
            f" that ended, {_mib(found.size - running.size)}"
        )
        mend = f"to remove them: pytpc keep --remove-ended 0 --folder {shlex.quote(str(folder))}"
        findings.append(Finding(Severity.NOTE, what, str(folder), mend))
    return findings


def _processes(count: int) -> str:
    return f"{count} process" if count == 1 else f"{count} processes"


def _mib(size: int) -> str:
    return f"{-(-size >> 20):,} MiB"
