"""Static information: the schema, where a broken file is broken, and merging."""

import json
from pathlib import Path
from typing import Any

import pytest
from static_units import KEYS, comparison, failed_unit, unit

from pytpc.base.checked_json import MERGED_SCHEMA, check_schema
from pytpc.base.errors import InputError, WorkspaceError
from pytpc.static.link_unit import LinkUnit, Place, Transform
from pytpc.static.static_info import StaticInfo, collect, load_link_unit, read_static, unit_files

AFFINE = {"kind": "affine", "scale": 0.0174, "offset": 0.0, "text": "x * 0.0174"}
EXPRESSION = {"kind": "expression", "text": "x^2 + 1", "tree": ["+", ["pow", "x", 2.0], 1.0]}
BARE = {"kind": "expression", "text": "x * x"}


def write(path: Path, data: object) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(data), encoding="utf-8")
    return path


def message(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        load_link_unit(path)
    text = str(caught.value)
    assert "\n" not in text
    assert text.startswith(str(path))
    return text.removeprefix(str(path))


def test_fields_arrive_as_they_are_in_the_file(tmp_path: Path) -> None:
    loaded = load_link_unit(write(tmp_path / "detector.json", unit()))
    assert (loaded.package, loaded.link_unit, loaded.status) == ("face", "detector", "ok")
    assert loaded.counts.indirect_calls == 2
    assert loaded.tool.llvm == "19.1.7"
    assert loaded.parameters[0].default == 0.25
    assert loaded.exposing[0].topic == "capture"
    (found,) = loaded.comparisons
    assert found.param_reads == (Place("src/detector.cpp", 12),)
    assert found.exposed_at == Place("src/detector.cpp", 41)
    assert found.transform is None


@pytest.mark.parametrize("default", [3, 3.0, True, "left", None])
def test_a_default_keeps_its_type(tmp_path: Path, default: object) -> None:
    data = unit(comparisons=[comparison(default=default)])
    read = load_link_unit(write(tmp_path / "u.json", data)).comparisons[0].default
    assert (type(read), read) == (type(default), default)


@pytest.mark.parametrize(
    ("transform", "expected"),
    [
        (AFFINE, Transform("affine", 0.0174, 0.0, "x * 0.0174")),
        (BARE, Transform("expression", None, None, "x * x")),
        (
            EXPRESSION,
            Transform("expression", None, None, "x^2 + 1", ("+", ("pow", "x", 2.0), 1.0)),
        ),
    ],
)
def test_transforms_go_there_and_back(
    tmp_path: Path, transform: dict[str, Any], expected: Transform
) -> None:
    data = unit(comparisons=[comparison(type="derived", transform=transform)])
    loaded = load_link_unit(write(tmp_path / "u.json", data))
    assert loaded.comparisons[0].transform == expected
    assert loaded.to_json() == data


BROKEN: list[tuple[dict[str, Any], str]] = [
    ({"schema": 2}, ": /schema: written by a newer TPC (format 2; this one reads 1)"),
    ({"extra": 1}, ": /: "),
    ({"source_root": "src"}, ": /source_root: "),
    ({"status": "half"}, ": /status: "),
    ({"failure": "but ok"}, ": /failure: "),
    ({"status": "failed"}, ": /"),
    ({"tool": {"name": "tpc", "version": "1", "llvm": "19"}}, ": /tool: 'profile' is a required"),
    ({"counts": {}}, ": /counts: "),
    ({"comparisons": [comparison(lineno=-1)]}, ": /comparisons/0/lineno: -1 is less"),
    ({"comparisons": [comparison(lineno="40")]}, ": /comparisons/0/lineno: '40' is not"),
    ({"comparisons": [comparison(distance=0)]}, ": /comparisons/0/distance: 0 is less"),
    ({"comparisons": [comparison(key="x")]}, ": /comparisons/0/key: 'x' does not match"),
    ({"comparisons": [comparison(relation="=>")]}, ": /comparisons/0/relation: "),
    ({"comparisons": [comparison(relation="flag")]}, ": /comparisons/0/relation: "),
    ({"comparisons": [comparison(type="flag")]}, ": /comparisons/0/relation: "),
    ({"comparisons": [comparison(type="derived")]}, ": /comparisons/0/transform: "),
    ({"comparisons": [comparison(transform=AFFINE)]}, ": /comparisons/0/transform: "),
    (
        {"comparisons": [comparison(type="derived", transform={"kind": "affine", "text": "x"})]},
        ": /comparisons/0/transform: 'scale' is a required",
    ),
    (
        {"comparisons": [comparison(type="derived", transform={**EXPRESSION, "scale": 2})]},
        ": /comparisons/0/transform: ",
    ),
    (
        {"comparisons": [comparison(publishes=[{"file": "a.cpp", "line": 3}])]},
        ": /comparisons/0/publishes/0: ",
    ),
    ({"comparisons": [comparison(default=[1])]}, ": /comparisons/0/default: "),
]


@pytest.mark.parametrize(("change", "expected"), BROKEN)
def test_what_breaks_the_schema_is_named(
    tmp_path: Path, change: dict[str, Any], expected: str
) -> None:
    assert message(write(tmp_path / "u.json", unit(**change))).startswith(expected)


def test_a_key_without_a_field_is_a_fault(tmp_path: Path) -> None:
    for field in unit().keys() - {"not_exposed", "blind_spots"}:
        data = unit()
        del data[field]
        assert f"'{field}' is a required property" in message(write(tmp_path / "u.json", data))
    for field in comparison().keys() - {"path"}:
        found = comparison()
        del found[field]
        text = message(write(tmp_path / "u.json", unit(comparisons=[found])))
        assert text.startswith(f": /comparisons/0: '{field}' is a required")


@pytest.mark.parametrize(
    ("raw", "expected"),
    [
        (b"", ":1: not JSON: the file is empty"),
        (b'{"schema": 1,\n "package": "a",\n', ":3: not JSON: "),
        (b'{"schema": 1,\n\n "package": tru}', ":3: not JSON: Expecting value, column 13"),
        (b'{"a": 1,\n "b": "\xff"}', ":2: not JSON: byte 16 is not UTF-8"),
        (b'{"schema": NaN}', ": not JSON that can be read: NaN"),
        (b'{"default": -1e999}', ": not JSON that can be read: -1e999"),
        # Written nowhere: neither to a terminal nor to a file.
        (b'["\\ud83d\\ude00", "\\uD800"]', ": not JSON that can be read: \\ud800 is half"),
        (b"[" * 100_000, ": not JSON that can be read: "),
        (b"[]", ": /: [] is not of type 'object'"),
        (b"null", ": /: None is not of type 'object'"),
    ],
)
def test_a_file_that_is_no_json_is_located(tmp_path: Path, raw: bytes, expected: str) -> None:
    path = tmp_path / "u.json"
    path.write_bytes(raw)
    assert message(path).startswith(expected)


def test_every_truncation_of_a_file_is_one_clear_error(tmp_path: Path) -> None:
    whole = json.dumps(unit(), indent=1).encode()
    path = tmp_path / "u.json"
    for length in range(0, len(whole), 97):
        path.write_bytes(whole[:length])
        assert ": not JSON" in message(path)


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({"column": 16.0}, "/column: 16.0 is not of type"),
        ({"file": "a\0b"}, "/file: 'a\\x00b' does"),
    ],
)
def test_a_place_is_one_that_can_be_looked_up(
    tmp_path: Path, change: dict[str, object], fault: str
) -> None:
    text = message(write(tmp_path / "u.json", unit(comparisons=[comparison(**change)])))
    assert text.startswith(f": /comparisons/0{fault}")


