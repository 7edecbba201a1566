"""Which link units were analysed, and why the others were not: folders as CMake leaves them."""

from pathlib import Path

import pytest
from file_api import reply, target
from static_units import failed_unit, unit

from pytpc.base.errors import InputError
from pytpc.build.reconcile import build_folders, left_out_units, remark, stale_files
from pytpc.static.link_unit import LinkUnit

NATIVE = b"\x7fELF rest"
FULL = b"BC\xc0\xde ... ThinLTO ..."
THIN = b"BC\xc0\xde ..."


def record(folder: Path, *lines: tuple[str, str]) -> None:
    """What tpc.cmake notes: target and reason of package face; each target is there."""
    rows = ""
    for name, left_out in lines:
        (folder / "devel").mkdir(parents=True, exist_ok=True)
        (folder / "devel" / name).touch()
        rows += f"face\t{name}\t{folder}/devel/{name}\t{folder}/tpc/{name}.json\t{left_out}\n"
    (folder / "tpc").mkdir(exist_ok=True)
    (folder / "tpc/targets.tsv").write_text(rows, encoding="utf-8")


def answer(folder: Path, *names: str) -> None:
    """What CMake says of the targets, each with a folder for its objects."""
    targets = [{**target(name, "EXECUTABLE"), "paths": {"build": "."}} for name in names]
    reply(folder, targets)


def objects(folder: Path, name: str, *contents: bytes) -> None:
    place = folder / f"CMakeFiles/{name}.dir/src"
    place.mkdir(parents=True)
    for number, content in enumerate(contents):
        (place / f"{number}.cpp.o").write_bytes(content)


def reasons(folder: Path) -> dict[str, str]:
    return {unit.link_unit: unit.reason for unit in left_out_units(folder)}


def test_each_unit_has_its_reason(tmp_path: Path) -> None:
    names = ("analysed", "left", "native", "thin", "removed")
    record(tmp_path, *((name, "it is a test" if name == "left" else "") for name in names))
    answer(tmp_path, *names, "hidden")
    (tmp_path / "devel/hidden").touch()
    (tmp_path / "tpc/analysed.json").touch()
    objects(tmp_path, "native", NATIVE, NATIVE)
    objects(tmp_path, "thin", FULL, THIN, NATIVE)
    objects(tmp_path, "removed", FULL, NATIVE)
    removed = f"remove {tmp_path}/devel/removed and build again"
    assert reasons(tmp_path) == {
        "hidden": "it was built by a part of the build that tpc.cmake does not see",
        "left": "it is a test",
        "native": "its objects are native code, not compiled with -flto",
        "removed": "the linker did not run the analysis, or its file was removed since; " + removed,
        "thin": "it was compiled for ThinLTO, which never sees a whole link unit",
    }


def test_what_was_not_built_is_no_link_unit(tmp_path: Path) -> None:
    record(tmp_path, ("node", "it is a test"))
    answer(tmp_path, "node", "later")
    assert list(reasons(tmp_path)) == ["node"]


def test_before_cmake_was_asked_the_record_says_what_there_is(tmp_path: Path) -> None:
    record(tmp_path, ("node", "TPC_DISABLE is set"))
    assert reasons(tmp_path) == {"node": "TPC_DISABLE is set"}


def test_without_a_record_there_was_no_tpc(tmp_path: Path) -> None:
    answer(tmp_path, "node")
    (tmp_path / "devel").mkdir()
    (tmp_path / "devel/node").touch()
    assert reasons(tmp_path) == {"node": "its package was configured without TPC"}
    assert left_out_units(tmp_path / "nowhere") == []


def test_a_broken_record_is_named_with_its_line(tmp_path: Path) -> None:
    record(tmp_path, ("node", ""))
    with (tmp_path / "tpc/targets.tsv").open("a", encoding="utf-8") as stream:
        stream.write("two\tfields\n")
    with pytest.raises(InputError, match=r"targets\.tsv:2: 2 fields where 5 are"):
        left_out_units(tmp_path)


def test_files_of_no_target_and_of_one_that_is_left_out_are_stale(tmp_path: Path) -> None:
    record(tmp_path, ("node", ""), ("test", "it is a test"))
    answer(tmp_path, "node", "test", "unseen")
    files = [tmp_path / f"tpc/{name}.json" for name in ("gone", "node", "test", "unseen")]
    assert [path.stem for path in stale_files(tmp_path, files)] == ["gone", "test"]
    assert [*stale_files(tmp_path / "unknown", files)] == []


def test_a_build_base_is_one_folder_or_has_one_for_each_package(tmp_path: Path) -> None:
    for name in ("b", "a"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "CMakeCache.txt").touch()
    (tmp_path / "log").mkdir()
    assert build_folders(tmp_path) == [tmp_path / "a", tmp_path / "b"]
    (tmp_path / "CMakeCache.txt").touch()
    assert build_folders(tmp_path) == [tmp_path]
    with pytest.raises(InputError, match="no such build folder"):
        build_folders(tmp_path / "c")


NOTHING = {"comparisons": 0, "parameter_reads": 0, "exposing_statements": 0}


@pytest.mark.parametrize(
    ("counts", "said"),
    [
        ({}, "ok"),
        (NOTHING, "no ROS call"),
        (NOTHING | {"parameter_reads": 1}, "ok"),
        (NOTHING | {"exposing_statements": 1, "without_debug_info": 2}, "no debug information"),
        ({"without_debug_info": 2}, "ok"),
    ],
)
def test_what_is_said_of_an_analysed_unit(counts: dict[str, int], said: str) -> None:
    data = unit()
    data["counts"] = {**data["counts"], **counts}
    assert remark(LinkUnit.from_json(data, Path("x"))) == said


def test_a_failed_unit_was_left_as_it_was() -> None:
    assert remark(LinkUnit.from_json(failed_unit(), Path("x"))) == "left as it was"


def test_a_unit_may_not_be_analysed_to_the_end() -> None:
    data = unit(incomplete="the analysis takes more than 1 s")
    assert remark(LinkUnit.from_json(data, Path("x"))) == "not analysed to the end"
