"""What became of each comparison between two builds: every kind of change, and every near miss."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from static_units import comparison, failed_unit, spot, unit

from pytpc.present.build_comparison import rerouted_texts
from pytpc.static.build_changes import BuildChanges, ComparisonChange, changes_between
from pytpc.static.compared_text import is_negated, sides, without_space
from pytpc.static.link_unit import LinkUnit
from pytpc.static.matching import function_name
from pytpc.static.static_info import StaticInfo

LIMIT = "if (coverage > min_coverage_limit_)"


def key(number: int) -> str:
    return f"6f1c0f4e-7a1b-5c3d-8e2f-{number:012d}"


def build(*units: dict[str, Any]) -> StaticInfo:
    return StaticInfo.of(LinkUnit.from_json(one, Path("x.json")) for one in units)


def of(*comparisons: dict[str, Any], **changes: Any) -> StaticInfo:
    """A build of one link unit with these comparisons."""
    numbered = [{**one, "key": key(n)} for n, one in enumerate(comparisons)]
    return build(unit(comparisons=numbered, **changes))


def said(old: StaticInfo, new: StaticInfo, **options: Any) -> list[tuple[str, str]]:
    """Each comparison's status and edits, without those that are the same."""
    found = changes_between(old, new, **options)
    return [(one.status, words(one)) for one in found.comparisons if one.status != "same"]


def words(one: ComparisonChange) -> str:
    return "; ".join(f"{edit.what}: {edit.old} -> {edit.new}" for edit in one.edits)


# ---- What is not a change.


@pytest.mark.parametrize(
    ("what", "status"),
    [
        ({}, "same"),
        ({"column": 20}, "same"),
        ({"lineno": 52}, "moved"),
        ({"file": "src/other.cpp"}, "moved"),
        ({"function": "face::Camera::onImage(int)"}, "moved"),
        ({"function": "face::Detector::onImage(long)"}, "same"),
        ({"source_code": "if (coverage>min_coverage_limit_) {"}, "same"),
        ({"source_code": "if (min_coverage_limit_ < coverage)"}, "same"),
        ({"source_code": "if (coverage > limit_)", "name": "limit_"}, "same"),
        ({"source_code": "  return ready && (coverage) > min_coverage_limit_;"}, "same"),
        ({"distance": 7}, "same"),
    ],
)
def test_what_says_the_same_is_no_change(what: dict[str, Any], status: str) -> None:
    found = changes_between(of(comparison()), of(comparison(**what)))
    assert [one.status for one in found.comparisons] == [status]
    assert found.parameters == ()
    assert found.is_same


def test_another_distance_is_a_note() -> None:
    found = changes_between(of(comparison()), of(comparison(distance=7)))
    assert [one.distances for one in found.farther] == [(1, 7)]


# A publish that was added elsewhere is nearer now: nobody edited the comparison.
def test_another_topic_alone_is_no_change_and_told_once() -> None:
    two = [comparison(), comparison(lineno=60, source="rate")]
    found = changes_between(of(*two), of(*({**one, "topic": "/new"} for one in two)))
    assert [one.status for one in found.comparisons] == ["same", "same"]
    assert rerouted_texts(found) == ["capture -> /new: 2 comparisons with min_coverage_limit, rate"]
    assert not found.is_same


def test_a_renamed_link_unit_holds_the_same_comparisons() -> None:
    found = changes_between(of(comparison()), of(comparison(), link_unit="face_detector"))
    assert [one.status for one in found.comparisons] == ["same"]
    assert found.renamed == (("face/detector", "face/face_detector"),)
    assert (found.missing, found.added) == ((), ())


def test_a_workspace_elsewhere_is_the_same_code() -> None:
    found = changes_between(of(comparison()), of(comparison(), source_root="/ci/42/face"))
    assert found.is_same
    assert found.counts["same"] == 1


def test_a_header_outside_of_the_packages_is_where_its_workspace_is() -> None:
    old, new = comparison(file="/ws/src/base/base.h"), comparison(file="/ci/42/base/base.h")
    assert changes_between(of(old), of(new)).counts["same"] == 1
    assert changes_between(of(old), of({**new, "lineno": 41})).counts["moved"] == 1


