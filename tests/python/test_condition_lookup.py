"""The conditions of many TPCs: which file with which flags, when only the line, and the cache."""

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from static_units import KEYS, comparison, unit

from pytpc.conditions import cpp_conditions as conditions
from pytpc.conditions import lookup as condition_lookup
from pytpc.conditions.cpp_conditions import libclang
from pytpc.conditions.lookup import (
    CHANGED,
    GONE,
    NEWER,
    NO_LIBCLANG,
    NOT_FOUND,
    WITHOUT_FLAGS,
    Answer,
)
from pytpc.conditions.lookup import look_up_conditions as look_up
from pytpc.static.link_unit import LinkUnit
from pytpc.static.static_info import StaticInfo

pytestmark = pytest.mark.skipif(not libclang(), reason="libclang 19 is not installed")

TEXT = """#include "limits.h"
void publish();
void f(double coverage) {
#ifdef FAULT
  if (coverage > 1)
#else
  if (coverage > LIMIT ||
      coverage < 0)
#endif
    publish();
}
"""
# The comparison of TEXT on line 7: `  if (coverage > LIMIT ||`, with the operator in column 16.
PLACE: dict[str, Any] = {
    "lineno": 7,
    "column": 16,
    "source_code": "if (coverage > LIMIT ||",
}
WHOLE = "coverage > LIMIT ||\n      coverage < 0"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    (tmp_path / "src").mkdir()
    (tmp_path / "src/detector.cpp").write_text(TEXT, encoding="utf-8")
    (tmp_path / "src/limits.h").write_text("#define LIMIT 3.0\n", encoding="utf-8")
    return tmp_path


def static_of(root: Path, *found: dict[str, Any], **changes: Any) -> StaticInfo:
    data = unit(source_root=str(root), comparisons=list(found or [comparison(**PLACE)]), **changes)
    return StaticInfo.of([LinkUnit.from_json(data, root)])


def answer_of(static: StaticInfo, root: Path) -> Answer:
    return look_up(static, static.tpcs, cache=root / "cache")[KEYS[0]]


def test_the_whole_condition_of_a_line(root: Path) -> None:
    answer = answer_of(static_of(root), root)
    assert answer.condition is not None
    assert answer.condition.text == WHOLE
    assert answer.note == WITHOUT_FLAGS


