"""How large harmless changes are and what they turned, against numbers worked out by hand."""

from __future__ import annotations

import json
import re

import pytest
from mission_samples import ns
from study_pages import row_of
from study_samples import EVENTS, STATIC

from pytpc.recording.mission import Recording
from pytpc.recording.parameter_change import Change
from pytpc_evaluation.study.report.changed import turned
from pytpc_evaluation.study.report.making import ReportOptions, make_report

RECORDING = Recording("m", EVENTS, (), 0, ns(20))
NODE = EVENTS.nodes[0]


# t > ~low (5) at 1 to 20 s is true from 6 s on; with 8 it would be from 9 s on, so that 6, 7 and 8
# turn. t > ~high (30) is never true, nor with 60; with 18.5 it would be at 19 and 20 s. 1 > ~other
# (0) is asked once.
@pytest.mark.parametrize(
    ("parameter", "old", "count"),
    [
        ("~low", 8.0, 3),
        ("/node/low", 5.0, 0),
        ("~high", 60.0, 0),
        ("~high", 18.5, 2),
        ("~other", 2.0, 1),
        ("~never", 1.0, 0),
        ("~nobody", 1.0, 0),
    ],
)
def test_decisions_that_the_old_value_turns(parameter, old, count):
    assert turned(RECORDING, STATIC, Change(parameter, NODE, old, 7.0)) == count
    assert turned(RECORDING, STATIC, Change(parameter, "/another", old, 7.0)) == 0


# Harmless: ~high 60 -> 30 (ln 2, turns nothing) in both missions, and in one of them ~other 2 -> 0,
# which has no size and turns one. Treated: ~low 8 -> 5, ln 1.6 = 0.47, turns three.
def test_the_changes_on_the_page(own_study, tmp_path):
    low, high, other = (
        {"parameter": name, "node": NODE, "old": old, "new": new}
        for name, old, new in (("~low", 8, 5), ("~high", 60, 30), ("~other", 2, 0))
    )
    for seed, changes in ((1, [high, low, other]), (2, [low, high])):
        folder = own_study / f"missions/alpha/type1_low/seed-{seed}"
        (folder / "changes.json").write_text(json.dumps(changes))
        treatment = json.loads((folder / "treatment.json").read_text())
        (folder / "treatment.json").write_text(json.dumps({**treatment, "node": NODE}))
    made = make_report(own_study, tmp_path / "study.md", ReportOptions(draw=False))
    text = re.sub(r"\n +", " ", made.page.read_text())
    assert row_of(text, "How large changes are", "alpha") == [
        "2", "0.69", "2", "33", "1", "0.47", "1.6", "100"
    ]  # fmt: skip
    assert row_of(text, "How large changes are", "image_capture") == [
        "0", "-", "-", "-", "0", "-", "-", "-"
    ]  # fmt: skip
    assert "by a factor of 2 (treatments: 1.6)" in text
    assert "33 % of these changes turned decisions" in text


def test_without_harmless_changes_the_page_says_so(study_text):
    assert "No mission has harmless changes." in study_text
    assert "There were two rounds." in study_text


def test_a_history_that_cannot_be_read_leaves_its_mission_out(own_study, tmp_path):
    (own_study / "missions/alpha/clean/seed-1/changes.json").write_text("{}")
    made = make_report(own_study, tmp_path / "study.md", ReportOptions(draw=False))
    assert any("not a history of changes" in trouble for trouble in made.troubles)
