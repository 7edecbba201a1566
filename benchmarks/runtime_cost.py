"""What one report costs the thread that makes it, for each sink and for what one would take else.

One loop (runtime/Loop.cpp) compares values with a parameter. It is built plainly, with TPC, and
with reports that stand in the source and go where others send them: the thesis's stream and
ROS_INFO, a std_msgs/String each, an LTTng-UST tracepoint with the same payload. All are real roscpp
nodes on one roscore, with one subscriber on /rosout (rosout itself) and one on
/threshold_information. The ways take turns, round after round; the measured thread alone is pinned.

A cost is the time of a comparison less that of the plain loop in the same round; the figure is the
median of the rounds. Hot: blocks of comparisons timed together, with a break between blocks in
which whatever was put off can be done (so LTTng's buffers are drained, and nothing is discarded).
Paced: 500 comparisons a second, each timed alone, with the caches as the sleep leaves them.
Single: 100,000 a second on average, each timed alone, with real-time priority where the user may,
for the slowest one of all.
Noise is the largest difference, in any round, between the plain loop and the same source with its
code placed otherwise: what a loop gains and loses by where it stands is no cost of anything.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import shlex
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import numpy.typing as npt
from figures import figure

from pytpc.base.paths import installed
from pytpc.ros.ros1.graph import RosGraph
from pytpc.static.static_info import load_link_unit

SOURCES = Path(__file__).resolve().parent / "runtime"
ROUNDS = 7
ENVIRONMENT = {**os.environ, "PATH": "/usr/bin:/bin"}
FILE = {"TPC_SINK": "file"}
EDGES = {**FILE, "TPC_POLICY": "edges"}
ROS2_CONTEXTS = ("vpid", "vtid", "procname")
Samples = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Way:
    """A way to report: program, environment, how many of a million comparisons flop.

    ``trace`` is None without LTTng, else the contexts that are recorded. ``slow`` ways take
    microseconds and get fewer comparisons.
    """

    program: str
    env: Mapping[str, str] = field(default_factory=dict)
    flops: int = 0
    trace: tuple[str, ...] | None = None
    slow: bool = False


@dataclass(frozen=True)
class Mode:
    """What is run: the loop's arguments after OUTPUT."""

    work: str
    how: str
    blocks: int
    count: int
    gap_us: int


WAYS = {
    "plain": Way("plain"),
    "again": Way("plain_placed"),
    "off": Way("built", {"TPC_SINK": "off"}),
    "file every": Way("built", FILE),
    "file edges, no flop": Way("built", EDGES),
    "file edges, 0.4 % flops": Way("built", EDGES, 4_000),
    "file edges, 10 % flops": Way("built", EDGES, 100_000),
    "plain, 0.4 % flops": Way("plain", flops=4_000),
    "plain, 10 % flops": Way("plain", flops=100_000),
    "topic every": Way("built", {"TPC_SINK": "topic"}, slow=True),
    "rosout every": Way("built", {"TPC_SINK": "rosout"}, slow=True),
    "rosout edges, no flop": Way("built", {"TPC_SINK": "rosout", "TPC_POLICY": "edges"}),
    "thesis": Way("thesis", slow=True),
    "string publish": Way("publish", slow=True),
    "LTTng-UST": Way("lttng", trace=()),
    "LTTng-UST, site number": Way("lttng_site", trace=()),
    "LTTng-UST, ros2_tracing's contexts": Way("lttng", trace=ROS2_CONTEXTS),
}
HOT = Mode("bare", "block", 60, 20_000, 5_000)
HOT_SLOW = Mode("bare", "block", 20, 500, 20_000)
FILTER = Mode("filter", "block", 60, 20_000, 1_000)
STEP = Mode("step", "block", 60, 20_000, 1_000)
ENDLESS = Mode("bare", "block", 100, 20_000, 0)
SINGLE = Mode("bare", "single", 100, 2_000, 20_000)
PACED = Mode("bare", "paced", 1, 1_000, 2_000)
LOOPS = ("plain", "again", "off")
ENDLESS_WAYS = ("plain", "file every")
SINGLE_WAYS = ("plain", "file every", "file edges, 10 % flops", "LTTng-UST")
PACED_WAYS = (
    "plain",
    "off",
    "file every",
    "file edges, no flop",
    "topic every",
    "rosout every",
    "thesis",
    "string publish",
    "LTTng-UST",
)