def test_a_message_stays_short_when_the_value_is_long(tmp_path: Path) -> None:
    assert len(message(write(tmp_path / "u.json", unit(package=["x" * 10_000])))) < 300


def test_a_missing_file_is_an_input_error(tmp_path: Path) -> None:
    assert message(tmp_path / "none.json") == ": cannot be read: No such file or directory"


def two_packages(base: Path) -> Path:
    write(base / "face/tpc/detector.json", unit())
    write(
        base / "arm/tpc/mover.json",
        unit(
            package="arm",
            link_unit="mover",
            source_root="/ws/src/arm",
            comparisons=[
                comparison(key=KEYS[2], file="src/mover.cpp"),
                comparison(key=KEYS[1], file="/elsewhere/common.cpp"),
            ],
        ),
    )
    write(base / "arm/tpc/broken.json", failed_unit(package="arm"))
    return base


def test_collect_merges_and_sorts_units(tmp_path: Path) -> None:
    base = two_packages(tmp_path)
    seen: list[tuple[int, int]] = []
    static = collect(base, lambda done, total: seen.append((done, total)))
    assert [(found.package, found.link_unit) for found in static.units] == [
        ("arm", "broken"),
        ("arm", "mover"),
        ("face", "detector"),
    ]
    assert list(static.comparisons) == [KEYS[2], KEYS[1], KEYS[0]]
    assert [found.link_unit for found in static.failed] == ["broken"]
    assert static.unit_of(KEYS[0]).package == "face"
    assert seen == [(1, 3), (2, 3), (3, 3)]


