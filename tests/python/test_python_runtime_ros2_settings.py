"""The settings of a node of ROS 2: which entries of files are for it, and which values it takes."""

from __future__ import annotations

import pytest

from pytpc.python_runtime.config import Config
from pytpc.python_runtime.ros2_settings import changed, entries, overrides

NAME = "/robot1/guard/_tpc"


@pytest.mark.parametrize(
    "pattern",
    [
        "/**/_tpc",
        "**/_tpc",
        "/robot1/guard/_tpc",
        "/robot1/*/_tpc",
        "/*/guard/_tpc",
        "/robot1/**/_tpc",
    ],
)
def test_a_pattern_that_is_for_the_hidden_node(pattern):
    assert entries({pattern: {"ros__parameters": {"sink": "file"}}}, NAME) == [("sink", "file")]


@pytest.mark.parametrize("pattern", ["/**", "/*", "/*/_tpc", "/robot2/guard/_tpc", "guard"])
def test_a_pattern_for_other_nodes(pattern):
    assert entries({pattern: {"ros__parameters": {"sink": "file"}}}, NAME) == []


def test_namespaces_may_be_nested_and_what_is_none_is_left_out():
    inner = {"_tpc": {"ros__parameters": {"sink": "off", "policy": "edges"}}}
    content = {"robot1": {"guard": inner}, "other": 3, "/**/_tpc": {"ros__parameters": 4}}
    assert entries(content, NAME) == [("policy", "edges"), ("sink", "off")]
    assert entries([1, 2], NAME) == []
    assert entries(None, NAME) == []


def test_files_and_rules_are_taken_from_the_arguments_for_ros(tmp_path):
    for name in ("own", "a", "b"):
        text = f"/**/_tpc: {{ros__parameters: {{sink: {name}}}}}\n"
        (tmp_path / name).write_text(text)
    own, a, b = (str(tmp_path / name) for name in ("own", "a", "b"))
    words = ["node", "--params-file", own, "--ros-args", "--params-file", a, "-r", "x:=y"]

    def values(*more):
        return [value for _, _, value in overrides([*words, *more], NAME)]

    assert values("--params-file", b) == ["a", "b"]
    assert values("--", "--params-file", b) == ["a"]
    assert values("-p", "_tpc:sink:=file", "-p", "sink:=off") == ["a", "file"]
    assert overrides(["--ros-args", "--params-file"], NAME) == []


@pytest.mark.parametrize(
    ("name", "value", "field"),
    [
        ("sink", "topic", {"sink": "topic"}),
        ("sink", False, {"sink": "off"}),
        ("period", 2, {"period_ns": 2 * 10**9}),
        ("period", 0.5, {"period_ns": 5 * 10**8}),
        ("site_cap", 7, {"site_cap": 7}),
    ],
)
def test_a_valid_value(name, value, field):
    assert changed(Config(), name, value) == (Config()._replace(**field), "")


@pytest.mark.parametrize(
    ("name", "value", "why"),
    [
        ("sink", True, "it is of the wrong type"),
        ("period", [1.0], "it is of the wrong type"),
        ("process_cap", -1, "it must be a whole number"),
        ("folder", "/tmp", "there is no such setting"),
    ],
)
def test_an_invalid_value(name, value, why):
    config, said = changed(Config(), name, value)
    assert config is None
    assert said.startswith(why)
