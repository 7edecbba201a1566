"""What is wrong with a recording, in sentences: everything that was left out is named."""

from __future__ import annotations

from collections.abc import Iterator

from pytpc.base.wording import many
from pytpc.diagnosis.ranking.mark_ranking import unknown_keys
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo

_NAMED = 3
"""Unknown keys that are named, those with the most reports."""


def complaints(recording: Recording, static_info: StaticInfo | None = None) -> Iterator[str]:
    """Each a sentence without a final full stop, the most harmful first.

    Args:
        recording: the mission.
        static_info: where given, reports that it does not know are among the complaints.
    """
    unknown = unknown_keys(recording.events, static_info) if static_info is not None else {}
    if unknown:
        often = sorted(unknown, key=lambda key: (-unknown[key], key))[:_NAMED]
        named = ", ".join(f"{key} ({unknown[key]:,})" for key in often)
        more = f" and {len(unknown) - _NAMED:,} more" if len(unknown) > _NAMED else ""
        yield (
            f"{many(sum(unknown.values()), 'report')} of {many(len(unknown), 'key')} left out:"
            f" not in the static information (built at another time?): {named}{more}"
        )
    if recording.lost:
        worst = max(recording.lost, key=lambda node: (recording.lost[node], node))
        yield (
            f"{many(sum(recording.lost.values()), 'log message')} lost on the way to the"
            f" recorder, most of {worst} ({recording.lost[worst]:,})"
        )
    if recording.malformed:
        first = recording.malformed_first[0]
        # Records of files say at which byte or line they stand.
        at = f" at {(first.time_ns - recording.start_ns) / 1e9:.3f} s" if first.time_ns else ""
        text = f": {first.text!r}" if first.text else ""
        yield (
            f"{many(recording.malformed, 'broken report')} left out, the first on"
            f" {first.topic}{at}: {first.what}{text}"
        )
    if recording.dropped:
        count = sum(dropped.count for dropped in recording.dropped)
        reasons = ", ".join(sorted({dropped.why for dropped in recording.dropped}))
        yield f"{many(count, 'report')} left out by the nodes themselves ({reasons})"
    for unit in static_info.failed if static_info is not None else ():
        yield f"{unit.package}/{unit.link_unit} was not analysed: {unit.failure}"
    yield from recording.notes
