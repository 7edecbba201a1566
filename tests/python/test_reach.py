"""What the marks say of where it was wrong, and who can be to blame by the graph."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mission_samples import comparison, events, link_unit, ns

from pytpc.diagnosis.question import Question
from pytpc.diagnosis.ranking.blame import blame
from pytpc.diagnosis.ranking.reach import (
    ELSEWHERE,
    UNHEARD,
    UNREACHED,
    Reach,
    place_notes,
    reach_prior,
)
from pytpc.diagnosis.scores.score_tables import Tpcs
from pytpc.recording.marks import Mark
from pytpc.recording.mission import Recording
from pytpc.static.static_info import StaticInfo
from pytpc.static.wiring import GraphTopic, Wiring

# The eye sees a face, the brain moves the wheels and calls the camera; the radio tells nobody.
EYE, BRAIN, WHEELS, RADIO = "/eye", "/brain", "/wheels", "/radio"
NODES = (EYE, BRAIN, WHEELS, RADIO)
SAYS = {EYE: "/faces", BRAIN: "cmd_vel", WHEELS: "/odom", RADIO: "/packets"}


def topic(publishers, subscribers):
    return GraphTopic(None, frozenset(publishers), frozenset(subscribers))


TOPICS = {
    "/faces": topic([EYE], [BRAIN]),
    "/cmd_vel": topic([BRAIN], [WHEELS]),
    "/odom": topic([WHEELS], [RADIO, "/tpc_recorder"]),
    "/packets": topic([RADIO], ["/tpc_recorder"]),
    "/dock/goal": topic([BRAIN], [WHEELS]),
    "/dock/cancel": topic([BRAIN], [WHEELS]),
    "/dock/feedback": topic([WHEELS], [BRAIN]),
    "/dock/status": topic([WHEELS], [BRAIN]),
    "/dock/result": topic([WHEELS], [BRAIN]),
    "/rosout": topic(NODES, ["/rosout"]),
}


def program(number, node, *more):
    """The program of a node, with its comparison and more of them."""
    own = comparison(number, f"~{node[1:]}", topic=SAYS[node])
    return replace(link_unit([own, *more]), link_unit=node[1:])


STATIC = StaticInfo.of(
    [
        program(0, EYE),
        program(1, BRAIN, comparison(9, "~shutter", topic="/capture")),
        program(2, WHEELS),
        program(3, RADIO),
    ]
)
NAMES = Tpcs.of(STATIC).names


SERVICES = {f"{node}/get_loggers": frozenset({node}) for node in NODES}


def mission(*notes, topics=TOPICS, services=SERVICES):
    """Each node evaluates its own comparison; the brain that of the shutter, too."""
    rows = [
        (t + n / 100, n, t > 20 + n, t, 20 + n, node)
        for t in range(40)
        for n, node in enumerate(NODES)
    ]
    rows += [(t + 0.5, 9, t > 30, t, 30, BRAIN) for t in range(40)]
    marks = tuple(Mark(ns(30 + n), "I", "", note) for n, note in enumerate(notes))
    found = Recording("m", events(sorted(rows)), marks, 0, ns(40))
    wiring = Wiring((), found.nodes_of, topics, services)
    return Recording("m", found.events, marks, 0, ns(40), wiring=wiring)


def prior(*notes, **more):
    found = reach_prior(mission(*notes, **more), STATIC, Tpcs.of(STATIC))
    return dict(zip(NAMES, found.tolist(), strict=True))


# To /cmd_vel lead the brain, the eye through it, and the wheels by the result of the dock.
def test_what_cannot_get_to_the_topic_is_out():
    found = prior("@/cmd_vel it does not move")
    assert found == {
        "~brain": 0.0,
        "~eye": 0.0,
        "~radio": UNREACHED,
        "~shutter": 0.0,
        "~wheels": 0.0,
    }


def test_a_topic_may_be_named_by_its_last_part():
    assert prior("@cmd_vel") == prior("@/cmd_vel")


def test_an_action_is_all_of_its_topics():
    assert prior("@/dock") == prior("@/dock/goal")


# No graph has who calls a service: the code of the brain does.
def test_a_service_is_found_by_who_calls_it():
    found = prior("@/capture no picture")
    assert (found["~shutter"], found["~eye"], found["~radio"]) == (0.0, 0.0, UNREACHED)


def test_of_a_node_its_own_parameters_are_likelier():
    found = prior("@eye")
    assert found["~eye"] == 0.0
    assert {found[name] for name in ("~brain", "~wheels", "~radio")} == {UNREACHED}
    found = prior("@brain")
    assert (found["~brain"], found["~eye"], found["~radio"]) == (0.0, ELSEWHERE, UNREACHED)


def test_a_node_beside_a_topic_does_not_narrow_it():
    assert prior("@brain", "@/cmd_vel")["~eye"] == 0.0


# The radio has a topic that ends like one of an action, and is named as a node all the same.
def test_a_node_whose_topic_ends_like_an_action_is_a_node():
    topics = {**TOPICS, "/eye/status": topic([EYE], [BRAIN])}
    assert prior("@/eye", topics=topics)["~brain"] == UNREACHED


def test_an_offered_service_is_a_place():
    services = {**SERVICES, "/reset": frozenset({WHEELS})}
    found = prior("@/reset", services=services)
    assert found["~wheels"] == 0.0
    assert place_notes(mission("@/reset", services=services), STATIC) == ()


# Where nobody of the robot publishes, nobody is out of reach.
def test_a_topic_of_a_tool_says_nothing():
    topics = {**TOPICS, "/buttons": topic(["/rqt_robot_steering"], [BRAIN])}
    assert prior("@/buttons", topics=topics) == prior("")
    assert len(place_notes(mission("@/buttons", topics=topics), STATIC)) == 1


def test_the_goal_of_an_action_of_ros2_leads_to_its_server():
    services = {**SERVICES, "/go/_action/send_goal": frozenset({RADIO})}
    topics = {**TOPICS, "/go/_action/status": topic([RADIO], [EYE])}
    found = prior("@/go", topics=topics, services=services)
    assert (found["~radio"], found["~eye"], found["~brain"]) == (0.0, 0.0, 0.0)
    assert prior("@/faces", topics=topics, services=services)["~wheels"] == 0.0


# A node of its own hears tf for another one, nobody knows for which.
def test_who_publishes_tf_to_a_listener_may_lead_anywhere():
    topics = {**TOPICS, "/tf": topic([RADIO], ["/transform_listener_impl_55a1"])}
    assert prior("@/cmd_vel", topics=topics)["~radio"] == 0.0


# Nobody but the recorder hears the radio. The eye would be heard without the brain's word, too.
def test_whom_nobody_hears_is_unlikely_without_a_place():
    found = prior("")
    assert found.pop("~radio") == UNHEARD
    assert set(found.values()) == {0.0}


def test_who_calls_a_service_may_be_heard():
    static = StaticInfo.of([link_unit([comparison(3, "~radio", topic="/archive")])])
    found = reach_prior(mission(""), static, Tpcs.of(static))
    assert found.tolist() == [0.0]


# The brain calls the radio, which answers.
def test_answers_are_heard_by_those_who_call():
    services = {**SERVICES, "/capture": frozenset({RADIO})}
    assert set(prior("", services=services).values()) == {0.0}
    assert prior("@/cmd_vel", services=services)["~radio"] == 0.0


def test_who_answers_anybody_can_lead_anywhere():
    services = {**SERVICES, "/archive": frozenset({RADIO})}
    assert set(prior("", services=services).values()) == {0.0}
    assert prior("@/cmd_vel", services=services)["~radio"] == 0.0


def test_without_the_services_less_is_certain():
    assert prior("", services={})["~radio"] == UNHEARD / 2
    assert prior("@/cmd_vel", services={})["~radio"] == UNREACHED / 2


@pytest.mark.parametrize("note", ["@/no_such_topic", "cmd_vel", "me@cmd_vel"])
def test_what_names_nothing_says_nothing(note):
    assert prior(note) == prior("")


def test_without_a_graph_nothing_is_known():
    assert set(prior("@/cmd_vel", topics={}).values()) == {0.0}
    assert place_notes(mission("@/cmd_vel", topics={}), STATIC) == (
        "marks say where it was wrong, but the graph was not recorded (graph.json)",
    )


def test_a_place_that_the_graph_does_not_have_is_told():
    (said,) = place_notes(mission("@/cmd_vle", "@/cmd_vel"), STATIC)
    assert said.startswith("a mark says @/cmd_vle, which is no topic, service, action or node")
    assert "/cmd_vel" in said.partition("recorded graph")[2]


def test_nothing_of_ros_itself_hears_or_is_heard():
    reach = Reach.of(STATIC, mission("").wiring)
    assert reach is not None
    assert RADIO in reach.unheard
    assert reach.end("/rosout") is None


# 5 of 5 and then 4 of 5 are left: the sum stays 1.
def test_the_verdict_has_the_place_in_it():
    plain, placed = (blame(mission(note), STATIC, Question()) for note in ("", "@/cmd_vel"))
    for found in (plain, placed):
        total = found.none + sum(one.probability for one in found.suspects)
        assert total == pytest.approx(1.0)
    radio = [next(s for s in one.suspects if s.parameter == "~radio") for one in (plain, placed)]
    assert radio[1].probability < radio[0].probability < np.exp(UNHEARD) * 2
