"""What of the files in build folders is merged, and what is stale."""

import json
import os
import shutil
from pathlib import Path
from typing import Any

import pytest
from file_api import reply, target
from static_units import KEYS, comparison, counts, failed_unit, unit

from pytpc.base.errors import InputError, WorkspaceError
from pytpc.build.collect import collect_sources, find_copies
from pytpc.build.stale import BuiltTarget, UnitFile, drop_repeated, drop_stale
from pytpc.static.link_unit import LinkUnit

FOLDER = Path("/b/face")


def unit_file(data: dict[str, Any], folder: Path = FOLDER, written_ns: int = 0) -> UnitFile:
    path = folder / "tpc" / f"{data['link_unit']}.json"
    return UnitFile(path, LinkUnit.from_json(data, path), written_ns)


def reasons(data: dict[str, Any], *targets: BuiltTarget) -> list[str]:
    kept, dropped = drop_stale([unit_file(data)], {FOLDER: targets})
    assert len(kept) + len(dropped) == 1
    return [stale.reason for stale in dropped]


KEY = KEYS[0].encode()


def test_a_unit_without_a_target_is_stale() -> None:
    assert reasons(unit(), BuiltTarget("other", KEY)) == ["its target no longer exists"]
    assert reasons(failed_unit(), BuiltTarget("other", None)) == ["its target no longer exists"]


def test_a_program_with_none_of_the_keys_was_linked_without_tpc() -> None:
    two = unit(comparisons=[comparison(), comparison(key=KEYS[1], lineno=41)])
    assert reasons(two, BuiltTarget("detector", b"\x7fELF\0")) == [
        "it was linked again without TPC"
    ]
    # The linker may have left one comparison out; one key is enough.
    assert reasons(two, BuiltTarget("detector", b"\x7fELF\0" + KEYS[1].encode() + b"\0")) == []


def test_what_cannot_be_looked_for_stays() -> None:
    constant = comparison(
        type="constant", source=None, name="7", read_at=None, param_reads=[], default=None
    )
    assert reasons(unit(), BuiltTarget("detector", None)) == []
    assert reasons(unit(comparisons=[]), BuiltTarget("detector", b"")) == []
    assert reasons(unit(comparisons=[constant]), BuiltTarget("detector", b"")) == []
    assert reasons(unit(counts=counts(not_instrumented=1)), BuiltTarget("detector", b"")) == []
    assert drop_stale([unit_file(unit())], {FOLDER: None})[1] == []


def test_what_was_built_of_a_package_that_was_removed_is_stale(tmp_path: Path) -> None:
    for name, key in (("face", KEYS[0]), ("arm", KEYS[1]), ("other", KEYS[2])):
        root = "/elsewhere/other" if name == "other" else str(tmp_path / "src" / name)
        data = unit(package=name, source_root=root, comparisons=[comparison(key=key)])
        write(tmp_path / "build" / name / "tpc/detector.json", data)
    # Built here, and the sources are on another machine.
    assert collect_sources([tmp_path]).dropped == ()
    (tmp_path / "src/face").mkdir(parents=True)
    found = collect_sources([tmp_path])
    assert [each.package for each in found.static.units] == ["face", "other"]
    assert [each.reason for each in found.dropped] == [
        f"its sources, {tmp_path}/src/arm, no longer exist"
    ]


def test_of_a_unit_in_two_places_the_later_one_counts() -> None:
    old = unit_file(unit(), Path("/a/face"), written_ns=1)
    new = unit_file(unit(), Path("/b/face"), written_ns=2)
    other = unit_file(unit(link_unit="other"), Path("/a/face"))
    kept, dropped = drop_repeated([old, new, other])
    assert kept == [other, new]
    assert [(stale.file, stale.reason) for stale in dropped] == [(old, "built later in /b/face")]


def write(path: Path, data: dict[str, Any], at: int = 1) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(data), encoding="utf-8")
    os.utime(path, (at, at))


def test_a_workspace_is_its_own_build_and_ours(tmp_path: Path) -> None:
    write(tmp_path / ".tpc/build/face/tpc/detector.json", unit(counts=counts(functions=1)), at=5)
    write(tmp_path / "build/face/tpc/detector.json", unit(counts=counts(functions=2)), at=9)
    write(tmp_path / "build/arm/tpc/broken.json", failed_unit(package="arm"), at=3)
    # What is in a package's sources is not a build's.
    write(tmp_path / "src/tpc/settings.json", {"no": "unit"})
    seen: list[tuple[int, int]] = []
    found = collect_sources([tmp_path], lambda done, total: seen.append((done, total)))
    assert [(each.link_unit, each.counts.functions) for each in found.static.units] == [
        ("broken", 7), ("detector", 2),
    ]  # fmt: skip
    assert [stale.file.path for stale in found.dropped] == [
        tmp_path / ".tpc/build/face/tpc/detector.json"
    ]
    assert seen == [(1, 3), (2, 3), (3, 3)]


def test_several_sources_are_merged_and_each_file_is_read_once(tmp_path: Path) -> None:
    write(tmp_path / "a/tpc/detector.json", unit())
    write(tmp_path / "b/tpc/broken.json", failed_unit())
    found = collect_sources([tmp_path / "a", tmp_path / "b", tmp_path])
    assert len(found.static.units) == 2
    assert found.dropped == ()