def built(folder: Path) -> None:
    """The programs of all ways, in ``folder``.

    Both plain and built have link-time optimisation by lld: they differ in the reports alone.
    """
    config = ["pkg-config", "--cflags", "--libs", "roscpp", "std_msgs"]
    found = subprocess.run(config, env=ENVIRONMENT, check=True, capture_output=True, text=True)
    flags = shlex.split(found.stdout)
    clang = ["clang++-19", "-O2"]
    linked = [*clang, "-g", "-flto=full", "-fuse-ld=lld-19"]
    by_hand = [*clang, "-DREPORT_BY_HAND", f"-I{SOURCES}"]
    programs = {
        "plain": [*linked, "Loop.cpp"],
        "plain_placed": [*linked, "-Wl,-mllvm,-align-all-nofallthru-blocks=5", "Loop.cpp"],
        "built": [str(installed("bin/tpc-clang++")), "-O2", "Loop.cpp"],
        "thesis": [*by_hand, "Loop.cpp", "Thesis.cpp"],
        "publish": [*by_hand, "Loop.cpp", "StringPublish.cpp"],
        "listener": [*clang, "Listener.cpp"],
    }
    if has_lttng():
        tracing = [*by_hand, "Loop.cpp", "Lttng.cpp", "-llttng-ust", "-ldl"]
        programs["lttng"] = tracing
        programs["lttng_site"] = [*tracing, "-DLTTNG_SITE"]
    env = {**ENVIRONMENT, "TPC_STATIC_INFO": str(folder / "static")}
    for name, command in programs.items():
        whole = [*command, "-o", str(folder / name), *flags]
        subprocess.run(whole, cwd=SOURCES, env=env, check=True)
    reported = [
        comparison
        for file in (folder / "static").rglob("*.json")
        for comparison in load_link_unit(file).comparisons
        if comparison.type == "parameter"
    ]
    if len(reported) != 3:
        sys.exit(f"the three loops were to have one report each, not {len(reported)} in all")


def has_lttng() -> bool:
    """Whether LTTng-UST can be built with and recorded."""
    header = Path("/usr/include/x86_64-linux-gnu/lttng/tracepoint.h")
    return shutil.which("lttng-sessiond") is not None and header.is_file()


@contextlib.contextmanager
def session_daemon() -> Iterator[None]:
    """LTTng's session daemon; one that runs already is used and left running."""
    if not has_lttng() or lttng("list", check=False).returncode == 0:
        yield
        return
    daemon = subprocess.Popen(["lttng-sessiond", "--no-kernel"], stderr=subprocess.DEVNULL)
    try:
        until = time.monotonic() + 10
        while lttng("list", check=False).returncode != 0 and time.monotonic() < until:
            time.sleep(0.1)
        yield
    finally:
        daemon.terminate()
        daemon.wait(20)


def lttng(*arguments: str, check: bool = True) -> subprocess.CompletedProcess[str]:
    """The command lttng, which is to start nothing."""
    command = ["lttng", "--no-sessiond", *arguments]
    return subprocess.run(command, check=check, capture_output=True, text=True)


