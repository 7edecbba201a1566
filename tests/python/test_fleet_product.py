"""The ranking of the product as the study asks it: a question's data set, and its answer."""

from __future__ import annotations

import pytest

from pytpc.base.errors import TpcError
from pytpc.diagnosis.results.fleet import FleetEvidence, FleetRanking, FleetSuspect
from pytpc.fleet.data_set import Fleet, Place
from pytpc.fleet.tables import MISSIONS
from pytpc_evaluation.study.fleet_product import link_missions, verdicts_of

ONE, OTHER = Place("robot-1", "2026-11-30", "m-1"), Place("robot 2", "2026-11-30", "m-2")


def test_the_data_set_of_a_question_has_its_missions_alone(tmp_path):
    fleet = Fleet(str(tmp_path / "whole"))
    fleet.begin()
    fleet.put_build("b", b"{}")
    row = dict.fromkeys(MISSIONS.names, 0)
    texts = {field.name for field in MISSIONS if str(field.type) == "string"}
    row |= dict.fromkeys(texts, "") | {"notes": [], "files": []}
    for place in (ONE, OTHER):
        fleet.write(place, {"missions": MISSIONS.empty_table().from_pylist([row], schema=MISSIONS)})
    part = tmp_path / "part"
    part.mkdir()
    link_missions(tmp_path / "whole", [OTHER], part)
    asked = Fleet(str(part))
    assert asked.places() == [OTHER]
    assert asked.build("b") == b"{}"
    with pytest.raises(TpcError, match="cannot be linked"):
        link_missions(tmp_path / "whole", [OTHER], part)


def suspect(name, position, importance, differs, *, tied=False):
    return FleetSuspect(
        position=position,
        tied=tied,
        parameter=name,
        probability=0.3,
        evidence=FleetEvidence(0.0, 0.0, 0.0, 0.0),
        importance=importance,
        importance_position=None,
        differs=differs,
        mean_position=None,
        values=(),
        more_values=0,
        margin_bad=None,
        margin_good=None,
        unit="",
        shows=None,
        robots=(),
        reason="",
    )


def test_an_answer_is_three_orders_with_the_ties_that_it_has():
    suspects = (
        suspect("~a", 1, 0.2, None),
        suspect("~b", 2, 0.7, 1.0, tied=True),
        suspect("~c", 2, 0.0, 1.0, tied=True),
    )
    found = verdicts_of(FleetRanking(suspects, 0.1, 10, 50, 3, 10, ()))
    fleet = found["fleet"]
    assert (fleet.order, fleet.scores) == (("~a", "~b", "~c"), (-1.0, -2.0, -2.0))
    assert (fleet.confidence, fleet.none) == (0.3, 0.1)
    # What no predicate or value speaks for is not found.
    assert found["fleet-importance"].order == ("~b", "~a")
    assert found["fleet-differs"].order == ("~b", "~c")
    assert found["fleet-differs"].scores == (1.0, 1.0)