def test_why_only_the_line_is_known(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def note(**changes: Any) -> str:
        answer = answer_of(static_of(root, comparison(**{**PLACE, **changes})), root)
        assert answer.condition is None
        return answer.note

    assert note(file="src/gone.cpp") == GONE
    assert note(source_code="if (coverage > 0.5)") == CHANGED
    assert note(lineno=700) == CHANGED
    assert note(lineno=2, column=1, source_code="void publish();") == (
        f"{NOT_FOUND}; {WITHOUT_FLAGS}"
    )
    monkeypatch.setattr(condition_lookup, "libclang", lambda: False)
    assert note() == NO_LIBCLANG


def test_a_condition_whose_other_lines_may_be_new_is_said_to_be_so(root: Path) -> None:
    json, source = root / "b/tpc/detector.json", root / "src/detector.cpp"
    json.parent.mkdir(parents=True)
    json.touch()
    static = static_of(root, build_folder=str(root / "b"))
    os.utime(json, (5, 5))
    os.utime(source, (4, 4))
    assert answer_of(static, root).note == WITHOUT_FLAGS
    source.write_text(TEXT.replace("coverage < 0", "coverage < 9"), encoding="utf-8")
    answer = answer_of(static, root)
    assert answer.condition is not None
    assert answer.condition.text == WHOLE.replace("< 0", "< 9")
    assert answer.note == f"{WITHOUT_FLAGS}; {NEWER}"
    # What it was built into says nothing more.
    json.unlink()
    assert answer_of(static, root).note == WITHOUT_FLAGS


def test_each_tpc_has_the_flags_of_a_unit_that_has_it(
    root: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Line 5 is compiled into the faulty node alone, line 7 into the other."""
    line_5 = comparison(
        key=KEYS[1], lineno=5, column=16, source_code="if (coverage > 1)", source="other"
    )
    units = [
        unit(source_root=str(root), comparisons=[comparison(**PLACE)]),
        unit(source_root=str(root), link_unit="fault", comparisons=[line_5]),
    ]
    static = StaticInfo.of(LinkUnit.from_json(data, root) for data in units)
    plain = condition_lookup.flags_for

    def flags_for(file: str, of: LinkUnit) -> condition_lookup.Flags:
        more = ("-DFAULT",) if of.link_unit == "fault" else ()
        flags = plain(file, of)
        return replace(flags, arguments=(*flags.arguments, *more), of_build=True)

    monkeypatch.setattr(condition_lookup, "flags_for", flags_for)
    found = look_up(static, static.tpcs, cache=root / "cache")
    texts = {key: answer.condition.text for key, answer in found.items() if answer.condition}
    assert texts == {KEYS[0]: WHOLE, KEYS[1]: "coverage > 1"}
    assert found[KEYS[0]].note == ""


@pytest.fixture
def parses(monkeypatch: pytest.MonkeyPatch) -> Callable[[], int]:
    """How many files have been parsed since the last call."""
    made: list[int] = []
    parse = condition_lookup.parse_conditions

    def counted(*arguments: Any) -> Any:
        made.append(1)
        return parse(*arguments)

    def count() -> int:
        number = len(made)
        made.clear()
        return number

    monkeypatch.setattr(condition_lookup, "parse_conditions", counted)
    return count


def test_a_file_is_parsed_again_when_something_has_changed(
    root: Path, parses: Callable[[], int]
) -> None:
    static = static_of(root)
    first = answer_of(static, root)
    assert parses() == 1
    assert answer_of(static, root) == first
    assert parses() == 0
    os.utime(root / "src/limits.h", (1, 1))
    assert answer_of(static, root) == first
    assert parses() == 1
    (root / "src/detector.cpp").write_text(TEXT + "// more\n", encoding="utf-8")
    answer_of(static, root)
    assert parses() == 1
    # A place that was not asked for before.
    more = comparison(key=KEYS[1], lineno=8, column=16, source_code="coverage < 0)", source="b")
    both = static_of(root, comparison(**PLACE), more)
    assert look_up(both, both.tpcs, cache=root / "cache").keys() == {KEYS[0], KEYS[1]}
    assert parses() == 1


def test_a_damaged_cache_is_no_cache(root: Path, parses: Callable[[], int]) -> None:
    static = static_of(root)
    first = answer_of(static, root)
    (path,) = (root / "cache").iterdir()
    for text in (b"", b"{", b"[]", b'{"included": {}, "conditions": {"7:16": {"kind": 3}}}'):
        path.write_bytes(text)
        assert answer_of(static, root) == first
    assert parses() == 5


def test_a_cache_that_cannot_be_written_is_no_error(root: Path) -> None:
    (root / "cache").write_text("a file", encoding="utf-8")
    assert answer_of(static_of(root), root).condition is not None


def test_progress_counts_the_files_that_are_parsed(root: Path) -> None:
    (root / "src/other.cpp").write_text(TEXT, encoding="utf-8")
    other = comparison(key=KEYS[1], file="src/other.cpp", **PLACE)
    static = static_of(root, comparison(**PLACE), other)
    seen: list[tuple[int, int]] = []
    look_up(static, static.tpcs, lambda *at: seen.append(at), root / "cache")
    # Both may be finished at once, and a slow one is told of before it is.
    assert seen[-1] == (2, 2)
    assert seen == sorted(seen)
    seen.clear()
    look_up(static, static.tpcs, lambda *at: seen.append(at), root / "cache")
    assert seen == []


@pytest.fixture
def precompiled(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The ends of the argument lists with which files are parsed."""
    ends: list[str] = []
    parse = condition_lookup.parse_conditions

    def noted(file: str, data: bytes, arguments: Any, places: Any) -> Any:
        ends.append(arguments[-2])
        return parse(file, data, arguments, places)

    monkeypatch.setattr(condition_lookup, "parse_conditions", noted)
    return ends


def three_files(root: Path) -> StaticInfo:
    """Three files that are compiled alike, each with the comparison of TEXT."""
    found = []
    for number, key in enumerate(KEYS):
        name = f"src/file{number}.cpp"
        (root / name).write_text(TEXT, encoding="utf-8")
        found.append(comparison(key=key, file=name, **PLACE))
    return static_of(root, *found)


def texts_of(static: StaticInfo, root: Path) -> list[str | None]:
    answers = look_up(static, static.tpcs, cache=root / "cache").values()
    return [answer.condition and answer.condition.text for answer in answers]


def test_files_that_are_compiled_alike_share_what_is_precompiled(
    root: Path, precompiled: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    same = condition_lookup.Flags(("-x", "c++", "-std=c++17", "-DNAME=1"), True)
    monkeypatch.setattr(condition_lookup, "flags_for", lambda *_: same)
    # Something smaller than ROS, without which the files do not have their macro.
    monkeypatch.setattr(conditions, "_PREFIX", "#define LIMIT 3.0\n")
    (root / "src/limits.h").write_text("#ifndef LIMIT\n#error\n#endif\n", encoding="utf-8")
    assert texts_of(three_files(root), root) == [WHOLE] * 3
    assert precompiled == ["-include-pch"] * 3


def test_what_is_not_found_so_is_sought_without(
    root: Path, precompiled: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    same = condition_lookup.Flags(("-x", "c++", "-std=c++17", "-DNAME=1"), True)
    monkeypatch.setattr(condition_lookup, "flags_for", lambda *_: same)

    def broken(_: Any, target: Path) -> bool:
        target.write_bytes(b"no precompiled header")
        return True

    monkeypatch.setattr(condition_lookup, "precompile", broken)
    assert texts_of(three_files(root), root) == [WHOLE] * 3
    assert sorted(precompiled) == [*["-include-pch"] * 3, *["-std=c++17"] * 3]
