"""What became of the parameters between two builds."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from static_units import KEYS, comparison, not_exposed, spot, unit

from pytpc.api.comparing_builds import compare_builds
from pytpc.present.build_comparison import parameter_text
from pytpc.static.build_changes import changes_between
from pytpc.static.link_unit import LinkUnit
from pytpc.static.parameter_changes import KINDS, DeclaredAs, ParameterChange
from pytpc.static.static_info import StaticInfo


def read(name: str, lineno: int = 12, **changes: Any) -> dict[str, Any]:
    return {**unit()["parameters"][0], "name": name, "lineno": lineno, **changes}


def build(*reads: dict[str, Any], **changes: Any) -> StaticInfo:
    """A build of one link unit with these reads, and nothing else if not given."""
    made = unit(**{"parameters": list(reads), "comparisons": [], **changes})
    return StaticInfo.of([LinkUnit.from_json(made, Path("x.json"))])


def said(old: StaticInfo, new: StaticInfo, **more: Any) -> list[tuple[str, str, str, str]]:
    found = changes_between(old, new, **more)
    return [(one.kind, one.parameter, one.old, one.new) for one in found.parameters]


LIMIT = read("min_coverage_limit")
COMPARED = build(LIMIT, comparisons=[comparison()])


def test_nothing_changed() -> None:
    assert said(COMPARED, COMPARED) == []
    # Another line, another default type of the same value.
    assert said(COMPARED, build(read("min_coverage_limit", 90), comparisons=[comparison()])) == []


def test_new_and_gone_reads() -> None:
    rate = read("rate", 13, default=5, type="int")
    assert said(build(LIMIT), build(LIMIT, rate)) == [
        ("new", "rate", "", "used, and never compared; default 5")
    ]
    assert said(build(LIMIT, rate), build(LIMIT)) == [
        ("gone", "rate", "used, and never compared; default 5", "")
    ]


def test_another_default() -> None:
    new = build({**LIMIT, "default": 0.5})
    assert said(build(LIMIT), new) == [("default", "min_coverage_limit", "0.25", "0.5")]
    new = build({**LIMIT, "default": None})
    assert said(build(LIMIT), new) == [("default", "min_coverage_limit", "0.25", "none")]
    # A flag is not the number 1.
    flags = build({**LIMIT, "default": True}), build({**LIMIT, "default": 1})
    assert said(*flags) == [("default", "min_coverage_limit", "true", "1")]


@pytest.mark.parametrize(
    ("new", "state", "why"),
    [
        ({}, "used, and never compared", ""),
        (
            {"blind_spots": [spot("lost_value", "min_coverage_limit", 20, "enters f()")]},
            "lost on the way",
            "src/detector.cpp:20: enters f()",
        ),
        (
            {"not_exposed": [not_exposed("min_coverage_limit", 40)]},
            "compared, but nothing exposed depends on it",
            "src/detector.cpp:40",
        ),
    ],
)
def test_a_parameter_that_lost_its_last_comparison(
    new: dict[str, Any], state: str, why: str
) -> None:
    found = changes_between(COMPARED, build(LIMIT, **new)).parameters
    assert [(o.kind, o.parameter, o.old, o.new, o.why) for o in found] == [
        ("uncompared", "min_coverage_limit", "compared", state, why)
    ]


def test_one_of_two_comparisons_less_is_no_loss() -> None:
    two = [comparison(), comparison(key=KEYS[1], lineno=60)]
    assert said(build(LIMIT, comparisons=two), COMPARED) == []


# ---- Names.


def test_a_name_behind_the_same_comparison_is_a_new_name() -> None:
    limit = read("face_threshold")
    new = build(limit, comparisons=[comparison(source="face_threshold")])
    found = changes_between(COMPARED, new).parameters
    assert [(one.kind, one.old, one.new, one.why) for one in found] == [
        ("renamed", "min_coverage_limit", "face_threshold", "the same comparisons are with it")
    ]


def test_a_name_that_is_alike_in_the_same_function_is_a_new_name() -> None:
    new = build(read("min_coverage_limits", 14))
    assert [one[:3] for one in said(build(LIMIT), new)] == [
        ("renamed", "min_coverage_limits", "min_coverage_limit")
    ]


@pytest.mark.parametrize(
    "other",
    [
        read("min_coverage_limits", default=0.5),
        read("min_coverage_limits", function="face::Camera::Camera()"),
        read("rate"),
    ],
)
def test_other_names_are_new_and_gone(other: dict[str, Any]) -> None:
    assert [one[0] for one in said(build(LIMIT), build(other))] == ["new", "gone"]


def test_each_name_has_one_new_name() -> None:
    old = build(read("max_speed_x"), read("max_speed_y", 13))
    new = build(read("max_speeds_x"), read("max_speeds_y", 13))
    assert [one[2:] for one in said(old, new)] == [
        ("max_speed_x", "max_speeds_x"),
        ("max_speed_y", "max_speeds_y"),
    ]


# The default of a parameter with a new name is compared, too.
def test_a_new_name_with_another_default() -> None:
    new = build(
        read("face_threshold", default=0.5), comparisons=[comparison(source="face_threshold")]
    )
    assert [one[0] for one in said(COMPARED, new)] == ["renamed", "default"]


def test_kinds_are_in_their_order() -> None:
    assert list(KINDS) == ["new", "gone", "renamed", "uncompared", "default", "declared"]


# ---- Declarations.


def in_file(name: str, default: float = 1.0, high: float = 2.0) -> DeclaredAs:
    return DeclaredAs("face", name, "double", default, 0.0, high, (), "cfg/Face.cfg:7")


def test_declarations_are_compared_if_both_are_known() -> None:
    old, new = [in_file("rate"), in_file("gain")], [in_file("rate", 1.5), in_file("bias")]
    assert said(build(), build(), declarations=(old, new)) == [
        ("declared", "bias", "", "double, default 1, 0 to 2"),
        ("declared", "gain", "double, default 1, 0 to 2", ""),
        ("declared", "rate", "double, default 1, 0 to 2", "double, default 1.5, 0 to 2"),
    ]
    assert said(build(), build(), declarations=([], new)) == []


@pytest.mark.parametrize(
    ("what", "declared", "is_declared"),
    [
        ({"default": 0.25}, (), True),
        ({"default": None, "api": "ros::NodeHandle::getParam"}, (), False),
        ({"default": None, "api": "ros::NodeHandle::getParam"}, ("min_coverage_limit",), True),
        # It takes a default, which the analysis cannot work out.
        ({"default": None, "api": "ros::NodeHandle::param"}, (), True),
        ({"default": None, "api": "rclcpp::Node::declare_parameter"}, (), True),
        ({"default": None, "api": "rclcpp::Node::get_parameter"}, (), False),
        ({"default": None, "api": "dynamic_reconfigure::Server"}, (), True),
    ],
)
def test_what_is_declared(
    what: dict[str, Any], declared: tuple[str, ...], is_declared: bool
) -> None:
    new = build({**LIMIT, **what}, comparisons=[comparison(default=what["default"])])
    found = changes_between(build(), new, declared=declared).comparisons
    assert [one.is_declared for one in found] == [is_declared]


CFG = """
from dynamic_reconfigure.parameter_generator_catkin import *
gen = ParameterGenerator()
gen.add("min_coverage_limit", double_t, 0, "How much", {}, 0, 1)
exit(gen.generate("face", "face", "Face"))
"""


def workspace(folder: Path, default: float) -> StaticInfo:
    (folder / "cfg").mkdir(parents=True)
    (folder / "package.xml").write_text("<package/>")
    (folder / "cfg/Face.cfg").write_text(CFG.format(default))
    return build({**LIMIT, "default": None}, source_root=str(folder))


def test_cfg_files_of_two_folders_are_compared(tmp_path: Path) -> None:
    old, new = workspace(tmp_path / "old", 0.2), workspace(tmp_path / "new", 0.4)
    (found,) = compare_builds(old, new).parameters
    assert (found.kind, found.package, found.parameter) == (
        "declared",
        "face",
        "min_coverage_limit",
    )
    assert (found.old, found.new) == ("double, default 0.2, 0 to 1", "double, default 0.4, 0 to 1")
    assert found.places == ("cfg/Face.cfg:4",)
    # One folder has only the newer file.
    assert compare_builds(new, new).parameters == ()
    # Nor is a folder that another version was checked out into the old build's.
    there = build({**LIMIT, "default": None}, source_root=str(tmp_path / "old"),
                  comparisons=[comparison(default=None)])  # fmt: skip
    source = tmp_path / "old/src/detector.cpp"
    source.parent.mkdir()
    source.write_text("int other;\n")
    assert "declared" not in [one.kind for one in compare_builds(there, new).parameters]
    source.write_text("\n" * 39 + "if (coverage > min_coverage_limit_)\n")
    assert "declared" in [one.kind for one in compare_builds(there, new).parameters]


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("", "bool", "a .cfg file declares it only now: bool"),
        ("bool", "", "a .cfg file declares it no more: bool"),
        ("bool", "int", "declared otherwise: bool -> int"),
    ],
)
def test_a_declaration_in_words(old: str, new: str, text: str) -> None:
    assert parameter_text(ParameterChange("declared", "face", "rate", old, new)) == text
