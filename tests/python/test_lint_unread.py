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


def test_the_right_name_where_only_the_running_node_knows_its_namespace():
    guard = node(read("/robot/guard/<dynamic>/tolerance"), read("/robot/guard/fast/tolerance"))
    [(_, text)] = said(unread(facts({"/robot/guard/slow/tolernace": 0.4}, guard)).findings)
    assert text.partition("; ")[2].startswith("did you mean /robot/guard/slow/tolerance")


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


ANY = "a node puts the names of parameters together"


# A name of which nothing is known is made of texts of the code, or of values.
@pytest.mark.parametrize(
    ("values", "guard"),
    [
        # Only its first letters are known.
        ({"/robot/guard/x_max": 1}, node(read("/robot/guard/x_<dynamic>"))),
        ({"/robot/guard/x": 1}, node(read("/<dynamic>"), words=frozenset({"x"}))),
        # As in `"joint_" + std::to_string(n)`.
        ({"/robot/guard/joint_1": 1}, node(read("/<dynamic>"), pieces=frozenset({"joint_"}))),
        ({"/robot/guard/left_max": 1}, node(read("/<dynamic>"), pieces=frozenset({"_max"}))),
        # A table whose name is a value, or a text of the code.
        ({"/robot/guard/left/y": 1, "/robot/guard/all": "left right"}, ...),
        ({"/robot/guard/left/y": 1, "/robot/guard/all": [{"name": "left"}]}, ...),
        ({"/robot/guard/left/y": 1}, node(
            read("/robot/guard/<dynamic>", is_table=True), texts=frozenset({"left"}))),
    ],
)  # fmt: skip
def test_what_may_have_a_name_that_is_put_together(values, guard):
    if guard is ...:
        guard = node(read("/robot/guard/<dynamic>", is_table=True), read("/robot/guard/all", ""))
    found = facts(values, guard)
    assert reasons(found) == {ANY: {next(iter(values))}}
    assert unread(found).findings == []


def test_another_node_with_the_text_of_a_name_may_read_it():
    tool = node(read("/<dynamic>"), name="/tool", texts=frozenset({"x"}))
    assert reasons(facts({"/robot/guard/x": 1, "/robot/guard/y": 1}, node(LIMIT), tool)) == {
        ANY: {"/robot/guard/x"}
    }


@pytest.mark.parametrize("is_table", [False, True])
def test_one_name_that_is_put_together_does_not_hide_a_misspelt_one(is_table: bool):
    anything = read("/<dynamic>", is_table=is_table)
    guard = node(LIMIT, anything, texts=frozenset({"left"}), pieces=frozenset({"joint_"}))
    values = {"/robot/guard/min_distnace": 0.4, "/robot/guard/mode": "left"}
    [(line, text), *_] = said(unread(facts(values, guard)).findings)
    assert (line, text.partition(";")[0]) == (
        1, "/robot/guard does not read /robot/guard/min_distnace",
    )  # fmt: skip


# `layer` stands in the code, but what is below it is read by its own names.
def test_a_misspelt_name_in_a_namespace_that_is_read_one_by_one():
    guard = node(
        read("/<dynamic>", is_table=True), read("/robot/guard/layer/height", 1.0),
        texts=frozenset({"layer"}),
    )  # fmt: skip
    values = {"/robot/guard/layer/heihgt": 2.0, "/robot/guard/layer/height": 1.0}
    assert [line for line, _ in said(unread(facts(values, guard)).findings)] == [1]


def test_what_is_not_known():
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
