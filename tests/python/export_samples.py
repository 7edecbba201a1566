"""A small mission for the tests of exports, with numbers worked out by hand."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from mission_samples import EventBuilder, SummaryBuilder, comparison, key, link_unit, ns

from pytpc.api.comparing import RecordedRun
from pytpc.api.diagnosing import AskedMission
from pytpc.api.exporting import export_of
from pytpc.diagnosis.question import PLAIN
from pytpc.diagnosis.results.exported import MissionExport
from pytpc.recording.events import Report
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.recording.summaries import Summary
from pytpc.static.link_unit import Transform
from pytpc.static.static_info import StaticInfo

NODE = "/arm/guard"
HOSTILE = '/a b\n"<script>,=1+1\u202e\ud800'
"""A name of a node, as no ROS gives one, but a recording may."""

LIMIT = comparison(0, "~limit")
NEAR = comparison(1, "~near", "<", transform=Transform("affine", 2.0, 0.0))
USED = comparison(2, "~used", "flag")
STATIC = StaticInfo.of([link_unit([LIMIT, NEAR, USED])])

# Seconds, key, result, cmp, thresh, node. ~limit: value > threshold, so that 4 > 3 has the margin 1
# and 2 > 3 has -1. ~near: value < 2 * ~near; 5 < 8 has 3 in the unit compared, 1.5 in ~near's.
ROWS = [
    (1.0, 0, True, 4.0, 3.0, NODE),
    (2.0, 0, False, 2.0, 3.0, NODE),
    (2.5, 1, True, 5.0, 8.0, NODE),
    (3.0, 2, True, 1.0, 1.0, NODE),
    (4.0, 0, True, 4.0, 3.5, NODE),
]
# It ends at 3.5 s, and so comes between the last two rows. The last of its 7 evaluations is 9 < 8.
SUMMARY = Summary(
    key(1),
    NODE,
    ns(2.6),
    ns(3.5),
    7,
    1,
    7,
    0,
    False,
    False,
    9.0,
    8.0,
    -4.0,
    1.0,
    -1.0,
    1.0,
    4.0,
    9.0,
)
MARKS = (Mark(ns(4.5), "I", "ann", "=SUM(A1)"), Mark(ns(5.0), "II"))


def mission(*more: tuple[float, int, bool, float, float, str]) -> Recording:
    builder, summaries = EventBuilder(), SummaryBuilder()
    for seconds, number, result, cmp, thresh, node in sorted([*ROWS, *more]):
        builder.add(ns(seconds), node, Report(key(number), result, cmp, thresh, result))
    summaries.add(SUMMARY)
    return Recording(
        "mission", builder.build(), MARKS, ns(1.0), ns(6.0), summaries=summaries.build()
    )


def exported(recording: Recording | None = None, source: Path | None = None) -> MissionExport:
    run = RecordedRun(mission() if recording is None else recording, source)
    return export_of(AskedMission.of(run, STATIC, replace(PLAIN, declared=())), period_s=1.0)