def test_an_analysis_that_ended_early_keeps_its_comparisons_and_is_told(tmp_path: Path) -> None:
    write(tmp_path / "arm/tpc/mover.json", unit(package="arm", incomplete="it takes more than 1 s"))
    static = collect(tmp_path)
    assert len(static.comparisons) == 1
    assert static.troubles == (
        "arm/detector was not analysed to the end, comparisons may be missing:"
        " it takes more than 1 s",
    )
    assert static.units[0].to_json()["incomplete"] == "it takes more than 1 s"


def test_processes_of_a_unit_and_of_a_comparison_are_kept(tmp_path: Path) -> None:
    processes = ["move_base", "amcl"]
    data = unit(processes=processes, comparisons=[comparison(processes=processes[:1])])
    loaded = load_link_unit(write(tmp_path / "u.json", data))
    assert loaded.processes == ("move_base", "amcl")
    assert loaded.comparisons[0].processes == ("move_base",)
    assert loaded.to_json() == data


def test_source_paths_are_absolute(tmp_path: Path) -> None:
    static = collect(two_packages(tmp_path))
    assert static.source_path(KEYS[0]) == Path("/ws/src/face/src/detector.cpp")
    assert static.source_path(KEYS[1]) == Path("/elsewhere/common.cpp")
    with pytest.raises(KeyError):
        static.source_path("no such key")


def test_collect_takes_only_the_files_of_link_units(tmp_path: Path) -> None:
    # A package called tpc has its build folder at <base>/tpc, with JSON files of CMake's in it.
    write(tmp_path / "tpc/compile_commands.json", [])
    (tmp_path / "tpc/CMakeCache.txt").touch()
    ours = write(tmp_path / "tpc/tpc/node.json", unit())
    write(tmp_path / "other/config.json", {})
    write(tmp_path / "other/tpc/node.json.tmp", {})
    write(tmp_path / "other/tpc/node.link.json", {})
    assert unit_files(tmp_path) == [ours]


def test_collect_of_no_folder_is_an_input_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such build folder"):
        collect(tmp_path / "build")


def test_one_broken_file_is_named(tmp_path: Path) -> None:
    two_packages(tmp_path)
    (tmp_path / "arm/tpc/mover.json").write_text("{", encoding="utf-8")
    with pytest.raises(InputError) as caught:
        collect(tmp_path)
    assert str(caught.value).startswith(f"{tmp_path}/arm/tpc/mover.json:1: not JSON")


def test_a_unit_that_occurs_twice_is_refused(tmp_path: Path) -> None:
    write(tmp_path / "face/tpc/detector.json", unit())
    write(tmp_path / "face_old/tpc/detector.json", unit())
    with pytest.raises(InputError, match="detector of package face occurs twice"):
        collect(tmp_path)


def test_a_key_that_occurs_twice_is_refused(tmp_path: Path) -> None:
    write(tmp_path / "a/tpc/detector.json", unit(comparisons=[comparison(), comparison()]))
    with pytest.raises(InputError, match="occurs twice, in detector and detector"):
        collect(tmp_path)
    write(tmp_path / "a/tpc/detector.json", unit())
    write(tmp_path / "b/tpc/other.json", unit(link_unit="other"))
    with pytest.raises(InputError, match="occurs twice, in detector and other"):
        collect(tmp_path)


def test_the_merged_document_goes_there_and_back(tmp_path: Path) -> None:
    static = collect(two_packages(tmp_path / "build"))
    path = tmp_path / "out" / "static.json"
    static.save(path)
    assert StaticInfo.load(path) == static
    first = path.read_bytes()
    StaticInfo.of(reversed(static.units)).save(path)
    assert path.read_bytes() == first
    assert [entry.name for entry in path.parent.iterdir()] == ["static.json"]


