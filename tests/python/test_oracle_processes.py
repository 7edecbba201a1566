"""TPC finds in random programs of several link units what their execution says (tests/oracle)."""

from pathlib import Path

import pytest

from pytpc.base.paths import prefix
from tests.oracle import process_run
from tests.oracle.process_generator import UNITS, Text, process
from tests.oracle.process_run import Compared, Ran

# More of them: python -m tests.oracle.process_run
SEEDS = (1, 2, 3, 4)

needs_passes = pytest.mark.skipif(
    not process_run.PLUGIN.exists() or not (prefix() / "bin/tpc-merge").is_file(),
    reason="the passes are not built",
)


@pytest.fixture(scope="module")
def runtime(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return process_run.runtime_library(tmp_path_factory.mktemp("ros"))


@needs_passes
@pytest.mark.parametrize("seed", SEEDS)
def test_what_is_found_across_units_is_what_execution_says(tmp_path, runtime, seed):
    compared = process_run.compare(process(seed), tmp_path / "program", runtime)
    assert compared.difference() == []
    assert len(compared.true) >= 3


# Written by hand: `near` decides, `count` counts only, and nothing is published for `other`.
HEADER = """#include <ros/ros.h>
double sensed();
bool truth(int Site, double Value, double Threshold, bool Outcome);
#define SITE(N, V, OP, T) truth(N, V, T, (V)OP(T))
bool isNear(double Value, double Limit);
"""
ROBOT = """#include "shared.h"
int main() {
  ros::NodeHandle Handle;
  double Near = 5, Count = 5, Other = 5;
  Handle.getParam("near", Near);
  Handle.getParam("count", Count);
  Handle.getParam("other", Other);
  ros::Publisher Out = Handle.advertise<std_msgs::Number>("out", 1);
  int Counted = 0;
  for (int Round = 0; Round < 30; ++Round) {
    double Value = sensed();
    if (isNear(Value, Near))
      Out.publish(std_msgs::Number());
    if (SITE(1, Value, <, Count))
      ++Counted;
  }
}
"""
BY_HAND = Text(
    {
        "shared.h": HEADER,
        "robot.cpp": ROBOT,
        "left.cpp": '#include "shared.h"\n'
        "bool isNear(double Value, double Limit) { return SITE(0, Value, <, Limit); }\n",
        **{f"{unit}.cpp": "\n" for unit in ("right", "careful", "direct")},
    },
    {"near": "4", "count": "4", "other": "4"},
)


@needs_passes
def test_the_truth_of_a_program_written_by_hand(tmp_path, runtime):
    process_run.write(BY_HAND, tmp_path)
    true, plain = process_run.truth(BY_HAND, process_run.built_native(tmp_path, runtime))
    assert true == {"0": {"near"}}
    assert {site: len(seen) for site, seen in plain.sites.items()} == {"0": 30, "1": 30}
    assert process_run.places(BY_HAND) == {"0": ("left.cpp", 2), "1": ("robot.cpp", 14)}


def test_what_is_missed_and_what_is_false_are_differences():
    one, other = ("left.cpp", 2, "near"), ("right.cpp", 3, "far")
    assert Compared(frozenset({one}), frozenset({one})).difference() == []
    found = Compared(frozenset({one}), frozenset({other}), ("reports: 1",))
    assert found.difference() == [f"missed: {one}", f"false: {other}", "reports: 1"]


def test_reports_that_are_not_what_was_evaluated():
    place = {"0": ("left.cpp", 2)}
    one = {"file": "src/left.cpp", "lineno": 2, "source": "near", "key": "k"}
    plain = Ran(sites={"0": [("1.5", "2", "1")]})
    assert process_run.reports([one], place, Ran(sites={"k": [("1.5", "2", "1")]}), plain) == []
    other = Ran(sites={"k": [("1.5", "2", "0")]})
    for ran in (other, Ran()):
        assert len(process_run.reports([one], place, ran, plain)) == 1


def test_a_program_of_several_units_is_the_same_again():
    assert process(7) == process(7)
    assert process(7) != process(8)
    assert process(7).files.keys() == {"shared.h", *(f"{unit}.cpp" for unit in UNITS)}
