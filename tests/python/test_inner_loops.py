"""Comparisons in inner loops are named after a build, and what they cost."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from click.testing import CliRunner, Result
from static_units import KEYS, comparison, unit

from pytpc.cli.main import main
from pytpc.static.link_unit import LinkUnit
from pytpc.static.loops import inner_loops
from pytpc.static.static_info import StaticInfo

COST = [
    "With the default policy `light`, a comparison sends a summary and at most 10 changes a second"
    " (50 per process).",
    "TPC_POLICY=every reports each evaluation, as 32 bytes of a file or a message on /rosout: a"
    " million a second are 1.9 GB a minute.",
]


def run(*arguments: object) -> Result:
    return CliRunner().invoke(main, [str(word) for word in arguments])


def key(number: int) -> str:
    return f"{KEYS[0][:-4]}{number:04d}"


def in_loop(number: int, depth: int | None, **changes: Any) -> dict[str, Any]:
    """A comparison on line ``number``."""
    known = {} if depth is None else {"loop_depth": depth}
    return comparison(key=key(number), lineno=number, **known, **changes)


def collected(folder: Path, *found: dict[str, Any]) -> list[str]:
    """What ``collect`` prints behind the number of comparisons."""
    source = folder / "face/tpc/detector.json"
    source.parent.mkdir(parents=True)
    source.write_text(json.dumps(unit(comparisons=list(found))), encoding="utf-8")
    result = run("collect", folder, "-o", folder / "static.json")
    assert result.exit_code == 0
    lines = result.stdout.splitlines()
    at = next(i for i, line in enumerate(lines) if line.endswith("/static.json"))
    return lines[at + 1 :]


def test_collect_names_the_deepest_first(tmp_path: Path) -> None:
    constant = in_loop(5, 4, type="constant", source=None, read_at=None, name="7")
    found = [in_loop(1, 0), in_loop(2, 1), in_loop(3, 2), in_loop(4, None), constant]
    assert collected(tmp_path, *found) == [
        "2 comparisons are in inner loops:",
        "  face/src/detector.cpp:3  2 loops  min_coverage_limit",
        "  face/src/detector.cpp:2  1 loop  min_coverage_limit",
        *COST,
    ]


def test_collect_names_five_at_most(tmp_path: Path) -> None:
    lines = collected(tmp_path, *[in_loop(n, 1) for n in range(1, 8)])
    assert lines[0] == "7 comparisons are in inner loops:"
    assert lines[5:7] == [
        "  face/src/detector.cpp:5  1 loop  min_coverage_limit",
        "  and 2 more: `loop_depth` in `pytpc list --json`",
    ]
    assert lines[7:] == COST


def test_without_inner_loops_nothing_is_said(tmp_path: Path) -> None:
    assert collected(tmp_path, in_loop(1, 0), in_loop(2, None)) == []


def test_show_and_list_have_the_number(tmp_path: Path) -> None:
    collected(tmp_path, in_loop(1, 3), in_loop(2, None))
    source = tmp_path / "static.json"
    assert "Inner loops  3" in run("show", source, key(1)).stdout
    assert "Inner loops" not in run("show", source, key(2)).stdout
    for number, depth in ((1, 3), (2, None)):
        (shown,) = json.loads(run("show", source, key(number), "--json").stdout)["comparisons"]
        assert shown["loop_depth"] == depth
    listed = json.loads(run("list", source, "--json").stdout)
    assert [each.get("loop_depth") for each in listed] == [3, None]


# One source in two link units: called from a loop in one of them only.
def test_of_several_link_units_the_largest_counts(tmp_path: Path) -> None:
    units = [
        unit(comparisons=[in_loop(1, 0)]),
        unit(link_unit="other", comparisons=[comparison(key=KEYS[1], lineno=1, loop_depth=2)]),
    ]
    static = StaticInfo.of(LinkUnit.from_json(each, tmp_path) for each in units)
    assert [(each.tpc.lineno, each.depth) for each in inner_loops(static)] == [(1, 2)]
