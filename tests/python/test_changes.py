"""What was changed on a robot, from a history or from two dumps of its parameters."""

from __future__ import annotations

import json
import math

import pytest

from pytpc.base.errors import InputError
from pytpc.recording.parameter_change import Change
from pytpc.values.changes import changes_between, read_changes


def test_a_history(tmp_path):
    path = tmp_path / "changes.json"
    one = {"parameter": "~a", "node": "/n", "old": 1, "new": 2.5}
    path.write_text(json.dumps([one, {"parameter": "b", "old": False, "new": True}]))
    assert read_changes(path) == (Change("~a", "/n", 1.0, 2.5), Change("b", "", 0.0, 1.0))


@pytest.mark.parametrize(
    ("document", "said"),
    [
        ({}, "expected a list"),
        ([1], "1 is no object"),
        ([{"parameter": 1, "old": 1, "new": 2}], "parameter and node are texts"),
        ([{"parameter": "a", "node": None, "old": 1, "new": 2}], "parameter and node are texts"),
        ([{"parameter": "a", "old": "1", "new": 2}], "old is no number"),
        ([{"parameter": "a", "old": 1}], "new is no number"),
        ([{"parameter": "a", "old": 10**400, "new": 1}], "old is no number"),
    ],
)
def test_what_is_none(tmp_path, document, said):
    path = tmp_path / "changes.json"
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match=said):
        read_changes(path)


def test_the_difference_of_two_dumps(tmp_path):
    before, after = tmp_path / "before.yaml", tmp_path / "after.yaml"
    before.write_text("n: {same: 1, number: 1, text: a, list: [1], gone: 2, nan: .nan}\n")
    after.write_text("n: {same: 1, number: 1.5, text: b, list: [1], new: 3, nan: .nan}\n")
    found = changes_between(before, after)
    assert [change.parameter for change in found] == ["/n/gone", "/n/new", "/n/number", "/n/text"]
    assert (found[2].old, found[2].new) == (1.0, 1.5)
    assert (found[0].old, math.isnan(found[0].new)) == (2.0, True)
    assert math.isnan(found[3].old)
    before.write_text("other: 1\n")
    with pytest.raises(InputError, match="no parameter in common"):
        changes_between(before, after)