# A header in two programs is one place: it counts once, before and after.
def test_a_place_in_two_link_units_counts_once() -> None:
    both = [
        unit(comparisons=[comparison(key=key(1))]),
        unit(comparisons=[comparison(key=key(2))], link_unit="other"),
    ]
    found = changes_between(build(*both), build(both[0]))
    assert [one.status for one in found.comparisons] == ["same"]
    assert found.missing == ("face/other",)
    assert [one.status for one in changes_between(build(), build(*both)).comparisons] == ["new"]


# The second program exposes on another topic, with another default: that it is not built, or built
# for the first time, is no edit of the comparison.
def test_what_another_link_unit_says_is_no_edit() -> None:
    one = unit(comparisons=[comparison(key=key(1), distance=4)])
    other = comparison(key=key(2), topic="/other", default=9, distance=1)
    both = build(one, unit(comparisons=[other], link_unit="other"))
    assert said(both, build(one)) == []
    assert said(build(one), both) == []
    found = changes_between(both, build(one))
    assert (found.farther, found.parameters) == ([], ())


# ---- Two lines that are alike.


def test_of_two_equal_lines_one_is_gone() -> None:
    two = [comparison(lineno=40), comparison(lineno=60)]
    assert said(of(*two), of(comparison(lineno=60))) == [("gone", "")]
    # The one on the line that is left is the same one.
    assert changes_between(of(*two), of(two[1])).counts["same"] == 1


def test_two_equal_lines_that_moved_stay_two() -> None:
    old = of(comparison(lineno=40), comparison(lineno=60))
    new = of(comparison(lineno=45), comparison(lineno=65))
    assert said(old, new) == [("moved", ""), ("moved", "")]


# `a > x` became `a >= x`, `b > x` stayed and moved onto the line where the first one was.
def test_the_edited_one_of_two_is_found_by_its_text() -> None:
    old = of(
        comparison(lineno=40, source_code="if (aaaa > min_coverage_limit_)"),
        comparison(lineno=50, source_code="if (bbbb > min_coverage_limit_)"),
    )
    new = of(
        comparison(lineno=40, source_code="if (bbbb > min_coverage_limit_)"),
        comparison(lineno=50, source_code="if (aaaa >= min_coverage_limit_)", relation=">="),
    )
    assert said(old, new) == [("moved", ""), ("changed", "operator: > -> >=")]


# ---- Changes.


@pytest.mark.parametrize(
    ("what", "edits"),
    [
        (
            {"relation": ">=", "source_code": "if (coverage >= min_coverage_limit_)"},
            "operator: > -> >=",
        ),
        (
            {"relation": "<", "source_code": "if (coverage < min_coverage_limit_)"},
            "operator: > -> <",
        ),
        (
            {"relation": "<", "source_code": "if (min_coverage_limit_ > coverage)"},
            "side: coverage > min_coverage_limit_ -> coverage < min_coverage_limit_",
        ),
        ({"default": 0.3}, "default: 0.25 -> 0.3"),
        ({"default": None}, "default: 0.25 -> none"),
        ({"default": 0.3, "topic": None}, "default: 0.25 -> 0.3; topic: capture -> unknown"),
        ({"source": "max_coverage_limit"}, "parameter: min_coverage_limit -> max_coverage_limit"),
        (
            {
                "type": "derived",
                "transform": {"kind": "affine", "scale": 2.0, "offset": 0.0, "text": "2 * x"},
                "source_code": "if (coverage > 2 * min_coverage_limit_)",
            },
            "type: parameter -> derived; arithmetic: as it is -> 2 * x",
        ),
        (
            {"source_code": "if (brightness > min_coverage_limit_)"},
            "compared value: coverage -> brightness",
        ),
        (
            {"source_code": "if (over(coverage, min_coverage_limit_))"},
            f"condition: {LIMIT} -> if (over(coverage, min_coverage_limit_))",
        ),
    ],
)
def test_what_was_edited(what: dict[str, Any], edits: str) -> None:
    assert said(of(comparison()), of(comparison(**what))) == [("changed", edits)]


def test_a_default_of_another_type_is_told_apart() -> None:
    assert said(of(comparison(default=1)), of(comparison(default=1.0))) == [
        ("changed", "default: 1 -> 1.0")
    ]