def test_documents_are_sources_too(tmp_path: Path) -> None:
    write(tmp_path / "a/tpc/detector.json", unit(counts=counts(functions=1)))
    collect_sources([tmp_path / "a"]).static.save(tmp_path / "a.json")
    os.utime(tmp_path / "a.json", (2, 2))
    write(tmp_path / "b/tpc/broken.json", failed_unit())
    # Of the unit that is in both, what the document says was written later.
    found = collect_sources([tmp_path / "a", tmp_path / "a.json", tmp_path / "b"])
    assert [each.link_unit for each in found.static.units] == ["broken", "detector"]
    assert [stale.file.path for stale in found.dropped] == [tmp_path / "a/tpc/detector.json"]


def test_a_folder_whose_name_is_not_utf_8_is_named(tmp_path: Path) -> None:
    base = tmp_path / os.fsdecode(b"a\xff")
    write(base / "face/tpc/detector.json", unit())
    with pytest.raises(InputError, match=r'not UTF-8, .*"build_folder": ".*/a\ufffd/face"'):
        collect_sources([base]).static.save(tmp_path / "static.json")


def test_a_source_without_any_is_named(tmp_path: Path) -> None:
    write(tmp_path / "a/tpc/detector.json", unit())
    (tmp_path / "b").mkdir()
    with pytest.raises(WorkspaceError, match=r"/b: no static information here"):
        collect_sources([tmp_path / "a", tmp_path / "b"])


def test_the_targets_and_programs_of_a_real_answer_are_asked(tmp_path: Path) -> None:
    folder = tmp_path / "build/face"
    reply(
        folder,
        [
            target("detector", "EXECUTABLE", artifact="bin/detector"),
            target("relinked", "EXECUTABLE", artifact="bin/relinked"),
            target("empty", "EXECUTABLE", artifact="bin/empty"),
        ],
    )
    (folder / "bin").mkdir()
    (folder / "bin/detector").write_bytes(b"\x7fELF" + KEY)
    (folder / "bin/relinked").write_bytes(b"\x7fELF")
    (folder / "bin/empty").touch()
    for number, name in enumerate(("detector", "relinked", "gone", "empty")):
        key = KEYS[0][:-1] + str(number + 1)
        write(folder / f"tpc/{name}.json", unit(link_unit=name, comparisons=[comparison(key=key)]))
    found = collect_sources([tmp_path])
    assert [each.link_unit for each in found.static.units] == ["detector"]
    assert [(stale.file.unit.link_unit, stale.reason) for stale in found.dropped] == [
        ("empty", "it was linked again without TPC"),
        ("gone", "its target no longer exists"),
        ("relinked", "it was linked again without TPC"),
    ]


def header_in(root: Path, package: str, text: str = "// limits\n") -> Path:
    path = root / package / "include" / package / "limits.h"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return path


def users(tmp_path: Path, *files: Path) -> list[LinkUnit]:
    """A unit of package common, and one of package arm that has comparisons in ``files``."""
    found = [comparison(key=KEYS[number], file=str(file)) for number, file in enumerate(files)]
    roots = {"common": tmp_path / "src/common", "arm": tmp_path / "src/arm"}
    for root in roots.values():
        root.mkdir(parents=True, exist_ok=True)
    return [
        LinkUnit.from_json(
            unit(
                package=package,
                source_root=str(root),
                comparisons=found if package == "arm" else [],
            ),
            tmp_path,
        )
        for package, root in roots.items()
    ]


def test_an_installed_header_is_the_one_it_is_a_copy_of(tmp_path: Path) -> None:
    original = header_in(tmp_path / "src", "common")
    installed = tmp_path / "install/common/include/common/limits.h"
    installed.parent.mkdir(parents=True)
    shutil.copy(original, installed)
    assert find_copies(users(tmp_path, installed)) == {str(installed): str(original)}
    # Installed before the last change: not what the package has.
    original.write_text("// other limits\n", encoding="utf-8")
    assert find_copies(users(tmp_path, installed)) == {}


def test_an_installed_link_is_where_it_leads(tmp_path: Path) -> None:
    original = header_in(tmp_path / "src", "common")
    installed = tmp_path / "install/limits.h"
    installed.parent.mkdir()
    installed.symlink_to(original)
    assert find_copies(users(tmp_path, installed, original)) == {str(installed): str(original)}


def test_a_package_that_is_reached_by_a_link_has_one_path(tmp_path: Path) -> None:
    real = header_in(tmp_path / "elsewhere", "common")
    (tmp_path / "src").mkdir()
    (tmp_path / "src/common").symlink_to(tmp_path / "elsewhere/common")
    linked = tmp_path / "src/common/include/common/limits.h"
    assert find_copies(users(tmp_path, real, linked)) == {str(real): str(linked)}


def test_of_several_originals_the_one_with_the_same_folders(tmp_path: Path) -> None:
    original = header_in(tmp_path / "src", "common")
    header_in(tmp_path / "src", "arm")
    installed = header_in(tmp_path / "install", "common")
    lone = tmp_path / "install/limits.h"
    shutil.copy(original, lone)
    # Nothing says which of the two the lone one is a copy of.
    assert find_copies(users(tmp_path, installed, lone)) == {str(installed): str(original)}


def test_two_packages_with_the_same_file_keep_theirs(tmp_path: Path) -> None:
    one, other = header_in(tmp_path / "src", "common"), header_in(tmp_path / "src", "arm")
    assert find_copies(users(tmp_path, one, other)) == {}


def test_a_header_that_is_gone_is_itself(tmp_path: Path) -> None:
    assert find_copies(users(tmp_path, tmp_path / "install/gone.h")) == {}
