"""What runs of random programs show, the analysis of Python says."""

from __future__ import annotations

from pathlib import Path

import pytest

from oracle_python.generator import program
from oracle_python.judge import judge
from oracle_python.runner import Compiled, Run
from oracle_python.shrink import shrink

SEEDS = range(1, 41)


@pytest.mark.parametrize("seed", SEEDS)
def test_nothing_that_runs_show_is_missed(seed: int, tmp_path: Path) -> None:
    assert not judge(program(seed), tmp_path).missed


def test_a_miss_would_be_seen(tmp_path: Path) -> None:
    # The value is the key of a dict, which the analysis does not follow.
    node = (
        "import rospy\nimport math\n"
        "pub = rospy.Publisher('out', float)\n"
        "keep = {}\n"
        "keep[rospy.get_param('~level')] = 1\n"
        "def callback(message):\n"
        "    for level in dict(keep).keys():\n"
        "        if message.data > level:\n"
        "            pub.publish(1)\n"
        "rospy.Subscriber('in', float, callback)\n"
    )
    verdict = judge({"node": node}, tmp_path)
    place = ("node.py", (8, 12, 8, 32), "right", "~level", ">")
    assert place in verdict.wanted
    assert verdict.missed == {place}


def test_what_decides_nothing_is_not_wanted(tmp_path: Path) -> None:
    node = (
        "import rospy\n"
        "pub = rospy.Publisher('out', float)\n"
        "level = rospy.get_param('~level')\n"
        "def callback(message):\n"
        "    if message.data > level:\n"
        "        rospy.loginfo('much')\n"
        "    pub.publish(message.data)\n"
        "rospy.Subscriber('in', float, callback)\n"
    )
    verdict = judge({"node": node}, tmp_path)
    assert verdict.is_sound
    assert not verdict.wanted
    assert not verdict.found


def test_turning_one_comparison_changes_what_is_published() -> None:
    node = (
        "import rospy\n"
        "pub = rospy.Publisher('out', float)\n"
        "def callback(message):\n"
        "    pub.publish(1 if message.data < 11 else 2)\n"
        "rospy.Subscriber('in', float, callback)\n"
    )
    program = Compiled({"node": node})
    assert Run(program, 1).run().published == [("out", "1")] * 8
    assert Run(program, 1, turned=0).run().published == [("out", "2")] * 8
    first = Run(program, 1, turned=0, how="first").run().published
    assert first == [("out", "2"), *[("out", "1")] * 7]


def test_a_program_is_made_smaller() -> None:
    source = "a = 1\nif a:\n    b = 2\n    c = 3\nd = 4\n"
    small = shrink({"node": source}, lambda each: "c = 3" in each["node"], 10)
    assert small == {"node": "c = 3\n"}
