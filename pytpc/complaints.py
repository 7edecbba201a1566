"""What is wrong with a recording, in sentences: nothing is left out without a word."""

from __future__ import annotations

from collections.abc import Iterator

from pytpc.ingest.recording import Recording
from pytpc.ranking import unknown_keys
from pytpc.static_info import StaticInfo
from pytpc.words import many


def complaints(recording: Recording, static_info: StaticInfo | None = None) -> Iterator[str]:
    """Each a sentence without a final full stop, the most harmful first.

    Args:
        recording: the mission.
        static_info: where given, reports that it does not know are among the complaints.
    """
    unknown = unknown_keys(recording.events, static_info) if static_info is not None else {}
    if unknown:
        yield (
            f"{many(sum(unknown.values()), 'report')} of {many(len(unknown), 'key')} left out:"
            f" not in the static information, as {next(iter(unknown))} (built at another time?)"
        )
    if recording.lost:
        worst = max(recording.lost, key=lambda node: (recording.lost[node], node))
        yield (
            f"{many(sum(recording.lost.values()), 'log message')} lost on the way to the"
            f" recorder, most of {worst} ({recording.lost[worst]:,})"
        )
    if recording.malformed:
        first = recording.malformed_first[0]
        at = (first.time_ns - recording.start_ns) / 1e9
        yield (
            f"{many(recording.malformed, 'broken report')} left out, the first on {first.topic} at"
            f" {at:.3f} s: {first.what}: {first.text!r}"
        )
    for unit in static_info.failed if static_info is not None else ():
        yield f"{unit.package}/{unit.link_unit} was not analysed: {unit.failure}"
    yield from recording.notes