@contextlib.contextmanager
def traced(contexts: tuple[str, ...], folder: Path) -> Iterator[None]:
    """A session that records the tracepoints; buffers that hold all blocks between breaks."""
    name = f"tpc{time.monotonic_ns()}"
    lttng("create", name, f"--output={folder / name}")
    try:
        channel = ["--subbuf-size=4M", "--num-subbuf=8"]
        lttng("enable-channel", "-u", "reports", f"--session={name}", *channel)
        lttng("enable-event", "-u", "tpc:*", "--channel=reports", f"--session={name}")
        for context in contexts:
            options = [f"--type={context}", "--channel=reports", f"--session={name}"]
            lttng("add-context", "-u", *options)
        lttng("start", name)
        yield
        lttng("stop", name)
        listed = lttng("list", name).stdout.splitlines()
        discarded = [line.split()[-1] for line in listed if "Discarded events" in line]
        if discarded != ["0"]:
            print(f"LTTng-UST discarded events, which makes it cheaper: {discarded}", flush=True)
    finally:
        lttng("destroy", name, check=False)
        shutil.rmtree(folder / name, ignore_errors=True)


def run(way: Way, mode: Mode, folder: Path, graph: RosGraph) -> Samples:
    """Nanoseconds of a comparison: of each block, or of each comparison."""
    output = folder / "taken"
    arguments = [mode.work, mode.how, mode.blocks, mode.count, mode.gap_us, way.flops]
    command = [folder / way.program, output, *arguments]
    records = folder / "records"
    env = {**graph.env, **way.env, "TPC_FOLDER": str(records)}
    with contextlib.ExitStack() as exits:
        if way.trace is not None:
            exits.enter_context(traced(way.trace, folder))
        done = subprocess.run(
            [str(word) for word in command],
            env=env,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            timeout=120,
            check=False,
        )
    # Summaries of the last period have nowhere to go when a node ends: that is no fault here.
    said = [line for line in done.stderr.splitlines() if "tpc:" in line]
    if done.returncode != 0 or any("after ros::shutdown" not in line for line in said):
        sys.exit(f"{way}: status {done.returncode}: {done.stderr[-500:]}")
    if way.env == FILE:
        check_records(records, mode.blocks * mode.count + 1)
    shutil.rmtree(records, ignore_errors=True)
    return np.fromfile(output, dtype=np.float64)


