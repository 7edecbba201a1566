"""What the study asks of fleets with several wrong parameters, and how the answers count."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from click.testing import CliRunner

from pytpc.cli.main import main
from pytpc_evaluation.study.fleet_causes import (
    CausesQuestion,
    CausesVerdict,
    causes_questions,
    judge_causes,
)
from pytpc_evaluation.study.report.fleets import causes_table

WRONG = {"type1_a": "~a", "type1_b": "~b", "type2_b": "~b", "type2_c": "~c"}


def flown(marked=10, goods=60):
    """Rows of good missions, and of ten bad ones of each treatment, so many of them marked."""

    def row(number, treatment, seen):
        parameter = WRONG.get(treatment)
        return {
            "folder": f"missions/pump/robot-{number % 3 + 1}/mission-{number:04}",
            "system": "pump",
            "robot": f"robot-{number % 3 + 1}",
            "treatment": treatment,
            "parameter": parameter,
            "state": "done",
            "errors": int(parameter is not None),
            "marks": int(seen),
        }

    rows = [row(number, "clean", seen=False) for number in range(goods)]
    for place, treatment in enumerate(WRONG, start=1):
        rows += [row(100 * place + turn, treatment, turn < marked) for turn in range(10)]
    return rows


def test_a_question_has_ten_missions_of_each_wrong_parameter():
    asked = list(causes_questions(flown(), draws=20, causes=2))
    assert [one.draw for one in asked] == list(range(20))
    for one in asked:
        # Both treatments of one parameter would be one cause.
        assert len(set(one.parameters)) == 2
        assert one.parameters == tuple(WRONG[treatment] for treatment in one.treatments)
        groups = Counter(int(folder[-4:]) // 100 for folder in one.missions)
        places = {list(WRONG).index(treatment) + 1 for treatment in one.treatments}
        assert groups == {0: 50, **dict.fromkeys(places, 10)}
        assert len(set(one.missions)) == 70
    assert {treatment for one in asked for treatment in one.treatments} == set(WRONG)
    assert asked == list(causes_questions(flown()[::-1], draws=20, causes=2))


def test_of_too_few_flown_missions_nothing_is_asked():
    assert list(causes_questions(flown(), 1, causes=3))
    assert not list(causes_questions(flown(), 1, causes=4))
    assert not list(causes_questions(flown(goods=49), 1, causes=2))
    assert not list(causes_questions(flown(marked=7), 1, causes=2))


def test_what_is_named_is_right_or_false():
    question = CausesQuestion("pump", 0, ("type1_a", "type1_b"), ("~a", "~b"), ("m/1", "m/2"))
    asked = []

    def causes_of(system, missions):
        asked.append((system, missions))
        return ["/pump/b", "~c"]

    found = judge_causes(question, causes_of)
    assert asked == [("pump", ("m/1", "m/2"))]
    assert found == CausesVerdict("pump", 0, question.treatments, (False, True), ("~c",))


# Of the treatments a, b and c, those are named in all, in half and in none of their questions.
def test_shares_are_those_of_treatments():
    rows = [
        CausesVerdict("pump", 0, ("a", "b"), (True, True), ()),
        CausesVerdict("pump", 1, ("a", "b"), (True, False), ()),
        CausesVerdict("arm", 0, ("c", "d"), (False, True), ("~x", "~y")),
    ]
    table = causes_table(rows)
    found = dict(table.rows)
    assert [(name, cells[0], cells[3]) for name, cells in table.rows] == [
        ("arm", 1, 2),
        ("pump", 2, 0),
        ("all", 3, 2),
    ]
    assert str(found["pump"][1]).startswith("75 [")
    assert str(found["all"][1]).startswith("62 [")
    assert found["pump"][2] == 50.0
    assert table.notes == ("Each question has 2 wrong parameters, each in other missions.",)


def test_nothing_is_flown(tmp_path: Path):
    done = CliRunner().invoke(main, ["study", "fleet", "causes", "--out", str(tmp_path)])
    assert done.exit_code == 1
    assert "too few missions are flown; fly on with" in done.stderr
