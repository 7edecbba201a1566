"""What two recordings decided differently, with the same code or another build of it."""

from __future__ import annotations

from dataclasses import replace

from pytpc.api.comparing import RecordedRun, Run
from pytpc.api.missions import Source, load_static, with_names_of
from pytpc.diagnosis.decisions import decisions
from pytpc.diagnosis.full_names import with_keys_of
from pytpc.diagnosis.results.decisions import RunDecisions
from pytpc.static.static_info import StaticInfo


def compare_decisions(old: Run, new: Run, static_info: StaticInfo | Source) -> RunDecisions:
    """How each comparison came out in two runs: how often, which way, by how much.

    Args:
        old: the older run. If it is of another build, its comparisons are found by their places.
        new: the newer run.
        static_info: of the newer run's build.

    Raises:
        InputError: something cannot be read.
    """
    given = load_static(static_info)
    before, after = RecordedRun.of(old), RecordedRun.of(new)
    named = with_names_of(after.recording, given, after.source)
    recording = with_keys_of(before.in_build(given).recording, given, named)
    return decisions(replace(before.values, recording=recording), after.values, named)
