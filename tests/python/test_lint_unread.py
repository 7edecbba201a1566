"""Values that no node reads: what is found, what was meant, and what is not known."""

import pytest
from lint_samples import facts, node, read, said, setting

from pytpc.lint.check import check, joined
from pytpc.lint.facts import Facts, NodeRead
from pytpc.lint.unread import unread

LIMIT = read("/robot/guard/min_distance", 0.5)


def reasons(found: Facts) -> dict[str, set[str]]:
    return {why: set(names) for why, names in unread(found).unjudged.reasons.items()}


def test_a_misspelt_name_has_the_one_that_was_meant():
    found = facts({"/robot/guard/min_distnace": 0.4}, node(LIMIT))
    assert said(unread(found).findings) == [
        (1, "/robot/guard does not read /robot/guard/min_distnace; did you mean"
            " /robot/guard/min_distance?")
    ]  # fmt: skip


# Who set both has the right one already.
def test_a_name_that_is_set_was_not_meant():
    values = {"/robot/guard/min_distance": 0.4, "/robot/guard/min_distnace": 0.4}
    assert said(unread(facts(values, node(LIMIT))).findings) == [
        (2, "/robot/guard does not read /robot/guard/min_distnace")
    ]


@pytest.mark.parametrize("name", ["/robot/guard/planner/min_distance", "/min_distance"])
def test_the_right_name_in_another_namespace(name: str):
    [(_, text)] = said(unread(facts({name: 0.4}, node(LIMIT))).findings)
    assert text == (
        f"/robot/guard does not read {name}; it would be read as /robot/guard/min_distance"
    )


def test_a_node_that_is_not_started_under_this_name():
    other = node(read("/robot/arm/speed", 1.0), name="/robot/arm")
    [(_, text)] = said(unread(facts({"/robot/guards/rate": 5}, node(LIMIT), other)).findings)
    assert text == "no node reads /robot/guards/rate; did you mean the node /robot/guard?"


@pytest.mark.parametrize(
    ("name", "reads"),
    [
        ("/robot/guard/min_distance", LIMIT),
        ("/robot/min_distance", read("/robot/min_distance", 0.5)),
        ("/robot/guard/a/b/x", read("/robot/guard/<dynamic>/x")),
        # The part that is put together at run time may be empty.
        ("/robot/guard/x", read("/robot/guard/<dynamic>/x")),
        ("/robot/guard/rate", read("/<dynamic>/rate")),
        ("/rate", read("/<dynamic>/rate")),
        ("/robot/guard/pid/p", read("/robot/guard/pid", is_table=True)),
        ("/robot/guard/limits.max", read("/robot/guard/limits", is_table=True, api="rclpy")),
        ("/use_sim_time", LIMIT),
        ("/robot/guard/qos_overrides./scan.publisher.depth", LIMIT),
    ],
)
def test_what_is_read(name: str, reads: NodeRead):
    found = facts({name: 0.4}, node(reads))
    assert unread(found).findings == []
    assert reasons(found) == {}


def test_one_part_of_a_name_that_is_put_together_is_no_other_name():
    found = facts({"/robot/guard/left/y": 1.0}, node(read("/robot/guard/<dynamic>/x")))
    assert len(unread(found).findings) == 1


# `param(prefix + "rate", ...)` with an empty prefix reads "rate", too.
def test_a_name_with_a_prefix_that_may_be_empty():
    found = facts({"/robot/guard/rate": 5}, node(read("/robot/guard/<dynamic>rate")))
    assert unread(found).findings == []


# The robot's launch file sets what the node of another launch file reads.
def test_a_node_that_another_launch_file_starts():
    values: dict[str, object] = {"/robot/arm/rate": 5, "/robot/leg/rate": 5}
    found = facts(values, node(LIMIT), elsewhere=frozenset({"/robot/arm", "/robot/guard"}))
    assert [line for line, _ in said(unread(found).findings)] == [2]
    assert reasons(found) == {
        "another launch file starts the node of that namespace": {"/robot/arm/rate"}
    }


def test_what_is_not_known():
    anything = node(read("/robot/guard/<dynamic>"))
    assert reasons(facts({"/robot/guard/x": 1}, anything)) == {
        "a node puts the names of parameters together": {"/robot/guard/x"}
    }
    other = node(LIMIT, unjudged="robot/guard was not analysed")
    assert reasons(facts({"/robot/guard/x": 1}, other)) == {
        "robot/guard was not analysed": {"/robot/guard/x"}
    }
    texts = node(LIMIT, texts=frozenset({"x"}))
    assert set(reasons(facts({"/robot/guard/x": 1}, texts)).values().__iter__().__next__()) == {
        "/robot/guard/x"
    }
    assert reasons(facts({"/robot/guard/x": 1})) == {
        "no node of that namespace is started": {"/robot/guard/x"}
    }


# A global name may be read by any node, so all of them must be known.
def test_an_unknown_node_elsewhere():
    stock = node(name="/driver", unjudged="driver/driver is of no workspace")
    values: dict[str, object] = {"/rate": 5, "/robot/guard/rate": 5}
    found = facts(values, node(LIMIT), stock)
    assert [line for line, _ in said(unread(found).findings)] == [2]
    assert reasons(found) == {"driver/driver is of no workspace": {"/rate"}}


# costmap_common.yaml is loaded for two costmaps, and its line is right if one of them reads it.
def test_a_line_that_sets_two_values_is_used_if_one_is_read():
    both = [setting("/robot/guard/a/x", 1, 7), setting("/robot/guard/b/x", 1, 7)]
    reader = node(read("/robot/guard/b/x", 1.0))
    assert unread(Facts(both, [reader])).findings == []
    assert len(unread(Facts(both, [node(LIMIT)])).findings) == 2


def test_a_line_is_used_if_another_launch_file_uses_it():
    unused = check(Facts([setting("/robot/guard/x", 1, 7)], [node(LIMIT)]))
    used = check(Facts([setting("/arm/x", 1, 7)], [node(read("/arm/x"), name="/arm")]))
    assert len(joined([unused, unused]).findings) == 1
    assert joined([unused, used]).findings == ()


# As costmap_common.yaml, which is loaded for two costmaps.
def test_one_line_in_two_namespaces_has_one_finding():
    both = [setting("/robot/guard/a/x", 1, 7), setting("/robot/guard/b/x", 1, 7)]
    found = joined([check(Facts(both, [node(LIMIT)]))])
    assert said(found.findings) == [
        (7, "/robot/guard does not read /robot/guard/a/x (and so 1 more name)")
    ]
