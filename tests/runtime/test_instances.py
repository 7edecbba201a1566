"""Objects of one class that evaluate one key: their reports and flops are apart."""

from __future__ import annotations

import subprocess
from collections import Counter, defaultdict
from pathlib import Path

import log_file
import pytest
from compiling import compile_program
from test_file import key

HERE = Path(__file__).parent

LIGHT = {"policy": "light", "period": 0.02, "site_cap": 0, "process_cap": 0}
POLICIES = [{"policy": "edges", "period": 0.02}, LIGHT]
# As in Sites.h.
MOST = 32


def totals(file: log_file.LogFile) -> dict[str, tuple[int, int]]:
    """Evaluations and flops by key."""
    found: dict[str, Counter[str]] = defaultdict(Counter)
    for summary in file.all_summaries:
        for name in ("count", "flops"):
            found[file.keys[summary["site"]]][name] += summary[name]
    return {name: (sums["count"], sums["flops"]) for name, sums in found.items()}


# The second object changes in the turns 10, 20, ... 90; the others never do. Under one key each of
# their evaluations would be a flop. The report without an object counts with the first one.
@pytest.mark.parametrize("policy", POLICIES, ids=["edges", "light"])
def test_flops_of_objects_are_apart(drive, files, policy):
    ran = drive("objects", 3, 100, **policy)
    assert (ran.returncode, ran.stderr) == (0, "")
    file = log_file.read(files()[0])
    first = key(0)
    assert totals(file) == {first: (101, 0), f"{first}#2": (100, 9), f"{first}#3": (100, 0)}
    results = defaultdict(list)
    for _steady, site, result, *_ in sorted(file.all_reports):
        results[file.keys[site]].append(result)
    assert results == {
        first: [False],
        f"{first}#2": [turn % 2 == 1 for turn in range(10)],
        f"{first}#3": [False],
    }


def test_every_evaluation_has_its_object(drive, files):
    assert drive("objects", 2, 50, policy="every").returncode == 0
    file = log_file.read(files()[0])
    first = key(0)
    values = Counter((file.keys[r[1]], r[4]) for r in file.all_reports)
    assert values == {(first, 0.0): 50, (f"{first}#2", 1.0): 50, (first, -1.0): 1}


# Under `light` the counts of a site are estimates if several threads evaluate it.
def test_two_threads_with_an_object_each_count_exactly(drive, files):
    assert drive("objects-threads", 100_000, **LIGHT).returncode == 0
    file = log_file.read(files()[0])
    assert sorted(totals(file).values()) == [(100_000, 0), (100_000, 0)]
    assert set(file.keys.values()) == {key(0), f"{key(0)}#2"}


# 32 objects have reports of their own, the others share one key; one line says so, and nothing is
# lost.
@pytest.mark.parametrize(
    "policy", [*POLICIES, {"policy": "every"}], ids=["edges", "light", "every"]
)
def test_ten_thousand_objects_are_harmless(drive, files, policy):
    ran = drive("objects", 10_000, 20, **policy)
    assert ran.returncode == 0
    (line,) = ran.stderr.splitlines()
    assert f"more than {MOST} objects evaluate comparison {key(0)}" in line
    file = log_file.read(files()[0])
    keys = {key(0), *(f"{key(0)}#{n}" for n in range(2, MOST + 1)), f"{key(0)}#0"}
    if policy["policy"] == "every":
        counts = Counter(file.keys[r[1]] for r in file.all_reports)
    else:
        counts = Counter({name: count for name, (count, _) in totals(file).items()})
    assert counts.keys() == keys
    assert counts.total() == 10_000 * 20 + 1
    assert counts[f"{key(0)}#0"] == (10_000 - MOST) * 20


# The words in which instrumented code counts go to the object of the hot loop. Each evaluation
# before is a call; afterwards nearly none is. All are counted, also those between the last call and
# the unloading of the module.
def test_the_hot_object_is_counted_in_place(drive, files):
    turns = 1_000_000
    ran = drive("in-place", turns, **LIGHT)
    assert (ran.returncode, ran.stderr) == (0, "")
    assert int(ran.stdout) < turns / 50
    file = log_file.read(files()[0])
    counts = {name: count for name, (count, _) in totals(file).items()}
    assert counts == {key(0): turns // 1000, f"{key(0)}#2": turns}


@pytest.fixture(scope="session")
def reading_objects(tmp_path_factory):
    program = tmp_path_factory.mktemp("objects") / "reading_objects"
    flags = subprocess.check_output(["pkg-config", "--cflags", "--libs", "roscpp"], text=True)
    return compile_program(HERE / "reading_objects.cpp", program, *flags.split())


# Which object has read which name is remembered of 10,000 objects; one line says that there are
# more. Nobody needs it if all have read the same name.
@pytest.mark.parametrize(
    ("objects", "names", "lines"), [(10_000, 2, 0), (10_020, 2, 1), (10_020, 1, 0)]
)
def test_too_many_objects_read(reading_objects, settings, objects, names, lines):
    ran = subprocess.run(
        [str(reading_objects), str(objects), str(names)],
        env={**settings, "ROS_LOG_DIR": settings["TPC_FOLDER"]},
        capture_output=True,
        text=True,
        timeout=60,
        check=True,
    )
    told = [line for line in ran.stderr.splitlines() if "which object it was" in line]
    assert len(told) == lines
    assert all("more than 10000 times" in line for line in told)