def test_an_edited_line_that_moved_is_still_that_line() -> None:
    new = comparison(lineno=90, relation=">=", source_code="if (coverage >= min_coverage_limit_)")
    assert said(of(comparison()), of(new)) == [("changed", "operator: > -> >=")]
    new["function"] = "face::Detector::decide()"
    assert said(of(comparison()), of(new)) == [("changed", "operator: > -> >=")]


# The threshold is what a method returns, so that its variable is not in the line.
def test_a_condition_that_is_broken_in_two_lines_is_no_change() -> None:
    old = comparison(name="tolerance_", source_code="if (now - stamp > map->tolerance())")
    two = {**old, "source_code": "now - stamp > map->tolerance())"}
    assert said(of(old), of(two)) == []
    other = {**old, "source_code": "now - start > map->tolerance())"}
    assert said(of(old), of(other)) == [
        ("changed", f"condition: {old['source_code']} -> {other['source_code']}")
    ]


def test_a_flag_that_is_negated_changed() -> None:
    flag = comparison(
        type="flag", relation="flag", name="use_gps_", source="use_gps", default=True,
        source_code="if (use_gps_)",
    )  # fmt: skip
    assert said(of(flag), of({**flag, "source_code": "if (use_gps_ && ready)"})) == []
    assert said(of(flag), of({**flag, "source_code": "if (!use_gps_)"})) == [
        ("changed", "operator: the parameter -> not the parameter")
    ]


# One line in one function, but a quite different condition: nobody edited the one into the other.
def test_another_condition_in_the_same_function_is_another_comparison() -> None:
    new = comparison(
        relation="<", source_code="while (ros::ok() && retries++ < attempts(min_coverage_limit_))"
    )
    assert said(of(comparison()), of(new)) == [("new", ""), ("gone", "")]


def test_an_empty_build_has_everything_new_or_gone() -> None:
    assert said(build(), of(comparison())) == [("new", "")]
    assert said(of(comparison()), build()) == [("gone", "")]


def test_constants_count_only_if_asked_for() -> None:
    constant = comparison(
        type="constant", source=None, name="7", read_at=None, param_reads=[], default=None,
        source_code="if (faces > 7)",
    )  # fmt: skip
    other = {**constant, "name": "8", "source_code": "if (faces > 8)"}
    assert said(of(constant), of(other)) == []
    assert said(of(constant), of(other), constants=True) == [("changed", "parameter: 7 -> 8")]


# ---- Link units.


def test_what_a_missing_unit_held_is_told_apart() -> None:
    old = build(
        unit(comparisons=[comparison(key=key(1))]),
        unit(comparisons=[comparison(key=key(2), file="src/b.cpp")], link_unit="other"),
    )
    found = changes_between(old, build(unit(comparisons=[])))
    assert found.missing == ("face/other",)
    gone = {one.site.tpc.place: one.is_unbuilt for one in found.of("gone")}
    assert gone == {"src/detector.cpp": False, "src/b.cpp": True}


def test_a_unit_that_failed_now_is_said_and_its_comparisons_are_not_gone_for_good() -> None:
    found = changes_between(of(comparison(), link_unit="broken"), build(failed_unit()))
    assert [one.is_unbuilt for one in found.of("gone")] == [True]
    assert len(found.unanalysed) == 1
    assert "does not verify" in found.unanalysed[0]
    # One that failed before, too, is no news.
    assert changes_between(build(failed_unit()), build(failed_unit())).unanalysed == ()


def test_another_analysis_is_a_note() -> None:
    other = {"name": "tpc", "version": "0.2.0", "llvm": "19.1.7", "profile": "default"}
    whole = unit(comparisons=[comparison(processes=["robot"])], tool=other, processes=["robot"])
    notes = changes_between(of(comparison()), build(whole)).notes
    assert [note.partition(":")[0] for note in notes] == [
        "TPC was 0.1.0 and is 0.2.0",
        "only NEW was analysed in whole processes",
    ]


# ---- Blind spots.


def spots(*found: dict[str, Any]) -> StaticInfo:
    return build(unit(blind_spots=list(found)))


