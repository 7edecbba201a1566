"""Facts for the tests of lint: a node /robot/guard with what it reads, and what is set."""

from __future__ import annotations

from typing import Any

from pytpc.lint.facts import Earlier, Facts, Node, NodeRead, Setting
from pytpc.lint.finding import Finding, Spot

FILE = "/ws/src/robot/config/params.yaml"
SOURCE = "/ws/src/robot/src/guard.cpp"


def read(name: str, default: object = None, **changes: Any) -> NodeRead:
    """``param(name, x, default)`` in line 20 of guard.cpp, with changes."""
    kinds = {bool: "bool", int: "int", float: "double", str: "std::string"}
    return NodeRead(
        **{
            "name": name,
            "api": "ros::NodeHandle::param",
            "type": kinds.get(type(default), "double"),
            "default": default,
            "spot": Spot(SOURCE, 20),
            **changes,
        }
    )


def node(*reads: NodeRead, name: str = "/robot/guard", **changes: Any) -> Node:
    return Node(name, "robot/guard", reads, **changes)


def setting(name: str, value: object, lineno: int = 1, *earlier: Earlier) -> Setting:
    return Setting(name, value, Spot(FILE, lineno), earlier)


def facts(values: dict[str, object], *nodes: Node, **changes: Any) -> Facts:
    """The values are set in the lines 1, 2, ... of params.yaml."""
    settings = [setting(name, value, n) for n, (name, value) in enumerate(values.items(), 1)]
    return Facts(settings, nodes, **changes)


def said(findings: Any) -> list[tuple[int, str]]:
    """Line and text of each finding."""
    found: list[Finding] = list(findings)
    return [(one.spot.lineno, one.text) for one in found]
