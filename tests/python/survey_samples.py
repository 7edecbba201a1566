"""Results of surveys for tests, with literal figures."""

from typing import Any

from pytpc_evaluation.survey.source_lines import LineCount, SourceLines
from pytpc_evaluation.survey.trees import Build, NotBuilt, TreeCounts, TreeResult

BAD = NotBuilt("bad", "CMake: CMakeLists.txt:3: Could not find it", ("Eigen3",))
AFTER = NotBuilt("after", "skipped: what it needs does not build")
LINES = SourceLines(
    {
        "C++": LineCount(2, 300, 40, 20),
        "header": LineCount(1, 50, 5, 2),
        "Python": LineCount(1, 10, 0, 0),
        "CMake": LineCount(1, 30, 0, 1),
        "XML": LineCount(2, 12, 0, 0),
    },
    {"binary": 1},
)


def build(processor: float, *not_built: NotBuilt) -> Build:
    """A build that took twice as long on the clock, and half of it to compile."""
    return Build(processor * 2, processor, processor / 2, not_built)


def found(comparisons: int = 0, **changes: Any) -> TreeCounts:
    """What was found: one parameter and one file for every two comparisons."""
    half = (comparisons + 1) // 2
    fields = {"python": 0, "units": 1, "failed": (), "without": (), **changes}
    return TreeCounts(comparisons, parameters=half, files=half, **fields)


def result(
    name: str, plain: float | Build | None, tpc: float | Build, **changes: Any
) -> TreeResult:
    """A tree of three packages; a build may be given by its processor time."""
    fields: dict[str, Any] = {
        "path": f"/src/{name}",
        "key": "k",
        "packages": 3,
        "first": "plain",
        "plain": build(plain) if isinstance(plain, float) else plain,
        "tpc": build(tpc) if isinstance(tpc, float) else tpc,
        "found": found(),
        "lines": LINES,
    }
    return TreeResult(name, **{**fields, **changes})