def test_only_new_blind_spots_are_told_wherever_they_moved() -> None:
    lost = spot("lost_value", "rate", 50, "enters f()")
    moved = {**lost, "lineno": 70}
    call = spot("indirect_call", None, 20, "a call through a pointer")

    def new_ones(found: BuildChanges) -> list[tuple[str, int]]:
        return [(one.spot.kind, one.spot.lineno) for one in found.spots]

    same_line = {**moved, "source_code": lost["source_code"]}
    assert new_ones(changes_between(spots(lost), spots(same_line))) == []
    # That of a parameter comes first.
    both = changes_between(spots(), spots(call, lost))
    assert new_ones(both) == [("lost_value", 50), ("indirect_call", 20)]
    assert changes_between(spots(call, lost), spots(call)).closed == 1
    # A library that another unit reads first is the same library.
    header = {**lost, "file": "/ws/src/base/base.h", "source_code": "f(rate)"}
    base = unit(package="base", source_root="/ws/src/base", link_unit="base", comparisons=[])
    first = unit(package="a", source_root="/ws/src/a", blind_spots=[header], comparisons=[])
    second = unit(blind_spots=[header])
    assert new_ones(changes_between(build(base, second), build(base, first, second))) == []
    # A second one like it is new.
    twice = changes_between(spots(lost), spots(lost, same_line))
    assert new_ones(twice) == [("lost_value", 70)]


# ---- The text of a line.


@pytest.mark.parametrize(
    ("line", "name", "relation", "compared"),
    [
        (LIMIT, "min_coverage_limit_", ">", "coverage"),
        ("if (limit < coverage)", "limit", ">", "coverage"),
        ("return aspect > lo_ && aspect < hi_;", "hi_", "<", "aspect"),
        ("if (f(a, b) >= node->limit_)", "Node::limit_", ">=", "f(a,b)"),
        ("while (static_cast<int>(v.size()) >= n_)", "n_", ">=", "static_cast<int>(v.size())"),
        ("bool far = dx * dx + dy > tol * tol;", "tol", ">", "dx*dx+dy"),
        ("x = (a + b) > lim ? 1 : 2;", "lim", ">", "a+b"),
        ("elif angle >= limit:", "limit", ">=", "angle"),
        ("if (p->range < limit_ || x)", "limit_", "<", "p->range"),
        ('if (name == "a < b" || x < lim)', "lim", "<", "x"),
    ],
)
def test_the_other_side_of_a_line(line: str, name: str, relation: str, compared: str) -> None:
    found = sides(line, name, relation)
    assert found is not None
    assert found.compared == compared


@pytest.mark.parametrize(
    ("line", "name", "relation"),
    [
        (None, "limit", "<"),
        ("if (near(x, limit))", "limit", "<"),
        # Which of both was it?
        ("if (x < limit || y < limit)", "limit", "<"),
        ("if (x < limited)", "limit", "<"),
        ("if (x << limit)", "limit", "<"),
        ("if (use)", "use", "flag"),
    ],
)
def test_a_line_that_does_not_tell_gives_nothing(
    line: str | None, name: str, relation: str
) -> None:
    assert sides(line, name, relation) is None


@pytest.mark.parametrize(
    ("line", "negated"),
    [
        ("if (!node->use_)", True), ("if (! use_ && x)", True), ("if (x != use_)", False),
        ("if not self.use_:", True), ("if (use_ != use_)", None), ("use_()", None), (None, None),
    ],
)  # fmt: skip
def test_negation(line: str | None, negated: bool | None) -> None:
    assert is_negated(line, "use_") is negated


def test_spaces_between_words_stay() -> None:
    assert without_space("return  x ;") == "return x;"


def test_function_names() -> None:
    assert function_name("a::f(int, std::function<void (int)>) const") == "a::f"
    assert function_name("a::operator()(int)") == "a::operator()"
    assert function_name("node.Node.run") == "node.Node.run"


def test_a_line_of_generated_code_takes_bounded_time() -> None:
    # Each place of the line once was looked at from each other one, for half an hour.
    assert is_negated(f"{'a' * 200_000} && !b->use_", "use_")
    assert sides("x < y && " * 20_000 + "a < limit_", "limit_", "<") == ("a", "limit_", "<")