def check_records(folder: Path, count: int) -> None:
    """See that the file sink recorded all reports: what is left out costs nothing."""
    recorded = 0
    for file in folder.glob("*.tpc"):
        data = np.fromfile(file, dtype="<u4")[1024:]
        chunks = data[: data.size // 16384 * 16384].reshape(-1, 16384)
        records = chunks[chunks[:, 0] == 1][:, 16:].reshape(-1, 8)
        recorded += int(np.count_nonzero((records[:, 0] & 0xFF) == 1))
    if recorded != count:
        sys.exit(f"the file sink recorded {recorded} of {count} reports")


def measured(names: list[str], folder: Path, rounds: int) -> dict[tuple[str, str], list[Samples]]:
    """By mode and way, a table of times for each round."""
    plan = [("hot", name, HOT_SLOW if WAYS[name].slow else HOT) for name in names]
    if any(WAYS[name].slow for name in names):
        plan.append(("hot slow", "plain", HOT_SLOW))
    for label, mode, ways in (
        ("filter", FILTER, LOOPS),
        ("step", STEP, LOOPS),
        ("endless", ENDLESS, ENDLESS_WAYS),
        ("single", SINGLE, SINGLE_WAYS),
        ("paced", PACED, PACED_WAYS),
    ):
        plan += [(label, name, mode) for name in ways if name in names]
    taken: dict[tuple[str, str], list[Samples]] = defaultdict(list)
    with session_daemon(), RosGraph(ENVIRONMENT, folder / "graph") as graph:
        graph.start("listener", [str(folder / "listener")])
        for number in range(rounds):
            for label, name, mode in plan:
                taken[label, name].append(run(WAYS[name], mode, folder, graph))
            graph.check()
            print(f"round {number + 1} of {rounds} done", file=sys.stderr, flush=True)
    return taken


class Costs:
    """Nanoseconds by mode and way, from what was measured."""

    def __init__(self, taken: dict[tuple[str, str], list[Samples]]) -> None:
        """Keep the tables."""
        self.taken = taken

    def times(self, label: str, name: str) -> list[float]:
        """The median time of a comparison in each round."""
        return [float(np.median(samples)) for samples in self.taken[label, name]]

    def report(self, label: str, name: str) -> float:
        """What the report costs: the median of what is more than in the plain loop."""
        way = WAYS[name]
        base = "hot slow" if way.slow and label == "hot" else label
        plain = f"plain, {name.split(', ')[1]}" if way.flops else "plain"
        if (base, plain) not in self.taken:
            plain = "plain"
        pairs = zip(self.times(label, name), self.times(base, plain), strict=True)
        return statistics.median(time - floor for time, floor in pairs)

    def noise(self, label: str) -> float:
        """The largest difference between two runs of the plain loop in one round."""
        pairs = zip(self.times(label, "plain"), self.times(label, "again"), strict=True)
        return max(abs(one - other) for one, other in pairs)

    def has(self, *names: str) -> bool:
        """Whether all of these were measured."""
        return all(("hot", name) in self.taken for name in names)


def show_table(costs: Costs) -> None:
    """All that was measured: ns a report (of the plain loop: of a comparison)."""
    for label, name in costs.taken:
        if WAYS[name].program.startswith("plain"):
            loop = statistics.median(costs.times(label, name))
            print(f"{label:8} {name:36} {loop:10.2f} ns loop")
        else:
            print(f"{label:8} {name:36} {costs.report(label, name):10.2f} ns a report")
    for (label, name), rounds in costs.taken.items():
        if label == "single":
            merged = np.concatenate(rounds)
            shares = [float(np.quantile(merged, q)) for q in (0.5, 0.99, 0.999)]
            text = ", ".join(f"{value:.0f}" for value in (*shares, float(merged.max())))
            print(f"single   {name}: median, 99 %, 99.9 %, maximum: {text} ns (with the clock)")


def show_figures(costs: Costs) -> None:
    """The figures that have a target."""
    for label in ("hot", "filter", "step"):
        if costs.has("off", "again"):
            more, noise = costs.report(label, "off"), costs.noise(label)
            where = "bare" if label == "hot" else label
            name, target = f"off_less_plain_{where}", f"<={noise:.2g}(noise)"
            figure("runtime-cost", name, more, unit="ns", target=target, hit=more <= noise)
    if costs.has("file edges, no flop"):
        cost = costs.report("hot", "file edges, no flop")
        figure("runtime-cost", "edges_no_flop", cost, unit="ns", target="<=10", hit=cost <= 10)
    for label in ("hot", "paced"):
        if costs.has("file every", "LTTng-UST"):
            ratio = costs.report(label, "file every") / costs.report(label, "LTTng-UST")
            name = f"file_over_lttng_{label}"
            hit = ratio <= 0.125
            figure("runtime-cost", name, ratio, unit="ratio", target="<=0.125", hit=hit)
        if costs.has("rosout every", "thesis"):
            ratio = costs.report(label, "rosout every") / costs.report(label, "thesis")
            name = f"rosout_over_thesis_{label}"
            figure("runtime-cost", name, ratio, unit="ratio", target="<=1", hit=ratio <= 1)
    if not has_lttng():
        print("LTTng-UST is not installed (liblttng-ust-dev, lttng-tools): no figure for it")


def main() -> None:
    """Builds, measures, prints a table and the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    parser.add_argument("--only", action="append", choices=WAYS, help="this way; may be repeated")
    options = parser.parse_args()
    names = [name for name, way in WAYS.items() if way.trace is None or has_lttng()]
    if options.only:
        names = [name for name in names if name in (*options.only, "plain", "again")]
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        built(folder)
        costs = Costs(measured(names, folder, options.rounds))
    show_table(costs)
    show_figures(costs)


if __name__ == "__main__":
    main()
