"""Values that no node reads, with the names that were most likely meant.

A value counts as read by no node only where all is known of the nodes that could read it: those in
whose namespace it is, or else all nodes of the robot.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

from pytpc.base.closest import closest
from pytpc.base.wording import listed, plain
from pytpc.lint.facts import (
    Facts,
    Node,
    NodeRead,
    Setting,
    Unjudged,
    above,
    is_anything,
    last_part,
    namespace,
    own_part,
)
from pytpc.lint.finding import Evidence, Finding, Spot
from pytpc.static.parameters import DYNAMIC

# What ROS's own libraries read in every node.
_OF_ROS = frozenset(
    {"use_sim_time", "tcp_keepalive", "enable_statistics", "start_type_description_service"}
    | {"rosdistro", "rosversion", "run_id", "robot_description", "robot_description_semantic"}
)
_QOS = "qos_overrides"
_MOST_NODES = 3
# Of a whole robot; comparing each name with all of them takes long, and says little.
_MOST_READS = 1000
ANY = "a node puts the names of parameters together"
NO_NODE = "no node of that namespace is started"
ELSEWHERE = "another launch file starts the node of that namespace"
TEXT = "the name stands in the sources, and what is done with it is not followed"


class Unread(NamedTuple):
    """The findings, the parameters that cannot be judged, and the lines that nodes may read.

    One line of YAML may set a value in several namespaces, of which one is enough.
    """

    findings: list[Finding]
    unjudged: Unjudged
    used: frozenset[Spot]


def unread(facts: Facts) -> Unread:
    """Find the values that no node reads."""
    found: list[tuple[Setting, list[Node]]] = []
    reasons = defaultdict(set)
    used = set()
    for setting in facts.settings:
        reads = facts.readers(setting.name)
        is_named = any(not is_anything(read) for _, read in reads)
        if is_named or _is_of_ros(setting.name):
            used.add(setting.spot)
            continue
        concerned = _concerned(facts, setting)
        why = _why_unjudged(facts, setting, concerned)
        if not why and any(_may_be(facts, setting, node, read) for node, read in reads):
            why = ANY
        if why:
            reasons[why].add(setting.name)
            used.add(setting.spot)
        else:
            found.append((setting, concerned))
    findings = [_finding(facts, one, nodes) for one, nodes in found if one.spot not in used]
    unjudged = Unjudged({why: frozenset(names) for why, names in reasons.items()})
    return Unread(findings, unjudged, frozenset(used))


def _may_be(facts: Facts, setting: Setting, node: Node, read: NodeRead) -> bool:
    """Whether the name that a call puts together may be that of a setting.

    Such a name is made of texts in the sources, of values that are set (a list of names), or of the
    arguments of the node. One of which nothing is known may be made of these alone: otherwise, one
    such call would hide all misspelt names.
    """
    if last_part(read.name) != DYNAMIC:
        return True
    known = facts.words, node.words, node.texts
    own = own_part(setting.name)
    if any(last_part(setting.name) in words or own in words for words in known):
        return True
    if any(own.startswith(piece) or own.endswith(piece) for piece in node.pieces):
        return True
    # It may be the name of a table with the value in it; what is read one by one is none.
    above_it = setting.name.split("/")[:-1]
    is_in_table = read.is_table and any(not words.isdisjoint(above_it) for words in known)
    return is_in_table and namespace(setting.name) not in facts.read_one_by_one


def _is_of_ros(name: str) -> bool:
    return last_part(name) in _OF_ROS or _QOS in name or name.startswith("/roslaunch/")


def _concerned(facts: Facts, setting: Setting) -> list[Node]:
    """The nodes that could read a value: its owners, or else all in the namespace around it."""
    owners = facts.owners(setting.name)
    if owners:
        return owners
    around = setting.name.rpartition("/")[0]
    below = [node for node in facts.nodes if node.name.startswith(f"{around}/")]
    return below or list(facts.nodes)


def _why_unjudged(facts: Facts, setting: Setting, concerned: list[Node]) -> str:
    """Why it is not known whether a value is read; empty where it is known."""
    if not concerned:
        return NO_NODE
    if not facts.owners(setting.name) and not facts.elsewhere.isdisjoint(above(setting.name)):
        return ELSEWHERE
    unknown = next((node for node in concerned if node.unjudged), None)
    if unknown is not None:
        return unknown.unjudged
    parts = {last_part(setting.name), own_part(setting.name)}
    if any(not parts.isdisjoint(node.texts) for node in concerned):
        return TEXT
    return ""


def _finding(facts: Facts, setting: Setting, concerned: list[Node]) -> Finding:
    names = [node.name for node in concerned]
    who = f"{names[0]} does not read" if len(names) == 1 else "no node reads"
    meant = _meant(facts, setting, concerned)
    text = f"{who} {plain(setting.name)}"
    evidence = [Evidence(f"{plain(read.name)} is read", read.spot) for read in meant[:1]]
    if meant:
        shown = listed([plain(read.name) for read in meant], _MOST_NODES)
        same = last_part(meant[0].name) == last_part(setting.name)
        text += f"; it would be read as {shown}" if same else f"; did you mean {shown}?"
    elif len(names) > 1 and not facts.owners(setting.name):
        near = closest(setting.name.rpartition("/")[0], [node.name for node in facts.nodes])
        if near and setting.name.count("/") > 1:
            text += f"; did you mean the node {plain(near[0])}?"
    return Finding("unread", "warning", setting.spot, setting.name, text, tuple(evidence))


def _meant(facts: Facts, setting: Setting, concerned: list[Node]) -> list[NodeRead]:
    """The reads that were most likely meant: of the same name elsewhere, or of one like it."""
    end = last_part(setting.name)
    names = {node.name for node in concerned}
    alike = facts.reads_by_end.get(end, ())
    same = _once(read for node, read in alike if node.name in names)
    same = same or _once(read for _, read in alike if read.is_exact)
    if same:
        return same
    mine = [read for node in concerned for read in node.reads]
    if len(mine) > _MOST_READS:
        return []
    unset: dict[str, NodeRead] = {}
    for read in mine:
        beside = _beside(setting, read, concerned)
        if not read.is_table and not facts.is_set(beside):
            unset.setdefault(beside, replace(read, name=beside))
    return [unset[name] for name in closest(setting.name, unset)]


def _beside(setting: Setting, read: NodeRead, concerned: list[Node]) -> str:
    """The name of a read: where a part of it is not known, that beside a setting, if it fits."""
    if read.is_exact or is_anything(read):
        return read.name
    beside = f"{setting.name.rpartition('/')[0]}/{last_part(read.name)}"
    fits = any(read in node.reads_of(beside) for node in concerned)
    return beside if fits else read.name


def _once(reads: Iterator[NodeRead]) -> list[NodeRead]:
    found: dict[str, NodeRead] = {}
    for read in reads:
        found.setdefault(read.name, read)
    return [found[name] for name in sorted(found)]