def test_the_merged_document_is_that_of_the_contract(tmp_path: Path) -> None:
    static = StaticInfo.of([LinkUnit.from_json(unit(), tmp_path)])
    tpc = {
        "file": "/ws/src/face/src/detector.cpp",
        "lineno": 40,
        "column": 16,
        "parameter": "min_coverage_limit",
        "name": None,
        "type": "parameter",
        "relation": ">",
        "distance": 1,
        "package": "face",
        "place": "src/detector.cpp",
        "keys": [{"key": KEYS[0], "package": "face", "link_unit": "detector", "distance": 1}],
    }
    document = static.to_json()
    others = {"copies": {}, "left_out": [], "doubled": []}
    assert document == {"schema": 1, "units": [unit()], "tpcs": [tpc], **others}
    # The whole document, the units among it, is what the schema of its own says.
    check_schema(document, tmp_path, MERGED_SCHEMA)
    with pytest.raises(InputError, match="/units/0/link_unit"):
        check_schema({**document, "units": [unit(link_unit="")]}, tmp_path, MERGED_SCHEMA)


def test_a_document_of_before_has_its_tpcs_as_well(tmp_path: Path) -> None:
    static = StaticInfo.load(write(tmp_path / "old.json", {"schema": 1, "units": [unit()]}))
    assert [tpc.key for tpc in static.tpcs] == [KEYS[0]]
    assert static.units[0].build_folder is None


def test_a_unit_knows_its_build_folder_and_the_merged_document_keeps_it(tmp_path: Path) -> None:
    path = write(tmp_path / "build/face/tpc/detector.json", unit())
    assert load_link_unit(path).build_folder == str(tmp_path / "build/face")
    collect(tmp_path / "build").save(tmp_path / "static.json")
    (loaded,) = StaticInfo.load(tmp_path / "static.json").units
    assert loaded.build_folder == str(tmp_path / "build/face")
    # Under catkin_make one CMake builds all packages.
    (tmp_path / "build/CMakeCache.txt").touch()
    assert load_link_unit(path).build_folder == str(tmp_path / "build")


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        ({"schema": 1}, '/: not merged static information, "units" is missing'),
        ({"schema": 7, "units": []}, "/schema: written by a newer TPC (format 7;"),
        ({"schema": 1, "units": [unit(), unit(link_unit="")]}, "/units/1/link_unit: "),
        ({"schema": 1, "units": [3]}, "/units/0: 3 is not of type 'object'"),
        ({"schema": 1, "units": [], "tpcs": [3], "copies": {}}, "/tpcs/0: 3 is not of type"),
        ({"schema": 1, "units": [], "more": 1}, "/: "),
    ],
)
def test_a_broken_merged_document_is_located(
    tmp_path: Path, data: dict[str, Any], expected: str
) -> None:
    path = write(tmp_path / "static.json", data)
    with pytest.raises(InputError) as caught:
        StaticInfo.load(path)
    assert str(caught.value).startswith(f"{path}: {expected}")


# Passed on together with its sources, wherever it is unpacked.
def test_a_source_root_may_be_relative_to_the_merged_document(tmp_path: Path) -> None:
    one = LinkUnit.from_json(unit(comparisons=[comparison()]), tmp_path)
    document = StaticInfo.of([one]).to_json()
    document["units"][0]["source_root"] = "../sources/a"
    path = write(tmp_path / "static" / "static.json", document)
    static = read_static(path)
    assert static.units[0].source_root == str(tmp_path / "sources/a")
    found = static.comparisons[KEYS[0]]
    assert static.source_path(KEYS[0]) == tmp_path / "sources/a" / found.file
    # A link unit's own file has an absolute one, as before.
    assert "source_root" in message(write(tmp_path / "a.json", unit(source_root="a")))


def test_read_static_takes_every_form(tmp_path: Path) -> None:
    base = two_packages(tmp_path / ".tpc" / "build")
    expected = collect(base)
    assert read_static(base) == expected
    assert read_static(base / "face/tpc/detector.json").units == expected.units[2:]
    expected.save(tmp_path / ".tpc" / "static.json")
    assert read_static(tmp_path) == expected


def test_read_static_of_a_folder_without_any_is_refused(tmp_path: Path) -> None:
    with pytest.raises(WorkspaceError, match="no static information here"):
        read_static(tmp_path)
